//! How fast the renderer is, against a loop that is written for one scene.
//!
//! `cargo bench --bench render` renders a floor under two lights with one camera ray for each pixel and
//! 16 samples of the lights and of the BSDF each, on one thread and on two, and prints samples a second
//! and their ratio to the loop of `by_hand`, the fastest of several runs each. `-- hand` or
//! `-- renderer` runs that alone, once.

#![allow(clippy::unwrap_used, missing_docs)]

mod by_hand;

use std::time::Instant;

use mis::lighting::{Camera, DVec3, GgxConductor, Light, Rectangle, Renderer, Scene, Sphere};

const SIZE: u32 = 96;
/// Samples of the lights, and of the BSDF, for each pixel.
const EACH: u64 = 16;

fn main() {
    let has = |name: &str| std::env::args().any(|argument| argument == name);
    let scene = scene();
    let camera = Camera::new(
        DVec3::new(0.0, -3.2, 1.6),
        DVec3::new(0.0, 0.3, 0.0),
        DVec3::Z,
        40_f64.to_radians(),
        SIZE,
        SIZE,
    )
    .unwrap();
    let with = |threads: usize| {
        let renderer = Renderer::new(&scene, &camera).rays(1).unwrap();
        let renderer = renderer.samples(EACH, EACH).unwrap().threads(threads).unwrap();
        move |seed| renderer.render(seed).unwrap().mean()
    };
    let (one, two) = (with(1), with(2));
    // A ray of its own for each pair of samples.
    let rays = |seed| {
        let renderer = Renderer::new(&scene, &camera).rays(EACH).unwrap().threads(1).unwrap();
        renderer.render(seed).unwrap().mean()
    };
    let loop_by_hand = |seed| by_hand::render(SIZE, EACH, seed);
    if has("hand") || has("renderer") {
        let mean = match () {
            () if has("hand") => loop_by_hand(1),
            () if has("rays") => rays(1),
            () => one(1),
        };
        println!("mean {mean:.5}");
        return;
    }
    // `cargo bench -- --test` wants to know whether it runs.
    let runs = if has("--test") { 1 } else { 200 };

    let rows: [(&str, &dyn Fn(u64) -> f64); 3] =
        [("by hand", &loop_by_hand), ("renderer", &one), ("renderer, 2 threads", &two)];
    let mut best = [f64::INFINITY; 3];
    let mut means = [0.0; 3];
    // In turn, so that whatever else the machine does hits all.
    for seed in 0..runs {
        for (((_, render), best), mean) in rows.iter().zip(&mut best).zip(&mut means) {
            let began = Instant::now();
            *mean += render(seed) / runs as f64;
            *best = best.min(began.elapsed().as_secs_f64());
        }
    }
    let samples = f64::from(SIZE * SIZE) * 2.0 * EACH as f64;
    let [hand, ..] = best;
    println!("{samples:.0} samples, the fastest of {runs}");
    println!("{:<20} {:>10} {:>10} {:>12}", "", "M/s", "mean", "to by hand");
    for (((name, _), best), mean) in rows.iter().zip(best).zip(means) {
        println!("{name:<20} {:>10.2} {mean:>10.5} {:>12.2}", samples / best / 1e6, hand / best);
    }
}

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
