//! Reductions over slices in eight lanes, which vectorise where a running total would not.

pub(crate) const LANES: usize = 8;

/// Folds `step` over every eighth element into each of eight lanes.
#[inline]
fn fold(xs: &[f64], start: f64, step: impl Fn(f64, f64) -> f64) -> [f64; LANES] {
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
    let pairwise =
        |[a, b, c, d, e, f, g, h]: [f64; LANES]| ((a + b) + (c + d)) + ((e + f) + (g + h));
    (pairwise(sum), pairwise(squares))
}

/// The least element; infinite for an empty slice. NaN may or may not be passed over.
#[inline]
pub(crate) fn least(xs: &[f64]) -> f64 {
    let lanes = fold(xs, f64::INFINITY, |least, x| if least < x { least } else { x });
    lanes.into_iter().fold(f64::INFINITY, f64::min)
}

/// The largest magnitude; 0 for an empty slice. NaN may or may not be passed over.
#[inline]
pub(crate) fn largest_magnitude(xs: &[f64]) -> f64 {
    let lanes = fold(xs, 0.0, |most, x| if most > x.abs() { most } else { x.abs() });
    lanes.into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::{largest_magnitude, least, sum_and_squares};

    #[test]
    fn every_element_counts_at_every_length() {
        for n in 1..40_u32 {
            let xs: Vec<f64> = (0..n).map(f64::from).collect();
            let exact = f64::from(n * (n - 1)) / 2.0;
            let squares = f64::from(n * (n - 1) * (2 * n - 1)) / 6.0;
            assert_eq!(sum_and_squares(&xs, 0.0, 1.0), (exact, squares));
            let shifted = (exact - f64::from(n), squares - 2.0 * exact + f64::from(n));
            assert_eq!(sum_and_squares(&xs, 1.0, 1.0), shifted);
            for at in 0..xs.len() {
                let with = |x: f64| {
                    let mut xs = xs.clone();
                    xs[at] = x;
                    xs
                };
                assert_eq!(least(&with(-1.0)), -1.0);
                assert_eq!(largest_magnitude(&with(-100.0)), 100.0);
            }
            assert_eq!(least(&xs), 0.0);
        }
    }
}
