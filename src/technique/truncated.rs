//! A technique on the line, restricted to an interval.

use super::{InverseCdf, Technique, canonical};
use crate::error::{ArgumentError, greater};

/// The density of a technique T restricted to \[a, b\], with respect to length.
///
/// With g and G the density and the CDF of T and m = G(b) - G(a): p(x) = g(x) / m on \[a, b\],
/// P(x) = (G(x) - G(a)) / m and P⁻¹(u) = G⁻¹(G(a) + u m).
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
/// Where T's round trip is exact to ε, |P(P⁻¹(u)) - u| is at most 8 ε max(1, M / m) + p(x) times
/// the spacing of the floats at x; a larger bound of T grows by the same factor. Construction
/// refuses m < 2⁻³⁰ M. For a narrow interval of a smooth density another proposal is better: the
/// uniform one, a table, or a type made for it. An end that lies in a gap of T's support can be
/// sampled, at canonical numbers within rounding of 0 or 1; put ends where T has a density.
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
        let given = [a, b];
        let (a, b) = (a.max(low), b.min(high));
        let mass = if a < b { mass_between(&inner, a, b) } else { 0.0 };
        let (below, above) = (inner.cdf(a), inner.survival(b));
        let (not_above, not_below) = (inner.cdf(b), inner.survival(a));
        let larger = not_above.min(not_below).min(0.5);
        if !(mass.is_normal() && mass > 0.0 && mass >= larger * 2.0_f64.powi(-30)) {
            let rule = if a < b {
                format!(
                    "the mass there is {mass:e}; it must be a normal number, and at least 2^-30 of the \
                     mass that it is a difference of, {larger:e}"
                )
            } else {
                format!("it must overlap the support, [{low:?}, {high:?}]")
            };
            return Err(ArgumentError::new("Truncated", "[a, b]", given, rule));
        }
        Ok(Self { inner, a, b, below, above, not_above, not_below, mass })
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
            if part <= rest { base + part * self.mass } else { far - rest * self.mass }
        };
        // From the nearer end, so that neither is overshot by more than rounding.
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
        if self.contains(*x) { self.inner.pdf(x) / self.mass } else { 0.0 }
    }

    fn ln_pdf(&self, x: &f64) -> f64 {
        let p = self.pdf(x);
        if p.is_normal() {
            p.ln()
        } else if self.contains(*x) {
            self.inner.ln_pdf(x) - self.mass.ln()
        } else {
            f64::NEG_INFINITY
        }
    }

    fn pdf_batch(&self, xs: &[f64], out: &mut [f64]) {
        self.inner.pdf_batch(xs, out);
        for (p, x) in out.iter_mut().zip(xs) {
            let inside = (self.a <= *x) & (*x <= self.b);
            *p = if inside { *p / self.mass } else { 0.0 };
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
        if u == 0.0 {
            self.a
        } else if u == 1.0 {
            self.b
        } else {
            self.split(u, 1.0 - u)
        }
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
        if v == 0.0 {
            self.b
        } else if v == 1.0 {
            self.a
        } else {
            self.split(1.0 - v, v)
        }
    }

    fn support(&self) -> (f64, f64) {
        (self.a, self.b)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{NumericInverse, PiecewiseConstant, Uniform};
    use super::*;
    use std::f64::consts::{FRAC_1_PI, FRAC_1_SQRT_2};

    type Normal = NumericInverse<fn(f64) -> f64, fn(f64) -> f64, fn(f64) -> f64>;

    fn normal(a: f64, b: f64) -> Result<Truncated<Normal>, ArgumentError> {
        let whole = [f64::NEG_INFINITY, f64::INFINITY];
        let pdf: fn(f64) -> f64 = |x| (-0.5 * x * x).exp() * (0.5 * FRAC_1_PI).sqrt();
        let cdf: fn(f64) -> f64 = |x| 0.5 * libm::erfc(-x * FRAC_1_SQRT_2);
        let survival: fn(f64) -> f64 = |x| 0.5 * libm::erfc(x * FRAC_1_SQRT_2);
        Truncated::new(NumericInverse::new(whole, pdf, cdf)?.with_survival(survival), a, b)
    }

    #[test]
    fn either_tail_keeps_its_precision() {
        // P(8 < Z < 9) to 17 digits, from erfc in arbitrary precision.
        let mass = 6.219_831_985_865_83e-16;
        let (upper, lower) = (normal(8.0, 9.0).unwrap(), normal(-9.0, -8.0).unwrap());
        assert!((upper.mass() / mass - 1.0).abs() < 1e-13, "{:e}", upper.mass());
        assert!((lower.mass() / mass - 1.0).abs() < 1e-13, "{:e}", lower.mass());
        // The density is 8.1 at the end towards 0, where floats are 1.8e-15 apart.
        let grain = 8.2 * (8.0_f64.next_up() - 8.0);
        for u in [1e-12, 1e-3, 0.25, 0.5, 0.75, 0.999] {
            for p in [&upper as &dyn InverseCdf, &lower] {
                let x = p.inverse_cdf(u);
                assert!((p.cdf(x) - u).abs() < 2.0 * grain, "{u}: {:e}", p.cdf(x) - u);
                let x = p.inverse_survival(u);
                assert!((p.survival(x) - u).abs() < 2.0 * grain, "{u}");
            }
            let (x, y) = (upper.inverse_cdf(u), lower.inverse_survival(u));
            assert!((x + y).abs() < 1e-13, "mirror images {x} {y}");
        }
    }

    #[test]
    fn across_the_median_both_sides_are_used() {
        let p = normal(-1.0, f64::INFINITY).unwrap();
        assert_eq!(p.support(), (-1.0, f64::INFINITY));
        for v in [0.9, 0.5, 1e-3, 1e-20, 1e-100] {
            let x = p.inverse_survival(v);
            assert!((p.survival(x) / v - 1.0).abs() < 1e-12, "{v:e}");
        }
        let whole = normal(f64::NEG_INFINITY, f64::INFINITY).unwrap();
        assert_eq!(whole.mass(), 1.0);
        assert_eq!(whole.pdf(&0.3), whole.inner().pdf(&0.3));
        for u in [0.0, 1.0] {
            assert!(whole.sample(&[u]).is_finite());
        }
    }

    #[test]
    fn the_stated_bound() {
        for (a, width) in [(-2.0, 1e-3), (-0.1, 1e-2), (-0.1, 1e-6), (0.5, 0.1), (1.0, 7.0)] {
            let p = normal(a, a + width).unwrap();
            let factor = p.not_above.min(p.not_below).min(0.5) / p.mass();
            for k in 1..1000 {
                let u = f64::from(k) / 1000.0;
                let x = p.inverse_cdf(u);
                let grain = p.pdf(&x) * (x.abs().next_up() - x.abs());
                let off = (p.cdf(x) - u).abs();
                assert!(off <= 8.0 * f64::EPSILON * factor.max(1.0) + grain, "{a} {u}: {off:e}");
            }
        }
    }

    #[test]
    fn the_ends_are_exact_and_the_rest_is_outside() {
        let p = Truncated::new(Uniform::new(0.0, 10.0).unwrap(), 2.0, 4.5).unwrap();
        assert_eq!((p.inverse_cdf(0.0), p.inverse_cdf(1.0)), (2.0, 4.5));
        assert_eq!((p.inverse_survival(0.0), p.inverse_survival(1.0)), (4.5, 2.0));
        assert_eq!(
            (p.cdf(2.0), p.cdf(4.5), p.survival(2.0), p.survival(4.5)),
            (0.0, 1.0, 1.0, 0.0)
        );
        assert_eq!((p.pdf(&1.9), p.pdf(&4.6), p.ln_pdf(&1.9)), (0.0, 0.0, f64::NEG_INFINITY));
        assert_eq!(
            (p.cdf(1.0), p.cdf(9.0), p.survival(1.0), p.survival(9.0)),
            (0.0, 1.0, 1.0, 0.0)
        );
        assert!((p.pdf(&3.0) - 0.4).abs() < 1e-15 && (p.ln_pdf(&3.0) - 0.4_f64.ln()).abs() < 1e-15);
        // An interval that sticks out is cut to the support.
        let p = Truncated::new(Uniform::unit(), -3.0, 0.5).unwrap();
        assert_eq!((p.support(), p.mass()), ((0.0, 0.5), 0.5));
        for u in [f64::NAN, -0.1, 1.1] {
            assert!(p.inverse_cdf(u).is_nan() && p.inverse_survival(u).is_nan());
        }
        assert!(
            p.sample(&[]).is_nan() && p.cdf(f64::NAN).is_nan() && p.survival(f64::NAN).is_nan()
        );
    }

    #[test]
    fn errors_name_argument_value_and_rule() {
        let unit = |a, b| Truncated::new(Uniform::unit(), a, b).unwrap_err().to_string();
        assert_eq!(unit(1.0, 0.5), "Truncated: `b` is 0.5, but it must be greater than a = 1");
        assert!(unit(f64::NAN, 1.0).contains("`a` is NaN"));
        assert!(unit(0.0, f64::NAN).contains("`b` is NaN"));
        assert!(unit(2.0, 3.0).contains("`[a, b]` is [2.0, 3.0], but it must overlap"));
        assert!(unit(0.3, 0.3 + 1e-12).contains("2^-30 of"));
        assert!(
            normal(40.0, 41.0)
                .unwrap_err()
                .to_string()
                .contains("`[a, b]` is [40.0, 41.0], but the mass")
        );
        let gap = PiecewiseConstant::new(&[0.0, 1.0, 2.0, 3.0], &[1.0, 0.0, 1.0]).unwrap();
        let error = Truncated::new(gap, 1.25, 1.75).unwrap_err();
        assert_eq!((error.argument(), error.value()), ("[a, b]", "[1.25, 1.75]"));
    }
}
