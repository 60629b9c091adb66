//! Every strategy has the same mean.

use super::{Strategy, error_of, strategies};
use crate::support::sphere_light;
use mis::lighting::{
    Camera, Combination, DVec3, Lambert, Light, LightChoice, ModifiedPhong, Picture, Rectangle,
    Scene, Sphere,
};
use mis::technique::{InverseCdf, Normal};

/// A glossy plate over a floor, both of two lobes, under two spheres and a rectangle. A ball and the
/// plate cast shadows; a light is below the horizon of a part of the plate.
fn scene() -> Scene<f64> {
    let floor = Rectangle::new(DVec3::ZERO, 2.0 * DVec3::X, 2.0 * DVec3::Y).unwrap();
    let corner = DVec3::new(-1.0, 0.2, 0.2);
    let plate = Rectangle::from_corner(corner, 2.0 * DVec3::X, DVec3::new(0.0, 0.6, 0.4)).unwrap();
    let ceiling = Rectangle::new(DVec3::new(-0.9, 0.2, 1.4), 0.3 * DVec3::Y, 0.4 * DVec3::X);
    let lobes = |diffuse, glossy, exponent| {
        (Lambert::new(diffuse).unwrap(), ModifiedPhong::new(glossy, exponent).unwrap())
    };
    Scene::new()
        .light(sphere_light(DVec3::new(0.5, 1.6, 1.3), 0.3, 4.0))
        .light(sphere_light(DVec3::new(1.2, 0.4, 0.9), 0.15, 9.0))
        .light(Light::one_sided(ceiling.unwrap(), 2.0).unwrap())
        .surface(floor, lobes(0.3, 0.5, 10.0))
        .surface(plate, lobes(0.2, 0.6, 40.0))
        .occluder(Sphere::new(DVec3::new(0.3, -0.2, 0.5), 0.15).unwrap())
}

fn camera(width: u32, height: u32) -> Camera {
    let (eye, target) = (DVec3::new(0.0, -3.0, 1.8), DVec3::new(0.0, 0.2, 0.25));
    Camera::new(eye, target, DVec3::Z, 0.2, width, height).unwrap()
}

/// The most precise strategy, with a seed of its own.
fn reference(camera: &Camera, rays: u64) -> Picture<f64> {
    let (combination, choice) = (Combination::Balance, LightChoice::Each);
    let strategy = Strategy { combination, choice, samples: [2, 2] };
    strategy.renderer(&scene(), camera, rays).threads(2).unwrap().render(1000).unwrap()
}

/// Every strategy's picture, and its differences from the reference in standard errors, pixel by pixel.
fn differences(camera: &Camera, rays: u64, reference: &[(f64, f64)]) -> Vec<(Strategy, Vec<f64>)> {
    let scene = scene();
    let of = |(strategy, seed): (Strategy, u64)| {
        let picture = strategy.renderer(&scene, camera, rays).render(seed).unwrap();
        // A pixel that is black is so for all.
        let z = picture.pixels().iter().zip(reference).map(|(pixel, (value, error))| {
            let (difference, own) = (pixel.value() - value, error_of(pixel));
            if difference == 0.0 { 0.0 } else { difference / own.hypot(*error) }
        });
        (strategy, z.collect())
    };
    strategies().into_iter().zip(1..).map(of).collect()
}

/// |z| beyond which one of `count` standard normal numbers is, by chance, in 1e-3 of cases.
fn bound(count: f64) -> f64 {
    -Normal::standard().inverse_cdf(0.5e-3 / count)
}

/// All differences are within the bound for their number, and so is the sum of the squares of each
/// strategy's, by Wilson and Hilferty's approximation of χ²: 2e-3 of false alarms in all.
fn assert_agree(all: &[(Strategy, Vec<f64>)]) {
    let strategies = all.len() as f64;
    for (strategy, z) in all {
        let n = z.len() as f64;
        let worst = z.iter().fold(0.0_f64, |worst, z| worst.max(z.abs()));
        assert!(worst < bound(n * strategies), "{strategy:?}: {z:.1?}");
        let squares: f64 = z.iter().map(|z| z * z).sum();
        let part = 2.0 / (9.0 * n);
        let allowed = n * (1.0 - part + bound(strategies) * part.sqrt()).powi(3);
        assert!(squares < allowed, "{strategy:?}: {squares} of {n}: {z:.1?}");
    }
}

/// Of the pixels of a small picture, from two million rays each.
const REFERENCE: [(f64, f64); 12] = [
    (0.275_425_3, 1.9e-4),
    (0.049_822_0, 3.2e-5),
    (0.027_875_4, 4.8e-6),
    (0.020_866_7, 1.3e-5),
    (0.312_526_0, 2.2e-4),
    (0.070_771_2, 4.3e-5),
    (0.050_662_6, 3.6e-5),
    (0.012_125_6, 2.9e-5),
    (0.054_262_5, 1.7e-5),
    (0.079_226_3, 2.4e-5),
    (0.111_189_4, 3.4e-5),
    (0.128_003_8, 3.8e-5),
];

#[test]
fn means_agree() {
    // 13 groups of rays tell the errors of optimal weights.
    let mut all = differences(&camera(4, 3), 13 * 19, &REFERENCE);
    // So few samples of the BSDF miss all light in some pixels.
    all.retain(|(strategy, _)| *strategy != Strategy::BSDF);
    assert_agree(&all);
}

#[test]
#[ignore = "half a minute in an optimised build"]
fn means_agree_pixel_by_pixel() {
    let camera = camera(12, 8);
    let reference = reference(&camera, 100_000);
    let reference: Vec<_> = reference.pixels().iter().map(|p| (p.value(), error_of(p))).collect();
    let mut all = differences(&camera, 61 * 67, &reference);
    // Where few rays in a thousand bring light, the error of so many is not known.
    let known = |k: usize| reference[k].1 <= 0.01 * reference[k].0;
    for (_, z) in &mut all {
        *z = z.iter().enumerate().filter(|(k, _)| known(*k)).map(|(_, z)| *z).collect();
        assert!(z.len() > 90, "{}", z.len());
    }
    assert_agree(&all);
}
