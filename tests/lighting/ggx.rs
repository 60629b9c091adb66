//! Microfacets: closed forms, laws, extremes.

use crate::common::canonical_numbers;
use crate::laws::{Cap, check_directions};
use crate::support::{assert_close, direction, horizontal, over};
use mis::Technique;
use mis::lighting::{Bsdf, DVec3, Direction, GgxConductor, GgxLobe, Surface};

fn seen_at(cos: f64) -> Surface {
    let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
    let eye = direction(sin * 0.6, sin * -0.8, cos);
    Surface::new(DVec3::ZERO, direction(0.0, 0.0, 1.0), eye).unwrap()
}

#[test]
fn the_mass_of_a_cone_at_normal_incidence_is_exact() {
    for (alpha, t) in [(0.1_f64, 0.05_f64), (0.1, 0.5), (1.0, 0.7), (1e-3, 2e-3), (1e-6, 1e-6)] {
        let lobe = GgxLobe::new(&horizontal(), alpha).unwrap();
        let cap = Cap { axis: horizontal().normal(), width: 2.0 * (0.5 * t).sin().powi(2) };
        let mass = over(&cap, 100, &|w| lobe.pdf(w));
        let tan2 = (0.5 * t).tan().powi(2);
        assert_close(mass, tan2 / (alpha * alpha + tan2), 1e-9);
    }
    let tan2 = 0.025_f64.tan().powi(2);
    assert_close(tan2 / (0.01 + tan2), 0.058_846_605_069_33, 1e-13);
}

#[test]
fn lobes_follow_their_pdf() {
    for (alpha, cos) in [(1.0, 1.0), (0.5, 0.8), (0.3, 0.2), (1.0, 0.05)] {
        let surface = seen_at(cos);
        let lobe = GgxLobe::new(&surface, alpha).unwrap();
        let cap = Cap { axis: surface.mirror(), width: 2.0 };
        check_directions(&lobe, &cap, |w| cap.coordinates(w), 0.03);
    }
}

/// f cos θ / p is what shadowing leaves, at most ρ.
#[test]
fn the_weight_of_a_sample_is_its_shadowing() {
    for alpha in [1e-9, 1e-8, 1e-4, 0.1, 1.0] {
        for cos in [1.0, 0.7, 1e-3, 1e-12] {
            let surface = seen_at(cos);
            let (lobe, bsdf) =
                (GgxLobe::new(&surface, alpha).unwrap(), GgxConductor::new(0.9, alpha).unwrap());
            for xi in canonical_numbers(7, 400).chunks_exact(2) {
                let w = lobe.sample(xi);
                let (pdf, value) = (lobe.pdf(&w), bsdf.value(&surface, &w));
                assert!(pdf > 0.0 && pdf.is_finite(), "{alpha} {cos} {xi:?}: {pdf}");
                let z = w.cos(surface.normal());
                if z <= 0.0 {
                    assert_eq!(value, 0.0);
                    continue;
                }
                let tan2 = (1.0 - z) * (1.0 + z) / (z * z);
                let shadowing = 2.0 / (1.0 + (1.0 + alpha * alpha * tan2).sqrt());
                assert_close(value * z / pdf, 0.9 * shadowing, 1e-13 / z.min(1e-1));
            }
        }
    }
}

#[test]
fn light_and_eye_may_change_places() {
    let normal = direction(0.1, 0.2, 0.9);
    let (a, b) = (direction(1.0, 0.3, 0.8), direction(-0.5, 0.4, 0.6));
    for alpha in [0.05, 0.4, 1.0] {
        let bsdf = GgxConductor::new(1.0, alpha).unwrap();
        let f = |eye, light: Direction| {
            bsdf.value(&Surface::new(DVec3::ZERO, normal, eye).unwrap(), &light)
        };
        assert_close(f(a, b), f(b, a), 1e-14);
        assert_eq!(f(a, direction(-0.1, -0.2, -0.9)), 0.0);
    }
}

#[test]
fn the_opposite_direction_has_no_half_vector() {
    let surface = seen_at(0.5);
    let opposite = Direction::new(-surface.outgoing().vector()).unwrap();
    assert_eq!(GgxLobe::new(&surface, 0.5).unwrap().pdf(&opposite), 0.0);
}

#[test]
fn arguments() {
    for bad in [0.0, 1e-10, 1.1, -0.1, f64::NAN, f64::INFINITY] {
        let message = GgxLobe::new(&horizontal(), bad).unwrap_err().to_string();
        assert!(message.contains("GgxLobe: `roughness`"), "{message}");
        assert!(GgxConductor::new(1.0, bad).is_err());
    }
    for bad in [-0.1, 1.1, f64::NAN] {
        assert!(GgxConductor::new([0.5, bad], 0.5).is_err());
    }
}
