//! Every strategy has the same mean.

use super::{Strategy, strategies};
use crate::support::sphere_light;
use mis::lighting::{
    Camera, Combination, DVec3, Lambert, Light, LightChoice, ModifiedPhong, Picture, Rectangle,
    Scene, Sphere,
};

/// A glossy plate over a floor, both of two lobes, under two spheres and a rectangle. A ball and the
/// plate cast shadows; a light is below the horizon of a part of the plate.
fn scene() -> Scene<f64> {
    let floor = Rectangle::new(DVec3::ZERO, 2.0 * DVec3::X, 2.0 * DVec3::Y).unwrap();
    let corner = DVec3::new(-1.0, 0.2, 0.2);
    let plate =
        Rectangle::from_corner(corner, 2.0 * DVec3::X, DVec3::new(0.0, 0.6, 0.4)).unwrap();
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
            let (difference, own) = (pixel.value() - value, pixel.standard_error().unwrap());
            if difference == 0.0 { 0.0 } else { difference / own.hypot(*error) }
        });
        (strategy, z.collect())
    };
    strategies().into_iter().zip(1..).map(of).collect()
}

#[test]
fn means_agree() {
    let camera = camera(4, 3);
    let all = differences(&camera, 250, &REFERENCE);
    for (strategy, z) in all {
        let squares: f64 = z.iter().map(|z| z * z).sum();
        println!("{strategy:?}: {squares:.1} {z:.1?}");
    }
}

const REFERENCE: [(f64, f64); 12] = [(1.0, 1.0); 12];

#[test]
#[ignore = "seconds in an optimised build"]
fn means_agree_pixel_by_pixel() {
    let small = reference(&camera(4, 3), 2_000_000);
    for pixel in small.pixels() {
        println!("({:.7}, {:.1e}),", pixel.value(), pixel.standard_error().unwrap());
    }
    let camera = camera(12, 8);
    let reference = reference(&camera, 100_000);
    let values: Vec<_> =
        reference.pixels().iter().map(|p| (p.value(), p.standard_error().unwrap())).collect();
    let all = differences(&camera, 4096, &values);
    for (strategy, z) in all {
        let squares: f64 = z.iter().map(|z| z * z).sum();
        let worst = z.iter().fold(0.0_f64, |w, z| w.max(z.abs()));
        println!("{strategy:?}: {squares:.1} of {}, {worst:.2}", z.len());
    }
}
