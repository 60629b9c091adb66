//! Constant weights.

use super::{Weighting, at};
use crate::error::ArgumentError;

/// Weights that are the same at every point: a weighted sum of independent estimators.
///
/// F = Σ w_i F_i, with the variance Σ w_i² V\[F_i\]. A sample needs only its own technique's pdf,
/// which makes this the cheap end of the trade between speed and accuracy; but one bad technique
/// spoils the sum.
///
/// **Every** technique with w_i > 0 must cover f. One that does not makes the estimate wrong, and
/// nothing in the samples tells: with f = 1 on \[0, 2\] and uniform techniques on \[0, 1\] and
/// \[1, 2\], equal weights give 1, not 2.
///
/// Source: Veach and Guibas 1995, section 3.
#[derive(Debug, Clone, PartialEq)]
pub struct Constant {
    /// `None`: equal.
    weights: Option<Vec<f64>>,
}

impl Constant {
    /// 1 / K for each of the K techniques that have samples.
    #[must_use]
    pub fn equal() -> Self {
        Self { weights: None }
    }

    /// Given weights, one a technique. Choose them before the samples are drawn: weights from the
    /// same samples' variances bias the sum.
    ///
    /// # Errors
    ///
    /// Every weight must be at least 0, and their sum 1 up to rounding.
    pub fn new(weights: impl Into<Vec<f64>>) -> Result<Self, ArgumentError> {
        let weights = weights.into();
        for (i, w) in weights.iter().enumerate() {
            if !(*w >= 0.0) {
                let argument = format!("weights[{i}]");
                return Err(ArgumentError::new("Constant", argument, w, "it must be at least 0"));
            }
        }
        let sum = weights.iter().sum::<f64>();
        if (sum - 1.0).abs() <= 4.0 * f64::EPSILON * weights.len() as f64 {
            Ok(Self { weights: Some(weights) })
        } else {
            let rule = format!("the weights must sum to 1, and they sum to {sum:?}");
            Err(ArgumentError::new("Constant", "weights", weights, rule))
        }
    }
}

impl Weighting for Constant {
    /// Not used: [`constant_weight`](Weighting::constant_weight) answers first.
    fn weight_over_ratio(&self, i: usize, r: &[f64]) -> f64 {
        self.constant_weight(i, r).unwrap_or(0.0) / at(r, i)
    }

    fn constant_weight(&self, i: usize, alpha: &[f64]) -> Option<f64> {
        Some(match &self.weights {
            Some(weights) => weights.get(i).copied().unwrap_or(0.0),
            None if at(alpha, i) > 0.0 => {
                (alpha.iter().filter(|alpha| **alpha > 0.0).count() as f64).recip()
            }
            None => 0.0,
        })
    }

    fn check(&self, alpha: &[f64]) -> Result<(), ArgumentError> {
        let Some(weights) = &self.weights else { return Ok(()) };
        if weights.len() != alpha.len() {
            let rule = format!("there must be one weight for each of {} techniques", alpha.len());
            return Err(ArgumentError::new("Constant", "weights", weights, rule));
        }
        for (i, (w, alpha)) in weights.iter().zip(alpha).enumerate() {
            if *w > 0.0 && *alpha == 0.0 {
                let rule = format!("technique {i} has no samples, so its weight must be 0");
                return Err(ArgumentError::new("Constant", format!("weights[{i}]"), w, rule));
            }
        }
        Ok(())
    }
}
