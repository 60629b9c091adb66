//! Batches of points of independent coordinates.

use super::InverseCdf;
use super::batch::ROWS;
use super::product::{at_least_1, is_final, ln_density};

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
