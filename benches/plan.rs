//! What plans are worth: predicted against realised variance, the efficiency of what is recommended, and
//! the coverage of intervals.
//!
//! `cargo bench --bench plan` measures every problem of `tests/plan/problems.rs`, in some minutes on two
//! cores, and prints tables. `-- --write` writes them to `src/plan/measured.md`, which is part of the
//! documentation; `-- --seeds 100` is a quick look.

#![allow(clippy::unwrap_used)]

#[allow(dead_code)] // the tests use the rest
#[path = "../tests/plan/coverage.rs"]
mod coverage;
#[cfg(feature = "lighting")]
#[path = "../tests/plan/lit.rs"]
mod lit;
#[allow(dead_code)]
#[path = "../tests/plan/measure.rs"]
mod measure;
#[allow(dead_code)]
#[path = "../tests/plan/problems.rs"]
mod problems;
#[allow(dead_code)]
#[path = "../tests/plan/suite.rs"]
mod suite;

use std::fmt::Write;

use coverage::{HOWS, How, cover, covered};
use measure::{Known, measure, parallel};
use mis::plan::Planner;
use problems::{KINDS, Problem};
use suite::problems;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let has = |name: &str| arguments.iter().any(|argument| argument == name);
    let full = has("--bench") && !has("--test");
    let after = arguments.iter().skip_while(|argument| *argument != "--seeds").nth(1);
    let seeds = after.map_or(if full { 1000 } else { 4 }, |seeds| seeds.parse().unwrap());
    let text = text(seeds, if full { 1 << 17 } else { 1 << 10 });
    if has("--write") {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/plan/measured.md");
        std::fs::write(path, text).unwrap();
        println!("written to {path}");
    } else {
        println!("{text}");
    }
}

fn text(seeds: usize, samples: u64) -> String {
    let pilots = (seeds / 125).clamp(1, 8);
    let mut rows = String::new();
    let mut sums = Sums::default();
    for problem in &problems() {
        rows += &row(problem, pilots, samples, &mut sums);
        eprintln!("{}", problem.name);
    }
    let mut lines = String::new();
    for problem in &covered() {
        for how in HOWS {
            line(&mut lines, problem, how, seeds);
        }
        eprintln!("{}: coverage", problem.name);
    }
    format!(
        "\
# Measured

By `cargo bench --bench plan -- --write`, with version {version}.

## Predictions and recommendations

Plans from pilots of 4096 samples of each technique, {pilots} of them with each of four kinds of declared
costs: all parts the same, pdfs ten times as much as the rest, the integrand a thousand times, and
sampling from 1 to 100 over the techniques. Every row of the table of a plan, all methods with equal
and optimised shares, is compared with what is realised: the exact variance by quadrature for
techniques alone and constant weights on the line, otherwise that of {samples} samples through the plan's
estimator. *Flagged* is the share of the rows with a caution; *within 20 %* and *worst* are of the
others. *Recommended* is the true efficiency, 1 / (variance · cost), of the plan over that of the best
row of its table: the least, and the mean. A variance of rounding counts as equal to another.

| problem | K | rows | flagged | within 20 % | worst | recommended, least | mean |
|---|--:|--:|--:|--:|--:|--:|--:|
{rows}
All together: {all} rows, of which {flagged:.1} % are flagged and {within:.2} % of the others are within
20 %; {good:.1} % of {plans} plans have at least 0.9 of the best efficiency.

## Coverage

How often 95 % intervals hold the integral, from {seeds} seeds for every line, each with a pilot of its
own of 512 samples a technique. *Not suspect* is the share of the runs that are neither suspect nor
without signal; then come the shares of these, and of all, whose intervals hold. Adaptive runs have
8192 samples. One in **bold** is outside 0.94 to 0.96 by more than three standard deviations of its
noise; it says nothing where few runs are not suspect.

| integrand | what | not suspect | 95 % | all: 95 % | samples |
|---|---|--:|--:|--:|--:|
{lines}",
        version = env!("CARGO_PKG_VERSION"),
        all = sums.rows,
        flagged = 100.0 * sums.flagged as f64 / sums.rows as f64,
        within = 100.0 * sums.within as f64 / (sums.rows - sums.flagged) as f64,
        good = 100.0 * sums.good as f64 / sums.plans as f64,
        plans = sums.plans,
    )
}

#[derive(Default)]
struct Sums {
    rows: usize,
    flagged: usize,
    within: usize,
    plans: usize,
    good: usize,
}

fn row(problem: &Problem, pilots: usize, samples: u64, sums: &mut Sums) -> String {
    let known = Known::default();
    let (mut rows, mut flagged, mut within, mut worst) = (0, 0, 0, 0.0_f64);
    let (mut least, mut sum, mut plans) = (f64::INFINITY, 0.0, 0_u32);
    for kind in KINDS {
        let planner = Planner::new().samples(4096).unwrap();
        let all =
            parallel(pilots, |seed| measure(problem, &planner, kind, seed as u64, samples, &known));
        for measured in all {
            for row in &measured.rows {
                rows += 1;
                if row.prediction.caution.is_some() {
                    flagged += 1;
                    continue;
                }
                within += usize::from(measured.is_within(row, 0.2));
                worst = worst.max(measured.off(row));
            }
            let relative = measured.recommended();
            if !relative.is_nan() {
                (least, sum, plans) = (least.min(relative), sum + relative, plans + 1);
                sums.good += usize::from(relative >= 0.9);
            }
        }
    }
    sums.rows += rows;
    sums.flagged += flagged;
    sums.within += within;
    sums.plans += plans as usize;
    let sound = rows - flagged;
    let share = |part: usize, of: usize| {
        if of == 0 { "–".into() } else { format!("{:.3}", part as f64 / of as f64) }
    };
    let worst = if sound == 0 { "–".into() } else { format!("{:.0} %", 100.0 * worst) };
    let recommended = if plans == 0 {
        "– | –".into()
    } else {
        format!("{least:.2} | {:.3}", sum / f64::from(plans))
    };
    let (name, k) = (problem.name, problem.techniques);
    let (flags, within) = (share(flagged, rows), share(within, sound));
    format!("| {name} | {k} | {rows} | {flags} | {within} | {worst} | {recommended} |\n")
}

fn line(lines: &mut String, problem: &Problem, how: How, seeds: usize) {
    let what = match how {
        How::Tolerance(relative) => format!("plan, to {relative}"),
        How::Samples(samples) => format!("plan, {samples} samples"),
        How::Adaptive => "adaptive".into(),
        How::AdaptiveWithoutControls => "adaptive, without controls".into(),
    };
    let all = cover(problem, how, seeds);
    for (c, counted) in all.iter().enumerate() {
        let component = if all.len() > 1 { format!(", {c}") } else { String::new() };
        let of_sound = if counted.sound == 0 {
            "–".into()
        } else {
            format!("{:.3}", counted.of_sound as f64 / counted.sound as f64)
        };
        let of_sound =
            if counted.is_outside([0.94, 0.96]) { format!("**{of_sound}**") } else { of_sound };
        writeln!(
            lines,
            "| {}{component} | {what} | {:.3} | {of_sound} | {:.3} | {:.0} |",
            problem.name,
            counted.sound as f64 / counted.runs as f64,
            counted.of_all as f64 / counted.runs as f64,
            counted.samples as f64 / counted.runs as f64,
        )
        .unwrap();
    }
}
