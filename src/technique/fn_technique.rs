//! A technique made of three closures.

use super::{InverseCdf, Technique, canonical};
use crate::error::{ArgumentError, greater};
use std::fmt;

/// A density on \[a, b\] given by its pdf, its CDF and its inverse CDF, with respect to length.
///
/// p(x) is `pdf(x)` on \[a, b\] and 0 elsewhere; P(x) is `cdf(x)`, and 0 below a and 1 above b;
/// P⁻¹(u) is `inverse_cdf(u)`, brought back into \[a, b\] where rounding leaves it, and a and b at
/// u = 0 and 1.
///
/// The closures are trusted: they must belong together (pdf the derivative of cdf, `inverse_cdf`
/// its increasing inverse) and must not panic, and their accuracy is the technique's. Where an
/// inverse overshoots an end, the pdf at that end must be positive and finite. The survival
/// function is 1 - P, so an upper tail has the absolute precision of the CDF.
///
/// ```
/// use mis::technique::{FnTechnique, InverseCdf, Technique};
/// use std::f64::consts::FRAC_PI_2;
/// # fn main() -> Result<(), mis::ArgumentError> {
/// // p(x) = cos x and p(x) = sin x on [0, π/2].
/// let cosine = FnTechnique::new([0.0, FRAC_PI_2], f64::cos, f64::sin, f64::asin)?;
/// assert!((cosine.sample(&[0.5]) - 30.0_f64.to_radians()).abs() < 1e-15);
///
/// // 1 - cos x = 2 sin²(x/2): acos(1 - u) would lose half the digits near 0.
/// let sine = FnTechnique::new(
///     [0.0, FRAC_PI_2],
///     f64::sin,
///     |x| 2.0 * (0.5 * x).sin().powi(2),
///     |u| 2.0 * (0.5 * u).sqrt().asin(),
/// )?;
/// assert_eq!(sine.pdf(&2.0), 0.0);
/// assert!((sine.cdf(sine.inverse_cdf(1e-20)) / 1e-20 - 1.0).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy)]
pub struct FnTechnique<P, C, I> {
    a: f64,
    b: f64,
    /// Whether the inverse leaves the support at the outermost canonical numbers. It increases, so
    /// otherwise it never does.
    overshoots: bool,
    pdf: P,
    cdf: C,
    inverse_cdf: I,
}

impl<P, C, I> FnTechnique<P, C, I>
where
    P: Fn(f64) -> f64 + Sync,
    C: Fn(f64) -> f64 + Sync,
    I: Fn(f64) -> f64 + Sync,
{
    /// The density with this support, which may be infinite, and these functions.
    ///
    /// # Errors
    ///
    /// The support must be two ends, not NaN, the second greater than the first.
    pub fn new(support: [f64; 2], pdf: P, cdf: C, inverse_cdf: I) -> Result<Self, ArgumentError> {
        let [a, b] = ends("FnTechnique", support)?;
        let inside = |u: f64| (a..=b).contains(&inverse_cdf(canonical(&[u], 0)));
        let overshoots = !(inside(0.0) && inside(1.0));
        Ok(Self { a, b, overshoots, pdf, cdf, inverse_cdf })
    }
}

/// The two ends of a support that may be infinite.
pub(super) fn ends(owner: &'static str, [a, b]: [f64; 2]) -> Result<[f64; 2], ArgumentError> {
    if a.is_nan() {
        let rule = "it must be a number or infinite";
        return Err(ArgumentError::new(owner, "support[0]", a, rule));
    }
    greater(owner, "support[1]", b, "support[0]", a)?;
    Ok([a, b])
}

/// `x`, or the end of \[a, b\] that is nearer; NaN stays NaN.
fn confined(x: f64, a: f64, b: f64) -> f64 {
    let x = if x < a { a } else { x };
    if x > b { b } else { x }
}

impl<P, C, I> fmt::Debug for FnTechnique<P, C, I> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let support = [self.a, self.b];
        f.debug_struct("FnTechnique").field("support", &support).finish_non_exhaustive()
    }
}

impl<P, C, I> Technique for FnTechnique<P, C, I>
where
    P: Fn(f64) -> f64 + Sync,
    C: Fn(f64) -> f64 + Sync,
    I: Fn(f64) -> f64 + Sync,
{
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        let x = (self.inverse_cdf)(canonical(xi, 0));
        if self.overshoots { confined(x, self.a, self.b) } else { x }
    }

    fn pdf(&self, x: &f64) -> f64 {
        if self.a <= *x && *x <= self.b { (self.pdf)(*x) } else { 0.0 }
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<f64>) {
        xs.clear();
        xs.extend(xi.iter().map(|u| (self.inverse_cdf)(canonical(&[*u], 0))));
        if self.overshoots {
            for x in xs.iter_mut() {
                *x = confined(*x, self.a, self.b);
            }
        }
    }
}

impl<P, C, I> InverseCdf for FnTechnique<P, C, I>
where
    P: Fn(f64) -> f64 + Sync,
    C: Fn(f64) -> f64 + Sync,
    I: Fn(f64) -> f64 + Sync,
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
        if u == 0.0 {
            self.a
        } else if u == 1.0 {
            self.b
        } else if (0.0..=1.0).contains(&u) {
            confined((self.inverse_cdf)(u), self.a, self.b)
        } else {
            f64::NAN
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn closures_are_confined_to_the_support() {
        // The inverse overshoots, and pdf and cdf go on beyond the support.
        let p = FnTechnique::new([0.0, 1.0], |_| 1.0, |x| x, |u| 1.5 * u).unwrap();
        assert_eq!((p.pdf(&-0.1), p.pdf(&0.0), p.pdf(&1.0), p.pdf(&1.1)), (0.0, 1.0, 1.0, 0.0));
        assert_eq!((p.cdf(-3.0), p.cdf(0.25), p.cdf(3.0)), (0.0, 0.25, 1.0));
        assert_eq!((p.sample(&[0.9]), p.inverse_cdf(0.9)), (1.0, 1.0));
        assert_eq!((p.ln_pdf(&2.0), p.pdf(&f64::NAN)), (f64::NEG_INFINITY, 0.0));
        for v in [-0.1, -5e-324, 1.1, f64::NAN] {
            assert!(p.inverse_cdf(v).is_nan() && p.inverse_survival(v).is_nan());
        }
        assert!(p.sample(&[]).is_nan() && p.cdf(f64::NAN).is_nan());
    }

    #[test]
    fn batches_are_confined_as_well() {
        let inverse = |u| if u > 0.9 { f64::NAN } else { 1.5 * u };
        let p = FnTechnique::new([0.0, 1.0], |_| 1.0, |x| x, inverse).unwrap();
        for n in [4, 20] {
            let mut xi = vec![0.5; n];
            (xi[0], xi[n - 1], xi[n / 2]) = (0.8, 0.8, 0.95);
            let mut xs = vec![];
            p.sample_batch(&xi, &mut xs);
            let mut pdfs = vec![7.0; n];
            p.pdf_batch(&xs, &mut pdfs);
            assert_eq!((xs[0], xs[n - 1], pdfs[n / 2]), (1.0, 1.0, 0.0));
            assert!(xs[n / 2].is_nan());
            xs[0] = 5.0;
            p.pdf_batch(&xs, &mut pdfs);
            assert_eq!((pdfs[0], pdfs[1]), (0.0, 1.0));
        }
    }

    #[test]
    fn infinite_supports() {
        let logistic = FnTechnique::new(
            [f64::NEG_INFINITY, f64::INFINITY],
            |x: f64| (0.5 / (0.5 * x).cosh()).powi(2),
            |x: f64| (1.0 + (-x).exp()).recip(),
            |u: f64| (u / (1.0 - u)).ln(),
        )
        .unwrap();
        assert_eq!(logistic.support(), (f64::NEG_INFINITY, f64::INFINITY));
        for u in [0.0, 1.0] {
            let x = logistic.sample(&[u]);
            assert!(x.is_finite() && logistic.pdf(&x) > 0.0);
        }
        let sine = FnTechnique::new([0.0, FRAC_PI_2], f64::sin, |x| 1.0 - x.cos(), f64::asin);
        assert_eq!(
            format!("{:?}", sine.unwrap()),
            format!("FnTechnique {{ support: [0.0, {FRAC_PI_2}], .. }}")
        );
    }

    #[test]
    fn errors_name_argument_value_and_rule() {
        let message =
            |support| FnTechnique::new(support, |_| 1.0, |x| x, |u| u).unwrap_err().to_string();
        assert_eq!(
            message([1.0, 0.0]),
            "FnTechnique: `support[1]` is 0.0, but it must be greater than support[0] = 1"
        );
        assert!(message([f64::NAN, 0.0]).contains("`support[0]` is NaN"));
        assert!(message([0.0, f64::NAN]).contains("`support[1]` is NaN"));
        assert!(message([f64::INFINITY, f64::INFINITY]).contains("`support[1]` is inf"));
    }
}
