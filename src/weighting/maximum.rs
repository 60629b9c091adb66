//! The maximum heuristic.

use super::{Weighting, at};

/// The maximum heuristic: all the weight to the technique with the largest q_k. Ties share.
///
/// It partitions the domain. The second moment is at most K times that of the balance heuristic.
/// The weights are discontinuous, which quasi-random points suffer from.
///
/// Source: Veach and Guibas 1995.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Maximum;

impl Weighting for Maximum {
    fn weight_over_ratio(&self, i: usize, r: &[f64]) -> f64 {
        if at(r, i) < 1.0 {
            return 0.0;
        }
        (r.iter().filter(|r| **r == 1.0).count() as f64).recip()
    }
}
