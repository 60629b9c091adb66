//! Reductions over slices in lanes, which vectorise where a running total would not.

pub(crate) const LANES: usize = 8;

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

/// Σ d³ with d = x - origin, and the largest magnitude of x; NaN may or may not be passed over.
#[inline(never)]
pub(crate) fn sum_of_cubes_and_largest(xs: &[f64], origin: f64) -> (f64, f64) {
    let lanes = fold(xs, (0.0, 0.0), |(sum, most), x| {
        (sum + cube(x - origin), if most > x.abs() { most } else { x.abs() })
    });
    (pairwise(lanes.map(|lane| lane.0)), lanes.into_iter().map(|lane| lane.1).fold(0.0, f64::max))
}

fn cube(d: f64) -> f64 {
    d * d * d
}

/// Σ d and Σ d², with d = p · inverse - 1.
#[inline]
pub(crate) fn relative_sums(ps: &[f64], inverses: &[f64]) -> [f64; 2] {
    let mut sums = [[0.0; LANES]; 2];
    let [first, second] = &mut sums;
    let (chunks, rest) = ps.as_chunks::<LANES>();
    let (inverse_chunks, inverse_rest) = inverses.as_chunks::<LANES>();
    for (chunk, inverse) in chunks.iter().zip(inverse_chunks) {
        for l in 0..LANES {
            let d = chunk[l] * inverse[l] - 1.0;
            first[l] += d;
            second[l] += d * d;
        }
    }
    for (l, (p, inverse)) in rest.iter().zip(inverse_rest).enumerate() {
        let d = p * inverse - 1.0;
        first[l] += d;
        second[l] += d * d;
    }
    sums.map(pairwise)
}

fn pairwise([a, b, c, d, e, f, g, h]: [f64; LANES]) -> f64 {
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}

/// The least element; infinite for an empty slice. NaN may or may not be passed over.
#[inline]
pub(crate) fn least(xs: &[f64]) -> f64 {
    let lanes = fold(xs, f64::INFINITY, |least, x| if least < x { least } else { x });
    lanes.into_iter().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::{least, sum_and_squares, sum_of_cubes, sum_of_cubes_and_largest};

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
            assert_eq!(sum_of_cubes_and_largest(&xs, 0.0).0, cubes);
            assert_eq!(sum_of_cubes_and_largest(&xs, 1.0).0, shifted_cubes);
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
                assert_eq!(sum_of_cubes_and_largest(&with(-100.0), 0.0).1, 100.0);
            }
            assert_eq!(least(&xs), 0.0);
        }
    }
}
