//! How often the intervals of runs hold the integral, and what the runs say of themselves.
//!
//! `cargo bench --bench coverage` measures every integrand and estimator of `tests/coverage/suite.rs`
//! from 10⁴ seeds, in about ten minutes on two cores, and prints a table. `-- --write` writes it to
//! `src/run/coverage.md`, which is part of the documentation; `-- --seeds 200` is a quick look;
//! further words choose integrands by a part of their names.

#![allow(clippy::unwrap_used)]

#[path = "../tests/coverage/measure.rs"]
mod measure;
#[allow(dead_code)] // the tests use the rest
#[path = "../tests/coverage/suite.rs"]
mod suite;

use std::fmt::Write;
use std::time::Instant;

use measure::{BAND, Cell, LIMIT, NOISE, Share, fixed, to_tolerance, tolerance};
use suite::{Row, Verdict, suite};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let has = |name: &str| arguments.iter().any(|argument| argument == name);
    // `cargo bench` gives --bench; `cargo bench -- --test` and `cargo test --benches` want to know
    // whether it runs.
    let mut seeds = if has("--bench") && !has("--test") { 10_000 } else { 4 };
    let mut names = Vec::new();
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        match argument.as_str() {
            "--seeds" => seeds = rest.next().unwrap().parse().unwrap(),
            name if !name.starts_with("--") => names.push(name),
            _ => {}
        }
    }
    let began = Instant::now();
    let mut rows = suite();
    rows.retain(|row| names.is_empty() || names.iter().any(|name| row.integrand.contains(name)));
    let table = table(&rows, seeds);
    if has("--write") {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/run/coverage.md");
        std::fs::write(path, table).unwrap();
        println!("written to {path}");
    } else {
        println!("{table}");
    }
    eprintln!("{:.0} s", began.elapsed().as_secs_f64());
}

fn table(rows: &[Row], seeds: u64) -> String {
    let mut budgets = String::new();
    let mut tolerances = String::new();
    for row in rows {
        let began = Instant::now();
        let budget = |n: u64| n <= 10_000 || row.slow;
        for n in [1000, 10_000, 100_000].into_iter().filter(|n| budget(*n)) {
            budget_lines(&mut budgets, row, n, &fixed(row, n, seeds));
        }
        let tolerance = tolerance(row);
        tolerance_lines(&mut tolerances, row, tolerance, &to_tolerance(row, tolerance, seeds));
        let seconds = began.elapsed().as_secs_f64();
        eprintln!("{}, {}: {seconds:.1} s", row.integrand, row.estimator);
    }
    format!(
        "{}\n{BUDGET_HEAD}{budgets}\n{}\n{TOLERANCE_HEAD}{tolerances}",
        introduction(seeds),
        tolerance_text()
    )
}

const BUDGET_HEAD: &str = "\
    | integrand | estimator | samples | not suspect | 68.27 % | 95 % | 99 % | all: 68.27 % | 95 % | 99 % | silent |\n\
    |---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n";

const TOLERANCE_HEAD: &str = "\
    | integrand | estimator | tolerance | converged | budget spent | suspect | no signal | within, converged | within, not suspect | 95 %, converged | samples |\n\
    |---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n";

fn introduction(seeds: u64) -> String {
    let [lower, upper] = BAND;
    format!(
        "\
# Coverage

How often intervals hold the integral, measured by `cargo bench --bench coverage -- --write` from
{seeds} seeds for every line, with the judgement of version {version} as it is described above. Shares
are of 1. One in **bold** is beyond what it should be by more than {NOISE} standard deviations of its
own noise: for 95 % intervals, outside {lower} to {upper}.

Fixed budgets: *not suspect* is the share of the runs whose status is \"budget spent\"; next come the
shares of these whose intervals at three levels hold the integral, then the shares of all runs, the
suspect ones included (a run without signal has no interval, and counts as a miss). *Silent* is the
share of all runs that are not suspect and whose 95 % interval misses: all that a user would be
misled by, 0.05 at best where no run is suspect.

In lines with †, fewer than 95 % of the runs pass the judgement, and the figures of those that do are
selected by it: the skewness of the samples, which it goes by, is large together with the error.
Where few runs pass, those are the ones that saw too little of the tail, and are low. Such figures
say nothing about the intervals; those of all runs, and *silent*, do.

*Sobol' points* are of the balance heuristic or the only technique, in 16 replicates, from which the
intervals come. Where contributions have a tail, the end of it stays random, and such intervals are a
little too narrow.

*x and a hidden spike* is what no judgement can see: more than half of the variance lies on a
thousandth of the interval, and one run of 1000 samples in three has none there. To a tolerance, few
runs converge before they have met it.
",
        version = env!("CARGO_PKG_VERSION"),
    )
}

fn tolerance_text() -> String {
    format!(
        "\
Runs to a relative tolerance at 95 %, of at most {LIMIT} samples. The tolerance is one that about
4096 samples reach, and as many again confirm. *Within* is the share of the runs whose error is within
the tolerance: of those that converged, which must be at least 0.95, and of all that are not suspect.
Then come the share of the 95 % intervals of converged runs that hold the integral, and the mean
number of samples.
"
    )
}

fn budget_lines(text: &mut String, row: &Row, samples: u64, cell: &Cell) {
    for (k, counted) in cell.components.iter().enumerate() {
        let sound = cell.sound();
        let dagger = if sound.value() < 0.95 { " †" } else { "" };
        let figures = |shares: [Share; 3]| shares.map(share).join(" | ");
        let in_band = |shares: [Share; 3]| {
            let mut texts = shares.map(share);
            if shares[1].is_outside(BAND) {
                texts[1] = format!("**{}**", texts[1]);
            }
            texts.join(" | ")
        };
        let judged =
            if dagger.is_empty() { in_band(counted.sound) } else { figures(counted.sound) };
        let mut silent = share(counted.silent);
        if counted.silent.is_above(1.0 - BAND[0]) {
            silent = format!("**{silent}**");
        }
        writeln!(
            text,
            "| {} | {} | {samples} | {}{dagger} | {judged} | {} | {silent} |",
            name(row, k),
            row.estimator,
            share(sound),
            in_band(counted.all),
        )
        .unwrap();
    }
}

fn tolerance_lines(text: &mut String, row: &Row, tolerance: f64, cell: &Cell) {
    for (k, counted) in cell.components.iter().enumerate() {
        let bold = |within: Share| {
            if within.is_below(0.95) { format!("**{}**", share(within)) } else { share(within) }
        };
        let mut covered = share(counted.converged[1]);
        if counted.converged[1].is_outside(BAND) {
            covered = format!("**{covered}**");
        }
        let verdicts = [Verdict::Converged, Verdict::Spent, Verdict::Suspect, Verdict::NoSignal];
        writeln!(
            text,
            "| {} | {} | {tolerance} | {} | {} | {} | {covered} | {:.0} |",
            name(row, k),
            row.estimator,
            verdicts.map(|verdict| share(cell.verdict(verdict))).join(" | "),
            bold(counted.within_of_converged),
            bold(counted.within_of_sound),
            cell.samples as f64 / cell.runs as f64,
        )
        .unwrap();
    }
}

fn name(row: &Row, component: usize) -> String {
    match row.components[component].0 {
        "" => row.integrand.into(),
        part => format!("{}: {part}", row.integrand),
    }
}

fn share(share: Share) -> String {
    if share.of == 0 { "–".into() } else { format!("{:.3}", share.value()) }
}
