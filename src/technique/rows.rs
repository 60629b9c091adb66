//! Points of boxes: neighbouring coordinates of a point in the lanes of a vector.

#![expect(clippy::inline_always, reason = "what is not inlined is not compiled for the vectors")]

use fearless_simd::{Level, Simd, dispatch, f64x2, f64x4, f64x8, prelude::*};

use super::{LARGEST, SMALLEST, Uniform as Side, open};

/// Puts the canonical numbers of the rows of `xi`, moved into the open unit interval, to their
/// places between the sides.
pub(super) fn place<P: AsMut<[f64]>>(sides: &[Side], xi: &[f64], xs: &mut [P]) {
    dispatch!(Level::new(), simd => match sides.len() {
        ..2 => place_single(sides, xi, xs),
        2..4 => place_lanes::<_, f64x2<_>, P>(simd, sides, xi, xs),
        4..8 => place_lanes::<_, f64x4<_>, P>(simd, sides, xi, xs),
        8.. => place_lanes::<_, f64x8<_>, P>(simd, sides, xi, xs),
    });
}

/// 1 for each point that is between all sides, else 0.
pub(super) fn within<P: AsRef<[f64]>>(sides: &[Side], xs: &[P], out: &mut [f64]) {
    dispatch!(Level::new(), simd => match sides.len() {
        ..2 => within_single(sides, xs, out),
        2..4 => within_lanes::<_, f64x2<_>, P>(simd, sides, xs, out),
        4..8 => within_lanes::<_, f64x4<_>, P>(simd, sides, xs, out),
        8.. => within_lanes::<_, f64x8<_>, P>(simd, sides, xs, out),
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
fn ends<S: Simd, V: SimdFloat<S, Element = f64>>(simd: S, sides: &[Side]) -> (V, V) {
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
            let (lower, upper) = ends::<S, V>(simd, sides.get(at.clone()).unwrap_or_default());
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

/// Points of one coordinate: the lanes are the compiler's.
#[inline(always)]
fn place_single<P: AsMut<[f64]>>(sides: &[Side], xi: &[f64], xs: &mut [P]) {
    let Some(side) = sides.first() else { return };
    for (x, u) in xs.iter_mut().zip(xi) {
        x.as_mut().iter_mut().for_each(|x| *x = side.place(open(*u)));
    }
}

#[inline(always)]
fn within_single<P: AsRef<[f64]>>(sides: &[Side], xs: &[P], out: &mut [f64]) {
    let Some(side) = sides.first() else { return };
    for (out, x) in out.iter_mut().zip(xs) {
        let inside = x.as_ref().iter().all(|x| side.contains(*x));
        *out = if inside { 1.0 } else { 0.0 };
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
            let (lower, upper) = ends::<S, V>(simd, sides.get(at.clone()).unwrap_or_default());
            for (out, x) in out.iter_mut().zip(xs) {
                let Some(x) = x.as_ref().get(at.clone()) else { continue };
                let x = V::from_slice(simd, x);
                let inside = lower.simd_le(x) & x.simd_le(upper);
                *out = if inside.all_true() { *out } else { 0.0 };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{ProductVec, Technique, Uniform, UniformBox};

    /// Boxes of `d` sides: the unit cube, and one that is no cube.
    fn boxes(d: usize) -> [ProductVec<Uniform>; 2] {
        let sides = (0..d).map(|k| Uniform::new(-0.1 - k as f64, 0.2 + (k * k) as f64).unwrap());
        [ProductVec::new(vec![Uniform::unit(); d]), ProductVec::new(sides.collect())]
            .map(Result::unwrap)
    }

    /// As bits, which tell -0 from 0; all NaN are one.
    fn bits(x: f64) -> u64 {
        if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() }
    }

    #[test]
    fn places_are_those_of_single_points_to_the_bit() {
        let xi = |k: usize| match k % 19 {
            3 => 0.0,
            5 => 1.0,
            7 => f64::NAN,
            11 => -1.0,
            13 => 2.0,
            14 => 0.5,
            15 => 0.5 - f64::EPSILON / 4.0,
            k => (k as f64 * 0.618_033_988_749_894_9).fract(),
        };
        for d in 1..20 {
            for p in boxes(d) {
                for n in [0, 1, 63, 64, 65, 200] {
                    let xi: Vec<f64> = (0..n * d).map(xi).collect();
                    let mut xs = Vec::new();
                    p.sample_batch(&xi, &mut xs);
                    assert_eq!(xs.len(), n);
                    for (x, xi) in xs.iter().zip(xi.chunks(d)) {
                        let single = p.sample(xi);
                        assert!(x.iter().map(|x| bits(*x)).eq(single.iter().map(|x| bits(*x))));
                    }
                }
            }
        }
    }

    #[test]
    fn densities_are_those_of_single_points() {
        for d in 1..20 {
            for p in boxes(d) {
                let centre = p.sample(&vec![0.5; d]);
                // One coordinate at, before and beyond each end of its side; the first is outside.
                let mut xs = Vec::new();
                for (k, side) in p.coordinates().iter().enumerate() {
                    let (a, b) = side.ends();
                    for value in [a.next_down(), a, b, b.next_up(), f64::NAN, f64::INFINITY] {
                        let mut x = centre.clone();
                        x[k] = value;
                        xs.push(x);
                    }
                }
                let mut out = vec![f64::NAN; xs.len()];
                p.pdf_batch(&xs, &mut out);
                let single: Vec<f64> = xs.iter().map(|x| p.pdf(x)).collect();
                assert_eq!(out, single);
                assert_eq!(out.iter().filter(|p| **p > 0.0).count(), 2 * d);
            }
        }
    }

    /// 0 times infinity is NaN.
    #[test]
    fn outside_a_density_that_overflows_it_is_zero() {
        let p = UniformBox::uniform([0.0; 4], [1e-200; 4]).unwrap();
        let mut out = [f64::NAN; 2];
        p.pdf_batch(&[[0.0; 4], [1.0; 4]], &mut out);
        assert_eq!(out, [f64::INFINITY, 0.0]);
    }
}
