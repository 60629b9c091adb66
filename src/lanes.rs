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

/// Σ d, Σ d² and Σ d³, with d = (x - origin) · unit computed as x · unit - origin · unit; lanes are
/// added pairwise.
#[inline]
pub(crate) fn power_sums(xs: &[f64], origin: f64, unit: f64) -> [f64; 3] {
    let shift = origin * unit;
    let mut sums = [[0.0; LANES]; 3];
    let [first, second, third] = &mut sums;
    let (chunks, rest) = xs.as_chunks::<LANES>();
    let mut last = [origin; LANES];
    last.iter_mut().zip(rest).for_each(|(last, x)| *last = *x);
    for chunk in chunks.iter().chain([&last]) {
        for l in 0..LANES {
            let d = chunk[l] * unit - shift;
            let square = d * d;
            first[l] += d;
            second[l] += square;
            third[l] += square * d;
        }
    }
    sums.map(pairwise)
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

/// The largest magnitude; 0 for an empty slice. NaN may or may not be passed over.
#[inline]
pub(crate) fn largest_magnitude(xs: &[f64]) -> f64 {
    let lanes = fold(xs, 0.0, |most, x| if most > x.abs() { most } else { x.abs() });
    lanes.into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::{largest_magnitude, least, power_sums};

    #[test]
    fn every_element_counts_at_every_length() {
        for n in 1..40_u32 {
            let xs: Vec<f64> = (0..n).map(f64::from).collect();
            let exact = f64::from(n * (n - 1)) / 2.0;
            let squares = f64::from(n * (n - 1) * (2 * n - 1)) / 6.0;
            let cubes = exact * exact;
            assert_eq!(power_sums(&xs, 0.0, 1.0), [exact, squares, cubes]);
            let n = f64::from(n);
            let shifted_cubes = cubes - 3.0 * squares + 3.0 * exact - n;
            let shifted = [exact - n, squares - 2.0 * exact + n, shifted_cubes];
            assert_eq!(power_sums(&xs, 1.0, 1.0), shifted);
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
