//! Counts in bins, and what is said of them.

use std::ops::Range;

use super::report::{Finding, Law, Tally, Verdict};
use super::statistics::{Fit, largest_score, middle_half};

/// Samples in bins between given edges; what is beyond the ends counts in the end bins.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Histogram {
    edges: Vec<f64>,
    pub(super) counts: Vec<f64>,
}

impl Histogram {
    /// Bins between `edges`, which increase.
    pub(super) fn new(edges: Vec<f64>) -> Self {
        let counts = vec![0.0; edges.len().saturating_sub(1).max(1)];
        Self { edges, counts }
    }

    pub(super) fn push(&mut self, x: f64) {
        let inner = self.edges.get(1..self.counts.len()).unwrap_or_default();
        let bin = inner.partition_point(|edge| *edge <= x);
        if let Some(count) = self.counts.get_mut(bin) {
            *count += 1.0;
        }
    }

    /// The interval of these bins.
    pub(super) fn range(&self, bins: &Range<usize>) -> String {
        interval(&self.edges, bins)
    }

    /// How the samples lie to the masses, if one can tell.
    pub(super) fn shape(&self, masses: &[f64]) -> String {
        shape(&self.edges, &self.counts, masses)
    }
}

pub(super) fn interval(edges: &[f64], bins: &Range<usize>) -> String {
    let end = |k: usize| edges.get(k).copied().unwrap_or(f64::NAN);
    format!("[{}, {})", brief(end(bins.start)), brief(end(bins.end)))
}

/// Five digits.
fn brief(x: f64) -> String {
    if x == 0.0 || (1e-3..1e5).contains(&x.abs()) { format!("{x:.4}") } else { format!("{x:.4e}") }
}

/// "the middle half of the samples is 5.0 % wider than the pdf's".
pub(super) fn shape(edges: &[f64], counts: &[f64], masses: &[f64]) -> String {
    let Some((ratio, shift)) = middle_half(edges, counts, masses) else {
        return String::new();
    };
    let percent = 100.0 * (ratio - 1.0);
    let way = if percent > 0.0 { "wider" } else { "narrower" };
    let width = format!("the middle half of the samples is {:.1} % {way}", percent.abs());
    format!("{width} than the pdf's and shifted by {:.1} % of its width", 100.0 * shift)
}

/// The finding on χ², with the bins that add most to it.
pub(super) fn describe(
    law: Law,
    fit: Option<Fit>,
    level: f64,
    place: impl FnOnce(&Range<usize>) -> String,
) -> Finding {
    let mut tally = Tally::new(law);
    let Some(fit) = fit else {
        let mut finding = tally.finding();
        finding.detail = "all samples and all mass in one bin".into();
        return finding;
    };
    let Fit { statistic, freedom, count, expected, ref bins, .. } = fit;
    tally.limit(fit.score.abs(), largest_score(level), || {
        format!(
            "χ² = {statistic:.1} on {freedom} degrees of freedom; worst in {}: {count} samples, \
             {expected:.1} expected",
            place(bins)
        )
    });
    tally.finding()
}

/// A finding on a law that could not be tested.
pub(super) fn unresolved(law: Law, why: &str) -> Finding {
    let (verdict, detail) = (Verdict::Unresolved, why.to_owned());
    Finding { law, verdict, measured: f64::NAN, allowed: f64::NAN, detail }
}
