//! How often right techniques fail.

use std::f64::consts::TAU;

use mis::check::{self, Options, Report};
use mis::technique::{Exponential, InverseCdf, Normal, Product};

use crate::{Square, square};

type Case = Box<dyn Fn(u64) -> Report>;

/// How many of `seeds` reports a right technique fails.
fn false_alarms(seeds: u32, report: impl Fn(u64) -> Report) -> f64 {
    (0..seeds).map(|seed| f64::from(u8::from(!report(seed.into()).passed()))).sum()
}

/// Right techniques on all ways of the checker.
fn cases(options: impl Fn(u64) -> Options + Copy + 'static) -> [(&'static str, Case); 5] {
    let exponential = Exponential::new(1.0, 0.0, f64::INFINITY).unwrap();
    let flatter = Exponential::new(0.5, 0.0, f64::INFINITY).unwrap();
    let p = Product::new([Normal::standard(); 2]).unwrap();
    let r = Product::new([Normal::new(0.0, 1.5).unwrap(); 2]).unwrap();
    let bent = |[u, v]: [f64; 2]| [u, (v + 0.2 * (TAU * u).sin()).rem_euclid(1.0)];
    let bent = Square { map: bent, pdf: |_| 1.0 };
    [
        ("line", Box::new(move |seed| check::inverse_cdf(&exponential, &options(seed)))),
        (
            "quadrature",
            Box::new(move |seed| {
                let ranks = |x: &[f64; 2]| [0, 1].map(|d| r.coordinates()[d].cdf(x[d]));
                check::technique(&p, &r, ranks, &options(seed))
            }),
        ),
        (
            "samples of the reference",
            Box::new(move |seed| check::technique(&p, &r, |x| *x, &options(seed))),
        ),
        (
            "reference of another shape",
            Box::new(move |seed| {
                check::technique(&exponential, &flatter, |x| [*x], &options(seed))
            }),
        ),
        (
            "bent square",
            Box::new(move |seed| check::technique(&bent, &square(), |x| *x, &options(seed))),
        ),
    ]
}

/// At a rate of 5 %, so that there is something to count.
fn assert_within_rate(seeds: u32) {
    let (n, rate) = (f64::from(seeds), 0.05_f64);
    let allowed = n * rate + 4.42 * (n * rate * (1.0 - rate)).sqrt();
    let options = move |seed| Options::default().seed(seed).samples(2000).false_alarms(rate);
    for (name, report) in cases(options) {
        let failed = false_alarms(seeds, report);
        println!("{name}: {failed} of {seeds}");
        assert!(failed <= allowed, "{name}: {failed} of {seeds}, {allowed} allowed");
    }
}

/// At the default rate of 1e-4.
fn assert_passing(seeds: u32) {
    for (name, report) in cases(|seed| Options::default().seed(seed).samples(5000)) {
        assert_eq!(false_alarms(seeds, report), 0.0, "{name}");
    }
}

#[test]
fn false_alarms_are_within_their_rate() {
    assert_within_rate(12);
}

#[test]
fn right_techniques_pass_with_any_seed() {
    assert_passing(6);
}

#[test]
#[ignore = "1000 seeds: run in release"]
fn false_alarms_battery() {
    assert_within_rate(1000);
}

#[test]
#[ignore = "250 seeds: run in release"]
fn right_techniques_battery() {
    assert_passing(250);
}
