//! How time and memory grow with samples, techniques and dimensions.
//!
//! `cargo bench --bench scale` takes a minute and prints three tables; `-- --write` writes them to
//! `src/scale.md`, which is part of the documentation.

#![allow(clippy::unwrap_used, missing_docs)]

use std::fmt::Write;
use std::time::Instant;

use mis::points::{PointSource, Random, Sobol};
use mis::technique::{Linear, ProductVec, Uniform};
use mis::{Estimator, MultiSample, Run, Target, Technique};

/// The fastest of so many.
const RUNS: usize = 5;

fn main() {
    let has = |name: &str| std::env::args().any(|argument| argument == name);
    // `cargo bench -- --test` wants to know whether it runs.
    let quick = has("--test") || !has("--bench");
    let text = format!("{}\n{}\n{}", samples(quick), techniques(quick), dimensions(quick));
    println!("{text}");
    if has("--write") {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/scale.md");
        std::fs::write(path, format!("# Scale\n\nMeasured by `cargo bench --bench scale -- --write`, one thread, x86-64, the fastest of {RUNS}.\n\n{text}")).unwrap();
        println!("written to {path}");
    }
}

fn seconds(mut work: impl FnMut()) -> f64 {
    let time = |_| {
        let began = Instant::now();
        work();
        began.elapsed().as_secs_f64()
    };
    (0..RUNS).map(time).fold(f64::INFINITY, f64::min)
}

/// A run of n samples: its time, and the most memory that it holds at once.
fn samples(quick: bool) -> String {
    let (flat, ramp) = (Uniform::unit(), Linear::new(0.0, 1.0, 1.0, 3.0).unwrap());
    let mis = MultiSample::new(&[(&flat, 1), (&ramp, 1)]).unwrap();
    let f = |x: &f64| x * x + 1.0;
    let run = |n: u64, points: &dyn PointSource| {
        let run = Run::new(Target::new().samples(n).unwrap()).threads(1).unwrap();
        drop(run.execute_from(&mis, &f, points).unwrap());
    };
    let mut text = String::from(
        "A run with two techniques and a cheap integrand. Its memory grows by a node of the merge \
         tree for twice the samples. The last lines are extrapolated from the one before.\n\n\
         | samples | random: ns per sample | peak kB | Sobol': ns per sample | peak kB |\n\
         |--:|--:|--:|--:|--:|\n",
    );
    let largest = if quick { 4 } else { 8 };
    let mut last = [0.0; 2];
    for power in 4..=10 {
        let n = 10_u64.pow(power);
        let sources: [&dyn PointSource; 2] = [&Random::new(1), &Sobol::new(1)];
        write!(text, "| 10^{power} |").unwrap();
        for (points, last) in sources.into_iter().zip(&mut last) {
            if power > largest {
                write!(text, " ({:.0} s in all) | |", *last * 1e-9 * n as f64).unwrap();
                continue;
            }
            let memory = allocation_counter::measure(|| run(n, points)).bytes_max;
            *last = seconds(|| run(n, points)) / n as f64 * 1e9;
            write!(text, " {last:.1} | {:.0} |", memory as f64 / 1e3).unwrap();
        }
        text.push('\n');
    }
    text
}

/// An estimate from 2^18 samples of K ramps, every density at every sample.
fn techniques(quick: bool) -> String {
    let mut text = String::from(
        "Balance heuristic with K techniques: every density is evaluated at every sample.\n\n\
         | K | ns per sample | ns per sample and density |\n|--:|--:|--:|\n",
    );
    let n = if quick { 1 << 10 } else { 1 << 18 };
    for k in [1_u32, 2, 4, 8, 16, 32, 64] {
        let ramps: Vec<Linear> =
            (0..k).map(|k| Linear::new(0.0, 1.0, 1.0, 1.5 + f64::from(k)).unwrap()).collect();
        let list: Vec<(&dyn Technique<Point = f64>, u64)> =
            ramps.iter().map(|ramp| (ramp as _, n / u64::from(k))).collect();
        let mis = MultiSample::new(&list).unwrap();
        let time = seconds(|| drop(mis.estimate(&|x: &f64| x * x, 1).unwrap()));
        let each = time / n as f64 * 1e9;
        writeln!(text, "| {k} | {each:.1} | {:.2} |", each / f64::from(k)).unwrap();
    }
    text
}

/// An estimate over the unit cube in d dimensions.
fn dimensions(quick: bool) -> String {
    let mut text = String::from(
        "The sum of squares over the unit cube in d dimensions.\n\n\
         | d | random: ns per coordinate | Sobol': ns per coordinate |\n|--:|--:|--:|\n",
    );
    let coordinates = if quick { 1 << 15 } else { 1 << 22 };
    for d in [1_usize, 2, 5, 10, 100, 1000] {
        let cube = ProductVec::new(vec![Uniform::unit(); d]).unwrap();
        let n = (coordinates / d as u64).max(16);
        let mis = MultiSample::new(&[(&cube, n)]).unwrap();
        let f = |x: &Vec<f64>| x.iter().map(|x| x * x).sum::<f64>();
        let sources: [&dyn PointSource; 2] = [&Random::new(1), &Sobol::new(1)];
        let times = sources.map(|points| {
            seconds(|| drop(mis.estimate_from(&f, points).unwrap())) / (n * d as u64) as f64 * 1e9
        });
        writeln!(text, "| {d} | {:.2} | {:.2} |", times[0], times[1]).unwrap();
    }
    text
}
