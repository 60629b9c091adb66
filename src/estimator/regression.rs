//! Least squares over any number of rows.

use nalgebra::{DMatrix, DVector, Dyn, PermutationSequence};

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
    /// Rows with a response that is not 0.
    informative: u64,
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
            informative: 0,
            pending: Vec::new(),
            triangle: DMatrix::zeros(0, 1 + regressors + responses),
            exponents: vec![UNSET; responses],
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
        let start = self.pending.len();
        self.pending.extend(responses.into_iter().take(self.responses).map(|y| weight * y));
        self.rows += 1;
        self.informative += u64::from(self.pending[start..].iter().any(|y| *y != 0.0));
        if self.pending.len() >= ROWS * self.triangle.ncols() {
            self.fold();
        }
    }

    /// How many rows there are.
    pub(crate) fn rows(&self) -> u64 {
        self.rows
    }

    /// How many have a response that is not 0.
    pub(crate) fn informative(&self) -> u64 {
        self.informative
    }

    /// Adds the rows of another one, of the same shape.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.fold();
        let mut other = other.clone();
        other.fold();
        for c in 0..self.responses {
            let unit = self.exponents[c].max(other.exponents[c]);
            self.set_unit(c, unit);
            other.set_unit(c, unit);
        }
        self.rows += other.rows;
        self.informative += other.informative;
        self.stack(&other.triangle);
    }

    /// Holds response `c` in units of 2^`exponent`, at least as large as before.
    fn set_unit(&mut self, c: usize, exponent: i32) {
        let held = self.exponents[c];
        if held != UNSET && held != exponent {
            let shift = libm::ldexp(1.0, held - exponent);
            self.triangle.column_mut(1 + self.regressors + c).scale_mut(shift);
        }
        self.exponents[c] = exponent;
    }

    /// Takes the pending rows into the triangle.
    fn fold(&mut self) {
        let columns = self.triangle.ncols();
        let added = self.pending.len() / columns;
        if added == 0 {
            return;
        }
        let mut rows = DMatrix::from_row_slice(added, columns, &self.pending);
        self.pending.clear();
        for c in 0..self.responses {
            let at = 1 + self.regressors + c;
            // The largest response sets the unit: the square of no other one may overflow in it.
            let largest = rows.column(at).iter().fold(0.0, |most: f64, y| most.max(y.abs()));
            if largest > 0.0 && largest.is_finite() {
                let exponent = libm::frexp(largest).1.clamp(-1020, 1020);
                self.set_unit(c, self.exponents[c].max(exponent));
            }
            let exponent = unset_as_0(self.exponents[c]);
            rows.column_mut(at).apply(|y| *y = libm::ldexp(*y, -exponent));
        }
        self.stack(&rows);
    }

    fn stack(&mut self, rows: &DMatrix<f64>) {
        if rows.nrows() == 0 {
            return;
        }
        let (held, columns) = (self.triangle.nrows(), self.triangle.ncols());
        let mut stacked = DMatrix::zeros(held + rows.nrows(), columns);
        stacked.rows_mut(0, held).copy_from(&self.triangle);
        stacked.rows_mut(held, rows.nrows()).copy_from(rows);
        self.triangle = stacked.qr().r();
    }

    /// The coefficients that leave the least squares; `None` if they are not finite.
    pub(crate) fn solve(&self) -> Option<Solution> {
        self.factored().solution()
    }

    /// The regressors, as independent of each other as they are.
    pub(crate) fn factored(&self) -> Factored {
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
        let exponents = folded.exponents;
        if kept.is_empty() {
            let (q, triangle) = (DMatrix::zeros(m, 0), DMatrix::zeros(0, 0));
            let order = PermutationSequence::identity_generic(Dyn(0));
            return Factored { regressors: m, r, exponents, kept, q, triangle, order };
        }
        let factors = scaled.col_piv_qr();
        let (q, triangle) = (factors.q(), factors.r());
        let largest = triangle[(0, 0)].abs();
        let rank = (0..kept.len().min(m))
            .take_while(|j| triangle[(*j, *j)].abs() > NOISE * largest)
            .count();
        let triangle = triangle.view((0, 0), (rank, rank)).into_owned();
        let order = factors.p().clone();
        Factored { regressors: m, r, exponents, kept, q, triangle, order }
    }
}

/// A regression whose independent regressors are known.
#[derive(Debug)]
pub(crate) struct Factored {
    regressors: usize,
    /// The triangle of the whole.
    r: DMatrix<f64>,
    exponents: Vec<i32>,
    /// The columns that are not constant, and their lengths beside the intercept.
    kept: Vec<(usize, f64)>,
    /// Those, scaled and put in order: q · triangle, of the rank.
    q: DMatrix<f64>,
    triangle: DMatrix<f64>,
    order: PermutationSequence<Dyn>,
}

impl Factored {
    pub(crate) fn solution(&self) -> Option<Solution> {
        let (m, rank) = (self.regressors, self.triangle.nrows());
        let mut coefficients = vec![vec![0.0; m]; self.exponents.len()];
        for (c, row) in coefficients.iter_mut().enumerate() {
            let y = self.r.view((1, 1 + m + c), (m, 1));
            let right: DVector<f64> = self.q.columns(0, rank).tr_mul(&y).column(0).into_owned();
            let solved = self.triangle.solve_upper_triangular(&right)?;
            let mut all = DVector::zeros(self.kept.len());
            all.rows_mut(0, rank).copy_from(&solved);
            self.order.inv_permute_rows(&mut all);
            for ((k, norm), beta) in self.kept.iter().zip(all.iter()) {
                row[k - 1] = libm::ldexp(beta / norm, unset_as_0(self.exponents[c]));
            }
        }
        let finite = coefficients.iter().flatten().all(|beta| beta.is_finite());
        finite.then_some(Solution { coefficients, rank })
    }

    /// The row with regressors `z` less the mean, in coordinates in which the rows are orthonormal.
    pub(crate) fn whitened(&self, z: &[f64]) -> DVector<f64> {
        let of = |(k, norm): &(usize, f64)| {
            let mean = self.r[(0, *k)] / self.r[(0, 0)];
            (z.get(k - 1).copied().unwrap_or(0.0) - mean) / norm
        };
        let mut row = DVector::from_iterator(self.kept.len(), self.kept.iter().map(of));
        self.order.permute_rows(&mut row);
        let mut row = row.rows(0, self.triangle.nrows()).into_owned();
        self.triangle.tr_solve_upper_triangular_mut(&mut row);
        row
    }
}

/// The exponent of a response that has been 0 so far.
const UNSET: i32 = i32::MIN;

/// It does not matter.
fn unset_as_0(exponent: i32) -> i32 {
    if exponent == UNSET { 0 } else { exponent }
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
    fn responses_of_any_size_in_any_order_are_fitted() {
        for reversed in [false, true] {
            let mut fit = Regression::new(1, 1);
            for j in 0..2000 {
                let x = f64::from(if reversed { 1999 - j } else { j }) / 2000.0;
                // From 1e-300 to 1e300.
                fit.push(1.0, [10_f64.powf(600.0 * x - 600.0)], [10_f64.powf(600.0 * x - 300.0)]);
            }
            let beta = fit.solve().unwrap().coefficients[0][0];
            assert!((beta / 1e300 - 1.0).abs() < 1e-12, "{reversed}: {beta}");
        }
    }

    /// The squared lengths of whitened rows sum to the rank, and the rows to 0.
    #[test]
    fn whitened_rows_are_orthonormal() {
        let z = |j: u32| {
            let x = f64::from(j) / 500.0;
            [x, x.exp(), 2.0 * x, 3.0, x * x]
        };
        let mut fit = Regression::new(5, 1);
        (0..500).for_each(|j| fit.push(1.0, z(j), [1.0]));
        let factored = fit.factored();
        let rows: Vec<_> = (0..500).map(|j| factored.whitened(&z(j))).collect();
        assert_eq!(rows[0].len(), 3);
        for i in 0..3 {
            assert!(rows.iter().map(|row| row[i]).sum::<f64>().abs() < 1e-9);
            for k in 0..3 {
                let product: f64 = rows.iter().map(|row| row[i] * row[k]).sum();
                assert!((product - f64::from(u8::from(i == k))).abs() < 1e-10, "{i} {k} {product}");
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
        assert_eq!(fit.solve().map_or(0, |s| s.rank), 0);
    }
}
