//! The uniform density on a finite interval.

use super::columns::density;
use super::{InverseCdf, Technique, batch, canonical, rows};
use crate::error::{ArgumentError, finite, greater};

/// The uniform density on \[a, b\], with respect to length.
///
/// p(x) = 1 / (b - a), P(x) = (x - a) / (b - a), P⁻¹(u) = a + u (b - a).
///
/// ```
/// use mis::technique::{InverseCdf, Technique, Uniform};
/// # fn main() -> Result<(), mis::ArgumentError> {
/// let p = Uniform::new(1.0, 3.0)?;
/// assert_eq!(p.sample(&[0.25]), 1.5);
/// assert_eq!(p.pdf(&1.5), 0.5);
/// assert_eq!(p.cdf(1.5), 0.25);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uniform {
    a: f64,
    b: f64,
}

impl Uniform {
    /// The uniform density on \[a, b\].
    ///
    /// # Errors
    ///
    /// `a` and `b` must be finite, b > a, and b - a must neither overflow nor be subnormal.
    pub fn new(a: f64, b: f64) -> Result<Self, ArgumentError> {
        finite("Uniform", "a", a)?;
        finite("Uniform", "b", b)?;
        greater("Uniform", "b", b, "a", a)?;
        if !(b - a).is_normal() {
            let rule = "it must be within the range of normal numbers";
            return Err(ArgumentError::new("Uniform", "b - a", b - a, rule));
        }
        Ok(Self { a, b })
    }

    /// The uniform density on \[0, 1\].
    #[must_use]
    pub fn unit() -> Self {
        Self { a: 0.0, b: 1.0 }
    }

    #[inline]
    pub(super) fn ends(&self) -> (f64, f64) {
        (self.a, self.b)
    }

    #[inline]
    pub(super) fn contains(&self, x: f64) -> bool {
        (self.a <= x) & (x <= self.b)
    }

    /// From the nearer end, so that neither end is overshot by rounding.
    #[inline]
    pub(super) fn place(&self, u: f64) -> f64 {
        let width = self.b - self.a;
        if u < 0.5 { self.a + u * width } else { self.b - (1.0 - u) * width }
    }
}

impl Technique for Uniform {
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        self.inverse_cdf(canonical(xi, 0))
    }

    fn pdf(&self, x: &f64) -> f64 {
        if self.contains(*x) { (self.b - self.a).recip() } else { 0.0 }
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<f64>) {
        batch::sample(self, xi, xs);
    }
}

impl InverseCdf for Uniform {
    fn cdf(&self, x: f64) -> f64 {
        ((x - self.a) / (self.b - self.a)).clamp(0.0, 1.0)
    }

    fn inverse_cdf(&self, u: f64) -> f64 {
        if !(0.0..=1.0).contains(&u) {
            return f64::NAN;
        }
        self.place(u)
    }

    fn survival(&self, x: f64) -> f64 {
        ((self.b - x) / (self.b - self.a)).clamp(0.0, 1.0)
    }

    fn inverse_survival(&self, v: f64) -> f64 {
        if !(0.0..=1.0).contains(&v) {
            return f64::NAN;
        }
        let width = self.b - self.a;
        if v < 0.5 { self.b - v * width } else { self.a + (1.0 - v) * width }
    }

    fn sample_slice(&self, xi: &[f64], xs: &mut [f64]) {
        let this = *self; // which no write to `xs` can change
        batch::places(xi, xs, move |u| this.place(u));
    }

    fn sample_rows<P: AsMut<[f64]>>(coordinates: &[Self], xi: &[f64], xs: &mut [P]) {
        rows::place(coordinates, xi, xs);
    }

    fn pdf_rows<P: AsRef<[f64]>>(coordinates: &[Self], xs: &[P], out: &mut [f64]) {
        rows::within(coordinates, xs, out);
        // It is the same wherever it is not 0.
        let first = out.iter().zip(xs).find(|(inside, _)| **inside > 0.0);
        let p = first.map_or(0.0, |(_, x)| density(coordinates, x.as_ref()));
        if p != 1.0 {
            // Not a product, which would be NaN at 0 times infinity.
            for out in out {
                *out = if *out > 0.0 { p } else { 0.0 };
            }
        }
    }
}
