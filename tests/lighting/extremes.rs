//! Lights from a speck to the whole sky, in grazing and degenerate positions, and radiances that
//! differ by 60 orders of magnitude.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use crate::common::canonical_numbers;
use crate::support::{
    alone, assert_close, assert_unbiased, by_quadrature, ceiling, direction, horizontal, over,
    polygon_irradiance, sphere_light, white,
};
use mis::lighting::{
    Bsdf, DVec3, Lambert, Light, ModifiedPhong, PhongLobe, Rectangle, ReflectedRadiance, Scene,
    Sphere,
};
use mis::{Estimator, Integrand, MultiSample, Technique};

/// Every sample, the corners of the unit square included, has a density and meets the rectangle.
fn assert_samples_hit(rectangle: &Rectangle, distances: [f64; 2]) {
    let p = rectangle.seen_from(DVec3::ZERO).unwrap();
    let mut xis = canonical_numbers(21, 1000);
    for u in [0.0, 1e-300, 0.5, 1.0] {
        xis.extend([u, 0.0, u, 1.0, u, 0.3]);
    }
    for xi in xis.chunks_exact(2) {
        let w = p.sample(xi);
        assert!((w.vector().length() - 1.0).abs() < 1e-15, "{w:?} at {xi:?}");
        assert_eq!(p.pdf(&w), 1.0 / p.solid_angle(), "{w:?} at {xi:?}");
        let t = p.hit(&w).unwrap();
        assert!(distances[0] <= t && t <= distances[1], "distance {t} at {xi:?}");
    }
}

#[test]
fn spheres_from_a_tenth_of_the_distance_to_a_speck() {
    let towards = DVec3::new(0.6, 0.0, 0.8);
    for exponent in 1..=12 {
        let s = 10.0_f64.powi(-exponent);
        let incident = alone(sphere_light(towards, s, 1.0));
        let radiance = by_quadrature(&incident, horizontal(), &white(), 4);
        assert_close(radiance, s * s * 0.8, 1e-14);
    }
}

#[test]
fn an_equal_power_light_of_radius_1e_8() {
    let r = 1e-8;
    for centre in [DVec3::new(0.0, 0.0, 2.0), DVec3::new(3.0, -2.0, 1.0)] {
        let incident = alone(sphere_light(centre, r, 1.0 / (r * r)));
        let irradiance = PI * by_quadrature(&incident, horizontal(), &white(), 4);
        let d2 = centre.length_squared();
        assert_close(irradiance, PI / d2 * centre.z / d2.sqrt(), 1e-14);
    }
}

#[test]
fn a_sphere_from_just_above_on_and_below_its_surface() {
    for d in [1.0 + 1e-12, 1.0, 1.0 - f64::EPSILON, 0.5, 0.0] {
        let scene = Scene::new().light(sphere_light(DVec3::new(0.0, 0.0, d), 1.0, 2.0));
        let incident = scene.seen_from(DVec3::ZERO).unwrap();
        let bsdf = white();
        let radiance = if d < 0.9 {
            // Half of the light is below the horizon; the lobe covers the other half.
            let f = ReflectedRadiance::new(&incident, horizontal(), &bsdf);
            let lobe = &bsdf.techniques(&horizontal())[0];
            over(lobe, 4, &|w| f.eval(w))
        } else {
            by_quadrature(&incident, horizontal(), &white(), 64)
        };
        assert_close(radiance, 2.0, 3e-12);
    }
}

#[test]
fn a_point_light_has_no_density() {
    let error = Sphere::new(DVec3::Z, 0.0).unwrap_err();
    assert_eq!(
        error.to_string(),
        "Sphere: `radius` is 0.0, but it must be finite and greater than 0"
    );
}

#[test]
fn narrow_and_wide_rectangles() {
    // 1e-8 wide: area × cosine / distance², each side.
    let (centre, half) = (DVec3::new(0.48, 0.36, 0.8), 0.5e-8);
    let speck = Rectangle::new(centre, half * DVec3::X, half * DVec3::Y).unwrap();
    assert_samples_hit(&speck, [0.999_999, 1.000_001]);
    let incident = alone(Light::new(speck, 1.0).unwrap());
    let irradiance = PI * by_quadrature(&incident, horizontal(), &white(), 4);
    assert_close(irradiance, 1e-16 * 0.8 * 0.8, 1e-14);

    // 1e12 wide: all of the sky but for 4 √2 × 1e-12 × 2.
    let sky = Rectangle::new(DVec3::Z, 0.5e12 * DVec3::X, 0.5e12 * DVec3::Y).unwrap();
    assert_samples_hit(&sky, [1.0, 1e12]);
    let p = sky.seen_from(DVec3::ZERO).unwrap();
    assert_close(p.solid_angle(), TAU - 8.0 * 2f64.sqrt() * 1e-12, 1e-15);
    let incident = alone(Light::new(sky, 1.0).unwrap());
    let bsdf = white();
    let f = ReflectedRadiance::new(&incident, horizontal(), &bsdf);
    let estimate = MultiSample::new(&[(&incident.lights()[0], 40_000)]).unwrap().estimate(&f, 1);
    assert_unbiased(&estimate.unwrap(), 1.0, 4e-3, "the sky");
}

#[test]
fn a_strip_of_1e12_to_1() {
    let strip = Rectangle::new(DVec3::Z, 0.5e12 * DVec3::X, 0.5 * DVec3::Y).unwrap();
    assert_samples_hit(&strip, [1.0, 1e12]);
    assert_close(strip.seen_from(DVec3::ZERO).unwrap().solid_angle(), 4.0 * 0.5f64.atan(), 1e-15);
    // Beside the point, and across.
    let centre = DVec3::new(1.5, 0.0, 1.0);
    let beside = Rectangle::new(centre, 0.5 * DVec3::X, 0.5e12 * DVec3::Y).unwrap();
    assert_samples_hit(&beside, [2f64.sqrt(), 1e12]);
    let exact = 2.0 * (2f64.atan() - 1f64.atan());
    assert_close(beside.seen_from(DVec3::ZERO).unwrap().solid_angle(), exact, 1e-15);
}

#[test]
fn tilted_rectangles_down_to_the_resolution_of_a_direction() {
    for k in 0..50 {
        let turn = f64::from(k);
        let z = direction(turn.sin(), turn.cos(), 0.3 - 0.05 * turn).vector();
        let (x, y) = z.any_orthonormal_pair();
        for (width, height) in [(1.0, 1.0), (1e-7, 1.0), (1e-13, 1.0), (0.25, 1e-12)] {
            let centre = height * z + 0.5 * x - 0.3 * y;
            let rectangle = Rectangle::new(centre, width * x, width * y).unwrap();
            let near = [(0.5 - width).max(0.0), (0.3 - width).max(0.0)];
            let far = [0.5 + width, 0.3 + width];
            let [near, far] = [near, far].map(|[a, b]| DVec3::new(a, b, height).length());
            assert_samples_hit(&rectangle, [near * (1.0 - 1e-15), far * (1.0 + 1e-15)]);
        }
    }
}

#[test]
fn edges_that_are_perpendicular_only_to_rounding() {
    // As given to twelve digits: all samples of the sheared rectangle are within it all the same.
    for shear in [1e-13, -9e-13] {
        for width in [1.0, 1e-9] {
            let centre = DVec3::new(0.3, 1.0, 1.0);
            let half_y = width * DVec3::new(shear, 1.0, 0.0);
            let rectangle = Rectangle::new(centre, width * DVec3::X, half_y).unwrap();
            assert_samples_hit(&rectangle, [0.9, 3.0]);
        }
    }
}

#[test]
fn lengths_100_orders_of_magnitude_apart() {
    // From the other end of the range of f64, the point is in the plane.
    let (x, y) = (1e120 * DVec3::X, 1e120 * DVec3::Y);
    assert!(Rectangle::new(1e-50 * DVec3::Z, x, y).unwrap().seen_from(DVec3::ZERO).is_err());
    let sky = Rectangle::new(1e30 * DVec3::Z, x, y).unwrap();
    assert_samples_hit(&sky, [1e30, 2e120]);
    assert_close(sky.seen_from(DVec3::ZERO).unwrap().solid_angle(), TAU, 1e-15);
    // A strip whose solid angle has a square below the range of f64.
    let strip = Rectangle::new(DVec3::Z, 0.5 * DVec3::X, 1e-200 * DVec3::Y).unwrap();
    assert_samples_hit(&strip, [1.0, 1.2]);
    // A solid angle of 4e-200, and one that no density can be of.
    for (half, seen) in [(1e-100, true), (1e-160, false)] {
        let speck = Rectangle::new(DVec3::Z, half * DVec3::X, half * DVec3::Y).unwrap();
        assert_eq!(speck.seen_from(DVec3::ZERO).is_ok(), seen);
        if seen {
            assert_samples_hit(&speck, [1.0, 1.0]);
        }
    }
}

#[test]
fn a_speck_is_not_seen_behind() {
    // As wide as the rounding of a direction.
    let speck = Rectangle::new(DVec3::Z, 1e-16 * DVec3::X, 1e-16 * DVec3::Y).unwrap();
    let p = speck.seen_from(DVec3::ZERO).unwrap();
    assert!(p.pdf(&direction(0.0, 0.0, 1.0)) > 0.0);
    assert_eq!(p.pdf(&direction(0.0, 0.0, -1.0)), 0.0);
}

#[test]
fn a_direction_at_the_horizon_meets_the_far_end() {
    let p = ceiling([1.0, 1e3], [-1.0, 1.0], 1e-14).seen_from(DVec3::ZERO).unwrap();
    for z in [0.0, -2e-16] {
        assert_close(p.hit(&direction(1.0, 0.0, z)).unwrap(), 1e3, 1e-6);
    }
}

#[test]
fn a_rectangle_1e_12_above_its_plane() {
    let exact = 1e-12 * (2.0 * 2f64.sqrt() - 5f64.sqrt());
    let (x, y) = ([1.0, 2.0], [-1.0, 1.0]);
    let grazing = ceiling(x, y, 1e-12);
    assert_close(grazing.seen_from(DVec3::ZERO).unwrap().solid_angle(), exact, 1e-15);
    assert_samples_hit(&grazing, [1.0, 6f64.sqrt()]);
    // Its samples are uniform within it: so many are in a sector.
    let p = grazing.seen_from(DVec3::ZERO).unwrap();
    let mut left = 0;
    for xi in canonical_numbers(22, 20_000).chunks_exact(2) {
        let w = p.sample(xi);
        left += u32::from(w.vector().y.abs() < 0.2 * w.vector().x);
    }
    // The solid angle of |y| < x/5 there is h ∫∫ r⁻³ = h (1 - 1/2) 2 / (5 √1.04).
    let share = 1e-12 * 0.2 / 1.04_f64.sqrt() / exact;
    let z = (f64::from(left) / 10_000.0 - share) / (share * (1.0 - share) / 10_000.0).sqrt();
    assert!(z.abs() < 5.0, "{left} for {share}");
}

#[test]
fn a_light_in_the_plane_of_the_point_gives_no_technique_and_no_light() {
    let light = Light::new(ceiling([1.0, 2.0], [-1.0, 1.0], 0.0), 1.0).unwrap();
    assert_eq!(light.seen_from(DVec3::ZERO).unwrap_err().argument(), "point");
    let incident = alone(light);
    assert!(incident.lights().is_empty());
    assert_eq!(incident.radiance(&direction(1.0, 0.0, 0.0)), 0.0);
    // So far below the resolution of a direction that it is in the plane all the same.
    assert!(ceiling([1.0, 2.0], [-1.0, 1.0], 1e-17).seen_from(DVec3::ZERO).is_err());
    // A tilted one, whose plane meets the point only up to rounding.
    let tilt = DVec3::new(0.0, 0.62276, -0.782_413);
    for k in 0..200 {
        let at = f64::from(k) / 200.0;
        let plate =
            Rectangle::from_corner(DVec3::new(-4.0, -2.7, 0.3), 8.0 * DVec3::X, tilt).unwrap();
        let point = DVec3::new(1.0 - at, -2.7, 0.3) + at * tilt;
        assert!(plate.seen_from(point).is_err(), "{at}");
    }
    assert!(Rectangle::new(DVec3::Z, DVec3::X, DVec3::new(1e-9, 1.0, 0.0)).is_err());
    assert!(Rectangle::new(DVec3::Z, DVec3::X, DVec3::ZERO).is_err());
}

#[test]
fn lights_below_the_horizon_contribute_nothing_and_count() {
    for light in [
        sphere_light(DVec3::new(0.0, 1.0, -3.0), 1.0, 1.0),
        Light::new(ceiling([-1.0, 1.0], [-1.0, 1.0], -0.5), 1.0).unwrap(),
    ] {
        let incident = alone(light);
        let bsdf = white();
        let f = ReflectedRadiance::new(&incident, horizontal(), &bsdf);
        let mis = MultiSample::new(&[(&incident.lights()[0], 500)]).unwrap();
        let estimate = mis.estimate(&f, 1).unwrap();
        assert_eq!((estimate.value(), estimate.zero(), estimate.samples()), (0.0, 500, 500));
        assert_eq!(estimate.standard_error(), None);
    }
}

#[test]
fn lights_that_straddle_the_horizon() {
    let n = 40_000;
    // A sphere whose centre is on the horizon: E = L (θ - sin θ cos θ).
    let theta = 0.4_f64;
    let sphere = sphere_light(DVec3::X, theta.sin(), 1.0);
    // An upright rectangle, of which the upper half counts.
    let upright = Rectangle::new(DVec3::X, DVec3::Y, DVec3::Z).unwrap();
    let upper = [(-1.0, 0.0), (1.0, 0.0), (1.0, 1.0), (-1.0, 1.0)];
    let upper = upper.map(|(y, z)| DVec3::new(1.0, y, z));
    let irradiance = polygon_irradiance(direction(0.0, 0.0, 1.0), &upper);
    for (light, irradiance) in [
        (sphere, theta - theta.sin() * theta.cos()),
        (Light::new(upright, 1.0).unwrap(), irradiance),
    ] {
        let incident = alone(light);
        let bsdf = white();
        let f = ReflectedRadiance::new(&incident, horizontal(), &bsdf);
        let lobe = &bsdf.techniques(&horizontal())[0];
        let light = &incident.lights()[0];
        let exact = FRAC_1_PI * irradiance;
        for (set, what) in [
            (vec![(light as _, n)], "light"),
            (vec![(lobe as _, 4 * n)], "BSDF"),
            (vec![(light as _, n), (lobe as _, n)], "both"),
        ] {
            let estimate = MultiSample::new(&set).unwrap().estimate(&f, 7).unwrap();
            assert_unbiased(&estimate, exact, 0.03, what);
            let zero = estimate.zero() as f64;
            assert!(zero > 0.4 * n as f64, "{what}: {zero} samples at 0 must count");
        }
    }
}

#[test]
fn a_highlight_that_underflows_gives_zero_and_no_nan() {
    // 0.3 rad beside a lobe of exponent 30000, cosⁿ is e^-1350.
    let bsdf = ModifiedPhong::new(1.0, 30_000.0).unwrap();
    let centre = DVec3::new(0.3_f64.sin(), 0.0, 0.3_f64.cos());
    let incident = alone(sphere_light(centre, 0.01, 1.0));
    let f = ReflectedRadiance::new(&incident, horizontal(), &bsdf);
    let lobe = &bsdf.techniques(&horizontal())[0];
    let light = &incident.lights()[0];
    let w = light.sample(&[1e-9, 0.0]);
    assert_eq!((bsdf.value(&horizontal(), &w), lobe.pdf(&w)), (0.0, 0.0));
    let w = direction(centre.x, 0.0, centre.z);
    let ln = (30_001.0 / TAU).ln() + 30_000.0 * 0.3_f64.cos().ln();
    assert_close(lobe.ln_pdf(&w), ln, 1e-14);
    let mis = MultiSample::new(&[(light, 1000), (lobe, 1000)]).unwrap();
    let estimate = mis.estimate(&f, 1).unwrap();
    assert_eq!((estimate.value(), estimate.zero()), (0.0, 2000));
    // The lobes alone: densities e^-1350 apart are compared through their logarithms.
    let other = PhongLobe::new(direction(centre.x, 0.0, centre.z), 30_000.0).unwrap();
    let lobes = MultiSample::new(&[(lobe, 1000), (&other, 1000)]).unwrap();
    let estimate = lobes.estimate(&|_: &_| 1.0, 1);
    assert!(estimate.unwrap().value() > 0.0);
}

#[test]
fn radiances_60_orders_of_magnitude_apart() {
    let bright = Sphere::new(DVec3::new(2.0, 0.0, 2.0), 0.5).unwrap();
    let faint = Sphere::new(DVec3::new(-2.0, 0.0, 2.0), 0.5).unwrap();
    let scene = Scene::new()
        .light(Light::new(bright, [1e30, 0.0]).unwrap())
        .light(Light::new(faint, [0.0, 1e-30]).unwrap());
    let incident = scene.seen_from(DVec3::ZERO).unwrap();
    let bsdf = Lambert::new([1.0; 2]).unwrap();
    let f = ReflectedRadiance::new(&incident, horizontal(), &bsdf);
    let lobe = &bsdf.techniques(&horizontal())[0];
    let [first, second] = incident.lights() else { panic!("two lights") };
    let mis = MultiSample::new(&[(first, 10_000), (second, 10_000), (lobe, 10_000)]).unwrap();
    let estimate = mis.estimate(&f, 3).unwrap();
    let exact = 0.25 / 8.0 * 0.5f64.sqrt();
    for (value, (error, scale)) in
        estimate.value().into_iter().zip(estimate.standard_error().into_iter().zip([1e30, 1e-30]))
    {
        let (value, error) = (value / scale, error.unwrap() / scale);
        assert!((value - exact).abs() < 5.0 * error && error < 0.01 * exact, "{value} ± {error}");
    }
}
