//! Points of boxes: neighbouring coordinates of a point in the lanes of a vector.

#![expect(clippy::inline_always, reason = "what is not inlined is not compiled for the vectors")]

use fearless_simd::{Level, Simd, dispatch, f64x4, f64x8, prelude::*};

use super::{LARGEST, SMALLEST, Uniform as Side};

/// The fewest coordinates that these functions are for.
pub(super) const FEWEST: usize = 4;

/// Puts the canonical numbers of the rows of `xi`, moved into the open unit interval, to their
/// places between the sides.
pub(super) fn place<P: AsMut<[f64]>>(
    sides: &[Side],
    xi: &[f64],
    xs: &mut [P],
) {
    dispatch!(Level::new(), simd => if sides.len() < 8 {
        place_lanes::<_, f64x4<_>, P>(simd, sides, xi, xs);
    } else {
        place_lanes::<_, f64x8<_>, P>(simd, sides, xi, xs);
    });
}

/// 1 for each point that is between all sides, else 0.
pub(super) fn within<P: AsRef<[f64]>>(
    sides: &[Side],
    xs: &[P],
    out: &mut [f64],
) {
    dispatch!(Level::new(), simd => if sides.len() < 8 {
        within_lanes::<_, f64x4<_>, P>(simd, sides, xs, out);
    } else {
        within_lanes::<_, f64x8<_>, P>(simd, sides, xs, out);
    });
}

/// The coordinates of the vectors that take in all of `dimension`; the last vector overlaps the one
/// before if it does not come out even.
#[inline(always)]
fn vectors(dimension: usize, lanes: usize) -> impl Iterator<Item = std::ops::Range<usize>> {
    let starts = (0..dimension).step_by(lanes);
    starts.map(move |at| at.min(dimension - lanes)).map(move |at| at..at + lanes)
}

/// The lower ends and the upper ends of coordinates.
#[inline(always)]
fn ends<S: Simd, V: SimdFloat<S, Element = f64>>(
    simd: S,
    sides: &[Side],
) -> (V, V) {
    let (mut lower, mut upper) = (V::splat(simd, 0.0), V::splat(simd, 0.0));
    let lanes = lower.as_mut_slice().iter_mut().zip(upper.as_mut_slice());
    lanes.zip(sides).for_each(|((lower, upper), side)| (*lower, *upper) = side.ends());
    (lower, upper)
}

/// How many points are gone over before the next coordinates are: they stay in the cache.
const ROWS: usize = 64;

#[inline(always)]
fn place_lanes<S: Simd, V: SimdFloat<S, Element = f64>, P: AsMut<[f64]>>(
    simd: S,
    sides: &[Side],
    xi: &[f64],
    xs: &mut [P],
) {
    let unit = sides.iter().all(|side| side.ends() == (0.0, 1.0));
    for (xs, xi) in xs.chunks_mut(ROWS).zip(xi.chunks(ROWS * sides.len())) {
        for at in vectors(sides.len(), V::LEN) {
            let (lower, upper) = ends::<S, V>(simd, &sides[at.clone()]);
            let width = upper - lower;
            for (x, xi) in xs.iter_mut().zip(xi.chunks_exact(sides.len())) {
                let (Some(x), Some(u)) = (x.as_mut().get_mut(at.clone()), xi.get(at.clone()))
                else {
                    continue;
                };
                let u = V::from_slice(simd, u);
                // NaN stays NaN.
                let u = u.simd_lt(SMALLEST).select(V::splat(simd, SMALLEST), u);
                let u = u.simd_gt(LARGEST).select(V::splat(simd, LARGEST), u);
                if unit {
                    // The places are the numbers, to the bit.
                    u.store_slice(x);
                    continue;
                }
                // From the nearer end, so that neither end is overshot by rounding.
                let from_lower = lower + u * width;
                let from_upper = upper - (V::splat(simd, 1.0) - u) * width;
                u.simd_lt(0.5).select(from_lower, from_upper).store_slice(x);
            }
        }
    }
}

#[inline(always)]
fn within_lanes<S: Simd, V: SimdFloat<S, Element = f64>, P: AsRef<[f64]>>(
    simd: S,
    sides: &[Side],
    xs: &[P],
    out: &mut [f64],
) {
    out.fill(1.0);
    for (xs, out) in xs.chunks(ROWS).zip(out.chunks_mut(ROWS)) {
        for at in vectors(sides.len(), V::LEN) {
            let (lower, upper) = ends::<S, V>(simd, &sides[at.clone()]);
            for (out, x) in out.iter_mut().zip(xs) {
                let Some(x) = x.as_ref().get(at.clone()) else { continue };
                let x = V::from_slice(simd, x);
                let inside = lower.simd_le(x) & x.simd_le(upper);
                *out = if inside.all_true() { *out } else { 0.0 };
            }
        }
    }
}
