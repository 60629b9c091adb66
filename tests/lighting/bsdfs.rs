//! The modified Phong model over all exponents, sums of BSDFs, and wrong arguments.

use std::f64::consts::TAU;

use crate::common::canonical_numbers;
use crate::support::{alone, assert_close, assert_unbiased, direction, horizontal, sphere_light};
use mis::lighting::{
    Bsdf, CosineHemisphere, DVec3, Direction, Lambert, Light, ModifiedPhong, PhongLobe, Rectangle,
    ReflectedRadiance, Sphere, Surface,
};
use mis::{Estimator, Integrand, MultiSample, Technique};

const EXPONENTS: [f64; 5] = [0.0, 1.0, 1e2, 1e6, 1e12];

/// Radiance 1 from everywhere.
fn furnace() -> Light<f64> {
    sphere_light(DVec3::new(1.0, 0.0, 0.0), 10.0, 1.0)
}

#[test]
fn lobe_samples_have_a_density_at_any_exponent() {
    for k in 0..20 {
        let turn = f64::from(k);
        lobe_samples_about(direction(turn.sin(), turn.cos(), 0.2 * turn - 2.0));
    }
}

fn lobe_samples_about(axis: Direction) {
    let mut xis = canonical_numbers(31, 500);
    for u in [0.0, 1e-300, 1.0 - f64::EPSILON / 2.0, 1.0] {
        xis.extend((0..=50).flat_map(|k| [u, f64::from(k) / 50.0]));
    }
    for n in [0.0, 1e-3, 1.0, 1e2, 1e6, 1e12, 1e24] {
        let lobe = PhongLobe::new(axis, n).unwrap();
        for xi in xis.chunks_exact(2) {
            let w = lobe.sample(xi);
            let (pdf, ln_pdf) = (lobe.pdf(&w), lobe.ln_pdf(&w));
            assert!(pdf > 0.0 && pdf.is_finite(), "n = {n}, {xi:?}: {pdf}");
            assert!((ln_pdf - pdf.ln()).abs() < 1e-13, "n = {n}, {xi:?}");
            // p = (n + 1) / 2π (1 - ξ)^(n / (n + 1)), as far as the direction resolves it.
            let u = mis::technique::canonical(xi, 0);
            let exact = ((n + 1.0) / TAU).ln() + n / (n + 1.0) * (-u).ln_1p();
            let q = -((-u).ln_1p() / (n + 1.0)).exp_m1();
            let resolution = 1e-15 * (1.0 + n * q.max(1e-32).sqrt() / (1.0 - q).max(1e-16));
            assert!(
                (ln_pdf - exact).abs() < 1e-13 + resolution,
                "n = {n}, {xi:?}: {ln_pdf} {exact}"
            );
        }
        let opposite = Direction::new(-axis.vector()).unwrap();
        assert_eq!((lobe.pdf(&opposite), lobe.ln_pdf(&opposite)), (0.0, f64::NEG_INFINITY));
    }
}

#[test]
fn at_normal_incidence_the_albedo_is_exact() {
    // ρ (n + 2) / 2π ∫ cosⁿ⁺¹ = ρ.
    let incident = alone(furnace());
    for n in EXPONENTS {
        let bsdf = ModifiedPhong::new(0.7, n).unwrap();
        let f = ReflectedRadiance::new(&incident, horizontal(), &bsdf);
        let lobe = &bsdf.techniques(&horizontal())[0];
        let estimate = MultiSample::new(&[(lobe, 40_000)]).unwrap().estimate(&f, 1).unwrap();
        // The contributions are ρ (n + 2) / (n + 1) cos α, with the variance below.
        let v = 1.0 / ((n + 1.0) * (n + 3.0));
        let slack = 1.1 * (v / 40_000.0).sqrt() + 1e-15;
        assert_unbiased(&estimate, 0.7, slack, &format!("n = {n}"));
    }
}

#[test]
fn lobe_samples_below_the_surface_contribute_nothing_and_count() {
    let incident = alone(furnace());
    for n in EXPONENTS {
        // Seen at so flat an angle that half of the lobe is below the surface.
        let normal = direction(0.0, 0.0, 1.0);
        let surface = Surface::new(DVec3::ZERO, normal, direction(1.0, 0.0, 1e-12)).unwrap();
        let bsdf = ModifiedPhong::new(1.0, n).unwrap();
        let f = ReflectedRadiance::new(&incident, surface, &bsdf);
        let lobe = &bsdf.techniques(&surface)[0];
        let samples = 20_000;
        let estimate = MultiSample::new(&[(lobe, samples)]).unwrap().estimate(&f, 2).unwrap();
        let z = (estimate.zero() as f64 - 1e4) / 5000f64.sqrt();
        assert!(z.abs() < 5.0, "n = {n}: {} at zero", estimate.zero());
        assert_eq!(estimate.samples(), samples);
        // E[cos θ; above] for cos θ = sin α cos φ is E[sin α] / π.
        let exact = (n + 2.0) / (n + 1.0) * mean_sine(n) / std::f64::consts::PI;
        assert_unbiased(&estimate, exact, 0.05, &format!("n = {n}"));
    }
}

/// A BSDF that claims to reflect light from below, too.
#[derive(Debug)]
struct Translucent;

impl Bsdf for Translucent {
    type Value = f64;

    fn value(&self, _: &Surface, _: &Direction) -> f64 {
        1.0
    }

    fn sample(&self, _: usize, surface: &Surface, xi: &[f64]) -> Direction {
        CosineHemisphere::new(surface.normal()).sample(xi)
    }

    fn pdf(&self, _: usize, surface: &Surface, w: &Direction) -> f64 {
        CosineHemisphere::new(surface.normal()).pdf(w)
    }
}

#[test]
fn light_from_below_the_surface_is_not_reflected() {
    let incident = alone(furnace());
    let (surface, below) = (horizontal(), direction(1.0, 0.0, -1e-9));
    assert_eq!(Lambert::new(0.5).unwrap().value(&surface, &below), 0.0);
    let oblique = Surface::new(DVec3::ZERO, surface.normal(), direction(-1.0, 0.0, 0.5)).unwrap();
    let phong = ModifiedPhong::new(0.5, 2.0).unwrap();
    assert_eq!(phong.value(&oblique, &below), 0.0);
    assert!(phong.value(&oblique, &direction(1.0, 0.0, 1e-9)) > 0.0);
    let f = ReflectedRadiance::new(&incident, surface, &Translucent);
    assert_eq!(f.eval(&below), 0.0);
    assert!(f.eval(&direction(1.0, 0.0, 1e-9)) > 0.0);
}

/// E[sin α] for the density (n + 1) cosⁿ α sin α: (n + 1) B((n + 1) / 2, 3/2) / 2.
fn mean_sine(n: f64) -> f64 {
    use statrs::function::gamma::ln_gamma;
    if n > 1e5 {
        // 1 - (3/4 + 1/8) / n and so on; sqrt(π / 2n) to 1 part in n.
        return (std::f64::consts::PI / (2.0 * n)).sqrt();
    }
    let ln_beta = ln_gamma(0.5 * (n + 1.0)) + ln_gamma(1.5) - ln_gamma(0.5 * n + 2.0);
    0.5 * (n + 1.0) * ln_beta.exp()
}

#[test]
fn a_sum_of_bsdfs_is_a_pair_with_a_technique_for_each_lobe() {
    let light = Light::new(Sphere::new(DVec3::new(0.5, 0.2, 3.0), 0.4).unwrap(), [1.0, 2.0, 4.0]);
    let scene = mis::lighting::Scene::new().light(light.unwrap());
    let incident = scene.seen_from(DVec3::ZERO).unwrap();
    let diffuse = Lambert::new([0.07, 0.09, 0.13]).unwrap();
    let glossy = ModifiedPhong::new([0.5; 3], 100.0).unwrap();
    let sum = (diffuse, glossy);
    let surface = horizontal();
    assert_eq!(sum.techniques(&surface).len(), 2);
    let w = direction(0.1, 0.1, 1.0);
    let parts = [diffuse.value(&surface, &w), glossy.value(&surface, &w)];
    for (c, total) in sum.value(&surface, &w).into_iter().enumerate() {
        assert_close(total, parts[0][c] + parts[1][c], 1e-15);
    }
    let lobes = sum.techniques(&surface);
    let light = &incident.lights()[0];
    let f = ReflectedRadiance::new(&incident, surface, &sum);
    let all = MultiSample::new(&[(light, 20_000), (&lobes[0], 20_000), (&lobes[1], 20_000)]);
    let all = all.unwrap().estimate(&f, 5).unwrap();
    let one = MultiSample::new(&[(light, 40_000)]).unwrap().estimate(&f, 6).unwrap();
    for c in 0..3 {
        let (a, b) = (all.standard_error()[c].unwrap(), one.standard_error()[c].unwrap());
        let z = (all.value()[c] - one.value()[c]) / a.hypot(b);
        assert!(z.abs() < 5.0 && a.max(b) < 0.01 * one.value()[c], "channel {c}: z = {z}");
    }
}

#[test]
fn wrong_arguments_are_named() {
    let message = |error: mis::ArgumentError| error.to_string();
    assert_eq!(
        message(Lambert::new(1.5).unwrap_err()),
        "Lambert: `albedo` is 1.5, but every channel must be in [0, 1]"
    );
    assert_eq!(ModifiedPhong::new([0.5, f64::NAN], 1.0).unwrap_err().argument(), "albedo");
    for n in [-1.0, f64::NAN, 1e25] {
        assert_eq!(ModifiedPhong::new(0.5, n).unwrap_err().argument(), "exponent");
        assert_eq!(PhongLobe::new(direction(0.0, 0.0, 1.0), n).unwrap_err().owner(), "PhongLobe");
    }
    let up = direction(0.0, 0.0, 1.0);
    let below = Surface::new(DVec3::ZERO, up, direction(0.0, 0.0, -1.0));
    assert_eq!(below.unwrap_err().argument(), "outgoing");
    assert!(Surface::new(DVec3::NAN, up, up).is_err());
    let no_direction = PhongLobe::new(up, 1.0).unwrap().sample(&[]);
    for outgoing in [direction(1.0, 0.0, 0.0), no_direction] {
        assert!(Surface::new(DVec3::ZERO, up, outgoing).is_err());
    }
    let sphere = Sphere::new(DVec3::Z, 0.5).unwrap();
    for radiance in [-1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(Light::new(sphere, radiance).unwrap_err().argument(), "radiance");
    }
    // A rectangle's, each constructor in its own words.
    let (x, y) = (DVec3::X, DVec3::new(0.5, 1.0, 0.0));
    let of = |result: Result<Rectangle, mis::ArgumentError>| result.unwrap_err().to_string();
    assert_eq!(
        of(Rectangle::new(DVec3::ZERO, x, y)),
        "Rectangle: `half_y` is DVec3(0.5, 1.0, 0.0), but it must be perpendicular to half_x = \
         [1, 0, 0]"
    );
    assert_eq!(
        of(Rectangle::from_corner(DVec3::ZERO, x, y)),
        "Rectangle: `y` is DVec3(0.5, 1.0, 0.0), but it must be perpendicular to x = [1, 0, 0]"
    );
    for bad in [DVec3::NAN, DVec3::INFINITY] {
        let named = |result: Result<Rectangle, mis::ArgumentError>| result.unwrap_err();
        assert_eq!(named(Rectangle::new(bad, x, DVec3::Y)).argument(), "centre");
        assert_eq!(named(Rectangle::new(DVec3::ZERO, bad, y)).argument(), "half_x");
        assert_eq!(named(Rectangle::from_corner(bad, x, DVec3::Y)).argument(), "corner");
        assert_eq!(named(Rectangle::from_corner(DVec3::ZERO, x, bad)).argument(), "y");
    }
    let far = Rectangle::from_corner(f64::MAX * DVec3::X, f64::MAX * DVec3::X, DVec3::Y);
    assert_eq!(far.unwrap_err().argument(), "corner");
    let scene = mis::lighting::Scene::<f64>::new();
    assert_eq!(scene.seen_from(DVec3::INFINITY).unwrap_err().argument(), "point");
}
