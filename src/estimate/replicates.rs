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

    fn moments_of_replicates(&self, value: impl Fn(usize) -> f64) -> Option<Moments> {
        let values: Vec<f64> = (0..self.replicates).map(value).collect();
        (self.replicates > 1 && values.iter().all(|v| !v.is_nan()))
            .then(|| Moments::of_block(&values))
    }

    /// α_i times the mean over the samples of a replicate, with α_i the part that the technique has
    /// of these if that is random. NaN without samples.
    fn part_of_replicate(&self, i: usize, r: usize, c: usize) -> f64 {
        let of = |i| self.of_replicate(i, r, c).moments;
        let Moments { count, mean, .. } = of(i);
        let alpha = match self.design {
            Design::Stratified => self.shares[i],
            Design::Pooled => {
                let all: u64 = self.techniques_drawn().map(|i| of(i).count).sum();
                if all == 0 {
                    return f64::NAN;
                }
                count as f64 / all as f64
            }
        };
        match (alpha == 0.0, count) {
            (true, _) => 0.0,
            (false, 0) => f64::NAN,
            (false, _) => alpha * mean,
        }
    }
}
