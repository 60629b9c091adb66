//! The bias of optimal MIS against the number of samples.
//!
//! `cargo bench --bench optimal -- --write` measures the three fits from 10⁵ seeds and writes the
//! table to `src/estimator/bias.md`, which is part of the documentation of `OptimalMis`; without
//! `--write` it is printed. `-- --seeds 2000` is a quick look.

#![allow(clippy::unwrap_used)]
// Counts are far below 2^32.
#![allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap, clippy::cast_sign_loss)]

#[allow(dead_code)] // the tests use the rest
#[path = "../tests/optimal/cases.rs"]
mod cases;
#[allow(dead_code)]
#[path = "../tests/common/ensemble.rs"]
mod ensemble;
#[allow(dead_code)]
#[path = "../tests/optimal/ensembles.rs"]
mod ensembles;
#[allow(dead_code)]
#[path = "../tests/variances/example.rs"]
mod example;
#[allow(dead_code)]
#[path = "../tests/variances/examples.rs"]
mod examples;

use std::fmt::Write;
use std::time::Instant;

use cases::Case;
use ensembles::{FITS, Mean, ensemble};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let has = |name: &str| arguments.iter().any(|argument| argument == name);
    // `cargo bench` gives --bench; `cargo bench -- --test` and `cargo test --benches` want to know
    // whether it runs.
    let mut seeds = if has("--bench") && !has("--test") { 100_000 } else { 20 };
    if let Some(at) = arguments.iter().position(|argument| argument == "--seeds") {
        seeds = arguments[at + 1].parse().unwrap();
    }
    let began = Instant::now();
    let mut text = introduction(seeds);
    for case in [cases::example_a(), cases::indicator()] {
        table(&mut text, &case, seeds);
    }
    if has("--write") {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/estimator/bias.md");
        std::fs::write(path, text).unwrap();
        println!("written to {path}");
    } else {
        println!("{text}");
    }
    eprintln!("{:.0} s", began.elapsed().as_secs_f64());
}

fn introduction(seeds: u64) -> String {
    format!(
        "\
# Bias

Measured by `cargo bench --bench optimal -- --write` from {seeds} seeds for every line, with n samples
of each of two techniques: the bias with its standard error in brackets, in units of the last digits,
and n times the mean squared error. Where it says *balance*, there are too few samples for any
coefficients.

*A* is √x + sin x on \\[0.01, π/2\\], from pdfs like 2 - x and sin² x: the integral is 2.3118, and n
times the variance 0.1386 by the balance heuristic and 0.03075 by optimal MIS with exact coefficients.
The indicator, of x < 0.1 on \\[0, 1\\], is skewed: its pdfs are 1 and 2x, of which the second hardly
ever goes there.

Cross-fit and progressive estimates have no bias beyond 4.42 of its standard errors. That of the direct
fit falls like 1/n, and the standard error like 1/√n.
"
    )
}

fn table(text: &mut String, case: &Case, seeds: u64) {
    let head = "\n| integrand | n | direct | cross-fit | progressive | direct: n MSE | cross-fit | progressive |\n\
                |---|--:|--:|--:|--:|--:|--:|--:|\n";
    text.push_str(head);
    for n in (0..8).map(|k| 1 << k) {
        let (mut biases, mut errors) = (Vec::new(), Vec::new());
        for fit in FITS {
            let unbiased = fit != mis::Fit::Direct;
            let found = ensemble(case, Some(fit), n * case.techniques, seeds);
            let bias = Mean::of(found.iter().map(|found| found.value - case.integral));
            let error = Mean::of(found.iter().map(|f| (f.value - case.integral).powi(2)));
            assert!(!unbiased || bias.z(0.0).abs() < 4.42, "{}, {n}, {fit:?}: {bias:?}", case.name);
            // Every seed has the same.
            let none = found.iter().all(|found| found.uncontrolled == n * case.techniques);
            let note = if none { ", balance" } else { "" };
            biases.push(format!("{}{note}", with_error(bias)));
            errors.push(format!("{:.4}", n as f64 * error.mean));
        }
        let (biases, errors) = (biases.join(" | "), errors.join(" | "));
        writeln!(text, "| {} | {n} | {biases} | {errors} |", case.name).unwrap();
    }
}

/// `-0.01234(56)`.
fn with_error(Mean { mean, error }: Mean) -> String {
    let decimals = if error > 0.0 { (1.0 - error.log10()).ceil().max(1.0) as usize } else { 5 };
    format!("{mean:.decimals$}({:.0})", error * 10_f64.powi(decimals as i32))
}
