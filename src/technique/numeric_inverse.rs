//! A technique whose inverse CDF is found numerically.

use super::fn_technique::ends;
use super::{InverseCdf, Technique, canonical, invert};
use crate::error::ArgumentError;
use std::fmt;

/// The largest |cdf(a)| and |cdf(b) - 1| that construction accepts.
const TOLERANCE: f64 = 1e-12;

/// A density on \[a, b\] given by its pdf and its CDF, with respect to length; the inverse CDF is
/// found numerically.
///
/// p(x) is `pdf(x)` on \[a, b\] and 0 elsewhere; P(x) is `cdf(x)`, and 0 below a and 1 above b.
/// Either end may be infinite.
///
/// The closures are trusted: `cdf` must not decrease, `pdf` must be its derivative, and neither may
/// panic inside the support. Nothing checks this but the values of the CDF at the ends.
///
/// ```
/// use mis::technique::{InverseCdf, NumericInverse, Technique};
/// # fn main() -> Result<(), mis::ArgumentError> {
/// // p(x) = (1 + cos x) / π on [0, π]: P has no closed inverse.
/// use std::f64::consts::PI;
/// let p = NumericInverse::new([0.0, PI], |x| (1.0 + x.cos()) / PI, |x| (x + x.sin()) / PI)?;
/// let x = p.sample(&[0.75]);
/// assert!((p.cdf(x) - 0.75).abs() <= f64::EPSILON);
/// # Ok(())
/// # }
/// ```
///
/// # Numerics
///
/// For 0 < u < 1 the inverse x is strictly inside the support, and one of two holds: |P(x) - u| is
/// at most ε u (ε = 2⁻⁵²; above the median 1 - P and 1 - u take the places of P and u) or p(x)
/// times the spacing of the floats at x; or x is one of two neighbouring floats between which the
/// computed P passes u. It takes at most 600 evaluations of
/// `cdf`, for any closures, and about 5 to 15 for smooth ones (Newton's method on the logarithm,
/// safeguarded by bisection over the floats). In a flat stretch of P, x is at an end of the
/// stretch. The survival function is 1 - P unless
/// [`with_survival`](NumericInverse::with_survival) gives a better one, so without it samples far
/// in an upper tail have the granularity of P near 1.
#[derive(Clone, Copy)]
pub struct NumericInverse<P, C, S = fn(f64) -> f64> {
    a: f64,
    b: f64,
    pdf: P,
    cdf: C,
    survival: Option<S>,
}

impl<P, C> NumericInverse<P, C>
where
    P: Fn(f64) -> f64 + Sync,
    C: Fn(f64) -> f64 + Sync,
{
    /// The density with this support, pdf and CDF.
    ///
    /// # Errors
    ///
    /// The support must be two ends, not NaN, the second greater than the first. `cdf` must be 0 at
    /// the first and 1 at the second to within 1e-12; at an infinite end it is evaluated there.
    pub fn new(support: [f64; 2], pdf: P, cdf: C) -> Result<Self, ArgumentError> {
        let [a, b] = ends("NumericInverse", support)?;
        for (x, expected) in [(a, 0.0), (b, 1.0)] {
            let value = cdf(x);
            let near = (value - expected).abs() <= TOLERANCE;
            if !near {
                let name = format!("cdf({x:?})");
                let rule = format!("it must be {expected} to within {TOLERANCE:e}");
                return Err(ArgumentError::new("NumericInverse", name, value, rule));
            }
        }
        Ok(Self { a, b, pdf, cdf, survival: None })
    }

    /// With `survival(x)` = 1 - P(x) computed without that cancellation, for precise upper tails.
    #[must_use]
    pub fn with_survival<S>(self, survival: S) -> NumericInverse<P, C, S>
    where
        S: Fn(f64) -> f64 + Sync,
    {
        let Self { a, b, pdf, cdf, .. } = self;
        NumericInverse { a, b, pdf, cdf, survival: Some(survival) }
    }
}

impl<P, C, S> fmt::Debug for NumericInverse<P, C, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let support = [self.a, self.b];
        f.debug_struct("NumericInverse").field("support", &support).finish_non_exhaustive()
    }
}

impl<P, C, S> Technique for NumericInverse<P, C, S>
where
    P: Fn(f64) -> f64 + Sync,
    C: Fn(f64) -> f64 + Sync,
    S: Fn(f64) -> f64 + Sync,
{
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        self.inverse_cdf(canonical(xi, 0))
    }

    fn pdf(&self, x: &f64) -> f64 {
        if self.a <= *x && *x <= self.b { (self.pdf)(*x) } else { 0.0 }
    }
}

impl<P, C, S> InverseCdf for NumericInverse<P, C, S>
where
    P: Fn(f64) -> f64 + Sync,
    C: Fn(f64) -> f64 + Sync,
    S: Fn(f64) -> f64 + Sync,
{
    fn cdf(&self, x: f64) -> f64 {
        if x <= self.a {
            0.0
        } else if x >= self.b {
            1.0
        } else {
            (self.cdf)(x).clamp(0.0, 1.0)
        }
    }

    fn inverse_cdf(&self, u: f64) -> f64 {
        let ends = [self.a, self.b];
        invert::inverse_cdf(u, ends, |x| self.cdf(x), |x| self.survival(x), |x| (self.pdf)(x))
    }

    fn survival(&self, x: f64) -> f64 {
        match &self.survival {
            Some(survival) if self.a < x && x < self.b => survival(x).clamp(0.0, 1.0),
            _ => 1.0 - self.cdf(x),
        }
    }

    fn inverse_survival(&self, v: f64) -> f64 {
        let ends = [self.a, self.b];
        invert::inverse_survival(v, ends, |x| self.cdf(x), |x| self.survival(x), |x| (self.pdf)(x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;
    use std::f64::consts::{FRAC_1_PI, PI};

    const LARGEST: f64 = 1.0 - f64::EPSILON / 2.0;
    const US: [f64; 13] =
        [1e-300, 1e-30, 5e-17, 1e-9, 1e-3, 0.1, 0.3, 0.5, 0.7, 0.9, 0.999, 0.999_999_999, LARGEST];

    /// The stated bound: to ε on the side of the nearer tail, or between neighbouring floats.
    fn assert_bound(p: &impl InverseCdf) {
        let (a, b) = p.support();
        for u in US {
            let x = p.inverse_cdf(u);
            assert!(a < x && x < b && x.is_finite(), "u = {u:e}: x = {x:?}");
            assert!(p.pdf(&x) > 0.0, "u = {u:e}: x = {x:?}");
            let (tail, target): (&dyn Fn(f64) -> f64, f64) =
                if u <= 0.5 { (&|x| p.cdf(x), u) } else { (&|x| -p.survival(x), u - 1.0) };
            let grain = p.pdf(&x) * (x.abs().next_up() - x.abs());
            let close = (tail(x) - target).abs() <= grain.max(f64::EPSILON * target.abs());
            let passed = tail(x.next_down()) <= target && target <= tail(x.next_up());
            assert!(close || passed, "u = {u:e}: x = {x:?}, {:e}", tail(x) - target);
        }
    }

    #[test]
    fn smooth_steep_and_flat_functions_meet_the_bound() {
        let whole = [f64::NEG_INFINITY, f64::INFINITY];
        let half = [0.0, f64::INFINITY];
        assert_bound(
            &NumericInverse::new([0.0, PI], |x| (1.0 + x.cos()) / PI, |x| (x + x.sin()) / PI)
                .unwrap(),
        );
        let cauchy = |x: f64| FRAC_1_PI / (1.0 + x * x);
        assert_bound(
            &NumericInverse::new(whole, cauchy, |x| 0.5 + x.atan() / PI)
                .unwrap()
                .with_survival(|x| 1.0_f64.atan2(x) / PI),
        );
        for scale in [1e-150, 1.0, 1e150] {
            let exponential = NumericInverse::new(
                half,
                |x| (-x / scale).exp() / scale,
                |x| -(-x / scale).exp_m1(),
            );
            assert_bound(&exponential.unwrap().with_survival(|x| (-x / scale).exp()));
        }
        // A pole at 0, a CDF whose derivative vanishes at 0, and a step of width 1e-12.
        assert_bound(
            &NumericInverse::new([0.0, 1.0], |x| 0.1 * x.powf(-0.9), |x| x.powf(0.1)).unwrap(),
        );
        assert_bound(&NumericInverse::new([0.0, 1.0], |x| 9.0 * x.powi(8), |x| x.powi(9)).unwrap());
        let logistic = |x: f64| (1.0 + (-(x - 0.3) / 1e-12).exp()).recip();
        let slope = |x: f64| (0.5 / (0.5 * (x - 0.3) / 1e-12).cosh()).powi(2) / 1e-12;
        assert_bound(&NumericInverse::new([-1.0, 1.0], slope, logistic).unwrap());
    }

    #[test]
    fn a_gap_in_the_support_is_not_sampled() {
        let pdf = |x: f64| {
            if (0.0..=1.0).contains(&x) || (2.0..=3.0).contains(&x) { 0.5 } else { 0.0 }
        };
        let cdf = |x: f64| 0.5 * (x.clamp(0.0, 1.0) + (x - 2.0).clamp(0.0, 1.0));
        let p = NumericInverse::new([-1.0, 4.0], pdf, cdf).unwrap();
        for u in [0.5_f64.next_down(), 0.5, 0.5_f64.next_up()] {
            for x in [p.inverse_cdf(u), p.inverse_survival(u)] {
                assert!(p.pdf(&x) > 0.0, "u = {u:?}: x = {x:?}");
            }
        }
    }

    #[test]
    fn few_evaluations_for_smooth_functions() {
        let (mut total, n) = (0, 1000);
        for k in 0..n {
            let u = 0.5 * (f64::from(k) + 0.5) / f64::from(n);
            let count = Cell::new(0);
            let cdf = |x: f64| {
                count.set(count.get() + 1);
                (x + x.sin()) / PI
            };
            let ends = [0.0, PI];
            invert::inverse_cdf(u, ends, cdf, |_| f64::NAN, |x| (1.0 + x.cos()) / PI);
            total += count.get();
        }
        assert!(total <= 8 * n, "{total} evaluations for {n} samples");
    }

    #[test]
    fn the_ends_and_bad_input() {
        let p =
            NumericInverse::new([0.0, f64::INFINITY], |x| (-x).exp(), |x| -(-x).exp_m1()).unwrap();
        assert_eq!(p.support(), (0.0, f64::INFINITY));
        assert_eq!((p.inverse_survival(0.0), p.inverse_survival(1.0)), (f64::INFINITY, 0.0));
        for u in [f64::NAN, -1.0, 2.0] {
            assert!(p.inverse_cdf(u).is_nan() && p.inverse_survival(u).is_nan());
        }
        assert!(p.sample(&[]).is_nan() && p.cdf(f64::NAN).is_nan());
        for u in [0.0, 1.0] {
            let x = p.sample(&[u]);
            assert!(x.is_finite() && p.pdf(&x) > 0.0);
        }
        assert_eq!((p.pdf(&-1.0), p.cdf(-1.0), p.survival(-1.0)), (0.0, 0.0, 1.0));
    }

    #[test]
    fn a_cdf_that_overshoots_stays_a_probability() {
        let p = NumericInverse::new([0.0, 1.0], |_| 1.0, |x| x * (1.0 + 1e-13)).unwrap();
        assert_eq!((p.cdf(1.0_f64.next_down()), p.survival(1.0_f64.next_down())), (1.0, 0.0));
    }

    #[test]
    fn errors_name_argument_value_and_rule() {
        let message = |support, cdf: fn(f64) -> f64| {
            NumericInverse::new(support, |_| 1.0, cdf).unwrap_err().to_string()
        };
        assert_eq!(
            message([0.0, 1.0], |x| 2.0 * x),
            "NumericInverse: `cdf(1.0)` is 2.0, but it must be 1 to within 1e-12"
        );
        assert!(message([0.5, 1.0], |x| x).contains("`cdf(0.5)` is 0.5"));
        assert!(message([0.0, 1.0], |_| f64::NAN).contains("`cdf(0.0)` is NaN"));
        assert!(message([1.0, 0.0], |x| x).contains("`support[1]` is 0.0"));
        assert!(message([f64::NAN, 0.0], |x| x).contains("`support[0]` is NaN"));
    }
}
