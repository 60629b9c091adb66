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
        let (mut least, mut greatest) = ([f64::INFINITY; LANES], [0.0; LANES]);
        for (chunk, out) in out.chunks_exact_mut(LANES).enumerate() {
            let mut c = [0.0; LANES];
            for (a, p) in q.rows() {
                for (c, p) in c.iter_mut().zip(&p.as_chunks::<LANES>().0[chunk]) {
                    *c += a * p;
                }
            }
            for j in 0..LANES {
                least[j] = if least[j] < c[j] { least[j] } else { c[j] };
                greatest[j] = if greatest[j] > c[j] { greatest[j] } else { c[j] };
                out[j] = c[j].recip();
            }
        }
        let factor = |c: f64| if SAFE.contains(&c) { c.recip() } else { f64::NAN };
        let safe = least.iter().chain(&greatest).all(|c| SAFE.contains(c));
        let first = if safe { whole } else { 0 };
        for (j, out) in out.iter_mut().enumerate().skip(first) {
            *out = factor(q.rows().map(|(a, p)| a * p[j]).sum());
        }
    }
}
