//! How a run speeds up with the number of threads.
//!
//! `cargo bench --bench threads` runs the slides' sin·cos, and an integrand that costs a
//! microsecond, on 1, 2, … threads in turn, and prints the fastest of several runs each, as samples
//! a second and as a ratio to one thread. The bits must be the same for all.

#![allow(clippy::unwrap_used, clippy::panic, missing_docs)]

use std::time::{Duration, Instant};

use mis::technique::{Cauchy, Uniform};
use mis::{Integrand, MultiSample, Run, Target, Technique};

fn main() {
    let quick = std::env::args().any(|a| a == "--test");
    let (samples, repeats) = if quick { (20_000, 1) } else { (4_000_000, 7) };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads: Vec<usize> =
        [1, 2, 4, 8, 16, 32].into_iter().filter(|threads| *threads <= cores.max(2)).collect();
    println!("{cores} cores; the fastest of {repeats} runs\n");

    let (flat, peak) = (Uniform::new(-1.0, 1.0).unwrap(), Cauchy::new(0.2, 0.01).unwrap());
    let techniques: [&dyn Technique<Point = f64>; 2] = [&flat, &peak];
    let f = |x: &f64| if x.abs() < 1.0 { 1.0 / ((x - 0.2).powi(2) + 1e-4) } else { 0.0 };
    measure("a peak and a plain", &techniques, &f, &threads, samples, repeats);
    let slow = |x: &f64| (1..60).map(|k| (f64::from(k) * x).cos() / f64::from(k * k)).sum::<f64>();
    let slow = |x: &f64| if x.abs() < 1.0 { slow(x) } else { 0.0 };
    measure("a sum of 59 cosines", &techniques, &slow, &threads, samples / 10, repeats);
}

fn measure(
    name: &str,
    techniques: &[&dyn Technique<Point = f64>; 2],
    f: &(impl Integrand<f64, Value = f64> + Sync),
    threads: &[usize],
    samples: u64,
    repeats: u32,
) {
    let mis = MultiSample::new(&techniques.map(|technique| (technique, 1))).unwrap();
    let target = Target::new().samples(samples).unwrap();
    let mut best = vec![Duration::MAX; threads.len()];
    let mut bits = None;
    for _ in 0..repeats {
        for (threads, best) in threads.iter().zip(&mut best) {
            let began = Instant::now();
            let report = Run::new(target).threads(*threads).unwrap().execute(&mis, f, 1).unwrap();
            *best = began.elapsed().min(*best);
            let value = report.value().to_bits();
            assert_eq!(*bits.get_or_insert(value), value, "{threads} threads: other bits");
        }
    }
    println!("{name}, {samples} samples");
    println!("threads   samples/s   speed-up");
    for (threads, time) in threads.iter().zip(&best) {
        let rate = samples as f64 / time.as_secs_f64();
        println!("{threads:>7}   {rate:9.3e}   {:8.2}", best[0].as_secs_f64() / time.as_secs_f64());
    }
    println!();
}
