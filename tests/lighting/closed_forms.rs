//! Closed forms of irradiance, lobe mass and white furnace.

use std::f64::consts::{FRAC_1_PI, TAU};

use crate::support::{
    alone, assert_close, assert_unbiased, by_quadrature, ceiling, corners, direction, horizontal,
    over, polygon_irradiance, sphere_light, white,
};
use mis::lighting::{
    Bsdf, DVec3, Direction, Lambert, Light, PhongLobe, ReflectedRadiance, Scene, Sphere, Surface,
};
use mis::{Estimator, MultiSample, Technique};

#[test]
fn sphere_irradiance_is_exact_for_wide_cones_too() {
    for s in [1e-3, 0.1, 0.5, 0.9, 0.999] {
        for z in [1.0, s + 0.5 * (1.0 - s), s] {
            let towards = DVec3::new((1.0_f64 - z * z).sqrt(), 0.0, z);
            let incident = alone(sphere_light(4.0 * towards, 4.0 * s, 3.0));
            let radiance = by_quadrature(&incident, horizontal(), &white(), 16);
            assert_close(radiance, 3.0 * s * s * z, 1e-13);
        }
    }
}

#[test]
fn rectangle_irradiance_is_lamberts_polygon_formula() {
    for (x, y, z) in [
        ([0.0, 1.0], [0.0, 1.0], 1.0),
        ([0.5, 3.0], [-4.0, -1.0], 0.3),
        ([1e-3, 2e-3], [5e-4, 7e-4], 1.0),
        ([2.0, 20.0], [0.1, 0.2], 5.0),
    ] {
        let incident = alone(Light::new(ceiling(x, y, z), 2.0).unwrap());
        for normal in [direction(0.0, 0.0, 1.0), direction(0.1, -0.05, 0.7)] {
            let surface = Surface::new(DVec3::ZERO, normal, normal).unwrap();
            let exact = 2.0 * polygon_irradiance(normal, &corners(x, y, z)) * FRAC_1_PI;
            // Corners given as low and high lose the width of a narrow rectangle to rounding.
            let rounding = 1e-15 * (x[1] / (x[1] - x[0])).max(y[1].abs() / (y[1] - y[0]));
            let radiance = by_quadrature(&incident, surface, &white(), 64);
            assert_close(radiance, exact, 1e-12 + rounding);
        }
    }
}

#[test]
fn every_strategy_finds_the_irradiance_of_two_lights() {
    let (x, y, z) = ([-2.0, 1.0], [0.5, 2.0], 1.5);
    let scene = Scene::new()
        .light(sphere_light(DVec3::new(2.0, -2.0, 3.0), 1.0, 5.0))
        .light(Light::new(ceiling(x, y, z), 0.7).unwrap());
    let surface = horizontal();
    let incident = scene.seen_from(surface.position()).unwrap();
    let bsdf = Lambert::new(0.4).unwrap();
    let f = ReflectedRadiance::new(&incident, surface, &bsdf);
    let irradiance = 5.0 * std::f64::consts::PI * 3.0 / 17.0_f64.powf(1.5)
        + 0.7 * polygon_irradiance(surface.normal(), &corners(x, y, z));
    let exact = 0.4 * FRAC_1_PI * irradiance;

    let lobes = bsdf.techniques(&surface);
    let [sphere, rectangle] = incident.lights() else { panic!("two lights") };
    let all = MultiSample::new(&[(sphere, 20_000), (rectangle, 20_000), (&lobes[0], 20_000)]);
    assert_unbiased(&all.unwrap().estimate(&f, 1).unwrap(), exact, 5e-3, "all");
    let bsdf_only = MultiSample::new(&[(&lobes[0], 60_000)]).unwrap();
    assert_unbiased(&bsdf_only.estimate(&f, 2).unwrap(), exact, 2e-2, "BSDF");
    let lights = MultiSample::new(&[(sphere, 30_000), (rectangle, 30_000)]).unwrap();
    assert_unbiased(&lights.estimate(&f, 3).unwrap(), exact, 2e-3, "lights");
}

/// Points of a rectangle, uniform in area; the pdf is per steradian all the same: d² / (A cos).
struct ByArea {
    x: [f64; 2],
    y: [f64; 2],
    z: f64,
}

impl Technique for ByArea {
    type Point = Direction;

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> Direction {
        let [x, y] = [(self.x, xi[0]), (self.y, xi[1])].map(|(e, u)| e[0] + u * (e[1] - e[0]));
        direction(x, y, self.z)
    }

    fn pdf(&self, w: &Direction) -> f64 {
        let at = w.vector() * (self.z / w.vector().z);
        let within = |e: [f64; 2], x: f64| e[0] <= x && x <= e[1];
        if !(w.vector().z > 0.0 && within(self.x, at.x) && within(self.y, at.y)) {
            return 0.0;
        }
        let area = (self.x[1] - self.x[0]) * (self.y[1] - self.y[0]);
        at.length_squared() / (area * w.vector().z)
    }
}

#[test]
fn samples_by_area_and_by_solid_angle_combine_in_one_measure() {
    let by_area = ByArea { x: [0.5, 2.0], y: [0.2, 1.2], z: 0.6 };
    let incident = alone(Light::new(ceiling(by_area.x, by_area.y, by_area.z), 1.0).unwrap());
    let by_angle = &incident.lights()[0];
    assert_close(over(by_angle, 32, &|w| by_area.pdf(w)), 1.0, 1e-9);
    assert_close(over(&by_area, 32, &|w| by_angle.pdf(w)), 1.0, 1e-9);
    let bsdf = white();
    let f = ReflectedRadiance::new(&incident, horizontal(), &bsdf);
    let corners = corners(by_area.x, by_area.y, by_area.z);
    let exact = FRAC_1_PI * polygon_irradiance(horizontal().normal(), &corners);
    let mis = MultiSample::new(&[(by_angle, 20_000), (&by_area, 20_000)]).unwrap();
    assert_unbiased(&mis.estimate(&f, 8).unwrap(), exact, 5e-3, "both");
}

#[test]
fn phong_lobe_mass_within_a_cone() {
    let axis = direction(0.3, 0.2, 0.9);
    let lobe = PhongLobe::new(axis, 30_000.0).unwrap();
    let width = 2.0 * 0.5e-3_f64.sin().powi(2);
    let exact = -(30_001.0 * (-width).ln_1p()).exp_m1();
    assert_close(exact, 0.014_888_555_415_645_4, 1e-13);
    // A unit sphere that fills the cone, as the domain of the quadrature.
    let distance = 1.0 / 1e-3_f64.sin();
    let cone = Sphere::new(distance * axis.vector(), 1.0).unwrap().seen_from(DVec3::ZERO).unwrap();
    assert_close(over(&cone, 8, &|w| lobe.pdf(w)), exact, 1e-12);
    let within = MultiSample::new(&[(&lobe, 200_000)]).unwrap();
    let estimate = within.estimate(&|w: &_| lobe.pdf(w) * cone.pdf(w) * cone.solid_angle(), 4);
    assert_unbiased(&estimate.unwrap(), exact, 0.02, "mass");
}

#[test]
fn a_white_furnace_reflects_the_albedo_exactly() {
    let albedo = [0.25, 0.5, 0.8];
    let light = Light::new(Sphere::new(DVec3::new(1.0, 2.0, -3.0), 10.0).unwrap(), [1.0; 3]);
    let scene = Scene::new().light(light.unwrap());
    let normal = direction(-0.3, 0.4, 0.2);
    let surface = Surface::new(DVec3::new(0.5, 0.0, 1.0), normal, normal).unwrap();
    let incident = scene.seen_from(surface.position()).unwrap();
    let bsdf = Lambert::new(albedo).unwrap();
    let f = ReflectedRadiance::new(&incident, surface, &bsdf);
    let lobes = bsdf.techniques(&surface);
    let estimate = MultiSample::new(&[(&lobes[0], 10_000)]).unwrap().estimate(&f, 5).unwrap();
    for (value, (error, rho)) in
        estimate.value().into_iter().zip(estimate.standard_error().into_iter().zip(albedo))
    {
        assert_close(value, rho, 4.0 * f64::EPSILON);
        assert!(error.unwrap() <= 1e-17, "{error:?}");
    }
    // And through the light, which is everywhere.
    let light = &incident.lights()[0];
    assert_close(light.directions().value(), 2.0 * TAU, 1e-15);
    let both = MultiSample::new(&[(light, 20_000), (&lobes[0], 20_000)]).unwrap();
    let both = both.estimate(&f, 6).unwrap();
    for (c, rho) in albedo.into_iter().enumerate() {
        let error = both.standard_error()[c].unwrap();
        assert!((both.value()[c] - rho).abs() < 5.0 * error && error < 0.01 * rho);
    }
}
