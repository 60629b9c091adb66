//! The affine image of a technique on the line.

use super::elementary::clamp;
use super::{InverseCdf, Technique, batch, canonical};
use crate::error::{ArgumentError, finite};

/// The density of x = shift + scale · y for y from a technique T, with respect to length.
///
/// With g and G the density and the CDF of T and y = (x - shift) / scale: p(x) = g(y) / |scale|,
/// and for scale > 0 P(x) = G(y) and P⁻¹(u) = shift + scale · G⁻¹(u). A negative scale mirrors: the
/// CDF is T's survival function, and the inverse CDF its inverse.
///
/// ```
/// use mis::technique::{Affine, InverseCdf, Technique, Uniform};
/// # fn main() -> Result<(), mis::ArgumentError> {
/// let p = Affine::new(Uniform::unit(), 1.0, -2.0)?;
/// assert_eq!(p.support(), (-1.0, 1.0));
/// assert_eq!(p.sample(&[0.25]), -0.5);
/// assert_eq!(p.pdf(&-0.5), 0.5);
/// # Ok(())
/// # }
/// ```
///
/// # Numerics
///
/// y is recovered from the rounded x, so p and P are those of T at an argument off by
/// ε (|x| + |shift|) / |scale|. A density with a pole keeps its precision there only if the pole's
/// image is x = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine<T> {
    inner: T,
    shift: f64,
    scale: f64,
    /// The support of `inner`, and its image in increasing order.
    inner_support: (f64, f64),
    support: (f64, f64),
    /// The part of `support` where samples may lie.
    sampled: (f64, f64),
}

impl<T: InverseCdf> Affine<T> {
    /// The density of shift + scale · y, y from `inner`.
    ///
    /// # Errors
    ///
    /// `shift` must be finite; `scale` must be finite, not subnormal and not 0, and keep finite
    /// ends of the support finite and apart, samples finite, and their densities finite and
    /// greater than 0 (where these underflow, their logarithms finite).
    pub fn new(inner: T, shift: f64, scale: f64) -> Result<Self, ArgumentError> {
        finite("Affine", "shift", shift)?;
        if !scale.is_normal() {
            let rule = "it must be a normal number, so neither 0 nor infinite";
            return Err(ArgumentError::new("Affine", "scale", scale, rule));
        }
        let inner_support = inner.support();
        let (a, b) = (shift + scale * inner_support.0, shift + scale * inner_support.1);
        let kept = a.is_finite() == inner_support.0.is_finite()
            && b.is_finite() == inner_support.1.is_finite();
        let support = if scale > 0.0 { (a, b) } else { (b, a) };
        if !(kept && support.0 < support.1) {
            let rule = format!(
                "it must map the support {inner_support:?} to an interval, but its image is {support:?}"
            );
            return Err(ArgumentError::new("Affine", "scale", scale, rule));
        }
        let mut this = Self { inner, shift, scale, inner_support, support, sampled: support };
        // Rounding may put samples on an end without a density; the numbers next to an end may
        // share its preimage.
        for _ in 0..4 {
            if support.0.is_finite() && !this.dense(this.sampled.0) {
                this.sampled.0 = this.sampled.0.next_up();
            }
            if support.1.is_finite() && !this.dense(this.sampled.1) {
                this.sampled.1 = this.sampled.1.next_down();
            }
        }
        let apart = this.sampled.0 <= this.sampled.1;
        if !(apart && [0.0, 0.5, 1.0].iter().all(|&xi| this.dense(this.sample(&[xi])))) {
            let rule = "samples must be finite and have a finite density greater than 0";
            return Err(ArgumentError::new("Affine", "scale", scale, rule));
        }
        Ok(this)
    }

    /// The technique whose samples are mapped.
    #[must_use]
    pub fn inner(&self) -> &T {
        &self.inner
    }

    /// The x for the inner y with the masses `below` and `above` on the sides of x.
    fn place(&self, below: f64, above: f64, y: f64) -> f64 {
        if below == 0.0 {
            self.support.0
        } else if above == 0.0 {
            self.support.1
        } else {
            (self.shift + self.scale * y).clamp(self.sampled.0, self.sampled.1)
        }
    }

    /// Whether x is a number and has a finite density, of which the logarithm at least does not
    /// underflow.
    fn dense(&self, x: f64) -> bool {
        x.is_finite() && self.pdf(&x) < f64::INFINITY && self.ln_pdf(&x).is_finite()
    }

    /// The y that maps to x. In the support's image it is in the support, whatever the rounding.
    fn preimage(&self, x: f64) -> f64 {
        let y = (x - self.shift) / self.scale;
        if self.support.0 <= x && x <= self.support.1 {
            y.clamp(self.inner_support.0, self.inner_support.1)
        } else {
            y
        }
    }

    fn contains(&self, x: f64) -> bool {
        self.support.0 <= x && x <= self.support.1
    }
}

impl<T: InverseCdf> Technique for Affine<T> {
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        self.inverse_cdf(canonical(xi, 0))
    }

    fn pdf(&self, x: &f64) -> f64 {
        if self.contains(*x) { self.inner.pdf(&self.preimage(*x)) / self.scale.abs() } else { 0.0 }
    }

    fn ln_pdf(&self, x: &f64) -> f64 {
        let p = self.pdf(x);
        if p.is_normal() {
            p.ln()
        } else if self.contains(*x) {
            self.inner.ln_pdf(&self.preimage(*x)) - self.scale.abs().ln()
        } else {
            f64::NEG_INFINITY
        }
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<f64>) {
        batch::sample(self, xi, xs);
    }

    fn pdf_batch(&self, xs: &[f64], out: &mut [f64]) {
        let (low, high) = self.inner_support;
        let mut ys = [0.0; batch::ROWS];
        for (xs, out) in xs.chunks(batch::ROWS).zip(out.chunks_mut(batch::ROWS)) {
            let ys = &mut ys[..xs.len()];
            for (y, x) in ys.iter_mut().zip(xs) {
                *y = clamp((x - self.shift) / self.scale, low, high);
            }
            self.inner.pdf_batch(ys, out);
            for (p, x) in out.iter_mut().zip(xs) {
                let inside = (self.support.0 <= *x) & (*x <= self.support.1);
                *p = if inside { *p / self.scale.abs() } else { 0.0 };
            }
        }
    }
}

impl<T: InverseCdf> InverseCdf for Affine<T> {
    fn cdf(&self, x: f64) -> f64 {
        if x <= self.support.0 {
            return 0.0;
        }
        if x >= self.support.1 {
            return 1.0;
        }
        let y = self.preimage(x);
        if self.scale > 0.0 { self.inner.cdf(y) } else { self.inner.survival(y) }
    }

    fn inverse_cdf(&self, u: f64) -> f64 {
        let y = if self.scale > 0.0 {
            self.inner.inverse_cdf(u)
        } else {
            self.inner.inverse_survival(u)
        };
        self.place(u, 1.0 - u, y)
    }

    fn survival(&self, x: f64) -> f64 {
        if x <= self.support.0 {
            return 1.0;
        }
        if x >= self.support.1 {
            return 0.0;
        }
        let y = self.preimage(x);
        if self.scale > 0.0 { self.inner.survival(y) } else { self.inner.cdf(y) }
    }

    fn inverse_survival(&self, v: f64) -> f64 {
        let y = if self.scale > 0.0 {
            self.inner.inverse_survival(v)
        } else {
            self.inner.inverse_cdf(v)
        };
        self.place(1.0 - v, v, y)
    }

    fn sample_slice(&self, xi: &[f64], xs: &mut [f64]) {
        if self.scale < 0.0 {
            // 1 - u would take the digits of a small u.
            return batch::places(xi, xs, |u| self.inverse_cdf(u));
        }
        self.inner.sample_slice(xi, xs);
        for (x, _) in xs.iter_mut().zip(xi) {
            *x = clamp(self.shift + self.scale * *x, self.sampled.0, self.sampled.1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Cauchy, Linear, Normal, Uniform};
    use super::*;

    #[test]
    fn a_negative_scale_mirrors() {
        let p = Affine::new(Uniform::new(0.0, 4.0).unwrap(), 10.0, -0.5).unwrap();
        assert_eq!(p.support(), (8.0, 10.0));
        assert_eq!((p.cdf(8.5), p.survival(8.5)), (0.25, 0.75));
        assert_eq!((p.inverse_cdf(0.25), p.inverse_survival(0.25)), (8.5, 9.5));
        assert_eq!((p.pdf(&8.5), p.pdf(&7.9), p.pdf(&10.1)), (0.5, 0.0, 0.0));
        assert_eq!((p.cdf(7.0), p.cdf(11.0)), (0.0, 1.0));
        assert_eq!(p.ln_pdf(&8.5), 0.5_f64.ln());
        assert_eq!(p.ln_pdf(&7.9), f64::NEG_INFINITY);
        // The tail at 0, which was the lower one, keeps its precision as the upper one.
        let p = Affine::new(Uniform::unit(), 0.0, -1.0).unwrap();
        assert_eq!((p.inverse_survival(1e-30), p.survival(-1e-30)), (-1e-30, 1e-30));
    }

    #[test]
    fn every_sample_has_a_density_in_spite_of_rounding() {
        for (shift, scale) in [(0.1, 0.3), (1.0, 1e-15), (-7.3, -1.7), (1e16, 3.0), (0.0, 1e-300)] {
            let p = Affine::new(Uniform::new(0.1, 0.7).unwrap(), shift, scale).unwrap();
            for u in [0.0, 1e-17, 0.1, 0.5, 0.9, 1.0 - f64::EPSILON / 2.0, 1.0] {
                let x = p.inverse_cdf(u);
                assert!(p.pdf(&x) > 0.0, "{shift} {scale} {u}");
                assert!(p.pdf(&p.inverse_survival(u)) > 0.0);
            }
        }
    }

    #[test]
    fn the_ends_of_the_image_have_the_masses_0_and_1() {
        // (b - shift) / scale is less than 1 for the rounded end b.
        let p =
            Affine::new(Uniform::unit(), 0.028_005_486_164_636_603, 0.002_749_134_709_490_756_4);
        let p = p.unwrap();
        let (a, b) = p.support();
        assert_eq!((p.cdf(a), p.cdf(b), p.survival(a), p.survival(b)), (0.0, 1.0, 1.0, 0.0));
        assert_eq!((p.inverse_cdf(0.0), p.inverse_cdf(1.0)), (a, b));
        assert_eq!((p.inverse_survival(1.0), p.inverse_survival(0.0)), (a, b));
    }

    #[test]
    fn rounding_does_not_put_samples_on_an_end_without_density() {
        let up = Linear::new(0.0, 1.0, 0.0, 1.0).unwrap();
        let down = Linear::new(3.0, 4.0, 1.0, 0.0).unwrap();
        for (shift, scale) in [(1e9, 1.0), (-1e9, -1.0), (1.0, 1e-15), (-0.1, -3e-17)] {
            for p in [Affine::new(up, shift, scale), Affine::new(down, shift, scale)] {
                let p = p.unwrap();
                for xi in [0.0, 1e-10, 0.5, 1.0 - 1e-10, 1.0] {
                    assert!(p.pdf(&p.sample(&[xi])) > 0.0, "{p:?}: {xi}");
                }
            }
        }
    }

    #[test]
    fn images_that_leave_the_range_of_numbers_are_refused() {
        let rule = "samples must be finite and have a finite density greater than 0";
        let cauchy = Cauchy::new(0.0, 1.0).unwrap();
        let error = Affine::new(cauchy, 0.0, 1e300).unwrap_err();
        assert_eq!(error.to_string(), format!("Affine: `scale` is 1e300, but {rule}"));
        let narrow = Normal::new(0.0, 1e-200).unwrap();
        assert_eq!(Affine::new(narrow, 0.0, 1e-200).unwrap_err().rule(), rule);
        // Here only the density underflows, and has a logarithm.
        let p = Affine::new(cauchy, 0.0, -3e292).unwrap();
        let x = p.sample(&[0.0]);
        assert!(p.pdf(&x) == 0.0 && p.ln_pdf(&x).is_finite());
    }

    #[test]
    fn bad_input_gives_nan_or_zero() {
        let p = Affine::new(Uniform::unit(), 1.0, 2.0).unwrap();
        assert!(p.inverse_cdf(1.5).is_nan() && p.inverse_survival(-0.5).is_nan());
        assert!(p.sample(&[]).is_nan() && p.cdf(f64::NAN).is_nan());
        assert_eq!((p.pdf(&f64::NAN), p.pdf(&f64::INFINITY)), (0.0, 0.0));
    }

    #[test]
    fn errors_name_argument_value_and_rule() {
        let message =
            |shift, scale| Affine::new(Uniform::unit(), shift, scale).unwrap_err().to_string();
        assert!(message(f64::NAN, 1.0).contains("`shift` is NaN"));
        for scale in [0.0, f64::NAN, f64::INFINITY, 5e-324] {
            let rule = "it must be a normal number, so neither 0 nor infinite";
            assert_eq!(message(0.0, scale), format!("Affine: `scale` is {scale:?}, but {rule}"));
        }
        // The support collapses, and overflows.
        assert!(message(1e20, 1.0).contains("its image is (1e20, 1e20)"));
        assert!(message(f64::MAX, 1e308).contains("inf"));
    }
}
