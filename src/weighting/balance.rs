//! The balance heuristic.

use fearless_simd::{Level, dispatch, f64x4, prelude::*};

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
        reciprocal_sums(&q.rows(), out);
    }
}

/// 1 / Σ a_k p_k at every point of a block; infinite or NaN where the sum leaves the range.
#[inline]
pub(super) fn reciprocal_sums<'a>(
    rows: &(impl Iterator<Item = (f64, &'a [f64])> + Clone),
    out: &mut [f64],
) {
    let greatest = dispatch!(Level::new(), simd => by_groups(simd, rows, out));
    let whole = out.len() - out.len() % POINTS;
    // A c that is too small has an infinite reciprocal, which shows; a c that is too large does
    // not. NaN stays NaN.
    let safe = greatest.iter().all(|c| *c < SAFE.end);
    let first = if safe { whole } else { 0 };
    for (j, out) in out.iter_mut().enumerate().skip(first) {
        let c: f64 = rows.clone().map(|(a, p)| a * p[j]).sum();
        *out = if c < SAFE.end { c.recip() } else { f64::NAN };
    }
}

/// How many points are summed side by side.
const POINTS: usize = 32;

/// 1 / Σ a_k p_k at as many points as there are whole groups of; returns the greatest sum in each of
/// four lanes.
#[expect(clippy::inline_always, reason = "what is not inlined is not compiled for the vectors")]
#[inline(always)]
fn by_groups<'a, S: Simd>(
    simd: S,
    rows: &(impl Iterator<Item = (f64, &'a [f64])> + Clone),
    out: &mut [f64],
) -> [f64; 4] {
    let mut greatest = f64x4::splat(simd, 0.0);
    for (chunk, out) in out.as_chunks_mut::<POINTS>().0.iter_mut().enumerate() {
        let mut c = [f64x4::splat(simd, 0.0); POINTS / 4];
        // A copy of an iterator that is made costs less than to make it.
        for (a, p) in rows.clone() {
            if let Some(p) = p.get(chunk * POINTS..).and_then(<[f64]>::first_chunk::<POINTS>) {
                for (c, p) in c.iter_mut().zip(p.as_chunks::<4>().0) {
                    *c += f64x4::simd_from(simd, *p) * a;
                }
            }
        }
        for (out, c) in out.as_chunks_mut::<4>().0.iter_mut().zip(c) {
            greatest = greatest.max(c);
            *out = (1.0 / c).into();
        }
    }
    greatest.into()
}
