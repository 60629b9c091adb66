//! Never worse than the balance heuristic.

use mis::Fit;

use crate::cases::{self, Case};
use crate::ensembles::{CROSS_FIT, FITS, Mean, ensemble, name, ratio, squares};

/// How much larger the variance may be, for the coefficients have to be found.
const MARGIN: f64 = 1.05;

/// Mean squared errors over those of the balance heuristic, from the same seeds.
fn never_worse(cases: &[Case], fits: &[Fit], of_each: &[u64], seeds: u64, most_error: f64) {
    for case in cases {
        for n in of_each.iter().map(|n| n * case.techniques) {
            let balance = ensemble(case, None, n, seeds);
            for fit in fits {
                let found = ensemble(case, Some(*fit), n, seeds);
                let ratio = ratio(&squares(case, &found, &balance));
                let what = format!("{}, {n} samples, {}: {ratio:?}", case.name, name(Some(*fit)));
                println!("{what}");
                assert!(ratio.error < most_error, "{what}");
                assert!(ratio.mean - 3.0 * ratio.error < MARGIN, "{what}");
            }
        }
    }
}

#[test]
fn variances_are_never_far_above_the_balance_heuristics() {
    never_worse(&cases::few(), &[CROSS_FIT, Fit::Direct], &[50], 60, 0.25);
}

#[test]
#[ignore = "takes a minute in release"]
fn variances_are_never_far_above_the_balance_heuristics_in_full_ensembles() {
    never_worse(&cases::all(), &[CROSS_FIT, Fit::Direct], &[50, 200], 10_000, 0.04);
}

/// Where a large part of the samples is the first batch, its noise counts twice.
#[test]
#[ignore = "takes half a minute in release"]
fn progressive_variances_are_not_far_above_either() {
    never_worse(&cases::all(), &[Fit::Progressive], &[200], 10_000, 0.04);
}

/// Unbiased, but for the direct fit, whose bias is below half of the standard error.
fn unbiased(cases: &[Case], of_each: u64, seeds: u64) {
    for case in cases {
        let n = of_each * case.techniques;
        for fit in FITS {
            let found = ensemble(case, Some(fit), n, seeds);
            let mean = Mean::of(found.iter().map(|found| found.value));
            let off = (mean.mean - case.integral).abs();
            let spread = mean.error * (seeds as f64).sqrt();
            let allowed = if fit == Fit::Direct { 0.5 * spread } else { 0.0 };
            let rounding = 1e-13 * case.integral;
            let what = format!("{}, {n} samples, {}: {mean:?}", case.name, name(Some(fit)));
            assert!(off < allowed + 4.42 * mean.error + rounding, "{what}");
        }
    }
}

#[test]
fn means_are_the_integrals() {
    unbiased(&cases::few(), 12, 200);
}

#[test]
#[ignore = "takes a minute in release"]
fn means_are_the_integrals_in_full_ensembles() {
    unbiased(&cases::all(), 12, 20_000);
    unbiased(&cases::all(), 60, 10_000);
}
