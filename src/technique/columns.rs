//! Densities of points of independent coordinates, and batches of such points.

use super::InverseCdf;
use super::batch::ROWS;

/// The points of the rows of `xi`, a coordinate at a time; no more rows than points.
pub(super) fn fill_columns<T: InverseCdf, P: AsMut<[f64]>>(
    coordinates: &[T],
    xi: &[f64],
    xs: &mut [P],
) {
    let dimension = coordinates.len();
    let (mut us, mut column) = ([0.0; ROWS], [0.0; ROWS]);
    for (xi, xs) in xi.chunks(ROWS * dimension).zip(xs.chunks_mut(ROWS)) {
        let (us, column) = (&mut us[..xs.len()], &mut column[..xs.len()]);
        for (d, t) in coordinates.iter().enumerate() {
            for (u, xi) in us.iter_mut().zip(xi.chunks_exact(dimension)) {
                *u = xi[d];
            }
            t.sample_slice(us, column);
            for (x, value) in xs.iter_mut().zip(&*column) {
                x.as_mut()[d] = *value;
            }
        }
    }
}

/// The density at every point, a coordinate at a time.
pub(super) fn densities<T: InverseCdf, P: AsRef<[f64]>>(
    coordinates: &[T],
    xs: &[P],
    out: &mut [f64],
) {
    let (mut column, mut factors, mut large) = ([0.0; ROWS], [0.0; ROWS], [0.0; ROWS]);
    for (xs, out) in xs.chunks(ROWS).zip(out.chunks_mut(ROWS)) {
        let (column, factors) = (&mut column[..xs.len()], &mut factors[..xs.len()]);
        let large = &mut large[..xs.len()];
        out.fill(1.0);
        large.fill(1.0);
        for (d, t) in coordinates.iter().enumerate() {
            for (value, x) in column.iter_mut().zip(xs) {
                *value = x.as_ref()[d];
            }
            t.pdf_batch(column, factors);
            for ((p, large), factor) in out.iter_mut().zip(&mut *large).zip(&*factors) {
                (*p, *large) = (*p * factor, *large * at_least_1(*factor));
            }
        }
        for ((p, large), x) in out.iter_mut().zip(&*large).zip(xs) {
            if !is_final(*p, *large) {
                *p = ln_density(coordinates, x.as_ref()).exp();
            }
        }
    }
}

pub(super) fn density<T: InverseCdf>(coordinates: &[T], x: &[f64]) -> f64 {
    let (mut p, mut large) = (1.0, 1.0);
    for (t, x) in coordinates.iter().zip(x) {
        let factor = t.pdf(x);
        (p, large) = (p * factor, large * at_least_1(factor));
    }
    // An underflow on the way, an overflow, or NaN, their product: let the logarithms decide.
    if is_final(p, large) { p } else { ln_density(coordinates, x).exp() }
}

/// Whether a product p of densities is what it seems; `large` is the product of those above 1.
///
/// A product that came to 0 was less than 2^-1074 at some point, or a factor was; no more than
/// `large` can have been lost, so that it is less than any normal number.
fn is_final(p: f64, large: f64) -> bool {
    const MOST: f64 = (1_u64 << 50) as f64;
    p.is_normal() || (p == 0.0 && large < MOST)
}

/// 1 for NaN.
#[inline]
fn at_least_1(factor: f64) -> f64 {
    if factor > 1.0 { factor } else { 1.0 }
}

pub(super) fn ln_density<T: InverseCdf>(coordinates: &[T], x: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (t, x) in coordinates.iter().zip(x) {
        let ln_p = t.ln_pdf(x);
        // Outside one support is outside the product's, also where another density is infinite.
        if ln_p == f64::NEG_INFINITY {
            return ln_p;
        }
        sum += ln_p;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::{at_least_1, is_final};

    #[test]
    fn which_products_are_final() {
        let most = 2_f64.powi(50);
        for (p, large, is) in [
            (1e-300, f64::INFINITY, true),
            (0.0, 1.0, true),
            (0.0, most, false),
            (1e-310, 1.0, false),
            (f64::INFINITY, f64::INFINITY, false),
            (f64::NAN, 1.0, false),
        ] {
            assert_eq!(is_final(p, large), is, "{p} {large}");
        }
        assert_eq!([0.5, 2.0, f64::NAN].map(at_least_1), [1.0, 2.0, 1.0]);
    }
}
