//! What replicates come to: independent estimates from points that depend on each other.

use super::{Design, Estimate};
use crate::integrand::Value;
use crate::moments::Moments;

impl<V: Value> Estimate<V> {
    /// The values that the R replicates come to, each for itself; `None` without replicates, and
    /// where one has no value, as it lacks samples of a technique.
    pub(super) fn replicate_values(&self, c: usize) -> Option<Moments> {
        self.moments_of_replicates(|r| {
            self.techniques_drawn().map(|i| self.part_of_replicate(i, r, c)).sum()
        })
    }

    /// What technique `i` adds to them.
    pub(super) fn replicate_parts(&self, i: usize, c: usize) -> Option<Moments> {
        self.moments_of_replicates(|r| self.part_of_replicate(i, r, c))
    }

    /// The samples of each replicate; `None` without replicates, and where one has no value.
    pub(super) fn samples_of_replicates(&self) -> Option<Vec<u64>> {
        let count = |i, r| self.of_replicate(i, r, 0).moments.count;
        let total = |r| {
            let counts = || self.techniques_drawn().map(move |i| count(i, r));
            let all: u64 = counts().sum();
            let has_value = match self.design {
                Design::Stratified => {
                    self.shares.iter().zip(counts()).all(|(share, n)| *share == 0.0 || n > 0)
                }
                Design::Pooled => all > 0,
            };
            has_value.then_some(all)
        };
        (self.replicates > 1).then(|| (0..self.replicates).map(total).collect()).flatten()
    }

    fn moments_of_replicates(&self, value: impl Fn(usize) -> f64) -> Option<Moments> {
        let values: Vec<f64> = (0..self.dealt.len()).map(value).collect();
        (!values.is_empty()).then(|| Moments::of_block(&values))
    }

    /// α_i times the mean over the samples of a replicate, with α_i the part that the technique has
    /// of these if that is random.
    fn part_of_replicate(&self, i: usize, r: usize, c: usize) -> f64 {
        let Moments { count, mean, .. } = self.of_replicate(i, r, c).moments;
        let alpha = match (self.design, self.dealt.get(r)) {
            (Design::Pooled, Some(dealt)) => count as f64 / *dealt as f64,
            _ => self.shares[i],
        };
        // Without a sample, there is no mean.
        if alpha == 0.0 { 0.0 } else { alpha * mean }
    }
}
