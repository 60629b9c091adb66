//! The balance heuristic.

use wide::f64x4;

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
        reciprocal_sums(|| q.rows(), out);
    }
}

/// 1 / Σ a_k p_k at every point of a block; infinite or NaN where the sum leaves the range.
#[inline]
pub(super) fn reciprocal_sums<'a, I>(rows: impl Fn() -> I, out: &mut [f64])
where
    I: Iterator<Item = (f64, &'a [f64])>,
{
    // The sums in registers, sixteen points at a time; then the rest.
    const POINTS: usize = 16;
    let whole = out.len() - out.len() % POINTS;
    let mut greatest = f64x4::ZERO;
    for (chunk, out) in out.as_chunks_mut::<POINTS>().0.iter_mut().enumerate() {
        let mut c = [f64x4::ZERO; POINTS / 4];
        for (a, p) in rows() {
            if let Some(p) = p.get(chunk * POINTS..).and_then(<[f64]>::first_chunk::<POINTS>) {
                for (c, p) in c.iter_mut().zip(p.as_chunks::<4>().0) {
                    *c += f64x4::splat(a) * f64x4::new(*p);
                }
            }
        }
        for (out, c) in out.as_chunks_mut::<4>().0.iter_mut().zip(c) {
            greatest = greatest.fast_max(c);
            *out = (f64x4::ONE / c).to_array();
        }
    }
    // A c that is too small has an infinite reciprocal, which shows; a c that is too large does
    // not. NaN stays NaN.
    let safe = greatest.to_array().iter().all(|c| *c < SAFE.end);
    let first = if safe { whole } else { 0 };
    for (j, out) in out.iter_mut().enumerate().skip(first) {
        let c: f64 = rows().map(|(a, p)| a * p[j]).sum();
        *out = if c < SAFE.end { c.recip() } else { f64::NAN };
    }
}
