//! Antithetic pairs and strata: their variances, and whether error bars honour the dependence.

use std::f64::consts::{E, FRAC_PI_2};

use mis::points::{Antithetic, PointSource, Random, Stratified};
use mis::technique::{FnTechnique, Uniform, UniformBox};
use mis::{Estimate, Estimator, InverseCdf, MultiSample, OneSample};

use super::ensemble::{Spread, Z};

type Make = fn(u64) -> Box<dyn PointSource>;

const ANTITHETIC: Make = |seed| Box::new(Antithetic::new(seed));
const STRATIFIED: Make = |seed| Box::new(Stratified::new(seed, 8).unwrap());
const RANDOM: Make = |seed| Box::new(Random::new(seed));

/// Estimates with so many samples.
type Problem = fn(u64, &dyn PointSource) -> Estimate;

fn line(f: fn(&f64) -> f64, n: u64, points: &dyn PointSource) -> Estimate {
    let flat = Uniform::unit();
    MultiSample::new(&[(&flat, n)]).unwrap().estimate_from(&f, points).unwrap()
}

/// Name, integral, estimate.
const PROBLEMS: [(&str, f64, Problem); 7] = [
    ("e^x", E - 1.0, |n, points| line(|x| x.exp(), n, points)),
    ("symmetric", 1.0 / 12.0, |n, points| line(|x| (x - 0.5).powi(2), n, points)),
    ("step", 0.3, |n, points| line(|x| f64::from(*x < 0.3), n, points)),
    ("sum", 0.5 + 1.0 / 3.0, |n, points| square(|x| x[0] + x[1] * x[1], n, points)),
    ("product", 0.25, |n, points| square(|x| x[0] * x[1], n, points)),
    ("sin cos, balance", 0.5, |n, points| {
        let (cosine, sine) = (cosine(), sine());
        let mis = MultiSample::new(&[(&cosine, n / 4), (&sine, n - n / 4)]).unwrap();
        mis.estimate_from(&|x: &f64| x.sin() * x.cos(), points).unwrap()
    }),
    ("sin cos, one-sample", 0.5, |n, points| {
        let (cosine, sine) = (cosine(), sine());
        let one = OneSample::new(&[(&cosine, 0.25), (&sine, 0.75)], n).unwrap();
        one.estimate_from(&|x: &f64| x.sin() * x.cos(), points).unwrap()
    }),
];

fn square(f: fn(&[f64; 2]) -> f64, n: u64, points: &dyn PointSource) -> Estimate {
    let flat = UniformBox::uniform([0.0; 2], [1.0; 2]).unwrap();
    MultiSample::new(&[(&flat, n)]).unwrap().estimate_from(&f, points).unwrap()
}

fn cosine() -> impl InverseCdf {
    FnTechnique::new([0.0, FRAC_PI_2], f64::cos, f64::sin, f64::asin).unwrap()
}

fn sine() -> impl InverseCdf {
    let cdf = |x: f64| 2.0 * (0.5 * x).sin().powi(2);
    let inverse = |u: f64| 2.0 * (0.5 * u).sqrt().asin();
    FnTechnique::new([0.0, FRAC_PI_2], f64::sin, cdf, inverse).unwrap()
}

/// The values of estimates, from the seeds 0 up to `seeds`.
fn values(problem: Problem, n: u64, make: Make, seeds: u64) -> Spread {
    let value = |seed| problem(n, &*make(seed)).value();
    Spread::of(&(0..seeds).map(value).collect::<Vec<_>>())
}

/// Unbiased; the mean of the reported variances is the variance; 95 % intervals hold 95 %.
fn check(seeds: u64) {
    // Whole pairs and blocks in every replicate, and neither.
    for n in [1024, 512 + 333] {
        for (source, make) in [("antithetic", ANTITHETIC), ("stratified", STRATIFIED)] {
            for (name, integral, problem) in PROBLEMS {
                let estimates: Vec<_> = (0..seeds).map(|seed| problem(n, &*make(seed))).collect();
                let value = Spread::of(&estimates.iter().map(Estimate::value).collect::<Vec<_>>());
                let variance = |e: &Estimate| e.variance().unwrap();
                let variances = Spread::of(&estimates.iter().map(variance).collect::<Vec<_>>());
                let hits = |e: &&Estimate| e.interval(0.95).unwrap().contains(integral);
                let share = estimates.iter().filter(hits).count() as f64 / seeds as f64;
                let z = (value.mean - integral) / value.error();
                let ratio = variances.mean / value.variance;
                let deviation = ((value.kurtosis.max(3.0) - 1.0) / value.count)
                    .sqrt()
                    .hypot(variances.error() / variances.mean);
                let text = format!(
                    "{source}, {name}, {n}: z = {z:.2}, calibration {ratio:.3} ± {deviation:.3}, \
                     coverage {share:.3}"
                );
                println!("{text}");
                assert!(value.error() < 7e-3 * integral / (seeds as f64 / 100.0).sqrt(), "{text}");
                assert!(z.abs() <= Z, "{text}");
                assert!(((ratio - 1.0) / deviation).abs() <= Z, "{text}");
                let noise = 3.0 * (0.05 * 0.95 / seeds as f64).sqrt();
                assert!((share - 0.95).abs() <= 0.01 + noise, "{text}");
            }
        }
    }
}

#[test]
fn errors_honour_pairs_and_strata() {
    check(60);
}

#[test]
#[ignore = "seconds in release"]
fn errors_honour_pairs_and_strata_in_full() {
    check(10_000);
}

/// Exact variances of n = 512 samples, over those of random numbers.
#[test]
fn variances_are_as_stated() {
    const N: u64 = 512;
    let variance = 0.5 * (E * E - 1.0) - (E - 1.0).powi(2);
    let antithetic = 1.0 + (E - (E - 1.0).powi(2)) / variance;
    assert!((antithetic.sqrt() - 0.18).abs() < 5e-3, "as documented");
    // One uniform number in each of 8 parts of [0, 1].
    let part = |k: i32| {
        let [a, b] = [0, 1].map(|d| f64::from(k + d) / 8.0);
        4.0 * ((2.0 * b).exp() - (2.0 * a).exp()) - (8.0 * (b.exp() - a.exp())).powi(2)
    };
    let stratified = (0..8).map(part).sum::<f64>() / 8.0 / variance;
    let smooth = 0.5 * (E * E - 1.0) / (12.0 * 64.0) / variance;
    assert!((stratified / smooth - 1.0).abs() < 0.01, "{stratified}, as documented {smooth}");
    for (name, make, problem, of_random, expected) in [
        ("antithetic, e^x", ANTITHETIC, 0, variance, antithetic),
        ("antithetic, symmetric", ANTITHETIC, 1, 1.0 / 180.0, 2.0),
        ("stratified, e^x", STRATIFIED, 0, variance, stratified),
        ("random, e^x", RANDOM, 0, variance, 1.0),
    ] {
        let found = values(PROBLEMS[problem].2, N, make, 1000);
        let ratio = found.variance * N as f64 / of_random / expected;
        let deviation = ((found.kurtosis - 1.0) / found.count).sqrt();
        println!("{name}: {expected:.4} of random, found over that {ratio:.3} ± {deviation:.3}");
        assert!(deviation < 0.06 && ((ratio - 1.0) / deviation).abs() <= Z, "{name}: {ratio}");
    }
}

/// In smooth one-dimensional integrands, twice the strata are a quarter of the variance.
#[test]
fn variance_falls_with_the_square_of_the_strata() {
    let reported = |strata| {
        let points = Stratified::new(1, strata).unwrap().with_replicates(512).unwrap();
        line(|x| x.exp(), 512 * 128, &points).variance().unwrap()
    };
    for [few, many] in [[4, 8], [8, 32], [32, 128]] {
        let ratio = reported(few) / reported(many) / (many as f64 / few as f64).powi(2);
        // A variance from 512 replicates is known to √(2 / 511), and here are two of them.
        assert!((ratio - 1.0).abs() < 5.0 * (4.0_f64 / 511.0).sqrt(), "{few} {many}: {ratio}");
    }
}
