//! Variance-aware weights.

use super::{Densities, Weighting, at};
use crate::error::{ArgumentError, positive};

/// The least factor over the largest: no sum of products with ratios then leaves the range.
const LEAST: f64 = 1e-200;

/// The most that [`VarianceAware::factor`] gives.
const MOST_FACTOR: f64 = 1e6;

/// The balance heuristic with a factor v_i for each technique, w_i = v_i q_i / Σ v_k q_k.
///
/// The balance heuristic minimises second moments, not variances, so it does not see that a technique
/// is nearly exact. With v_i = E\[F_i²\] / V\[F_i\] = 1 + μ² / V_i, F_i being f / p_i at one sample of
/// technique i and V_i its variance, it does: a technique that is nearly exact takes most of the
/// weight, and where all are bad, all v_i are near 1, which is the balance heuristic.
/// [`factor`](VarianceAware::factor) makes them. Only their ratios matter.
///
/// **The factors must not come from the samples that are weighted**, but from earlier ones, such as a
/// pilot of each technique: factors that depend on the samples bias the estimate. Any that do not
/// leave it unbiased, good or bad. The second moment is at most max v / min v times that of the
/// balance heuristic. As with that, only the union of the supports must cover f.
///
/// ```
/// use mis::technique::{Linear, Uniform};
/// use mis::weighting::VarianceAware;
/// use mis::{Estimator, MultiSample, Technique};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let f = |x: &f64| x + 0.001 * x.sin(); // nearly in proportion to the first density
/// let ramp = Linear::new(0.0, 1.0, 0.0, 2.0)?;
/// let flat = Uniform::unit();
/// let techniques: [&dyn Technique<Point = f64>; 2] = [&ramp, &flat];
///
/// let mut factors = Vec::new();
/// for technique in techniques {
///     let n = 1000;
///     let pilot = MultiSample::new(&[(technique, n)])?.estimate(&f, 1)?;
///     let variance = pilot.variance().unwrap() * n as f64;
///     factors.push(VarianceAware::factor(pilot.value(), variance));
/// }
/// let mis = || MultiSample::new(&[(&ramp, 5000), (&flat, 5000)]);
/// let balance = mis()?.estimate(&f, 2)?;
/// let aware = mis()?.weighting(VarianceAware::new(factors)?)?.estimate(&f, 2)?;
/// assert!(aware.standard_error().unwrap() < 0.01 * balance.standard_error().unwrap());
/// # Ok(())
/// # }
/// ```
///
/// Source: P. Grittmann, I. Georgiev, P. Slusallek and J. Křivánek, *Variance-Aware Multiple
/// Importance Sampling*, ACM Transactions on Graphics 38(6), 2019, doi:10.1145/3355089.3356515.
#[derive(Debug, Clone, PartialEq)]
pub struct VarianceAware {
    /// Over the largest.
    factors: Vec<f64>,
}

impl VarianceAware {
    /// Given factors, one a technique.
    ///
    /// # Errors
    ///
    /// Every factor must be finite and greater than 0, and at least 1e-200 times the largest.
    pub fn new(factors: impl Into<Vec<f64>>) -> Result<Self, ArgumentError> {
        let mut factors = factors.into();
        let name = |i| format!("factors[{i}]");
        for (i, v) in factors.iter().enumerate() {
            positive("VarianceAware", name(i), *v)?;
        }
        let largest = factors.iter().copied().fold(0.0, f64::max);
        for (i, v) in factors.iter_mut().enumerate() {
            if *v / largest < LEAST {
                let rule = format!("it must be at least 1e-200 times the largest, {largest:?}");
                return Err(ArgumentError::new("VarianceAware", name(i), *v, rule));
            }
            *v /= largest;
        }
        Ok(Self { factors })
    }

    /// v = 1 + mean² / variance, at most 10⁶, of the mean and the variance of f / p at the samples of
    /// one technique: not of their average, whose variance is less.
    ///
    /// It is 1 where the variance is infinite, or one of the two is unknown (NaN), or both are 0.
    /// It is 10⁶ where the variance alone is 0. A factor bounds how much worse than balance the weights
    /// can be, and a variance of 0 is often a mistake, of a pilot that missed a peak; and an error that
    /// is 1/1000 of the other techniques' no longer matters beside them.
    ///
    /// ```
    /// use mis::weighting::VarianceAware;
    /// assert_eq!(VarianceAware::factor(3.0, 1.0), 10.0);
    /// assert_eq!(VarianceAware::factor(3.0, f64::INFINITY), 1.0);
    /// assert_eq!(VarianceAware::factor(3.0, f64::NAN), 1.0);
    /// assert_eq!(VarianceAware::factor(3.0, 0.0), 1e6);
    /// ```
    #[must_use]
    pub fn factor(mean: f64, variance: f64) -> f64 {
        // A mean over a deviation: their squares may be out of range. It is 0 over infinity.
        let ratio = mean / variance.sqrt();
        if ratio.is_nan() { 1.0 } else { (1.0 + ratio * ratio).min(MOST_FACTOR) }
    }
}

impl Weighting for VarianceAware {
    fn weight_over_ratio(&self, i: usize, r: &[f64]) -> f64 {
        let sum = self.factors.iter().zip(r).map(|(v, r)| v * r).sum::<f64>();
        at(&self.factors, i) * sum.recip()
    }

    fn weight_over_density_batch(
        &self,
        i: usize,
        q: &Densities<'_>,
        _: &mut [f64],
        out: &mut [f64],
    ) {
        let rows = q.rows().zip(&self.factors).map(|((a, p), v)| (a * v, p));
        super::balance::reciprocal_sums(&rows, out);
        // A reciprocal that is infinite or NaN stays so.
        let own = at(&self.factors, i);
        for out in out {
            *out *= own;
        }
    }

    fn check(&self, alpha: &[f64]) -> Result<(), ArgumentError> {
        if self.factors.len() == alpha.len() {
            Ok(())
        } else {
            let rule = format!("there must be one factor for each of {} techniques", alpha.len());
            let count = self.factors.len();
            Err(ArgumentError::new("VarianceAware", "number of factors", count, rule))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Balance, Densities, Weighting, weights};
    use super::VarianceAware;

    fn aware(factors: &[f64]) -> VarianceAware {
        VarianceAware::new(factors).unwrap()
    }

    #[test]
    fn weights_are_those_of_the_products() {
        let w = weights(&aware(&[3.0, 1.0]), &[1.0, 1.0]).unwrap();
        assert_eq!(w, [0.75, 0.25]);
        assert_eq!(weights(&aware(&[1e6, 1.0]), &[0.0, 5.0]), Some(vec![0.0, 1.0]));
        // Of a product and a sum: three roundings and a reciprocal.
        let (v, q) = ([1e6, 7.0, 1.0, 3.0], [1e-7, 0.3, 0.0, 2.0]);
        let w = weights(&aware(&v), &q).unwrap();
        let sum: f64 = v.iter().zip(q).map(|(v, q)| v * q).sum();
        for (w, (v, q)) in w.iter().zip(v.iter().zip(q)) {
            assert!((w - v * q / sum).abs() <= 8.0 * f64::EPSILON * w, "{w}");
        }
        assert!((w.iter().sum::<f64>() - 1.0).abs() <= 8.0 * f64::EPSILON);
    }

    /// Factors from 1 to `v` of the first technique lead from balance to all of the weight.
    #[test]
    fn a_great_factor_takes_the_weight() {
        let (q, mut last) = ([1.0, 10.0], 0.0);
        for exponent in 0..200 {
            let w = weights(&aware(&[10_f64.powi(exponent), 1.0]), &q).unwrap();
            assert!(w[0] > last || w[0] == 1.0, "{w:?}");
            let other = 1.0 / (0.1 * 10_f64.powi(exponent) + 1.0);
            assert!((w[1] / other - 1.0).abs() < 1e-14, "{w:?}");
            last = w[0];
        }
        assert_eq!(last, 1.0);
    }

    /// By the bits, alone and in blocks.
    #[test]
    fn equal_factors_are_the_balance_heuristic() {
        let (points, alpha) = (37, [0.2, 0.5, 0.3]);
        let pdfs: Vec<f64> = (0..3 * points).map(|k| (k * 37 % 101) as f64).collect();
        let q = Densities::new(&alpha, &pdfs, points);
        for v in [1.0, 0.3, 1e300] {
            let aware = aware(&[v; 3]);
            for i in 0..3 {
                let [mut own, mut balance, mut r] = [(); 3].map(|()| vec![f64::NAN; points]);
                aware.weight_over_density_batch(i, &q, &mut r, &mut own);
                Balance.weight_over_density_batch(i, &q, &mut r, &mut balance);
                assert_eq!(own, balance);
                let r = [0.7, 1.0, 0.1];
                assert_eq!(aware.weight_over_ratio(i, &r), Balance.weight_over_ratio(i, &r));
            }
        }
    }

    /// A block's quotients are those at one point.
    #[test]
    fn blocks_are_many_points() {
        let (points, a) = (37, [0.2, 0.5, 0.3]);
        let pdfs: Vec<f64> = (0..3 * points).map(|k| (1 + k * 37 % 101) as f64).collect();
        let q = Densities::new(&a, &pdfs, points);
        let aware = aware(&[1e5, 4.0, 1.0]);
        for i in 0..3 {
            let [mut out, mut r] = [(); 2].map(|()| vec![f64::NAN; points]);
            aware.weight_over_density_batch(i, &q, &mut r, &mut out);
            for (j, out) in out.iter().enumerate() {
                let q: Vec<f64> = (0..3).map(|k| a[k] * pdfs[k * points + j]).collect();
                let w = weights(&aware, &q).unwrap()[i];
                assert!((out * q[i] / w - 1.0).abs() <= 8.0 * f64::EPSILON, "{i} {j}");
            }
        }
        // Where the sum leaves the range, the quotient shows it.
        for extreme in [1e-310, 1e300] {
            let [mut out, mut r] = [(); 2].map(|()| vec![0.0; 1]);
            let pdfs = [extreme; 3];
            let q = Densities::new(&a, &pdfs, 1);
            aware.weight_over_density_batch(2, &q, &mut r, &mut out);
            assert!(!out[0].is_finite(), "{out:?}");
        }
    }

    #[test]
    fn factors_of_extreme_moments() {
        let factor = VarianceAware::factor;
        for scale in [1e-300, 1e-200, 1.0, 1e150] {
            let v = factor(3.0 * scale, scale * scale);
            let expected = if scale < 1e-160 { 1e6 } else { 10.0 };
            assert!((v / expected - 1.0).abs() < 1e-14, "{scale}: {v}");
        }
        assert_eq!(factor(-3.0, 1.0), 10.0);
        assert_eq!(factor(1e300, 1.0), 1e6);
        for (mean, variance) in [
            (0.0, 0.0),
            (0.0, 1.0),
            (f64::NAN, 1.0),
            (f64::NAN, 0.0),
            (1.0, f64::NAN),
            (1.0, -1.0),
            (1.0, f64::INFINITY),
            (f64::INFINITY, f64::INFINITY),
        ] {
            assert_eq!(factor(mean, variance), 1.0, "{mean} {variance}");
        }
    }
}
