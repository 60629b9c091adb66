//! The continuous distributions of the crate `statrs` as techniques.

use super::invert::{Side, invert};
use super::{InverseCdf, Technique, canonical};
use crate::error::ArgumentError;
use statrs::distribution::{Continuous, ContinuousCDF};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// 2⁻⁵⁰⁰ and 2⁵⁰⁰: where the library's squares and products neither over- nor underflow.
const SMALL: f64 = f64::from_bits((1023 - 500) << 52);
const LARGE: f64 = f64::from_bits((1023 + 500) << 52);

/// A continuous distribution of the crate `statrs`, with respect to length.
///
/// p, ln p, P and 1 - P are `statrs`' functions on the distribution's support, and 0 or 1 beyond it.
/// The inverse is not `statrs`' own, which for several distributions panics at 0 and 1 (Laplace),
/// may not end (those of the beta family), or cancels in the upper tail (Pareto, Exp): P is inverted
/// below the median and 1 - P above it, as for [`NumericInverse`](super::NumericInverse).
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
/// For 0 < u < 1, |P(x) - u| at x = P⁻¹(u) is at most 2e-13 + p(x) times the spacing of the floats at
/// x (the outermost floats also take the mass beyond them); tested for every continuous distribution
/// of `statrs` 0.19. Relative to u in the lower tail and
/// to 1 - u in the upper one the bound is 1e-12, where `statrs`' own functions keep that precision:
/// in both tails `Normal`, `LogNormal`, `Gamma`, `Erlang`, `ChiSquared`, `Chi`, `Beta`, `StudentsT`,
/// `Weibull`, `Gumbel`, `Laplace`, `InverseGamma`, `Levy` and `Uniform`; in the lower one
/// `FisherSnedecor`; in the upper one `Exp` and `Pareto`; in neither `Cauchy`. One inversion takes
/// about 5 to 20 evaluations of the CDF: 0.1 to 10 µs.
///
/// Where `statrs`' pdf is NaN at an end of the support, so is this one: at 0 for
/// `Triangular(0, 1, 0)`. Samples are strictly inside the support, so no sample is such a point. Where
/// it is NaN inside, as 0 · ∞ far out in a tail, p is exp(ln p), or 0 if that is NaN too and P or
/// 1 - P is 0 there or |x| is not within 2⁻⁵⁰⁰ to 2⁵⁰⁰.
///
/// Where `statrs`' CDF panics (`Gamma`, where x · rate leaves the range of floats), the value is NaN
/// if panics unwind; the search for the inverse does not go there unless the quantile is there.
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
    /// are coarse).
    pub fn new(distribution: D) -> Result<Self, ArgumentError> {
        let (a, b) = (distribution.min(), distribution.max());
        if !(a < b) {
            let rule = "its first end must be less than its second";
            return Err(ArgumentError::new("Statrs", "support", (a, b), rule));
        }
        let technique = Self { distribution, a, b };
        let (small, large) = (2.0_f64.powi(-500), 2.0_f64.powi(500));
        let first = if a == 0.0 {
            small
        } else {
            a.next_up().max(-large)
        };
        let last = if b == 0.0 {
            -small
        } else {
            b.next_down().min(large)
        };
        let (below, above) = (technique.cdf(first), technique.survival(last));
        for (name, mass) in [("cdf", below), ("survival", above)] {
            if !(mass <= 1e-6) {
                let x = if name == "cdf" { first } else { last };
                let rule = "it must be at most 1e-6 at the outermost float of the support";
                return Err(ArgumentError::new(
                    "Statrs",
                    format!("{name}({x:e})"),
                    mass,
                    rule,
                ));
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
        if !p.is_nan() || x == self.a || x == self.b {
            return p;
        }
        // Far out, the library's products are 0 · inf.
        let p = self.distribution.ln_pdf(x).exp();
        if p.is_nan() && (self.cdf(x) == 0.0 || self.survival(x) == 0.0) {
            0.0
        } else {
            p
        }
    }

    fn from_below(&self, u: f64) -> f64 {
        invert(
            Side::Lower,
            u,
            [self.a, self.b],
            |x| self.cdf(x),
            |x| self.density(x),
        )
    }

    fn from_above(&self, v: f64) -> f64 {
        invert(
            Side::Upper,
            v,
            [self.a, self.b],
            |x| self.survival(x),
            |x| self.density(x),
        )
    }
}

/// `f()` as a probability; NaN where it panics, as the documentation of `statrs` allows it to.
fn probability(f: impl Fn() -> f64) -> f64 {
    catch_unwind(AssertUnwindSafe(f))
        .unwrap_or(f64::NAN)
        .clamp(0.0, 1.0)
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
        if self.contains(*x) {
            self.density(*x)
        } else {
            0.0
        }
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
        if u == 0.0 {
            self.a
        } else if u == 1.0 {
            self.b
        } else if !(0.0..=1.0).contains(&u) {
            f64::NAN
        } else if u <= 0.5 {
            self.from_below(u)
        } else {
            self.from_above(1.0 - u)
        }
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
        if v == 0.0 {
            self.b
        } else if v == 1.0 {
            self.a
        } else if !(0.0..=1.0).contains(&v) {
            f64::NAN
        } else if v < 0.5 {
            self.from_above(v)
        } else {
            self.from_below(1.0 - v)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution as d;

    const LARGEST: f64 = 1.0 - f64::EPSILON / 2.0;

    fn zoo() -> Vec<(&'static str, Box<dyn InverseCdf>)> {
        macro_rules! zoo {
            ($($name:literal $e:expr),* $(,)?) => {
                vec![$(($name, Box::new(Statrs::new($e.unwrap()).unwrap()) as Box<dyn InverseCdf>)),*]
            };
        }
        zoo![
            "Normal" d::Normal::new(1.0, 2.0),
            "LogNormal" d::LogNormal::new(0.5, 1.5),
            "Gamma" d::Gamma::new(2.5, 3.0),
            "Gamma(0.3)" d::Gamma::new(0.3, 1.0),
            "Gamma(200)" d::Gamma::new(200.0, 0.01),
            "Erlang" d::Erlang::new(4, 2.0),
            "Exp" d::Exp::new(0.5),
            "ChiSquared" d::ChiSquared::new(3.0),
            "Chi" d::Chi::new(4),
            "Beta" d::Beta::new(2.0, 5.0),
            "Beta(0.5, 0.5)" d::Beta::new(0.5, 0.5),
            "StudentsT" d::StudentsT::new(0.5, 2.0, 3.0),
            "FisherSnedecor" d::FisherSnedecor::new(5.0, 7.0),
            "Weibull" d::Weibull::new(1.5, 2.0),
            "Gumbel" d::Gumbel::new(1.0, 2.0),
            "Laplace" d::Laplace::new(-1.0, 3.0),
            "Triangular" d::Triangular::new(0.0, 2.0, 0.5),
            "Triangular at a" d::Triangular::new(0.0, 1.0, 0.0),
            "Triangular at b" d::Triangular::new(0.0, 1.0, 1.0),
            "Pareto" d::Pareto::new(2.0, 1.5),
            "InverseGamma" d::InverseGamma::new(2.0, 3.0),
            "Levy" d::Levy::new(0.0, 1.0),
            "Cauchy" d::Cauchy::new(0.0, 2.0),
            "Uniform" d::Uniform::new(-1.0, 3.0),
        ]
    }

    /// How far `tail(x)` is from `target`, beyond what the spacing of the floats at x explains.
    fn miss(p: &dyn InverseCdf, tail: f64, target: f64, x: f64) -> f64 {
        let (a, b) = p.support();
        if x.next_down() <= a || x.next_up() >= b {
            return 0.0;
        }
        let grain = p.pdf(&x) * (x.abs().next_up() - x.abs());
        ((tail - target).abs() - grain).max(0.0)
    }

    #[test]
    fn the_inverse_meets_its_bound() {
        for (name, p) in zoo() {
            let grid = (1..1000).map(|k| f64::from(k) / 1000.0);
            for u in grid.chain([1e-300, 1e-100, 1e-20, 1e-10, 1.0 - 1e-10, LARGEST]) {
                let x = p.inverse_cdf(u);
                let off = miss(&p, p.cdf(x), u, x);
                assert!(off <= 2e-13, "{name}: u = {u:e}, x = {x:e}: off by {off:e}");
                let x = p.inverse_survival(u);
                let off = miss(&p, p.survival(x), u, x);
                assert!(off <= 2e-13, "{name}: v = {u:e}, x = {x:e}: off by {off:e}");
            }
        }
    }

    #[test]
    fn tails_are_as_precise_as_the_library() {
        const LOWER: &[&str] = &[
            "Exp",
            "Beta(0.5, 0.5)",
            "Triangular at a",
            "Triangular at b",
            "Pareto",
            "Cauchy",
        ];
        const UPPER: &[&str] = &[
            "Beta(0.5, 0.5)",
            "FisherSnedecor",
            "Triangular at a",
            "Triangular at b",
            "Cauchy",
        ];
        for (name, p) in zoo() {
            for e in [
                3.0, 5.0, 8.3, 12.0, 16.0, 25.0, 40.0, 80.0, 150.0, 230.5, 300.0,
            ] {
                let v = 10_f64.powf(-e);
                if !LOWER.contains(&name) {
                    let x = p.inverse_cdf(v);
                    let off = miss(&p, p.cdf(x), v, x) / v;
                    assert!(
                        off <= 1e-12,
                        "{name}: u = {v:e}, x = {x:e}: off by {off:e} u"
                    );
                }
                if !UPPER.contains(&name) {
                    let x = p.inverse_survival(v);
                    let off = miss(&p, p.survival(x), v, x) / v;
                    assert!(
                        off <= 1e-12,
                        "{name}: v = {v:e}, x = {x:e}: off by {off:e} v"
                    );
                }
            }
        }
    }

    #[test]
    fn every_sample_is_inside_and_has_a_density() {
        for (name, p) in zoo() {
            let (a, b) = p.support();
            for u in [
                0.0,
                5e-324,
                1e-300,
                2.0_f64.powi(-54),
                0.1,
                0.5,
                0.9,
                LARGEST,
                1.0,
            ] {
                let x = p.sample(&[u]);
                assert!(
                    a < x && x < b && x.is_finite(),
                    "{name}: u = {u:e}: x = {x:e}"
                );
                assert!(
                    p.pdf(&x) > 0.0 && p.pdf(&x).is_finite(),
                    "{name}: u = {u:e}: x = {x:e}"
                );
                assert!((p.ln_pdf(&x) - p.pdf(&x).ln()).abs() < 1e-13, "{name}");
            }
            for u in [-1.0, 2.0, f64::NAN] {
                assert!(p.inverse_cdf(u).is_nan() && p.inverse_survival(u).is_nan());
            }
            assert!(p.sample(&[]).is_nan() && p.cdf(f64::NAN).is_nan() && p.pdf(&f64::NAN) == 0.0);
        }
    }

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
        assert_eq!(
            (p.pdf(&1e-277), p.ln_pdf(&1e-277)),
            (0.0, f64::NEG_INFINITY)
        );
        let p = Statrs::new(d::Gumbel::new(0.0, 1.0).unwrap()).unwrap();
        assert_eq!(
            (p.pdf(&f64::NEG_INFINITY), p.ln_pdf(&f64::NEG_INFINITY)),
            (0.0, f64::NEG_INFINITY)
        );
        // A density that underflows has a logarithm.
        let p = Statrs::new(d::Normal::new(0.0, 1.0).unwrap()).unwrap();
        assert_eq!(p.pdf(&100.0), 0.0);
        assert!((p.ln_pdf(&100.0) + 5000.918_938_533_204_5).abs() < 1e-11);
    }

    #[test]
    fn mass_that_floats_cannot_resolve_is_refused() {
        let error = Statrs::new(d::Gamma::new(0.01, 1.0).unwrap()).unwrap_err();
        assert!(error.argument().starts_with("cdf("), "{error}");
        let error = Statrs::new(d::Beta::new(1.0, 0.1).unwrap()).unwrap_err();
        assert!(error.argument().starts_with("survival("), "{error}");
        assert_eq!(
            error.rule(),
            "it must be at most 1e-6 at the outermost float of the support"
        );
        assert!(Statrs::new(d::Beta::new(0.1, 1.0).unwrap()).is_ok());
    }
}
