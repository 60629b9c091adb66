//! Pixels of a small scene, against quadrature and an independent renderer.

use super::{Strategy, only, strategies};
use mis::lighting::{
    Camera, Combination, DVec3, GgxConductor, Light, LightChoice, Rectangle, Scene, Sphere,
};

/// Column and row, the value by quadrature, and Mitsuba 3.9.1's with its standard error.
const PIXELS: [(u32, u32, f64, f64, f64); 10] = [
    (195, 173, 2.375_750_230_898_3, 2.375_870_4, 3.3e-4),
    (191, 159, 2.095_655_176_5, 2.095_383_8, 3.5e-4),
    (216, 173, 0.959_383_106_791_08, 0.959_208_87, 2.3e-4),
    (183, 135, 0.278_337_166_881_48, 0.278_412_68, 7.6e-5),
    (64, 203, 1.800_077_828_942, 1.800_059_9, 3.3e-4),
    (96, 190, 1.102_811_358_818_7, 1.102_687_3, 2.8e-4),
    (55, 235, 0.332_012_806_737_81, 0.332_010_17, 7.1e-5),
    (128, 181, 0.063_897_317_258_776, 0.063_897_975, 1.5e-5),
    (128, 216, 0.060_297_482_295_293, 0.060_289_944, 1.2e-5),
    (34, 149, 0.255_583_257_295_25, 0.255_624_48, 6.8e-5),
];

/// A floor of microfacets, under a sphere and a rectangle that emits downwards.
fn scene() -> Scene<f64> {
    let sphere = Sphere::new(DVec3::new(0.9, 0.8, 0.9), 0.25).unwrap();
    let (half_x, half_y) = (-0.35 * DVec3::X, 0.25 * DVec3::Y);
    let ceiling = Rectangle::new(DVec3::new(-0.8, 0.7, 1.1), half_x, half_y).unwrap();
    let floor = Rectangle::new(DVec3::ZERO, 2.0 * DVec3::X, 2.0 * DVec3::Y).unwrap();
    Scene::new()
        .light(Light::new(sphere, 5.0).unwrap())
        .light(Light::one_sided(ceiling, 8.0).unwrap())
        .surface(floor, GgxConductor::new(1.0, 0.1).unwrap())
}

fn camera() -> Camera {
    let (eye, target) = (DVec3::new(0.0, -3.2, 1.6), DVec3::new(0.0, 0.3, 0.0));
    Camera::new(eye, target, DVec3::Z, 40_f64.to_radians(), 256, 256).unwrap()
}

/// The differences to quadrature and to Mitsuba, in standard errors, of each pixel; and the largest
/// standard error, over the value.
fn compare(strategy: &Strategy, rays: u64, seed: u64) -> (Vec<[f64; 2]>, f64) {
    let (scene, camera) = (scene(), camera());
    let mut largest = 0.0_f64;
    let differences = PIXELS.map(|(column, row, exact, rendered, its_error)| {
        let renderer = strategy.renderer(&scene, &camera, rays);
        let renderer = renderer.window(column..column + 1, row..row + 1).unwrap();
        let (value, error) = only(&renderer.render(seed).unwrap());
        largest = largest.max(error / exact);
        [(value - exact) / error, (value - rendered) / error.hypot(its_error)]
    });
    (differences.to_vec(), largest)
}

#[test]
fn every_strategy_agrees_with_quadrature_and_with_an_independent_renderer() {
    for (strategy, seed) in strategies().iter().zip(1..) {
        let (differences, largest) = compare(strategy, 256, seed);
        for (z, (column, row, ..)) in differences.iter().zip(PIXELS) {
            let worst = z[0].abs().max(z[1].abs());
            assert!(worst < 5.0, "{strategy:?}: {column}, {row}: {z:?}");
        }
        let allowed = match strategy {
            Strategy { samples: [0, _], .. } => 0.8,
            Strategy { combination: Combination::Constant, .. } => 0.5,
            _ => 0.16,
        };
        assert!(largest < allowed, "{strategy:?}: {largest}");
    }
}

#[test]
#[ignore = "half a minute in an optimised build"]
fn pixels_agree_to_a_part_in_a_thousand() {
    for combination in [Combination::Balance, Combination::Power, Combination::Optimal] {
        let strategy = Strategy { combination, choice: LightChoice::Each, samples: [4, 4] };
        let began = std::time::Instant::now();
        let (differences, largest) = compare(&strategy, 600_000, 1);
        let seconds = began.elapsed().as_secs_f64() / PIXELS.len() as f64;
        println!("{combination:?}: {largest:.1e} of the value, {seconds:.2} s a pixel");
        println!("{differences:.2?}");
        assert!(largest < 1e-3, "{combination:?}: {largest}");
        let agrees = differences.iter().flatten().all(|z| z.abs() < 3.0);
        assert!(agrees, "{combination:?}: {differences:?}");
    }
}
