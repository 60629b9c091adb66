//! A technique on the line, restricted to an interval.

use super::{InverseCdf, Technique, canonical};
use crate::error::{ArgumentError, greater};

/// The density of a technique T restricted to \[a, b\], with respect to length.
///
/// With m = P_T(b) - P_T(a): p(x) = p_T(x) / m on \[a, b\], P(x) = (P_T(x) - P_T(a)) / m and
/// P⁻¹(u) = P_T⁻¹(P_T(a) + u m).
///
/// ```
/// use mis::technique::{InverseCdf, PiecewiseConstant, Technique, Truncated};
/// # fn main() -> Result<(), mis::ArgumentError> {
/// let steps = PiecewiseConstant::new(&[0.0, 1.0, 2.0], &[3.0, 1.0])?;
/// let p = Truncated::new(steps, 0.5, f64::INFINITY)?;
/// assert_eq!(p.support(), (0.5, 2.0));
/// assert_eq!(p.pdf(&0.75), 1.2);
/// # Ok(())
/// # }
/// ```
///
/// # Numerics
///
/// Below T's median the masses are differences of its CDF, above it of its survival function, and
/// across it of both, so an interval in either tail keeps T's relative precision. A difference of
/// nearly equal masses loses digits: m has the relative error ε M / m, with M the mass beyond the
/// interval's end that is nearer to the median (or 1/2), and so have p, and the CDF near the ends.
/// Construction refuses m < 2⁻³⁰ M. For a narrow interval of a smooth density another proposal is
/// better: the uniform one, a table, or a type made for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truncated<T> {
    inner: T,
    a: f64,
    b: f64,
    /// T's mass below a, above b, below b, above a, and between.
    below: f64,
    above: f64,
    not_above: f64,
    not_below: f64,
    mass: f64,
}

impl<T: InverseCdf> Truncated<T> {
    /// `inner` restricted to \[a, b\]; either end may be infinite or outside its support.
    ///
    /// # Errors
    ///
    /// b > a. The mass of `inner` in \[a, b\] must be a normal number, and at least 2⁻³⁰ of the
    /// larger of the masses whose difference it is.
    pub fn new(inner: T, a: f64, b: f64) -> Result<Self, ArgumentError> {
        if a.is_nan() {
            let rule = "it must be a number or infinite";
            return Err(ArgumentError::new("Truncated", "a", a, rule));
        }
        greater("Truncated", "b", b, "a", a)?;
        let (low, high) = inner.support();
        let (a, b) = (a.max(low), b.min(high));
        let mass = if a < b {
            mass_between(&inner, a, b)
        } else {
            0.0
        };
        let (below, above) = (inner.cdf(a), inner.survival(b));
        let (not_above, not_below) = (inner.cdf(b), inner.survival(a));
        let larger = not_above.min(not_below).min(0.5);
        if !(mass.is_normal() && mass > 0.0 && mass >= larger * 2.0_f64.powi(-30)) {
            let rule = format!("it must be a normal number, and at least 2^-30 of {larger:e}");
            return Err(ArgumentError::new(
                "Truncated",
                "mass in [a, b]",
                mass,
                rule,
            ));
        }
        Ok(Self {
            inner,
            a,
            b,
            below,
            above,
            not_above,
            not_below,
            mass,
        })
    }

    /// The technique that is restricted.
    #[must_use]
    pub fn inner(&self) -> &T {
        &self.inner
    }

    /// m, the mass of the unrestricted density in \[a, b\].
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.mass
    }

    fn contains(&self, x: f64) -> bool {
        self.a <= x && x <= self.b
    }

    /// The x with the part `u` of the mass below it and `v` = 1 - u above it.
    fn split(&self, u: f64, v: f64) -> f64 {
        let from_nearer = |base: f64, part: f64, far: f64, rest: f64| {
            if part <= rest {
                base + part * self.mass
            } else {
                far - rest * self.mass
            }
        };
        // Each form is exact at both ends of the interval.
        let lower = from_nearer(self.below, u, self.not_above, v);
        let x = if lower <= 0.5 {
            self.inner.inverse_cdf(lower)
        } else {
            let upper = from_nearer(self.above, v, self.not_below, u);
            self.inner.inverse_survival(upper)
        };
        x.clamp(self.a, self.b)
    }
}

/// The mass of `inner` between x and y > x, without cancellation between the tails.
fn mass_between<T: InverseCdf>(inner: &T, x: f64, y: f64) -> f64 {
    let (below, above) = (inner.cdf(x), inner.survival(y));
    if below >= 0.5 {
        inner.survival(x) - above
    } else if above >= 0.5 {
        inner.cdf(y) - below
    } else {
        (0.5 - below) + (0.5 - above)
    }
}

impl<T: InverseCdf> Technique for Truncated<T> {
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        self.inverse_cdf(canonical(xi, 0))
    }

    fn pdf(&self, x: &f64) -> f64 {
        if self.contains(*x) {
            self.inner.pdf(x) / self.mass
        } else {
            0.0
        }
    }

    fn ln_pdf(&self, x: &f64) -> f64 {
        if self.contains(*x) {
            self.inner.ln_pdf(x) - self.mass.ln()
        } else {
            f64::NEG_INFINITY
        }
    }
}

impl<T: InverseCdf> InverseCdf for Truncated<T> {
    fn cdf(&self, x: f64) -> f64 {
        if x.is_nan() {
            return f64::NAN;
        }
        if !self.contains(x) {
            return if x < self.a { 0.0 } else { 1.0 };
        }
        (mass_between(&self.inner, self.a, x) / self.mass).clamp(0.0, 1.0)
    }

    fn inverse_cdf(&self, u: f64) -> f64 {
        if !(0.0..=1.0).contains(&u) {
            return f64::NAN;
        }
        self.split(u, 1.0 - u)
    }

    fn survival(&self, x: f64) -> f64 {
        if x.is_nan() {
            return f64::NAN;
        }
        if !self.contains(x) {
            return if x < self.a { 1.0 } else { 0.0 };
        }
        (mass_between(&self.inner, x, self.b) / self.mass).clamp(0.0, 1.0)
    }

    fn inverse_survival(&self, v: f64) -> f64 {
        if !(0.0..=1.0).contains(&v) {
            return f64::NAN;
        }
        self.split(1.0 - v, v)
    }

    fn support(&self) -> (f64, f64) {
        (self.a, self.b)
    }
}
