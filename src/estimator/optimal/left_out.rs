//! What samples would leave if each were left out of the fit.

use nalgebra::DVector;

use crate::estimator::kept::{Kept, Origin, controlled};
use crate::estimator::regression::{Factored, Solution};

/// Contributions whose variance is that of the value, although coefficients are fitted to them.
///
/// The value is Σ ω_j y_j / N, with weights ω_j that depend on the regressors alone. Sample j leaves
/// r_j, but r_j / (1 - h_j) of a fit without it, where h_j is its leverage. So it enters the variance
/// as ω_j r_j / (1 - h_j). The mean over a technique stays what it is.
#[derive(Debug)]
pub(super) struct LeftOut {
    /// ω_j / (1 - h_j).
    factors: Vec<f64>,
    /// The value of each component.
    values: Vec<f64>,
    /// What is added to those of a technique; a row for each component.
    shifts: Vec<Vec<f64>>,
}

impl LeftOut {
    pub(super) fn new(
        kept: &Kept,
        factored: &Factored,
        solution: &Solution,
        techniques: usize,
    ) -> Self {
        let n = kept.len() as f64;
        // The mean of all regressors is known to be 0.
        let truth = factored.whitened(&[]);
        let factor = |z: &[f64]| {
            let row: DVector<f64> = factored.whitened(z);
            let influence = 1.0 + n * truth.dot(&row);
            let left = 1.0 - 1.0 / n - row.norm_squared();
            // A coefficient that is this sample's alone leaves nothing to divide.
            if left > 0.0 { influence / left } else { influence }
        };
        let mut counts = vec![0.0; techniques];
        kept.samples().for_each(|(of, _, _)| counts[of.technique] += 1.0);
        // The leverages account for the means of the techniques; a variance within one does it again.
        let within: Vec<f64> =
            counts.iter().map(|n: &f64| (1.0 - 1.0 / n).max(0.0).sqrt()).collect();
        let factors: Vec<f64> =
            kept.samples().map(|(of, z, _)| factor(z) * within[of.technique]).collect();
        let mut values = Vec::new();
        let mut shifts = Vec::new();
        for (c, beta) in solution.coefficients.iter().enumerate() {
            let left =
                || kept.samples().map(|(of, z, y)| (of.technique, controlled(y[c], z, beta)));
            let value = left().map(|(_, y)| y / n).sum::<f64>();
            let mut shift = vec![0.0; techniques];
            for ((technique, y), factor) in left().zip(&factors) {
                shift[technique] += (y - value) * (1.0 - factor) / counts[technique];
            }
            values.push(value);
            shifts.push(shift);
        }
        Self { factors, values, shifts }
    }

    /// That of sample j, of component `c`, for what it leaves.
    pub(super) fn contribution(&self, j: usize, of: &Origin, c: usize, left: f64) -> f64 {
        let (value, shift) = (self.values[c], self.shifts[c][of.technique]);
        value + (left - value) * self.factors[j] + shift
    }
}
