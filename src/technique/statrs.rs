//! The continuous distributions of the crate `statrs` as techniques.

use super::{InverseCdf, Technique, canonical, invert};
use crate::error::ArgumentError;
use statrs::distribution::{Continuous, ContinuousCDF};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// 2⁻⁵⁰⁰ and 2⁵⁰⁰: where the library's squares and products neither over- nor underflow.
const SMALL: f64 = f64::from_bits((1023 - 500) << 52);
const LARGE: f64 = f64::from_bits((1023 + 500) << 52);

/// A continuous distribution of the crate `statrs`, with respect to length.
///
/// The distributions are those of `statrs` 0.19, which your crate depends on directly.
///
/// p, ln p, P and 1 - P are `statrs`' functions on the distribution's support, and 0 or 1 beyond
/// it. The inverse is not `statrs`' own, which for several distributions panics at 0 and 1
/// (Laplace), may not end (those of the beta family), or cancels in the upper tail (Pareto, Exp): P
/// is inverted below the median and 1 - P above it, as for
/// [`NumericInverse`](super::NumericInverse).
///
/// ```
/// use mis::technique::{InverseCdf, Statrs, Technique};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let p = Statrs::new(statrs::distribution::Gamma::new(2.0, 3.0)?)?;
/// let x = p.sample(&[0.25]);
/// assert!((p.cdf(x) - 0.25).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
///
/// # Numerics
///
/// For 0 < u < 1, |P(x) - u| at x = P⁻¹(u) is at most 2e-13 + p(x) times the spacing of the floats
/// at x (the outermost floats also take the mass beyond them); tested for every continuous
/// distribution of `statrs` 0.19. The exception is `StudentsT` near its centre, where the library's
/// CDF is a staircase: within |u - 1/2| < 1e-2 the bound is 1e-6 up to 1000 degrees of freedom.
/// Relative to u in the lower tail and to 1 - u in the upper one the bound is 1e-12, where
/// `statrs`' own functions keep that precision: in both tails `Normal`, `LogNormal`, `Gamma`,
/// `Erlang`, `ChiSquared`, `Chi`, `Beta`, `StudentsT`, `Weibull`, `Gumbel`, `Laplace`,
/// `InverseGamma`, `Levy` and `Uniform`; in the lower one `FisherSnedecor`; in the upper one `Exp`
/// and `Pareto`; in neither `Cauchy`. One inversion takes about 5 to 20 evaluations of the CDF: 0.1
/// to 10 µs.
///
/// These bounds are the inverse's; the accuracy of P itself is the library's. The upper tail of its
/// `Normal`, for one, is off by 5e-11 of 1 - P at 8 standard deviations, where
/// [`NumericInverse`](super::NumericInverse) with a better function keeps 1e-15.
///
/// Where `statrs`' pdf is NaN at an end of the support, so is this one: at 0 for
/// `Triangular(0, 1, 0)`. Samples are strictly inside the support, so no sample is such a point.
/// Where it is infinite or NaN inside (the products of `Gamma(99, 0.06)` overflow, those far out in
/// a tail are 0 · ∞), p is exp(ln p), or 0 if that is NaN too and P or 1 - P is 0 there or |x| is
/// not within 2⁻⁵⁰⁰ to 2⁵⁰⁰.
///
/// Where `statrs`' CDF panics (`Gamma`, where x · rate leaves the range of floats), the value is
/// NaN if panics unwind; the search for the inverse does not go there unless the quantile is there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statrs<D> {
    distribution: D,
    a: f64,
    b: f64,
}

impl<D: Continuous<f64, f64> + ContinuousCDF<f64, f64> + Sync> Statrs<D> {
    /// The `distribution` as a technique.
    ///
    /// # Errors
    ///
    /// The support must be an interval, and at most 1e-6 of the mass may lie beyond the floats
    /// that are strictly inside it and between 2⁻⁵⁰⁰ and 2⁵⁰⁰ in magnitude: samples would pile up
    /// on the outermost floats (`Gamma` with shape 0.001; a pole of `Beta` at 1, where the floats
    /// are coarse). At the median and at the outermost samples the density must be finite and
    /// greater than 0 (it is not where `statrs`' products leave the range of floats, as those of
    /// `FisherSnedecor(80, 80)` and `InverseGamma(150, 1)` do).
    pub fn new(distribution: D) -> Result<Self, ArgumentError> {
        let (a, b) = (distribution.min(), distribution.max());
        let ordered = a < b;
        if !ordered {
            let rule = "its first end must be less than its second";
            return Err(ArgumentError::new("Statrs", "support", (a, b), rule));
        }
        let technique = Self { distribution, a, b };
        let first = if a == 0.0 { SMALL } else { a.next_up().max(-LARGE) };
        let last = if b == 0.0 { -SMALL } else { b.next_down().min(LARGE) };
        let (below, above) = (technique.cdf(first), technique.survival(last));
        for (name, mass) in [("cdf", below), ("survival", above)] {
            let small = mass <= 1e-6;
            if !small {
                let x = if name == "cdf" { first } else { last };
                let rule = "it must be at most 1e-6 at the outermost float of the support";
                return Err(ArgumentError::new("Statrs", format!("{name}({x:e})"), mass, rule));
            }
        }
        for xi in [0.0, 0.5, 1.0] {
            let x = technique.sample(&[xi]);
            let p = technique.pdf(&x);
            if !(p > 0.0 && p.is_finite()) {
                let rule = "it must be finite and greater than 0 at a sample";
                return Err(ArgumentError::new("Statrs", format!("pdf({x:e})"), p, rule));
            }
        }
        Ok(technique)
    }

    /// The distribution.
    #[must_use]
    pub fn distribution(&self) -> &D {
        &self.distribution
    }

    fn contains(&self, x: f64) -> bool {
        self.a <= x && x <= self.b && x.is_finite()
    }

    /// p(x) in the support.
    fn density(&self, x: f64) -> f64 {
        let p = self.distribution.pdf(x);
        if p.is_finite() || x == self.a || x == self.b {
            return p;
        }
        // The library's products overflow, and are 0 · inf.
        let p = self.distribution.ln_pdf(x).exp();
        let far = !(SMALL..=LARGE).contains(&x.abs());
        if p.is_nan() && (far || self.cdf(x) == 0.0 || self.survival(x) == 0.0) { 0.0 } else { p }
    }
}

/// `f()` as a probability; NaN where it panics, as the documentation of `statrs` allows it to.
fn probability(f: impl Fn() -> f64) -> f64 {
    catch_unwind(AssertUnwindSafe(f)).unwrap_or(f64::NAN).clamp(0.0, 1.0)
}

impl<D: Continuous<f64, f64> + ContinuousCDF<f64, f64> + Sync> Technique for Statrs<D> {
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        self.inverse_cdf(canonical(xi, 0))
    }

    fn pdf(&self, x: &f64) -> f64 {
        if self.contains(*x) { self.density(*x) } else { 0.0 }
    }

    fn ln_pdf(&self, x: &f64) -> f64 {
        if !self.contains(*x) {
            return f64::NEG_INFINITY;
        }
        let p = self.density(*x);
        if p.is_normal() {
            return p.ln();
        }
        let ln_p = self.distribution.ln_pdf(*x);
        if ln_p.is_nan() { p.ln() } else { ln_p }
    }
}

impl<D: Continuous<f64, f64> + ContinuousCDF<f64, f64> + Sync> InverseCdf for Statrs<D> {
    fn cdf(&self, x: f64) -> f64 {
        if x.is_nan() {
            f64::NAN
        } else if x <= self.a {
            0.0
        } else if x >= self.b {
            1.0
        } else {
            probability(|| self.distribution.cdf(x))
        }
    }

    fn inverse_cdf(&self, u: f64) -> f64 {
        let ends = [self.a, self.b];
        invert::inverse_cdf(u, ends, |x| self.cdf(x), |x| self.survival(x), |x| self.density(x))
    }

    fn survival(&self, x: f64) -> f64 {
        if x.is_nan() {
            f64::NAN
        } else if x <= self.a {
            1.0
        } else if x >= self.b {
            0.0
        } else {
            probability(|| self.distribution.sf(x))
        }
    }

    fn inverse_survival(&self, v: f64) -> f64 {
        let ends = [self.a, self.b];
        invert::inverse_survival(
            v,
            ends,
            |x| self.cdf(x),
            |x| self.survival(x),
            |x| self.density(x),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution as d;

    #[test]
    fn what_the_library_gets_wrong_at_the_edges() {
        let p = Statrs::new(d::Triangular::new(0.0, 1.0, 0.0).unwrap()).unwrap();
        assert!(p.pdf(&0.0).is_nan());
        assert!(p.pdf(&p.sample(&[0.0])) > 1.99);
        // The library's quantile panics at 0 and 1.
        let p = Statrs::new(d::Laplace::new(0.0, 1.0).unwrap()).unwrap();
        assert_eq!(p.support(), (f64::NEG_INFINITY, f64::INFINITY));
        // The library's products are 0 · inf here.
        assert!(d::Gamma::new(2.5, 3.0).unwrap().pdf(1e228).is_nan());
        let p = Statrs::new(d::Gamma::new(2.5, 3.0).unwrap()).unwrap();
        assert_eq!((p.pdf(&1e228), p.pdf(&f64::INFINITY)), (0.0, 0.0));
        assert!(d::InverseGamma::new(2.0, 3.0).unwrap().pdf(1e-277).is_nan());
        let p = Statrs::new(d::InverseGamma::new(2.0, 3.0).unwrap()).unwrap();
        assert_eq!((p.pdf(&1e-277), p.ln_pdf(&1e-277)), (0.0, f64::NEG_INFINITY));
        let p = Statrs::new(d::Gumbel::new(0.0, 1.0).unwrap()).unwrap();
        assert_eq!(
            (p.pdf(&f64::NEG_INFINITY), p.ln_pdf(&f64::NEG_INFINITY)),
            (0.0, f64::NEG_INFINITY)
        );
        // A density that underflows has a logarithm.
        let p = Statrs::new(d::Normal::new(0.0, 1.0).unwrap()).unwrap();
        assert_eq!(p.pdf(&100.0), 0.0);
        assert!((p.ln_pdf(&100.0) + 5_000.918_938_533_205).abs() < 1e-11);
    }

    #[test]
    fn products_of_the_library_that_overflow_inside() {
        for (shape, rate) in [(80.0, 1e-2), (98.5, 0.06), (120.0, 1e-6), (150.0, 1e6)] {
            let library = d::Gamma::new(shape, rate).unwrap();
            let p = Statrs::new(library).unwrap();
            for xi in [0.0, 0.1, 0.5, 0.9, 1.0] {
                let x = p.sample(&[xi]);
                assert!((p.pdf(&x).ln() - library.ln_pdf(x)).abs() < 1e-11, "{shape} {rate} {x}");
            }
        }
        assert_eq!(d::Gamma::new(98.5, 0.06).unwrap().pdf(2300.0), f64::INFINITY);
        // Here the library has no logarithm of its own.
        for error in [
            Statrs::new(d::InverseGamma::new(150.0, 1.0).unwrap()).unwrap_err(),
            Statrs::new(d::FisherSnedecor::new(80.0, 80.0).unwrap()).unwrap_err(),
        ] {
            assert!(error.argument().starts_with("pdf("), "{error}");
            assert_eq!(error.rule(), "it must be finite and greater than 0 at a sample");
        }
    }

    #[test]
    fn the_centre_of_students_t() {
        for freedom in [0.5, 2.0, 8.0, 30.0, 1000.0] {
            let p = Statrs::new(d::StudentsT::new(7.5, 12.0, freedom).unwrap()).unwrap();
            for k in 0..400 {
                let distance = 10_f64.powf(-0.31 - 0.04 * f64::from(k));
                let bound = if distance < 1e-2 { 1e-6 } else { 1e-12 };
                for u in [0.5 - distance, 0.5 + distance] {
                    let off = (p.cdf(p.inverse_cdf(u)) - u).abs();
                    assert!(off <= bound, "{freedom} at {u}: {off:e}");
                }
            }
        }
    }

    #[test]
    fn panics_of_the_library_become_nan() {
        let p = Statrs::new(d::Gamma::new(2.0, 1e-20).unwrap()).unwrap();
        assert!(p.cdf(1e-310).is_nan() && p.survival(1e-310).is_nan());
        assert!((p.cdf(p.inverse_cdf(1e-300)) / 1e-300 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn mass_that_floats_cannot_resolve_is_refused() {
        let error = Statrs::new(d::Gamma::new(0.01, 1.0).unwrap()).unwrap_err();
        assert!(error.argument().starts_with("cdf("), "{error}");
        let error = Statrs::new(d::Beta::new(1.0, 0.1).unwrap()).unwrap_err();
        assert!(error.argument().starts_with("survival("), "{error}");
        assert_eq!(error.rule(), "it must be at most 1e-6 at the outermost float of the support");
        assert!(Statrs::new(d::Beta::new(0.1, 1.0).unwrap()).is_ok());
    }
}
