//! Instructions per sample, under valgrind, which must be installed: they repeat, as seconds do not.
//!
//! `cargo bench --bench instructions` counts every variant at two sizes; the difference leaves out
//! what starting costs. It fails if a ratio is beyond what is stated for it, or a count is more than
//! 2 % above the one in `counts.txt`; the latter only with the compiler and C library of that file, as
//! others have other code. `-- --write` writes the file.
//!
//! The loops by hand are compiled for the target, as a user's are; the library has loops for AVX2 as
//! well, which it uses where the processor, or valgrind's, has it.

#![allow(clippy::unwrap_used, clippy::panic, missing_docs)]

mod by_hand;
mod library;
#[path = "../render/scene.rs"]
mod scene;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::hint::black_box;
use std::process::Command;

/// Its name, what it does with a size, and two sizes.
type Variant = (&'static str, fn(u64) -> f64, [u64; 2]);

const SAMPLES: [u64; 2] = [20_000, 60_000];
const MANY: [u64; 2] = [20_480, 204_800];

const VARIANTS: &[Variant] = &[
    ("by hand, f, p1, p2 separate", by_hand::separate, SAMPLES),
    ("by hand, sin and cos shared", by_hand::shared, SAMPLES),
    ("by hand, sin and cos algebraic", by_hand::without_angles, SAMPLES),
    ("by hand, sin and cos algebraic, in lanes", by_hand::in_lanes, SAMPLES),
    ("balance, closures", library::balance, SAMPLES),
    ("balance, the point carries sin and cos", library::carried, SAMPLES),
    ("balance, sin and cos algebraic", library::algebraic, SAMPLES),
    ("balance, sin and cos algebraic, in batches", library::in_batches, SAMPLES),
    ("balance, closures, Sobol' points", library::sobol, [32_768, 65_536]),
    ("power 2, closures", library::power, SAMPLES),
    ("constant, closures", library::constant, SAMPLES),
    ("one-sample balance, closures", library::one_sample, SAMPLES),
    ("2 ramps, constant", library::ramps_constant::<2>, MANY),
    ("4 ramps, constant", library::ramps_constant::<4>, MANY),
    ("16 ramps, constant", library::ramps_constant::<16>, MANY),
    ("2 ramps, balance", library::ramps_balance::<2>, MANY),
    ("4 ramps, balance", library::ramps_balance::<4>, MANY),
    ("16 ramps, balance", library::ramps_balance::<16>, MANY),
    ("a ramp's density", library::ramp_density, MANY),
    ("product in 8-D", library::product, SAMPLES),
    ("lighting point", library::lighting, [20_001, 60_000]),
    ("rendered sample", library::rendered, [32_768, 98_304]),
    ("random number", library::random_points, [256_000, 512_000]),
    ("Sobol' coordinate", library::sobol_points, [256_000, 512_000]),
];

/// A run, the estimator that it drives, and what the latter costs alone: runs are counted at
/// [`DRIVEN`] samples, over which early rounds and the end are spread.
const RUNS: [(&str, Variant); 4] = [
    ("balance, closures", ("run, balance, closures", library::run_balance, SAMPLES)),
    (
        "balance, the point carries sin and cos",
        ("run, balance, the point carries sin and cos", library::run_carried, SAMPLES),
    ),
    ("constant, closures", ("run, constant, closures", library::run_constant, SAMPLES)),
    (
        "one-sample balance, closures",
        ("run, one-sample balance, closures", library::run_one_sample, SAMPLES),
    ),
];

const DRIVEN: u64 = 3_000_000;

/// Sixteen chunks more.
const CHUNKS: [Variant; 2] =
    [("a round of chunks", library::chunks, [2, 3]), ("at once", library::at_once, [2, 3])];

/// Ratios, and the most that each may be.
const RATIOS: [(&str, &str, f64); 4] = [
    ("balance, closures", "by hand, f, p1, p2 separate", 1.06),
    ("balance, the point carries sin and cos", "by hand, sin and cos shared", 1.05),
    ("balance, sin and cos algebraic", "by hand, sin and cos algebraic", 1.1),
    ("balance, sin and cos algebraic, in batches", "by hand, sin and cos algebraic, in lanes", 1.3),
];

const COUNTS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/instructions/counts.txt");

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if let Some(at) = arguments.iter().position(|a| a == "--variant") {
        let (name, n) = (&arguments[at + 1], arguments[at + 2].parse().unwrap());
        let runs = RUNS.iter().map(|(_, run)| run);
        let mut all = VARIANTS.iter().chain(runs).chain(&CHUNKS);
        let run = all.find(|(known, ..)| known == name).unwrap().1;
        println!("{:e}", black_box(run(black_box(n))));
        return;
    }
    let mut counts: BTreeMap<&str, f64> =
        VARIANTS.iter().map(|variant| (variant.0, per_unit(variant))).collect();
    let [chunks, at_once] =
        CHUNKS.map(|(name, _, [a, b])| instructions(name, b) - instructions(name, a));
    counts.insert("chunk of a run", (chunks - at_once) / 16.0);
    let committed = std::fs::read_to_string(COUNTS).unwrap_or_default();
    if arguments.iter().any(|argument| argument == "--write") {
        std::fs::write(COUNTS, text(&counts)).unwrap();
        println!("written to {COUNTS}");
    }

    let mut failures = against(&counts, &committed);
    println!("\nratio                                                        at most");
    for (library, hand, most) in RATIOS {
        let ratio = counts[library] / counts[hand];
        println!("{library:45} {ratio:8.3} {most:8.2}");
        if ratio > most {
            failures.push(format!("{library} costs {ratio:.3} times what {hand} does"));
        }
    }
    for k in [2, 4, 16] {
        let [constant, balance] =
            ["constant", "balance"].map(|w| counts[format!("{k} ramps, {w}").as_str()]);
        // K densities, and 15 % of them for the sum and for looking at them.
        let most = constant + 1.15 * f64::from(k) * counts["a ramp's density"];
        println!("{k:2} ramps, balance over constant weights       {balance:8.1} {most:8.1}");
        if balance > most {
            failures.push(format!("balance of {k} costs {balance:.1} instructions, not {most:.1}"));
        }
    }
    println!("\n{DRIVEN} samples                                       alone    a run");
    for (alone, (run, ..)) in RUNS {
        let [alone, run_count] =
            [alone, run].map(|name| instructions(name, DRIVEN) / DRIVEN as f64);
        let ratio = run_count / alone;
        println!("{run:50} {alone:8.1} {run_count:8.1} {ratio:8.4}");
        if ratio > 1.03 {
            failures.push(format!("{run} costs {ratio:.4} times the estimator alone"));
        }
    }
    assert!(failures.is_empty(), "more instructions than allowed:\n{}", failures.join("\n"));
}

fn per_unit((name, _, [few, many]): &Variant) -> f64 {
    (instructions(name, *many) - instructions(name, *few)) / (many - few) as f64
}

/// What counts depend on: the compiler and the C library. Valgrind's processor is the same wherever
/// the real one has AVX2.
fn platform() -> String {
    let first_line = |program: &str| {
        let output = Command::new(program).arg("--version").output();
        let text = output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
        text.unwrap_or_default().lines().next().unwrap_or_default().to_owned()
    };
    format!("{}, {}, {}", first_line("rustc"), first_line("ldd"), std::env::consts::ARCH)
}

fn text(counts: &BTreeMap<&str, f64>) -> String {
    let mut text = format!("{}\n", platform());
    for (name, ..) in VARIANTS {
        writeln!(text, "{:10.2}  {name}", counts[name]).unwrap();
    }
    writeln!(text, "{:10.2}  chunk of a run", counts["chunk of a run"]).unwrap();
    text
}

/// Prints the counts beside those of the file, and lists what is more than 2 % above it.
fn against(counts: &BTreeMap<&str, f64>, committed: &str) -> Vec<String> {
    let new = text(counts);
    let same = committed.lines().next() == new.lines().next();
    let known: BTreeMap<&str, f64> = committed
        .lines()
        .skip(1)
        .filter_map(|line| line.trim().split_once("  "))
        .filter_map(|(count, name)| Some((name, count.parse().ok()?)))
        .collect();
    println!("{:>10} {:>10}  instructions for each", "counted", "committed");
    let mut failures = Vec::new();
    for (count, name) in new.lines().skip(1).filter_map(|line| line.trim().split_once("  ")) {
        let count: f64 = count.parse().unwrap();
        let before = known.get(name).copied();
        let shown = before.map_or("-".into(), |before| format!("{before:.2}"));
        println!("{count:10.2} {shown:>10}  {name}");
        if same && before.is_none_or(|before| count > 1.02 * before) {
            failures.push(format!("{name}: {count:.2} instructions, committed {shown}"));
        }
    }
    if !same {
        println!("counts.txt is of another platform: {:?}", committed.lines().next());
    }
    failures
}

/// What valgrind counts for one variant of size `n`.
fn instructions(name: &str, n: u64) -> f64 {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(std::env::current_exe().unwrap())
        .args(["--variant", name, &n.to_string()])
        .output()
        .unwrap_or_else(|error| panic!("valgrind does not run: {error}"));
    let text = String::from_utf8_lossy(&output.stderr);
    let collected = text.lines().find_map(|line| line.split("Collected :").nth(1));
    collected.unwrap_or_else(|| panic!("valgrind printed: {text}")).trim().parse().unwrap()
}
