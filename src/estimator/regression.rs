//! Least squares over any number of rows.

use nalgebra::{DMatrix, DVector};

/// Rows are folded into the triangle so many at a time.
const ROWS: usize = 256;

/// A column whose part beside the intercept is this small is one of rounding errors.
const NOISE: f64 = 16.0 * f64::EPSILON;

/// The least squares of several responses y on regressors z and an intercept.
///
/// Rows \[1, z, y\] are folded, a block at a time, into the triangle of their QR factorisation by
/// Householder reflections: forming Z'Z would square the condition number, and techniques that
/// resemble each other make it large. The first column takes the means out of the others; these are
/// then scaled, and solved with pivoting, so that a column that depends on others is left out.
///
/// Source: G. H. Golub and C. F. Van Loan, *Matrix Computations*, 4th edition, 2013, sections 5.2 to
/// 5.5; J. Demmel, L. Grigori, M. Hoemmen and J. Langou, *Communication-optimal Parallel and
/// Sequential QR and LU Factorizations*, 2012, doi:10.1137/080731992, for the folding of blocks.
#[derive(Debug, Clone)]
pub(crate) struct Regression {
    regressors: usize,
    responses: usize,
    rows: u64,
    /// Rows that are still to be folded, one after the other.
    pending: Vec<f64>,
    /// Upper triangular.
    triangle: DMatrix<f64>,
    /// Responses are held in units of 2^exponent.
    exponents: Vec<i32>,
}

/// What a regression finds.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Solution {
    /// A row for each response, a coefficient for each regressor; 0 for those that are left out.
    pub(crate) coefficients: Vec<Vec<f64>>,
    /// How many regressors are not left out.
    pub(crate) rank: usize,
}

impl Regression {
    pub(crate) fn new(regressors: usize, responses: usize) -> Self {
        Self {
            regressors,
            responses,
            rows: 0,
            pending: Vec::new(),
            triangle: DMatrix::zeros(0, 1 + regressors + responses),
            exponents: vec![i32::MIN; responses],
        }
    }

    /// Adds a row, times `weight`.
    pub(crate) fn push(
        &mut self,
        weight: f64,
        regressors: impl IntoIterator<Item = f64>,
        responses: impl IntoIterator<Item = f64>,
    ) {
        self.pending.push(weight);
        self.pending.extend(regressors.into_iter().take(self.regressors).map(|z| weight * z));
        for (y, exponent) in responses.into_iter().zip(&mut self.exponents) {
            if *exponent == i32::MIN && y != 0.0 {
                *exponent = libm::frexp(y).1.clamp(-1020, 1020);
            }
            self.pending.push(weight * libm::ldexp(y, -unset_as_0(*exponent)));
        }
        self.rows += 1;
        if self.pending.len() >= ROWS * self.triangle.ncols() {
            self.fold();
        }
    }

    /// How many rows there are.
    pub(crate) fn rows(&self) -> u64 {
        self.rows
    }

    /// Adds the rows of another one, of the same shape.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.fold();
        let mut other = other.clone();
        other.fold();
        for c in 0..self.responses {
            let (own, others) = (self.exponents[c], other.exponents[c]);
            if own == i32::MIN {
                self.exponents[c] = others;
            } else if others != i32::MIN {
                let shift = libm::ldexp(1.0, others - own);
                other.triangle.column_mut(1 + self.regressors + c).scale_mut(shift);
            }
        }
        self.rows += other.rows;
        let rows =
            other.triangle.row_iter().flat_map(|row| row.iter().copied().collect::<Vec<_>>());
        self.pending.extend(rows);
        self.fold();
    }

    fn fold(&mut self) {
        let columns = self.triangle.ncols();
        let added = self.pending.len() / columns;
        if added == 0 {
            return;
        }
        let held = self.triangle.nrows();
        let mut stacked = DMatrix::zeros(held + added, columns);
        stacked.rows_mut(0, held).copy_from(&self.triangle);
        stacked.rows_mut(held, added).copy_from(&DMatrix::from_row_slice(
            added,
            columns,
            &self.pending,
        ));
        self.triangle = stacked.qr().r();
        self.pending.clear();
    }

    /// The coefficients that leave the least squares; `None` if they are not finite.
    pub(crate) fn solve(&self) -> Option<Solution> {
        let mut folded = self.clone();
        folded.fold();
        let (m, columns) = (self.regressors, self.triangle.ncols());
        // Of fewer rows than columns, the rest of the triangle is 0.
        let r = folded.triangle.resize_vertically(columns, 0.0);
        let mean_row = r[(0, 0)].abs();
        let beside = |k: usize| r.view((1, k), (columns - 1, 1)).norm();
        let kept: Vec<(usize, f64)> = (1..=m)
            .map(|k| (k, beside(k)))
            .filter(|(k, norm)| *norm > NOISE * r[(0, *k)].abs().max(mean_row))
            .collect();
        let scaled = DMatrix::from_fn(m, kept.len(), |row, at| {
            let (k, norm) = kept[at];
            r[(row + 1, k)] / norm
        });
        let mut coefficients = vec![vec![0.0; m]; self.responses];
        let mut rank = 0;
        if !kept.is_empty() {
            let factors = scaled.col_piv_qr();
            let (q, triangle) = (factors.q(), factors.r());
            let largest = triangle[(0, 0)].abs();
            rank = (0..kept.len().min(m))
                .take_while(|j| triangle[(*j, *j)].abs() > NOISE * largest)
                .count();
            let solvable = triangle.view((0, 0), (rank, rank)).into_owned();
            for (c, row) in coefficients.iter_mut().enumerate() {
                let y = r.view((1, 1 + m + c), (m, 1));
                let right: DVector<f64> = q.columns(0, rank).tr_mul(&y).column(0).into_owned();
                let solved = solvable.solve_upper_triangular(&right)?;
                let mut all = DVector::zeros(kept.len());
                all.rows_mut(0, rank).copy_from(&solved);
                factors.p().inv_permute_rows(&mut all);
                for ((k, norm), beta) in kept.iter().zip(all.iter()) {
                    row[k - 1] = libm::ldexp(beta / norm, unset_as_0(self.exponents[c]));
                }
            }
        }
        let finite = coefficients.iter().flatten().all(|beta| beta.is_finite());
        finite.then_some(Solution { coefficients, rank })
    }
}

/// The exponent of a response that has been 0 so far does not matter.
fn unset_as_0(exponent: i32) -> i32 {
    if exponent == i32::MIN { 0 } else { exponent }
}

#[cfg(test)]
mod tests {
    use super::{Regression, Solution};

    /// Rows of x, x² and, as responses, what `of` makes of x.
    fn fitted<const C: usize>(of: impl Fn(f64) -> [f64; C], rows: u32) -> Solution {
        let mut fit = Regression::new(2, C);
        for j in 0..rows {
            let x = f64::from(j) / f64::from(rows);
            fit.push(1.0, [x, x * x], of(x));
        }
        fit.solve().unwrap()
    }

    #[test]
    fn what_is_in_the_span_is_found() {
        for scale in [1.0, 1e-200, 1e200] {
            let exact = fitted(|x| [scale * (3.0 + 2.0 * x - 5.0 * x * x), scale * x], 1000);
            assert_eq!(exact.rank, 2);
            for (row, expected) in exact.coefficients.iter().zip([[2.0, -5.0], [1.0, 0.0]]) {
                for (beta, expected) in row.iter().zip(expected) {
                    assert!((beta / scale - expected).abs() < 1e-12, "{scale}: {beta} {expected}");
                }
            }
        }
    }

    #[test]
    fn residuals_are_orthogonal_to_the_regressors() {
        let solution = fitted(|x| [x.exp()], 777);
        let row = &solution.coefficients[0];
        let xs = || (0..777).map(|j| f64::from(j) / 777.0);
        let left = |x: f64| x.exp() - row[0] * x - row[1] * x * x;
        let mean = xs().map(left).sum::<f64>() / 777.0;
        for power in [1, 2] {
            let product: f64 = xs().map(|x| (left(x) - mean) * x.powi(power)).sum();
            assert!(product.abs() < 1e-10, "{power}: {product}");
        }
    }

    #[test]
    fn parts_of_the_rows_are_as_good_as_all() {
        let of = |range: std::ops::Range<u32>, scale: f64| {
            let mut fit = Regression::new(2, 1);
            for j in range {
                let x = f64::from(j) / 1000.0;
                fit.push(1.0 + x, [x, x.sqrt()], [scale * (x - 0.31).abs()]);
            }
            fit
        };
        let whole = of(0..1000, 1e180).solve().unwrap();
        for cut in [0, 1, 310, 500, 1000] {
            let mut left = of(0..cut, 1e180);
            left.merge(&of(cut..1000, 1e180));
            assert_eq!(left.rows(), 1000);
            let found = left.solve().unwrap();
            for (a, b) in found.coefficients[0].iter().zip(&whole.coefficients[0]) {
                assert!((a / b - 1.0).abs() < 1e-11, "{cut}: {a} {b}");
            }
        }
    }

    #[test]
    fn weights_are_repeated_rows() {
        let (mut once, mut thrice) = (Regression::new(1, 1), Regression::new(1, 1));
        for (x, y, times) in [(0.0, 1.0, 1), (1.0, 4.0, 3), (2.0, 3.0, 2)] {
            once.push(f64::from(times).sqrt(), [x], [y]);
            (0..times).for_each(|_| thrice.push(1.0, [x], [y]));
        }
        let [a, b] = [once, thrice].map(|fit| fit.solve().unwrap().coefficients[0][0]);
        assert!((a - b).abs() < 1e-14, "{a} {b}");
    }

    #[test]
    fn dependent_columns_are_left_out() {
        let mut fit = Regression::new(4, 1);
        for j in 0..300 {
            let x = f64::from(j) / 300.0;
            // A constant, a column twice, and one of rounding errors.
            fit.push(1.0, [7.0, x, x, 1e-17 * (f64::from(j % 7) - 3.0)], [2.0 * x + 1.0]);
        }
        let Solution { coefficients, rank } = fit.solve().unwrap();
        let row = &coefficients[0];
        assert_eq!((rank, row[0], row[3]), (1, 0.0, 0.0));
        assert!((row[1] + row[2] - 2.0).abs() < 1e-12, "{row:?}");
    }

    #[test]
    fn too_few_rows_leave_columns_out() {
        assert_eq!(Regression::new(2, 1).solve().unwrap().rank, 0);
        let mut fit = Regression::new(2, 1);
        fit.push(1.0, [1.0, 2.0], [3.0]);
        assert_eq!(fit.solve().unwrap().rank, 0);
        fit.push(1.0, [2.0, 2.5], [5.0]);
        let Solution { coefficients, rank } = fit.solve().unwrap();
        let row = &coefficients[0];
        assert_eq!(rank, 1);
        assert!((row[0] + 0.5 * row[1] - 2.0).abs() < 1e-12, "{row:?}");
    }

    #[test]
    fn what_is_not_finite_has_no_solution() {
        let mut fit = Regression::new(1, 1);
        fit.push(1.0, [f64::NAN], [1.0]);
        fit.push(1.0, [1.0], [2.0]);
        assert_eq!(fit.solve().map(|s| s.rank).unwrap_or(0), 0);
    }
}
