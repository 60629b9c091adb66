//! Microfacets: closed forms, laws, extremes.

use std::f64::consts::{FRAC_1_PI, TAU};

use crate::common::canonical_numbers;
use crate::common::quadrature::gauss;
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
            let mut xis = canonical_numbers(7, 400);
            for u in [0.0, 1e-300, 1.0 - 1e-15, 1.0 - f64::EPSILON / 2.0, 1.0] {
                xis.extend((0..=20).flat_map(|k| [u, f64::from(k) / 20.0]));
            }
            for xi in xis.chunks_exact(2) {
                let w = lobe.sample(xi);
                let (pdf, value) = (lobe.pdf(&w), bsdf.value(&surface, &w));
                assert!(pdf > 0.0 && pdf.is_finite(), "{alpha} {cos} {xi:?}: {pdf}");
                let length = w.vector().length();
                assert!((length - 1.0).abs() < 1e-15, "{alpha} {cos} {xi:?}: {length:e}");
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
fn samples_of_the_steepest_facets_have_a_density() {
    // The last canonical number gives a facet edge on, up to rounding on either side.
    for (k, x) in canonical_numbers(8, 600).into_iter().enumerate() {
        // From above, and from grazing angles of all orders, over level and tilted surfaces.
        let cos = if k % 2 == 0 { x } else { 10f64.powf(-15.0 * x) };
        let normal = direction(0.3 * x, -0.5 + x, 0.8).vector();
        let sideways = normal.any_orthonormal_vector();
        let eye = cos * normal + ((1.0 - cos) * (1.0 + cos)).sqrt() * sideways;
        let (normal, eye) = (Direction::new(normal).unwrap(), Direction::new(eye).unwrap());
        let Ok(tilted) = Surface::new(DVec3::ZERO, normal, eye) else { continue };
        let surface = if k % 3 == 0 { seen_at(cos) } else { tilted };
        for alpha in [1e-9, 1e-3, 0.3, 1.0] {
            let lobe = GgxLobe::new(&surface, alpha).unwrap();
            for u in [0.0, 0.5, 1.0 - 1e-9, 1.0 - 1e-14, 1.0] {
                let w = lobe.sample(&[u, k as f64 / 600.0]);
                let pdf = lobe.pdf(&w);
                assert!(pdf > 0.0 && pdf.is_finite(), "{alpha} {x} {u}: {pdf}");
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
    for alpha in [1e-9, 1e-8, 1e-4, 0.5, 1.0] {
        for cos in [1.0, 0.5, 1e-6, 1e-12] {
            let surface = seen_at(cos);
            let opposite = Direction::new(-surface.outgoing().vector()).unwrap();
            // Exactly opposite, or a rounding away, where it is any.
            let pdf = GgxLobe::new(&surface, alpha).unwrap().pdf(&opposite);
            let exactly = opposite.vector() == -surface.outgoing().vector();
            assert!(pdf.is_finite() && (pdf == 0.0 || !exactly), "{alpha} {cos}: {pdf}");
            assert!(exactly || cos < 1.0);
            let bsdf = GgxConductor::new(1.0, alpha).unwrap();
            assert_eq!(bsdf.value_and_pdf(&surface, &opposite), (0.0, pdf));
        }
    }
}

const ROUGHNESSES: [f64; 8] = [1e-9, 1e-8, 1e-7, 1e-5, 1e-3, 0.1, 0.5, 1.0];

/// The direction of light that a facet of the slope (x, y) mirrors to the eye.
fn mirrored(surface: &Surface, x: f64, y: f64) -> Option<Direction> {
    let facet = direction(-x, -y, 1.0);
    (surface.outgoing().cos(facet) > 0.0).then(|| surface.outgoing().reflected(facet))
}

#[test]
fn the_density_is_that_of_the_formula() {
    // As printed: with the unit half vector m, D(m) = 1 / (π α² cos⁴ θ (1 + tan² θ / α²)²), and
    // G1(ω) = 2 / (1 + √(1 + α² tan² θ)).
    let g1 = |alpha: f64, w: DVec3| {
        let tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
        2.0 / (1.0 + (1.0 + alpha * alpha * tan2).sqrt())
    };
    let mut compared = 0;
    for alpha in ROUGHNESSES {
        let bsdf = GgxConductor::new(0.8, alpha).unwrap();
        for cos in [1.0, 0.7, 0.1, 1e-3, 1e-6, 1e-12] {
            let surface = seen_at(cos);
            let lobe = GgxLobe::new(&surface, alpha).unwrap();
            let o = surface.outgoing().vector();
            for (k, slope) in [0.0, 1e-3, 0.1, 1.0, 10.0, 1e3].into_iter().enumerate() {
                let turn = k as f64;
                let (x, y) = (alpha * slope * turn.cos(), alpha * slope * turn.sin());
                let Some(w) = mirrored(&surface, x, y) else { continue };
                let i = w.vector();
                let m = (o + i).normalize();
                let (cos2, sin2) = (m.z * m.z, m.x * m.x + m.y * m.y);
                let k = cos2 * (1.0 + sin2 / cos2 / (alpha * alpha));
                let d = FRAC_1_PI / (alpha * alpha * k * k);
                let pdf = g1(alpha, o) * d / (4.0 * o.z);
                assert_close(lobe.pdf(&w), pdf, 2e-14);
                assert_eq!(bsdf.pdf(0, &surface, &w), lobe.pdf(&w));
                let value = if i.z > 0.0 { 0.8 * pdf * g1(alpha, i) / i.z } else { 0.0 };
                let (both, density) = bsdf.value_and_pdf(&surface, &w);
                assert_eq!((both, density), (bsdf.value(&surface, &w), lobe.pdf(&w)));
                assert!((both - value).abs() <= 2e-14 * value, "{alpha} {cos}: {both} {value}");
                compared += 1;
            }
        }
    }
    assert!(compared > 200, "{compared}");
}

#[test]
fn visible_normals_have_a_density() {
    // ∫ D_v dm = ∫ p(ω) 4 (ω_o·m) dm = 1, over slopes α (x, y), dm = cos³ θ α² dx dy.
    for alpha in ROUGHNESSES {
        for cos in [1.0, 0.6, 0.01] {
            let surface = seen_at(cos);
            let lobe = GgxLobe::new(&surface, alpha).unwrap();
            let rule = gauss(24);
            let mut sum = 0.0;
            for &(u, wu) in &rule {
                // |x, y|² = u / (1 - u): that share of the facets is less steep.
                let (u, wu) = (u * (2.0 - u), wu * 2.0 * (1.0 - u));
                let slope = (u / (1.0 - u)).sqrt();
                let per_area = 1.0 / ((1.0 - u) * (1.0 - u));
                for &(v, wv) in &rule {
                    let (sin, cos) = (TAU * v).sin_cos();
                    let (x, y) = (alpha * slope * cos, alpha * slope * sin);
                    let Some(w) = mirrored(&surface, x, y) else { continue };
                    let facet = direction(-x, -y, 1.0);
                    let z = facet.vector().z;
                    let normals = 0.5 * TAU * per_area * z.powi(3) * alpha * alpha;
                    let mirror = 4.0 * surface.outgoing().cos(facet);
                    sum += wu * wv * normals * mirror * lobe.pdf(&w);
                }
            }
            // Facets that the eye does not see end the slopes within a panel.
            let allowed = if cos > 0.1 { 2e-6 } else { 5e-4 };
            assert!((sum - 1.0).abs() < allowed, "{alpha} {cos}: {sum}");
        }
    }
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
