//! The cutoff heuristic.

use super::{Weighting, at};
use crate::error::ArgumentError;

/// The cutoff heuristic: the balance heuristic among the techniques with q_k ≥ a max q.
///
/// a = 0 is the balance heuristic, a = 1 the maximum heuristic. With K techniques the second
/// moment is at most 1 + a (K - 1) times that of the balance heuristic.
///
/// The weights are discontinuous, which quasi-random points suffer from.
///
/// Source: Veach and Guibas 1995.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cutoff {
    a: f64,
}

impl Cutoff {
    /// The cutoff heuristic that ignores densities below `a` times the largest.
    ///
    /// # Errors
    ///
    /// `a` must be in \[0, 1\].
    pub fn new(a: f64) -> Result<Self, ArgumentError> {
        if (0.0..=1.0).contains(&a) {
            Ok(Self { a })
        } else {
            Err(ArgumentError::new("Cutoff", "a", a, "it must be in [0, 1]"))
        }
    }
}

impl Weighting for Cutoff {
    fn weight_over_ratio(&self, i: usize, r: &[f64]) -> f64 {
        if at(r, i) < self.a {
            return 0.0;
        }
        r.iter().filter(|r| **r >= self.a).sum::<f64>().recip()
    }
}
