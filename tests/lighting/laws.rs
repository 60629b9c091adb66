//! Every technique: ∫ p dω = 1, and samples as the pdf says.

use std::f64::consts::TAU;

use crate::common::canonical_numbers;
use crate::support::{ceiling, direction};
use mis::Technique;
use mis::check::{Law, Options};
use mis::lighting::{
    CosineHemisphere, DVec3, Direction, PhongLobe, Rectangle, Shape, Sphere, SphericalRectangle,
};
use mis::technique::canonical;

/// Every law, by a reference that is trusted; ∫ p dω = 1 to `integral` by quadrature.
pub(crate) fn check_directions(
    p: &dyn Technique<Point = Direction>,
    reference: &dyn Technique<Point = Direction>,
    coordinates: impl Fn(&Direction) -> [f64; 2],
    integral: f64,
) {
    // Two each of χ² and Kolmogorov, one of the cells, and the integral, at 1e-5 each.
    let options = Options::strict().integral(integral).false_alarms(6e-5);
    let report = mis::check::technique(p, reference, coordinates, &options);
    assert!(report.passed(), "{report}");
    assert!(report.get(Law::Integral).unwrap().allowed() <= integral, "{report}");
}

/// Uniform per steradian on the cap 1 - cos α ≤ `width` about `axis`.
pub(crate) struct Cap {
    pub(crate) axis: Direction,
    pub(crate) width: f64,
}

impl Cap {
    /// The canonical numbers of a direction.
    pub(crate) fn coordinates(&self, w: &Direction) -> [f64; 2] {
        let (s, t) = self.axis.vector().any_orthonormal_pair();
        let turn = w.vector().dot(t).atan2(w.vector().dot(s)) / TAU;
        [w.one_minus_cos(self.axis) / self.width, (turn + 1.0).fract()]
    }
}

impl Technique for Cap {
    type Point = Direction;

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> Direction {
        let q = self.width * canonical(xi, 0);
        let (sin, cos) = (TAU * canonical(xi, 1)).sin_cos();
        let (s, t) = self.axis.vector().any_orthonormal_pair();
        let radius = (q * (2.0 - q)).sqrt();
        Direction::new((1.0 - q) * self.axis.vector() + radius * (cos * s + sin * t)).unwrap()
    }

    fn pdf(&self, w: &Direction) -> f64 {
        // The rim is as wide as a direction is exact.
        let within = w.one_minus_cos(self.axis) <= self.width * (1.0 + 1e-9) + 1e-15;
        if within { 1.0 / (TAU * self.width) } else { 0.0 }
    }
}

fn check_cap(p: &dyn Technique<Point = Direction>, axis: Direction, width: f64) {
    let cap = Cap { axis, width };
    check_directions(p, &cap, |w| cap.coordinates(w), 1e-9);
}

#[test]
fn cones_are_uniform_per_steradian() {
    let axis = direction(-0.4, 0.1, -0.7);
    for s in [1e-3, 0.5, 0.999] {
        let sphere = Sphere::new(2.0 * axis.vector(), 2.0 * s).unwrap();
        let cone = sphere.seen_from(DVec3::ZERO).unwrap();
        let width = cone.solid_angle() / TAU;
        check_cap(&cone, axis, width);
    }
    let within = Sphere::new(axis.vector(), 2.0).unwrap().seen_from(DVec3::ZERO).unwrap();
    check_cap(&within, axis, 2.0);
}

#[test]
fn lobes_follow_their_pdf() {
    let axis = direction(0.6, -0.2, 0.3);
    let cosine = CosineHemisphere::new(axis);
    check_cap(&cosine, axis, 1.0);
    for n in [0.0, 1.0, 30.0, 1e4, 1e8] {
        let lobe = PhongLobe::new(axis, n).unwrap();
        // All but e^-60 of the mass, where the lobe ends nowhere.
        let end = if n < 60.0 { 1.0 } else { 60.0 / n };
        check_cap(&lobe, axis, end);
    }
}

/// Uniform per area of the rectangle at the height h; per steradian that is d³ / (h A).
struct ByArea {
    x: [f64; 2],
    y: [f64; 2],
    h: f64,
}

impl ByArea {
    /// The canonical numbers of a direction.
    fn coordinates(&self, w: &Direction) -> [f64; 2] {
        let at = w.vector() * (self.h / w.vector().z);
        let share = |x: f64, [a, b]: [f64; 2]| (x - a) / (b - a);
        [share(at.x, self.x), share(at.y, self.y)]
    }
}

impl Technique for ByArea {
    type Point = Direction;

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> Direction {
        let at = |u: f64, [a, b]: [f64; 2]| a + u * (b - a);
        let (x, y) = (at(canonical(xi, 0), self.x), at(canonical(xi, 1), self.y));
        Direction::new(DVec3::new(x, y, self.h)).unwrap()
    }

    fn pdf(&self, w: &Direction) -> f64 {
        // The rim is as wide as a direction is exact.
        if !self.coordinates(w).iter().all(|u| (-1e-9..=1.0 + 1e-9).contains(u)) {
            return 0.0;
        }
        let area = (self.x[1] - self.x[0]) * (self.y[1] - self.y[0]);
        (self.h / w.vector().z).powi(3) / (self.h * area)
    }
}

fn check_rectangle(p: &SphericalRectangle, x: [f64; 2], y: [f64; 2], h: f64) {
    let by_area = ByArea { x, y, h };
    check_directions(p, &by_area, |w| by_area.coordinates(w), 1e-7);
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
