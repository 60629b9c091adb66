//! The loops of batch methods.

use super::{InverseCdf, open};
use crate::vectors::vectorised;

/// The rows of blocks on the stack.
pub(super) const ROWS: usize = 64;

/// The batch method of a technique that overrides [`InverseCdf::sample_slice`].
pub(super) fn sample(technique: &impl InverseCdf, xi: &[f64], xs: &mut Vec<f64>) {
    if xs.len() < xi.len() {
        xs.resize(xi.len(), 0.0);
    }
    technique.sample_slice(xi, &mut xs[..xi.len()]);
}

/// The point `place(u)` of each canonical number u of `xi`.
///
/// `place` should own what it reads: behind a reference, a write to `xs` might change it.
#[inline]
pub(super) fn places(xi: &[f64], xs: &mut [f64], place: impl Fn(f64) -> f64) {
    vectorised(
        #[inline(always)]
        move || {
            for (x, u) in xs.iter_mut().zip(xi) {
                *x = place(open(*u));
            }
        },
    );
}

/// One number of [`map`].
#[inline]
pub(super) fn one(x: f64, in_lanes: impl Fn(f64) -> f64, alone: impl Fn(f64) -> f64) -> f64 {
    let y = in_lanes(x);
    if y.is_nan() { alone(x) } else { y }
}

/// `out` is `in_lanes` of `xs`, and `alone` of those where that is NaN.
///
/// `in_lanes` should have no branches and be inlined, so that the loop becomes vector
/// instructions; what it would need a branch for it leaves to `alone`.
#[inline]
pub(super) fn map(
    xs: &[f64],
    out: &mut [f64],
    in_lanes: impl Fn(f64) -> f64,
    alone: impl Fn(f64) -> f64,
) {
    const LANES: usize = 8;
    let ys = &mut *out;
    vectorised(
        #[inline(always)]
        move || {
            for (y, x) in ys.iter_mut().zip(xs) {
                *y = in_lanes(*x);
            }
        },
    );
    for (ys, xs) in out.chunks_mut(LANES).zip(xs.chunks(LANES)) {
        if ys.iter().fold(false, |any, y| any | y.is_nan()) {
            for (y, x) in ys.iter_mut().zip(xs).filter(|(y, _)| y.is_nan()) {
                *y = alone(*x);
            }
        }
    }
}
