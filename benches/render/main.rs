//! How fast the renderer is, against a loop that is written for one scene.
//!
//! `cargo bench --bench render` prints samples a second, the fastest of many short pictures each, which
//! are made in turn: with one camera ray for each pixel and 16 samples of the lights and of the BSDF
//! each, and with 16 rays and one of each. `by_hand` is the loop. A larger picture shows what a second
//! thread gives.

#![allow(clippy::unwrap_used, missing_docs)]

mod by_hand;
mod scene;

use std::time::Instant;

use mis::lighting::{Camera, Renderer, Scene};
use scene::{camera, scene};

/// A picture of a few milliseconds: one of many will not be disturbed.
const SMALL: u32 = 96;
const LARGE: u32 = 384;
/// Samples of the lights, and of the BSDF, for each pixel.
const EACH: u64 = 16;

fn main() {
    // `cargo bench -- --test` wants to know whether it runs.
    let quick = std::env::args().any(|argument| argument == "--test");
    let (many, few) = if quick { (1, 1) } else { (200, 9) };
    let scene = scene();
    let camera = camera(SMALL);
    for (name, rays, each) in [("a ray for each pixel", 1, EACH), ("16 rays", EACH, 1)] {
        println!("\n{name}, {each} samples of the lights and {each} of the BSDF for each");
        let renderer = |seed| render(&scene, &camera, rays, each, 1, seed);
        let by_hand = |seed| by_hand::render(SMALL, rays, each, seed);
        compare(SMALL, many, &[("by hand", &by_hand), ("renderer", &renderer)]);
    }
    println!("\nthreads");
    let camera = self::camera(LARGE);
    let on = |threads| {
        let (scene, camera) = (&scene, &camera);
        move |seed| render(scene, camera, 1, EACH, threads, seed)
    };
    compare(LARGE, few, &[("1", &on(1)), ("2", &on(2))]);
}

/// The mean radiance of a picture.
fn render(
    scene: &Scene<f64>,
    camera: &Camera,
    rays: u64,
    each: u64,
    threads: usize,
    seed: u64,
) -> f64 {
    let renderer = Renderer::new(scene, camera).rays(rays).unwrap();
    let renderer = renderer.samples(each, each).unwrap().threads(threads).unwrap();
    renderer.render(seed).unwrap().mean()
}

/// Prints the rates of some ways to render a picture, over that of the first.
fn compare(size: u32, runs: u64, rows: &[(&str, &dyn Fn(u64) -> f64)]) {
    let mut results = vec![(f64::INFINITY, 0.0); rows.len()];
    // In turn, so that whatever else the machine does hits all.
    for seed in 0..runs {
        for ((_, render), (best, mean)) in rows.iter().zip(&mut results) {
            let began = Instant::now();
            *mean += render(seed) / runs as f64;
            *best = best.min(began.elapsed().as_secs_f64());
        }
    }
    let samples = f64::from(size * size) * 2.0 * EACH as f64;
    println!("{:<10} {:>10} {:>10} {:>8}", "", "M/s", "mean", "ratio");
    for ((name, _), (best, mean)) in rows.iter().zip(&results) {
        let (rate, ratio) = (samples / best / 1e6, results[0].0 / best);
        println!("{name:<10} {rate:>10.2} {mean:>10.5} {ratio:>8.2}");
    }
}
