//! The balance heuristic.

use super::{Densities, Weighting};

/// The balance heuristic, w_i = q_i / Σ q_k.
///
/// A sample of any technique contributes f / Σ q_k, so only the union of the supports must cover
/// f. For f ≥ 0, no non-negative weights have a variance that is lower by more than
/// (1 / min n_i - 1 / N) μ². Cost: every pdf at every sample.
///
/// Source: Veach and Guibas 1995, theorem 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Balance;

impl Weighting for Balance {
    #[inline]
    fn weight_over_ratio(&self, _: usize, r: &[f64]) -> f64 {
        r.iter().sum::<f64>().recip()
    }

    fn weight_over_density_batch(
        &self,
        _: usize,
        q: &Densities<'_>,
        _: &mut [f64],
        out: &mut [f64],
    ) {
        let mut rows = q.rows();
        if let Some(first) = rows.next() {
            out.copy_from_slice(first);
        }
        for row in rows {
            for (c, q) in out.iter_mut().zip(row) {
                *c += q;
            }
        }
        for c in out {
            *c = if super::SAFE.contains(c) { c.recip() } else { f64::NAN };
        }
    }
}
