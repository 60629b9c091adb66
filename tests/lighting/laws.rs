//! Every technique: ∫ p dω = 1, and samples as the pdf says.

use std::f64::consts::TAU;

use crate::common::laws::{canonical_numbers, chi_squared};
use crate::common::quadrature::gauss;
use crate::support::{ceiling, direction};
use mis::Technique;
use mis::lighting::{
    CosineHemisphere, DVec3, Direction, PhongLobe, Rectangle, Shape, Sphere, SphericalRectangle,
};

/// Chi-squared over cells of rings × 8 sectors about `axis`, with the cells' probabilities from
/// the pdf; `edges` are of q = 1 - cos α, and outside them there is no density.
fn check_rings(p: &dyn Technique<Point = Direction>, axis: Direction, edges: &[f64], n: usize) {
    const SECTORS: usize = 8;
    let (s, t) = axis.vector().any_orthonormal_pair();
    let turned = |w: &Direction| {
        let turn = w.vector().dot(t).atan2(w.vector().dot(s)) / TAU;
        (turn + 1.0).fract()
    };
    let direction_at = |q: f64, turn: f64| {
        let (sin, cos) = (TAU * turn).sin_cos();
        let radius = (q * (2.0 - q)).sqrt();
        Direction::new((1.0 - q) * axis.vector() + radius * (cos * s + sin * t)).unwrap()
    };
    let rule = gauss(64);
    let mut probabilities = Vec::new();
    for ring in edges.windows(2) {
        for sector in 0..SECTORS {
            let mut mass = 0.0;
            for &(u, wu) in &rule {
                for &(v, wv) in &gauss(2) {
                    let q = ring[0] + u * (ring[1] - ring[0]);
                    let w = direction_at(q, (sector as f64 + v) / SECTORS as f64);
                    mass += wu * wv * p.pdf(&w) * (ring[1] - ring[0]) * TAU / SECTORS as f64;
                }
            }
            probabilities.push(mass);
        }
    }
    let total: f64 = probabilities.iter().sum();
    assert!((total - 1.0).abs() < 1e-9, "∫ p = {total}");
    let xis = canonical_numbers(11, 2 * n);
    let cells = xis.chunks_exact(2).map(|xi| {
        let w = p.sample(xi);
        assert!(p.pdf(&w) > 0.0);
        let q = w.one_minus_cos(axis);
        let ring = edges[1..edges.len() - 1].iter().filter(|edge| q >= **edge).count();
        ring * SECTORS + ((SECTORS as f64 * turned(&w)) as usize).min(SECTORS - 1)
    });
    chi_squared(&probabilities, cells);
}

fn rings(width: f64, quantile: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..=16).map(|k| if k == 16 { width } else { quantile(f64::from(k) / 16.0) }).collect()
}

#[test]
fn cones_are_uniform_per_steradian() {
    let axis = direction(-0.4, 0.1, -0.7);
    for s in [1e-3, 0.5, 0.999] {
        let sphere = Sphere::new(2.0 * axis.vector(), 2.0 * s).unwrap();
        let cone = sphere.seen_from(DVec3::ZERO).unwrap();
        let width = cone.solid_angle() / TAU;
        check_rings(&cone, axis, &rings(width, |u| u * width), 100_000);
    }
    let within = Sphere::new(axis.vector(), 2.0).unwrap().seen_from(DVec3::ZERO).unwrap();
    check_rings(&within, axis, &rings(2.0, |u| 2.0 * u), 100_000);
}

#[test]
fn lobes_follow_their_pdf() {
    let axis = direction(0.6, -0.2, 0.3);
    let cosine = CosineHemisphere::new(axis);
    check_rings(&cosine, axis, &rings(1.0, |u| 1.0 - (1.0 - u).sqrt()), 100_000);
    for n in [0.0, 1.0, 30.0, 1e4, 1e8] {
        let lobe = PhongLobe::new(axis, n).unwrap();
        let quantile = |u: f64| -((-u).ln_1p() / (n + 1.0)).exp_m1();
        // All but e^-60 of the mass, where the lobe ends nowhere.
        let end = if n < 60.0 { 1.0 } else { 60.0 / n };
        check_rings(&lobe, axis, &rings(end, quantile), 100_000);
    }
}

/// Chi-squared over 8 × 8 equal cells of the rectangle at the height h, with cells' probabilities
/// ∫ p h / (x² + y² + h²)^(3/2) dx dy.
fn check_rectangle(p: &SphericalRectangle, x: [f64; 2], y: [f64; 2], h: f64) {
    const CELLS: usize = 8;
    let (dx, dy) = ((x[1] - x[0]) / CELLS as f64, (y[1] - y[0]) / CELLS as f64);
    let rule = gauss(12);
    let mut probabilities = Vec::new();
    for i in 0..CELLS {
        for j in 0..CELLS {
            let mut mass = 0.0;
            for &(u, wu) in &rule {
                for &(v, wv) in &rule {
                    let at = DVec3::new(x[0] + (i as f64 + u) * dx, y[0] + (j as f64 + v) * dy, h);
                    let pdf = p.pdf(&Direction::new(at).unwrap());
                    mass += wu * wv * dx * dy * pdf * h / at.length().powi(3);
                }
            }
            probabilities.push(mass);
        }
    }
    let total: f64 = probabilities.iter().sum();
    assert!((total - 1.0).abs() < 1e-7, "{x:?} {y:?} {h}: ∫ p = {total}");
    let cell = |at: f64, low: f64, width: f64| (((at - low) / width) as usize).min(CELLS - 1);
    let xis = canonical_numbers(12, 200_000);
    let cells = xis.chunks_exact(2).map(|xi| {
        let w = p.sample(xi);
        assert!(p.pdf(&w) > 0.0);
        let at = w.vector() * (h / w.vector().z);
        cell(at.x, x[0], dx) * CELLS + cell(at.y, y[0], dy)
    });
    chi_squared(&probabilities, cells);
}

#[test]
fn rectangles_are_uniform_per_steradian() {
    for (x, y, h) in [
        ([-1.0, 1.0], [-1.0, 1.0], 1.0),
        ([-0.5, 2.0], [1.0, 3.0], 0.7),
        ([3.0, 3.5], [-4.0, -1.0], 0.2),
        ([-1.0, 3.0], [-2.0, 0.5], 0.4),
        ([1e-4, 3e-4], [-2e-4, 1e-4], 1.0),
        ([1.0, 2.0], [-1.0, 1.0], 1e-3),
    ] {
        let p = ceiling(x, y, h).seen_from(DVec3::ZERO).unwrap();
        check_rectangle(&p, x, y, h);
    }
}

#[test]
fn a_tilted_rectangle_is_the_same_as_a_level_one() {
    // Turned about the origin, with the rectangle: the solid angle and the samples turn with it.
    let axes = [
        DVec3::new(2.0, -1.0, 2.0) / 3.0,
        DVec3::new(2.0, 2.0, -1.0) / 3.0,
        DVec3::new(-1.0, 2.0, 2.0) / 3.0,
    ];
    let turn = |v: DVec3| v.x * axes[0] + v.y * axes[1] + v.z * axes[2];
    let level = Rectangle::new(DVec3::new(1.0, 0.3, 2.0), DVec3::X, 0.5 * DVec3::Y).unwrap();
    let tilted =
        Rectangle::new(turn(DVec3::new(1.0, 0.3, 2.0)), turn(DVec3::X), turn(0.5 * DVec3::Y));
    let point = DVec3::new(0.2, -0.1, 0.4);
    let level = level.seen_from(point).unwrap();
    let tilted = tilted.unwrap().seen_from(turn(point)).unwrap();
    assert!((tilted.solid_angle() / level.solid_angle() - 1.0).abs() < 1e-14);
    for xi in canonical_numbers(13, 200).chunks_exact(2) {
        let (v, w) = (level.sample(xi), tilted.sample(xi));
        assert!((turn(v.vector()) - w.vector()).length() < 1e-14);
        let (s, t) = (level.hit(&v).unwrap(), tilted.hit(&w).unwrap());
        assert!((s / t - 1.0).abs() < 1e-14);
        assert_eq!(level.pdf(&direction(0.0, 0.0, -1.0)), 0.0);
    }
}

#[test]
fn lengths_may_be_of_any_unit() {
    // From 2^-900 to 2^900: the same bits.
    let xis = canonical_numbers(23, 200);
    for exponent in [-900, -500, -300, 300, 500, 900] {
        let unit = 2f64.powi(exponent);
        let point = DVec3::new(0.2, 0.1, -0.4);
        let seen = |unit: f64| {
            let rectangle =
                Rectangle::new(DVec3::ONE * unit, DVec3::X * unit, 1.5 * DVec3::Z * unit).unwrap();
            let sphere = Sphere::new(DVec3::new(2.0, 3.0, -1.0) * unit, 1.5 * unit).unwrap();
            let around = Sphere::new(DVec3::new(2.0, 3.0, -1.0) * unit, 5.0 * unit).unwrap();
            [rectangle.into(), sphere.into(), around.into()]
                .map(|shape: Shape| shape.seen_from(point * unit).unwrap())
        };
        for (here, there) in seen(1.0).iter().zip(&seen(unit)) {
            assert_eq!(here.value(), there.value());
            for xi in xis.chunks_exact(2) {
                let (v, w) = (here.sample(xi), there.sample(xi));
                assert_eq!((v, here.pdf(&v)), (w, there.pdf(&w)));
                assert_eq!(here.hit(&v).unwrap() * unit, there.hit(&w).unwrap());
            }
        }
    }
}

#[test]
fn missing_numbers_give_no_direction() {
    let sphere = Sphere::new(DVec3::Z, 0.5).unwrap();
    let rectangle = ceiling([-1.0, 1.0], [-1.0, 1.0], 1.0);
    let lobe = PhongLobe::new(direction(0.0, 0.0, 1.0), 5.0).unwrap();
    let [sphere, rectangle] =
        [sphere.into(), rectangle.into()].map(|s: Shape| s.seen_from(DVec3::ZERO).unwrap());
    let hemisphere = CosineHemisphere::new(direction(0.0, 0.0, 1.0));
    let techniques: [&dyn Technique<Point = Direction>; 4] =
        [&sphere, &rectangle, &lobe, &hemisphere];
    for technique in techniques {
        for xi in [&[][..], &[0.5], &[f64::NAN, 0.5], &[0.5, f64::NAN]] {
            let w = technique.sample(xi);
            assert!(w.vector().is_nan() && !(technique.pdf(&w) > 0.0), "{xi:?}: {w:?}");
        }
    }
}
