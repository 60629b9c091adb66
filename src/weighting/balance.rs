//! The balance heuristic.

use crate::lanes::LANES;

use super::{Densities, SAFE, Weighting};

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
        // Σ q_k in registers, eight points at a time; then the rest.
        let whole = out.len() - out.len() % LANES;
        let mut greatest = [0.0; LANES];
        for (chunk, out) in out.chunks_exact_mut(LANES).enumerate() {
            let mut c = [0.0; LANES];
            for (a, p) in q.rows() {
                for (c, p) in c.iter_mut().zip(&p.as_chunks::<LANES>().0[chunk]) {
                    *c += a * p;
                }
            }
            for ((out, greatest), c) in out.iter_mut().zip(&mut greatest).zip(c) {
                *greatest = if *greatest > c { *greatest } else { c };
                *out = c.recip();
            }
        }
        // A c that is too small has an infinite reciprocal, which shows; a c that is too large does
        // not. NaN stays NaN.
        let safe = greatest.iter().all(|c| *c < SAFE.end);
        let first = if safe { whole } else { 0 };
        for (j, out) in out.iter_mut().enumerate().skip(first) {
            let c: f64 = q.rows().map(|(a, p)| a * p[j]).sum();
            *out = if c < SAFE.end { c.recip() } else { f64::NAN };
        }
    }
}
