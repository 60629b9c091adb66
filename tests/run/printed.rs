//! The numbers of a report as it is printed, computed anew.

use std::sync::atomic::{AtomicU64, Ordering};

use mis::points::Random;
use mis::technique::{Linear, Uniform};
use mis::{Integrand, MultiSample, Report, Run, Target};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::common::f;

fn go<F: Integrand<f64> + Sync>(samples: u64, f: &F) -> Report<F::Value> {
    let (flat, ramp) = (Uniform::new(0.0, 2.0).unwrap(), Linear::new(0.0, 2.0, 0.0, 1.0).unwrap());
    let mis = MultiSample::new(&[(&flat, 1), (&ramp, 1)]).unwrap();
    let target = Target::new().samples(samples).unwrap();
    Run::new(target).threads(1).unwrap().execute(&mis, f, 1).unwrap()
}

fn line(text: &str, start: &str) -> Option<String> {
    text.lines().find(|line| line.trim_start().starts_with(start)).map(ToOwned::to_owned)
}

const AGREEMENT: &str = "rounds against each other: ";

#[test]
fn rounds_against_each_other() {
    // Of 2, 3, and 5 rounds, the last of other lengths.
    for samples in [1500, 4000, 10_000] {
        let report = go(samples, &f);
        let rounds = report.rounds();
        let of = |k: usize| {
            let own = &rounds[k].estimate;
            (own.value(), own.standard_error().unwrap(), own.samples() as f64)
        };
        let all = || (0..rounds.len()).map(of);
        let mean = all().map(|(value, _, n)| value * n).sum::<f64>() / samples as f64;
        let chi2: f64 = all().map(|(value, error, _)| ((value - mean) / error).powi(2)).sum();
        let freedom = (rounds.len() - 1) as f64;
        let q = ChiSquared::new(freedom).unwrap().sf(chi2);
        let expected = format!("chi2/dof {:.2}, probability {q:.2}", chi2 / freedom);
        let text = report.to_string();
        assert_eq!(line(&text, AGREEMENT), Some(format!("{AGREEMENT}{expected}")), "{text}");
    }
}

#[test]
fn rounds_that_cannot_be_compared() {
    // One round; and rounds without an error, of contributions that are all the same.
    let flat = Uniform::new(0.0, 2.0).unwrap();
    let mis = MultiSample::new(&[(&flat, 3000)]).unwrap();
    let same = Run::new(Target::new()).execute(&mis, &|_: &f64| 0.5, 1).unwrap();
    assert_eq!((same.rounds().len(), same.standard_error()), (3, Some(0.0)));
    for report in [go(1000, &f), same, go(3000, &|_: &f64| 0.0)] {
        assert_eq!(line(&report.to_string(), AGREEMENT), None, "{report}");
    }
}

#[test]
fn the_component_that_a_table_shows_is_named() {
    let one = go(1500, &f).to_string();
    let two = go(1500, &|x: &f64| [f(x), 2.0 * f(x)]).to_string();
    assert!(line(&one, "round ").unwrap().ends_with("all"), "{one}");
    assert!(line(&two, "round ").unwrap().ends_with("all (component 0)"), "{two}");
    assert!(line(&one, "95 % interval: [").is_some());
    assert!(line(&two, "95 % interval, component 1: [").is_some());
    // The lines of the rounds are the same.
    for number in ["0 ", "1 "] {
        assert_eq!(line(&one, number), line(&two, number));
    }
}

#[test]
fn sums_that_there_are_not() {
    let flat = Uniform::new(0.0, 2.0).unwrap();
    let mis = MultiSample::new(&[(&flat, 3000)]).unwrap();
    for bound in [-1.0, 0.5] {
        let missed = AtomicU64::new(0);
        // With one thread and no file, every sample is shown once.
        let run = Run::new(Target::new()).threads(1).unwrap();
        let report = run.tally(&mis, &f, &Random::new(1), 2, |sample, tally| {
            tally.add(1, sample.contribution());
            if *sample.x() < bound {
                missed.fetch_add(1, Ordering::Relaxed);
                tally.add(2, 1.0);
            }
        });
        let (report, missed) = (report.unwrap(), missed.into_inner());
        assert_eq!((report.misplaced(), missed > 600), (missed, bound > 0.0));
        let expected = format!("sums: 2; amounts for sums that there are not: {missed}");
        assert_eq!(line(&report.to_string(), "sums: "), Some(expected));
    }
    assert_eq!(line(&go(3000, &f).to_string(), "sums: "), None);
}
