//! What a run's diagnostics are made of.

use std::slice::ChunksExact;

use crate::lanes;
use crate::tail::Tail;

/// The tails of the contributions, and the agreement of samplers and pdfs.
#[derive(Debug, Clone, Default)]
pub struct Evidence {
    /// One for each component of each technique, a technique's side by side.
    pub(crate) tails: Vec<Tail>,
    /// Σ d and Σ d² over the samples of technique i, with d = p_k / Σ α_m p_m - 1, at i K + k.
    ///
    /// The mean of 1 + d over all samples, each technique by its share α_i, has the expectation
    /// ∫ p_k = 1, if every technique samples the pdf that it states and the pdf integrates to 1.
    /// NaN if some density left the range of `f64`; zeros where only one technique has samples,
    /// and where the weights are constant.
    pub(crate) densities: Vec<[f64; 2]>,
}

impl Evidence {
    /// Room for the evidence on `techniques` and their components; tails begin at `thresholds`.
    pub(crate) fn new(techniques: usize, thresholds: &[f64]) -> Self {
        Self {
            tails: thresholds.iter().copied().map(Tail::above).collect(),
            densities: vec![[0.0; 2]; techniques * techniques],
        }
    }

    /// Adds the densities at the samples of technique `i`. `rows` holds the pdfs of each technique
    /// and `inverse` has room for 1 / Σ α_k p_k.
    pub(super) fn densities(
        &mut self,
        i: usize,
        alpha: &[f64],
        rows: &ChunksExact<'_, f64>,
        inverse: &mut [f64],
    ) {
        let techniques = alpha.len();
        if alpha.iter().filter(|alpha| **alpha > 0.0).count() < 2 {
            return;
        }
        inverse.fill(0.0);
        for (row, alpha) in rows.clone().zip(alpha) {
            if *alpha > 0.0 {
                inverse.iter_mut().zip(row).for_each(|(sum, p)| *sum += alpha * p);
            }
        }
        for sum in inverse.iter_mut() {
            *sum = 1.0 / *sum;
        }
        let sums = self.densities.iter_mut().skip(i * techniques);
        for (([sum, squares], row), alpha) in sums.zip(rows.clone()).zip(alpha) {
            if *alpha > 0.0 {
                let [d, d2] = lanes::relative_sums(row, inverse);
                *sum += d;
                *squares += d2;
            }
        }
    }
}
