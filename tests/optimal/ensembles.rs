//! Ensembles: estimates of a case from many seeds.

use std::num::NonZero;
use std::sync::atomic::{AtomicU64, Ordering};

use mis::Fit;

use crate::cases::{Case, Found};

pub(crate) const CROSS_FIT: Fit = Fit::CrossFit { folds: 5 };

/// The three ways of an estimate to its coefficients.
pub(crate) const FITS: [Fit; 3] = [Fit::Direct, CROSS_FIT, Fit::Progressive];

pub(crate) fn name(fit: Option<Fit>) -> &'static str {
    match fit {
        None => "balance",
        Some(Fit::Direct) => "direct",
        Some(Fit::Progressive) => "progressive",
        Some(_) => "cross-fit",
    }
}

/// Estimates from the seeds 0 up to `seeds`, in order.
pub(crate) fn ensemble(case: &Case, fit: Option<Fit>, samples: u64, seeds: u64) -> Vec<Found> {
    const BLOCK: u64 = 64;
    let next = AtomicU64::new(0);
    let work = || {
        let mut found = Vec::new();
        loop {
            let start = next.fetch_add(BLOCK, Ordering::Relaxed);
            if start >= seeds {
                return found;
            }
            let run = |seed| (seed, case.run(fit, samples, seed));
            found.extend((start..(start + BLOCK).min(seeds)).map(run));
        }
    };
    let mut all = std::thread::scope(|scope| {
        let threads = std::thread::available_parallelism().map_or(1, NonZero::get).min(4);
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(work)).collect();
        let mut all = work();
        for other in others {
            all.extend(other.join().unwrap());
        }
        all
    });
    all.sort_by_key(|(seed, _)| *seed);
    all.into_iter().map(|(_, found)| found).collect()
}

/// A mean and its standard error.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mean {
    pub(crate) mean: f64,
    pub(crate) error: f64,
}

impl Mean {
    pub(crate) fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.into_iter().collect();
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        Self { mean, error: (squares / (n * (n - 1.0))).sqrt() }
    }

    /// How many standard errors it is from `expected`.
    pub(crate) fn z(self, expected: f64) -> f64 {
        if self.mean == expected { 0.0 } else { (self.mean - expected) / self.error }
    }
}

/// The ratio of two means of pairs, by the delta method.
pub(crate) fn ratio(pairs: &[(f64, f64)]) -> Mean {
    let above = Mean::of(pairs.iter().map(|p| p.0)).mean;
    let below = Mean::of(pairs.iter().map(|p| p.1)).mean;
    let mean = above / below;
    let error = Mean::of(pairs.iter().map(|p| (p.0 - mean * p.1) / below)).error;
    Mean { mean, error }
}

/// Squared errors of two ensembles from the same seeds, side by side.
pub(crate) fn squares(case: &Case, found: &[Found], other: &[Found]) -> Vec<(f64, f64)> {
    let square = |found: &Found| (found.value - case.integral).powi(2);
    found.iter().zip(other).map(|(a, b)| (square(a), square(b))).collect()
}
