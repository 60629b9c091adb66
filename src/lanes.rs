//! Reductions over slices in lanes, which vectorise where a running total would not.

#![expect(clippy::inline_always, reason = "what is not inlined is not compiled for the vectors")]

use fearless_simd::{Level, dispatch, f64x4, prelude::*};

use crate::integrand::Value;

pub(crate) const LANES: usize = 8;

/// What one pass over numbers x tells of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sums {
    /// Σ d, Σ d², Σ d³ with d = x - origin.
    pub(crate) powers: [f64; 3],
    /// The largest |x|; NaN may or may not be passed over.
    pub(crate) largest: f64,
    /// Whether any x may be 0: none is if not.
    pub(crate) zeros: bool,
}

/// The sums over the terms of [`Sums`], in four lanes.
#[derive(Clone, Copy)]
struct Summing<S: Simd> {
    shift: f64x4<S>,
    powers: [f64x4<S>; 3],
    largest: f64x4<S>,
    least: f64x4<S>,
}

impl<S: Simd> Summing<S> {
    #[inline(always)]
    fn about(simd: S, origin: f64) -> Self {
        let zero = f64x4::splat(simd, 0.0);
        Self {
            shift: f64x4::splat(simd, origin),
            powers: [zero; 3],
            largest: zero,
            least: f64x4::splat(simd, f64::INFINITY),
        }
    }

    #[inline(always)]
    fn add(&mut self, x: f64x4<S>) {
        let d = x - self.shift;
        let square = d * d;
        let [sum, squares, cubes] = &mut self.powers;
        *sum += d;
        *squares += square;
        *cubes += square * d;
        self.largest = self.largest.max(x.abs());
        self.least = self.least.min(x.abs());
    }

    /// Lanes are added pairwise.
    #[inline(always)]
    fn total(self) -> Sums {
        let lanes = |lanes: f64x4<S>| <[f64; 4]>::from(lanes);
        let pairwise = |sum: f64x4<S>| {
            let [a, b, c, d] = lanes(sum);
            (a + b) + (c + d)
        };
        Sums {
            powers: self.powers.map(pairwise),
            largest: lanes(self.largest).into_iter().fold(0.0, f64::max),
            zeros: lanes(self.least).into_iter().any(|least| !(least > 0.0)),
        }
    }
}

/// Sums of `xs` themselves.
pub(crate) fn sums_about(xs: &[f64], origin: f64) -> Sums {
    #[inline(always)]
    fn sums<S: Simd>(simd: S, xs: &[f64], origin: f64) -> Sums {
        let mut sums = Summing::about(simd, origin);
        let (chunks, rest) = xs.as_chunks::<4>();
        for chunk in chunks {
            sums.add(f64x4::simd_from(simd, *chunk));
        }
        if !rest.is_empty() {
            let mut last = [origin; 4];
            last.iter_mut().zip(rest).for_each(|(last, x)| *last = *x);
            sums.add(f64x4::simd_from(simd, last));
        }
        sums.total()
    }
    dispatch!(Level::new(), simd => sums(simd, xs, origin))
}

/// Puts component `c` of each value times its factor into `ys`, of the same length, and sums those
/// products about the first.
pub(crate) fn products<V: Value>(values: &[V], c: usize, factors: &[f64], ys: &mut [f64]) -> Sums {
    #[inline(always)]
    fn sums<S: Simd, V: Value>(
        simd: S,
        values: &[V],
        c: usize,
        factors: &[f64],
        ys: &mut [f64],
    ) -> Sums {
        let (Some(value), Some(factor)) = (values.first(), factors.first()) else {
            return Summing::about(simd, 0.0).total();
        };
        let origin = value.times(c, *factor);
        let mut sums = Summing::about(simd, origin);
        let (values, last_values) = values.as_chunks::<4>();
        let (factors, last_factors) = factors.as_chunks::<4>();
        let (ys, last_ys) = ys.as_chunks_mut::<4>();
        for ((y, value), factor) in ys.iter_mut().zip(values).zip(factors) {
            *y = std::array::from_fn(|lane| value[lane].times(c, factor[lane]));
            sums.add(f64x4::simd_from(simd, *y));
        }
        if !last_ys.is_empty() {
            let mut last = [origin; 4];
            for ((y, value), factor) in last.iter_mut().zip(last_values).zip(last_factors) {
                *y = value.times(c, *factor);
            }
            last_ys.iter_mut().zip(last).for_each(|(y, last)| *y = last);
            sums.add(f64x4::simd_from(simd, last));
        }
        sums.total()
    }
    dispatch!(Level::new(), simd => sums(simd, values, c, factors, ys))
}

/// Folds `step` over every eighth element into each of eight lanes.
#[inline]
fn fold<T: Copy>(xs: &[f64], start: T, step: impl Fn(T, f64) -> T) -> [T; LANES] {
    let mut lanes = [start; LANES];
    let mut chunks = xs.chunks_exact(LANES);
    for chunk in &mut chunks {
        for (lane, x) in lanes.iter_mut().zip(chunk) {
            *lane = step(*lane, *x);
        }
    }
    for (lane, x) in lanes.iter_mut().zip(chunks.remainder()) {
        *lane = step(*lane, *x);
    }
    lanes
}

/// Σ d and Σ d², with d = (x - origin) · unit computed as x · unit - origin · unit; lanes are added
/// pairwise.
#[inline]
pub(crate) fn sum_and_squares(xs: &[f64], origin: f64, unit: f64) -> (f64, f64) {
    let shift = origin * unit;
    let (mut sum, mut squares) = ([0.0; LANES], [0.0; LANES]);
    let (chunks, rest) = xs.as_chunks::<LANES>();
    let mut last = [origin; LANES];
    last.iter_mut().zip(rest).for_each(|(last, x)| *last = *x);
    for chunk in chunks.iter().chain([&last]) {
        for ((sum, squares), x) in sum.iter_mut().zip(&mut squares).zip(chunk) {
            let d = x * unit - shift;
            *sum += d;
            *squares += d * d;
        }
    }
    (pairwise(sum), pairwise(squares))
}

/// Σ d³ with d = (x - origin) · unit, likewise.
///
/// A pass of its own: next to the squares, the compiler would pair squares with cubes, and spend
/// more on shuffling them than one pass saves.
pub(crate) fn sum_of_cubes(xs: &[f64], origin: f64, unit: f64) -> f64 {
    let shift = origin * unit;
    pairwise(fold(xs, 0.0, |sum, x| sum + cube(x * unit - shift)))
}

fn cube(d: f64) -> f64 {
    d * d * d
}

/// Σ d and Σ d², with d = p · inverse - 1.
#[inline]
pub(crate) fn relative_sums(ps: &[f64], inverses: &[f64]) -> [f64; 2] {
    // A pass for each, as for the cubes.
    let d = |p: f64, inverse: f64| p * inverse - 1.0;
    [fold_pairs(ps, inverses, d), fold_pairs(ps, inverses, |p, inverse| d(p, inverse).powi(2))]
}

/// Σ `term`(x, y) in lanes.
#[inline]
fn fold_pairs(xs: &[f64], ys: &[f64], term: impl Fn(f64, f64) -> f64) -> f64 {
    let mut lanes = [0.0; LANES];
    let ((x_chunks, x_rest), (y_chunks, y_rest)) =
        (xs.as_chunks::<LANES>(), ys.as_chunks::<LANES>());
    for (xs, ys) in x_chunks.iter().zip(y_chunks) {
        for ((lane, x), y) in lanes.iter_mut().zip(xs).zip(ys) {
            *lane += term(*x, *y);
        }
    }
    for ((lane, x), y) in lanes.iter_mut().zip(x_rest).zip(y_rest) {
        *lane += term(*x, *y);
    }
    pairwise(lanes)
}

/// The first x of magnitude `magnitude`.
#[inline]
pub(crate) fn position_of_magnitude(xs: &[f64], magnitude: f64) -> Option<usize> {
    let is = |x: &f64| x.abs() == magnitude;
    // Whole chunks are compared without a branch for each element.
    let chunks = xs.as_chunks::<LANES>().0;
    let missed = |chunk: &&[f64; LANES]| !chunk.iter().fold(false, |found, x| found | is(x));
    let skipped = LANES * chunks.iter().take_while(missed).count();
    xs.iter().skip(skipped).position(is).map(|at| skipped + at)
}

fn pairwise([a, b, c, d, e, f, g, h]: [f64; LANES]) -> f64 {
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}

/// The least element; infinite for an empty slice. NaN may or may not be passed over.
pub(crate) fn least(xs: &[f64]) -> f64 {
    #[inline(always)]
    fn lanes<S: Simd>(simd: S, chunks: &[[f64; 4 * LANES]]) -> [f64; 4] {
        let mut least = [f64x4::splat(simd, f64::INFINITY); 4];
        for chunk in chunks {
            for (eight, least) in chunk.as_chunks::<LANES>().0.iter().zip(&mut least) {
                for four in eight.as_chunks::<4>().0 {
                    *least = least.min(f64x4::simd_from(simd, *four));
                }
            }
        }
        let [a, b, c, d] = least;
        a.min(b).min(c.min(d)).into()
    }
    let (chunks, rest) = xs.as_chunks();
    let lanes = dispatch!(Level::new(), simd => lanes(simd, chunks));
    rest.iter().chain(&lanes).fold(f64::INFINITY, |least, x| if least < *x { least } else { *x })
}

#[cfg(test)]
mod tests {
    use super::{least, sum_and_squares, sum_of_cubes, sums_about};
    use super::{position_of_magnitude, relative_sums};

    #[test]
    fn every_element_counts_at_every_length() {
        for n in 1..40_u32 {
            let xs: Vec<f64> = (0..n).map(f64::from).collect();
            let exact = f64::from(n * (n - 1)) / 2.0;
            let squares = f64::from(n * (n - 1) * (2 * n - 1)) / 6.0;
            let cubes = exact * exact;
            let n = f64::from(n);
            let shifted_cubes = cubes - 3.0 * squares + 3.0 * exact - n;
            assert_eq!(sum_and_squares(&xs, 0.0, 1.0), (exact, squares));
            assert_eq!(sums_about(&xs, 0.0).powers, [exact, squares, cubes]);
            assert_eq!(sums_about(&xs, 1.0).powers[2], shifted_cubes);
            assert_eq!(sum_of_cubes(&xs, 0.0, 0.5), cubes / 8.0);
            let shifted = (exact - n, squares - 2.0 * exact + n);
            assert_eq!(sum_and_squares(&xs, 1.0, 1.0), shifted);
            assert_eq!(sum_of_cubes(&xs, 1.0, 1.0), shifted_cubes);
            for at in 0..xs.len() {
                let with = |x: f64| {
                    let mut xs = xs.clone();
                    xs[at] = x;
                    xs
                };
                assert_eq!(least(&with(-1.0)), -1.0);
                assert_eq!(sums_about(&with(-100.0), 0.0).largest, 100.0);
                let positive: Vec<f64> = xs.iter().map(|x| x + 1.0).collect();
                assert!(!sums_about(&positive, 3.0).zeros && sums_about(&xs, 3.0).zeros);
                for bad in [0.0, -0.0] {
                    let mut ys = positive.clone();
                    ys[at] = bad;
                    assert!(sums_about(&ys, 3.0).zeros, "{at} of {n}");
                }
            }
            assert_eq!(least(&xs), 0.0);
        }
    }

    #[test]
    fn pairs_are_summed_at_every_length() {
        for n in 1..40_u32 {
            let ps: Vec<f64> = (0..n).map(f64::from).collect();
            let inverses = vec![0.5; ps.len()];
            let sum = f64::from(n * (n - 1)) / 4.0 - f64::from(n);
            let squares: f64 = ps.iter().map(|p| (p / 2.0 - 1.0).powi(2)).sum();
            assert_eq!(relative_sums(&ps, &inverses), [sum, squares]);
        }
    }

    #[test]
    fn the_first_of_a_magnitude_is_found() {
        for n in 1..40 {
            for at in 0..n {
                let mut xs = vec![1.0; n];
                xs[at] = -2.0;
                xs[n - 1] = if at < n - 1 { 2.0 } else { xs[n - 1] };
                assert_eq!(position_of_magnitude(&xs, 2.0), Some(at));
                assert_eq!(position_of_magnitude(&xs, 3.0), None);
            }
        }
    }
}
