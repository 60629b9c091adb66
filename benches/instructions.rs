//! Instructions per sample on the slides' sin·cos, through the public API and by hand.
//!
//! `cargo bench --bench instructions` runs every variant under valgrind (which must be
//! installed) at two sample counts, and prints the difference per sample; start-up cancels.
//! It fails if the library costs more than 1.1 times a hand-written loop over separate f, p1, p2,
//! or 1.2 times one that shares sin and cos, when the point carries them.

#![allow(clippy::unwrap_used, clippy::panic, missing_docs)]

use std::f64::consts::FRAC_PI_2;
use std::hint::black_box;
use std::process::Command;

use mis::technique::{FnTechnique, canonical};
use mis::weighting::{Constant, Power};
use mis::{Estimator, MultiSample, OneSample, Run, Target, Technique};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Dxsm;

/// Its name, and what it computes from a number of samples.
type Variant = (&'static str, fn(u64) -> f64);

/// How many samples the driver is measured at; what it spends on early rounds and at the end is
/// spread over them.
const MANY: u64 = 3_000_000;

/// What the runs drive.
const ALONE: [&str; 4] = [
    "balance, closures",
    "balance, the point carries sin and cos",
    "constant, closures",
    "one-sample balance, closures",
];

const BY_HAND: [Variant; 3] = [
    ("by hand, f, p1, p2 separate", hand_separate),
    ("by hand, sin and cos shared", hand_shared),
    ("by hand, sin and cos algebraic", hand_algebraic),
];

const RUNS: [Variant; 4] = [
    ("run, balance, closures", run_balance),
    ("run, balance, the point carries sin and cos", run_carried),
    ("run, constant, closures", run_constant),
    ("run, one-sample balance, closures", run_one_sample),
];

const LIBRARY: [Variant; 6] = [
    ("balance, closures", balance),
    ("balance, the point carries sin and cos", balance_carried),
    ("balance, sin and cos algebraic", balance_algebraic),
    ("power 2, closures", power),
    ("constant, closures", constant),
    ("one-sample balance, closures", one_sample),
];

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if let Some(at) = arguments.iter().position(|a| a == "--variant") {
        let (name, n) = (&arguments[at + 1], arguments[at + 2].parse().unwrap());
        let run =
            BY_HAND.iter().chain(&LIBRARY).chain(&RUNS).find(|(known, _)| known == name).unwrap().1;
        println!("{:e}", black_box(run(black_box(n))));
        return;
    }
    let count = |name: &str| {
        let total = |n: u64| instructions(name, n);
        (total(60_000) - total(20_000)) / 40_000.0
    };
    let by_hand = BY_HAND.map(|(name, _)| (name, count(name)));
    let library = LIBRARY.map(|(name, _)| (name, count(name)));
    let runs = RUNS.map(|(name, _)| (name, instructions(name, MANY) / MANY as f64));
    let alone = ALONE.map(|name| instructions(name, MANY) / MANY as f64);
    println!("{:44} {:>12}", "variant", "instructions");
    for (name, n) in by_hand.iter().chain(&library) {
        println!("{name:44} {n:12.1}");
    }
    println!("\n{MANY} samples, start-up included{:>20} {:>12}", "alone", "a run");
    let mut most = 0.0_f64;
    for ((name, run), alone) in runs.iter().zip(alone) {
        println!("{name:44} {alone:12.1} {run:12.1} {:8.4}", run / alone);
        most = most.max(run / alone);
    }
    println!("a run against the estimator alone:  {most:.4} (at most 1.03)");
    let separate = library[0].1 / by_hand[0].1;
    let shared = library[1].1 / by_hand[1].1;
    println!("closures against separate by hand: {separate:.3} (at most 1.1)");
    println!("carried against shared by hand:    {shared:.3} (at most 1.2)");
    assert!(separate <= 1.1 && shared <= 1.2 && most <= 1.03, "more instructions than allowed");
}

/// What valgrind counts for a run of one variant with `n` samples.
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

#[inline(never)]
fn f(x: f64) -> f64 {
    x.sin() * x.cos()
}

#[inline(never)]
fn p1(x: f64) -> f64 {
    x.cos()
}

#[inline(never)]
fn p2(x: f64) -> f64 {
    x.sin()
}

/// The two inverse CDFs.
fn sample(technique: usize, xi: f64) -> f64 {
    if technique == 0 { xi.asin() } else { 2.0 * (xi / 2.0).sqrt().asin() }
}

/// The balance estimate by a plain loop; `contribution` is f/c.
fn by_hand(n: u64, contribution: impl Fn(f64, f64) -> f64) -> f64 {
    let mut value = 0.0;
    let mut variance = 0.0;
    let per_technique = (n / 2) as f64;
    for technique in 0..2 {
        let mut generator = Pcg64Dxsm::seed_from_u64(technique as u64);
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..n / 2 {
            let xi = f64::from_bits(generator.next_u64() >> 12 | 1_f64.to_bits())
                - (1.0 - f64::EPSILON / 2.0);
            let y = contribution(sample(technique, xi), per_technique);
            sum += y;
            squares += y * y;
        }
        value += sum;
        variance += squares - sum * sum / per_technique;
    }
    value + variance
}

fn hand_separate(n: u64) -> f64 {
    by_hand(n, |x, n| f(x) / (n * p1(x) + n * p2(x)))
}

fn hand_shared(n: u64) -> f64 {
    by_hand(n, |x, n| {
        let (sin, cos) = x.sin_cos();
        sin * cos / (n * cos + n * sin)
    })
}

/// (sin x, cos x) at the x that ξ maps to, without x.
fn algebraic(technique: usize, xi: f64) -> (f64, f64) {
    if technique == 0 { (xi, (1.0 - xi * xi).sqrt()) } else { ((xi * (2.0 - xi)).sqrt(), 1.0 - xi) }
}

fn hand_algebraic(n: u64) -> f64 {
    let mut value = 0.0;
    let mut variance = 0.0;
    let per_technique = (n / 2) as f64;
    for technique in 0..2 {
        let mut generator = Pcg64Dxsm::seed_from_u64(technique as u64);
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..n / 2 {
            let xi = f64::from_bits(generator.next_u64() >> 12 | 1_f64.to_bits())
                - (1.0 - f64::EPSILON / 2.0);
            let (sin, cos) = algebraic(technique, xi);
            let y = sin * cos / (per_technique * cos + per_technique * sin);
            sum += y;
            squares += y * y;
        }
        value += sum;
        variance += squares - sum * sum / per_technique;
    }
    value + variance
}

fn cosine() -> impl Technique<Point = f64> {
    FnTechnique::new([0.0, FRAC_PI_2], f64::cos, f64::sin, f64::asin).unwrap()
}

fn sine() -> impl Technique<Point = f64> {
    let inverse = |u: f64| 2.0 * (u / 2.0).sqrt().asin();
    FnTechnique::new([0.0, FRAC_PI_2], f64::sin, |x: f64| 1.0 - x.cos(), inverse).unwrap()
}

fn finish(estimate: Result<mis::Estimate, mis::EstimateError>) -> f64 {
    let estimate = estimate.unwrap();
    estimate.value() + estimate.standard_error().unwrap()
}

fn sin_cos(x: &f64) -> f64 {
    x.sin() * x.cos()
}

fn balance(n: u64) -> f64 {
    let (cosine, sine) = (cosine(), sine());
    finish(MultiSample::new(&[(&cosine, n / 2), (&sine, n / 2)]).unwrap().estimate(&sin_cos, 1))
}

fn power(n: u64) -> f64 {
    let (cosine, sine) = (cosine(), sine());
    let mis = MultiSample::new(&[(&cosine, n / 2), (&sine, n / 2)]).unwrap();
    finish(mis.weighting(Power::squared()).unwrap().estimate(&sin_cos, 1))
}

fn on_one_thread<E: mis::Estimator<P>, P: std::fmt::Debug>(
    estimator: &E,
    f: &(impl mis::Integrand<P, Value = f64> + Sync),
) -> f64 {
    let report = Run::new(Target::new()).threads(1).unwrap().execute(estimator, f, 1).unwrap();
    report.value() + report.standard_error().unwrap()
}

fn run_balance(n: u64) -> f64 {
    let (cosine, sine) = (cosine(), sine());
    on_one_thread(&MultiSample::new(&[(&cosine, n / 2), (&sine, n / 2)]).unwrap(), &sin_cos)
}

fn run_carried(n: u64) -> f64 {
    let mis = MultiSample::new(&[(&Carried(0), n / 2), (&Carried(1), n / 2)]).unwrap();
    on_one_thread(&mis, &|x: &Angle| x.sin * x.cos)
}

fn run_constant(n: u64) -> f64 {
    let (cosine, sine) = (cosine(), sine());
    let mis = MultiSample::new(&[(&cosine, n / 2), (&sine, n / 2)]).unwrap();
    on_one_thread(&mis.weighting(Constant::equal()).unwrap(), &sin_cos)
}

fn run_one_sample(n: u64) -> f64 {
    let (cosine, sine) = (cosine(), sine());
    on_one_thread(&OneSample::new(&[(&cosine, 0.5), (&sine, 0.5)], n).unwrap(), &sin_cos)
}

fn constant(n: u64) -> f64 {
    let (cosine, sine) = (cosine(), sine());
    let mis = MultiSample::new(&[(&cosine, n / 2), (&sine, n / 2)]).unwrap();
    finish(mis.weighting(Constant::equal()).unwrap().estimate(&sin_cos, 1))
}

fn one_sample(n: u64) -> f64 {
    let (cosine, sine) = (cosine(), sine());
    finish(OneSample::new(&[(&cosine, 0.5), (&sine, 0.5)], n).unwrap().estimate(&sin_cos, 1))
}

/// A point that carries what several evaluations share.
#[derive(Debug, Clone, Copy)]
struct Angle {
    sin: f64,
    cos: f64,
}

/// The same, from algebra alone.
struct Algebraic<const TECHNIQUE: usize>;

impl<const TECHNIQUE: usize> Technique for Algebraic<TECHNIQUE> {
    type Point = Angle;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> Angle {
        let (sin, cos) = algebraic(TECHNIQUE, canonical(xi, 0));
        Angle { sin, cos }
    }

    fn pdf(&self, x: &Angle) -> f64 {
        if TECHNIQUE == 0 { x.cos } else { x.sin }
    }
}

fn balance_algebraic(n: u64) -> f64 {
    let mis = MultiSample::new(&[(&Algebraic::<0>, n / 2), (&Algebraic::<1>, n / 2)]).unwrap();
    finish(mis.estimate(&|x: &Angle| x.sin * x.cos, 1))
}

/// p = cos (technique 0) or sin (technique 1) over angles.
struct Carried(usize);

impl Technique for Carried {
    type Point = Angle;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> Angle {
        let (sin, cos) = sample(self.0, canonical(xi, 0)).sin_cos();
        Angle { sin, cos }
    }

    fn pdf(&self, x: &Angle) -> f64 {
        if self.0 == 0 { x.cos } else { x.sin }
    }
}

fn balance_carried(n: u64) -> f64 {
    let mis = MultiSample::new(&[(&Carried(0), n / 2), (&Carried(1), n / 2)]).unwrap();
    finish(mis.estimate(&|x: &Angle| x.sin * x.cos, 1))
}
