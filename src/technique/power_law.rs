//! The power law.

use super::elementary::{clamp, ln_sum, times_exp};
use super::exponential::{Decay, Logarithm, Place};
use super::two_sided::{TwoSided, inverse_cdf_by_sides};
use super::{InverseCdf, Technique, batch, canonical};
use crate::error::{ArgumentError, finite, greater};

/// The density proportional to x^a on \[lo, hi\], 0 <= lo < hi, with respect to length.
///
/// With m = a + 1: p(x) = m x^a / (hi^m - lo^m), P(x) = (x^m - lo^m) / (hi^m - lo^m),
/// P⁻¹(u) = (lo^m + u (hi^m - lo^m))^(1/m); at a = -1, p(x) = 1 / (x ln(hi / lo)),
/// P(x) = ln(x / lo) / ln(hi / lo), P⁻¹(u) = lo (hi / lo)^u.
///
/// ```
/// use mis::technique::{InverseCdf, PowerLaw, Technique};
/// # fn main() -> Result<(), mis::ArgumentError> {
/// let p = PowerLaw::new(2.0, 0.0, 1.0)?;
/// assert!((p.sample(&[0.125]) - 0.5).abs() < 1e-15);
/// assert!((p.pdf(&0.5) - 0.75).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
///
/// ln x has the exponential density of rate -m, and everything is computed there: nothing
/// overflows at large exponents, nothing cancels where lo and hi are close, and a = -1 is no
/// special case but the rate 0. The rounding of a logarithm y becomes one of |y| ε (ε = 2⁻⁵²) in
/// x = hi e^(-y), and of |m y| ε in the density of ln x; beyond that, both are within 4 ε.
///
/// For lo = 0 and a close to -1, samples can be smaller than any normal number; they are rounded
/// up to [`f64::MIN_POSITIVE`], and the density at 0 is that of the same number. A part
/// (2.2e-308 / hi)^(a + 1) of all samples is so small: with hi = 1, 1e-31 at a = -0.9, 8e-4 at
/// -0.99 and half at -0.999. Above 1e-6, construction refuses: such samples would bias an estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
#[doc(alias("power", "Pareto", "log-uniform", "reciprocal"))]
pub struct PowerLaw {
    exponent: f64,
    lo: f64,
    hi: f64,
    /// In |ln(x / dense end)|.
    decay: Decay,
    /// The dense end of ln x is ln hi.
    grows: bool,
    /// The dense and the thin end of ln x, and the rate with its sign: what loops need without a
    /// branch.
    near: f64,
    far: f64,
    rate: f64,
    /// The least sample.
    lowest: f64,
}

impl PowerLaw {
    /// The density proportional to x^`exponent` on \[lo, hi\].
    ///
    /// # Errors
    ///
    /// All arguments must be finite, lo >= 0, hi > lo, and hi > 0 a normal number; `exponent`
    /// must be greater than -1 where lo = 0, by enough that at most 1e-6 of the mass lies below the
    /// smallest normal number (-0.98 will do where hi = 1). No density may leave the range of
    /// normal numbers at a sample.
    pub fn new(exponent: f64, lo: f64, hi: f64) -> Result<Self, ArgumentError> {
        finite("PowerLaw", "exponent", exponent)?;
        finite("PowerLaw", "lo", lo)?;
        finite("PowerLaw", "hi", hi)?;
        if !(lo == 0.0 || lo.is_normal() && lo > 0.0) {
            let rule = "it must be 0 or a positive normal number";
            return Err(ArgumentError::new("PowerLaw", "lo", lo, rule));
        }
        greater("PowerLaw", "hi", hi, "lo", lo)?;
        if !hi.is_normal() {
            let rule = "it must be a normal number";
            return Err(ArgumentError::new("PowerLaw", "hi", hi, rule));
        }
        let m = exponent + 1.0;
        if lo == 0.0 && m <= 0.0 {
            let rule = "it must be greater than -1, since lo is 0";
            return Err(ArgumentError::new("PowerLaw", "exponent", exponent, rule));
        }
        let below_normal = -m * ln_ratio(hi, f64::MIN_POSITIVE);
        if lo == 0.0 && below_normal > -6.0 * std::f64::consts::LN_10 {
            let rule = format!(
                "{:.1e} of the mass lies below the smallest normal number; at most 1e-6 may",
                below_normal.exp()
            );
            return Err(ArgumentError::new("PowerLaw", "exponent", exponent, rule));
        }
        let width = if lo == 0.0 { f64::INFINITY } else { ln_ratio(hi, lo) };
        let decay = Decay::new(m.abs(), width);
        let grows = m > 0.0;
        let (near, far) = if grows { (hi, lo) } else { (lo, hi) };
        let lowest = lo.max(f64::MIN_POSITIVE);
        let this = Self { exponent, lo, hi, decay, grows, near, far, rate: -m, lowest };
        let samples = [0.0, 1.0].map(|xi| this.sample(&[xi]));
        if ![samples[0], samples[1], this.edge()].iter().all(|x| this.pdf(x).is_normal()) {
            let rule = "the densities of samples must be within the range of normal numbers";
            return Err(ArgumentError::new("PowerLaw", "exponent", exponent, rule));
        }
        Ok(this)
    }

    /// The distances of ln x to the dense and to the thin end.
    fn distances(&self, x: f64) -> (f64, f64) {
        let x = x.clamp(self.lo, self.hi).abs(); // -0 is 0
        let (below, above) = (ln_ratio(x, self.lo), ln_ratio(self.hi, x));
        if self.grows { (above, below) } else { (below, above) }
    }

    /// The end where ln x is dense.
    fn edge(&self) -> f64 {
        if self.grows { self.hi } else { self.lo }
    }

    /// The density; NaN where a factor of it leaves the range.
    #[inline(always)]
    fn density(&self, x: f64) -> f64 {
        let inside = (self.lo <= x) & (x <= self.hi);
        let x = if x < f64::MIN_POSITIVE { f64::MIN_POSITIVE } else { x };
        let larger = if self.grows { self.hi } else { x };
        let smaller = if self.grows { x } else { self.lo };
        // `ln_ratio` in one logarithm.
        let (excess, ratio) = ((larger - smaller) / smaller, larger / smaller);
        let near = excess < 1.0;
        let lost = if near { excess - ((1.0 + excess) - 1.0) } else { 0.0 };
        let distance = ln_sum(if near { 1.0 + excess } else { ratio }, lost);
        let in_ln_x = self.decay.density(distance);
        let sound = (in_ln_x >= f64::MIN_POSITIVE) & (ratio < f64::INFINITY);
        let p = if sound { in_ln_x / x } else { f64::NAN };
        if inside { p } else { 0.0 }
    }

    /// The density where a factor of it leaves the range.
    fn far_density(&self, x: f64) -> f64 {
        let x = x.max(f64::MIN_POSITIVE);
        let in_ln_x = self.decay.density(self.distances(x).0);
        if in_ln_x.is_normal() {
            return in_ln_x / x;
        }
        // The density of ln x has underflown, that of x need not have: by the root of x^a.
        let root = (0.5 * self.ln_power(x)).exp();
        self.decay.density(0.0) * root / self.edge() * root
    }

    /// [`place`](TwoSided::place) by the logarithm of a mass.
    #[inline(always)]
    fn in_lanes(&self, logarithm: &Logarithm, below: f64, above: f64) -> f64 {
        let grows = self.grows;
        let dense = if grows { above } else { below };
        let thin = if grows { below } else { above };
        let (y, from_thin) = logarithm.place(dense, thin);
        let end = if from_thin { self.far } else { self.near };
        clamp(times_exp(end, y / self.rate), self.lowest, self.hi)
    }

    /// ln((x / edge)^a).
    fn ln_power(&self, x: f64) -> f64 {
        let distance = self.distances(x).0;
        if self.grows { -self.exponent * distance } else { self.exponent * distance }
    }

    /// lo e^y. The larger y is taken in two steps: e^y may overflow where lo e^y does not.
    fn up(&self, y: f64) -> f64 {
        if y < 1.0 {
            self.lo + self.lo * y.exp_m1()
        } else {
            let half = (0.5 * y).exp();
            self.lo * half * half
        }
    }

    /// hi e^(-y).
    fn down(&self, y: f64) -> f64 {
        if y < 1.0 {
            self.hi + self.hi * (-y).exp_m1()
        } else {
            let half = (-0.5 * y).exp();
            self.hi * half * half
        }
    }
}

/// ln(x / y) for x >= y >= 0.
fn ln_ratio(x: f64, y: f64) -> f64 {
    if x == y {
        return 0.0; // both may be 0
    }
    let ratio = x / y;
    if ratio < 2.0 {
        ((x - y) / y).ln_1p()
    } else if ratio == f64::INFINITY {
        x.ln() - y.ln()
    } else {
        ratio.ln()
    }
}

impl Technique for PowerLaw {
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        self.inverse_cdf(canonical(xi, 0))
    }

    fn pdf(&self, x: &f64) -> f64 {
        batch::one(*x, |x| self.density(x), |x| self.far_density(x))
    }

    fn ln_pdf(&self, x: &f64) -> f64 {
        if !(self.lo <= *x && *x <= self.hi) {
            return f64::NEG_INFINITY;
        }
        // Where x is huge or tiny, the logarithms of the two factors cancel.
        let p = self.pdf(x);
        if p.is_normal() {
            return p.ln();
        }
        let x = x.max(f64::MIN_POSITIVE);
        self.decay.ln_density(self.distances(x).0) - x.ln()
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<f64>) {
        batch::sample(self, xi, xs);
    }

    fn pdf_batch(&self, xs: &[f64], out: &mut [f64]) {
        let this = *self; // which no write to `out` can change
        batch::map(xs, out, move |x| this.density(x), |x| self.far_density(x));
    }
}

impl TwoSided for PowerLaw {
    fn ends(&self) -> (f64, f64) {
        (self.lo, self.hi)
    }

    fn masses(&self, x: f64) -> (f64, f64) {
        let (dense, thin) = self.distances(x);
        let (dense, thin) = self.decay.masses(dense, thin);
        if self.grows { (thin, dense) } else { (dense, thin) }
    }

    fn place(&self, below: f64, above: f64) -> f64 {
        if let Some(logarithm) = self.decay.logarithm_of(below, above) {
            return self.in_lanes(logarithm, below, above);
        }
        let (dense, thin) = if self.grows { (above, below) } else { (below, above) };
        let x = match (self.decay.place(dense, thin), self.grows) {
            (Place::Dense(y), true) | (Place::Thin(y), false) => self.down(y),
            (Place::Dense(y), false) | (Place::Thin(y), true) => self.up(y),
        };
        x.clamp(self.lowest, self.hi)
    }

    fn places(&self, xi: &[f64], xs: &mut [f64]) {
        match self.decay.logarithm {
            Some(l) => {
                let this = *self; // which no write to `xs` can change
                batch::places(xi, xs, move |u| this.in_lanes(&l, u, 1.0 - u));
            }
            None => batch::places(xi, xs, |u| self.place(u, 1.0 - u)),
        }
    }
}

inverse_cdf_by_sides!(PowerLaw);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_arguments_are_named() {
        for ((exponent, lo, hi), message) in [
            ((f64::NAN, 0.0, 1.0), "PowerLaw: `exponent` is NaN, but it must be finite"),
            ((1.0, 0.0, f64::INFINITY), "PowerLaw: `hi` is inf, but it must be finite"),
            (
                (1.0, -1.0, 1.0),
                "PowerLaw: `lo` is -1.0, but it must be 0 or a positive normal number",
            ),
            ((1.0, 2.0, 1.0), "PowerLaw: `hi` is 1.0, but it must be greater than lo = 2"),
            (
                (-1.0, 0.0, 1.0),
                "PowerLaw: `exponent` is -1.0, but it must be greater than -1, since lo is 0",
            ),
            (
                (1e10, 0.0, 1e-300),
                "PowerLaw: `exponent` is 10000000000.0, but the densities of samples must be \
                 within the range of normal numbers",
            ),
        ] {
            assert_eq!(PowerLaw::new(exponent, lo, hi).unwrap_err().to_string(), message);
        }
    }

    #[test]
    fn the_density_does_not_underflow_before_its_value_does() {
        let p = PowerLaw::new(1.0, 0.0, 1.0).unwrap();
        assert!((p.pdf(&1e-200) / 2e-200 - 1.0).abs() < 1e-12);
        let p = PowerLaw::new(-0.1, 0.0, 1e300).unwrap();
        let expected = 0.9 * 1e-270 * 1e30;
        assert!((p.pdf(&1e-300) / expected - 1.0).abs() < 1e-12);
    }

    #[test]
    fn negative_zero_is_zero() {
        let p = PowerLaw::new(1.0, 0.0, 2.0).unwrap();
        assert_eq!((p.cdf(-0.0), p.survival(-0.0)), (0.0, 1.0));
        assert_eq!(p.pdf(&-0.0), p.pdf(&0.0));
    }

    #[test]
    fn samples_do_not_underflow_to_a_point_of_infinite_density() {
        let p = PowerLaw::new(-0.98, 0.0, 1.0).unwrap();
        let x = p.sample(&[1e-12]);
        assert_eq!(x, f64::MIN_POSITIVE);
        assert!(p.pdf(&x).is_finite());
        // More than 1e-6 of the samples so small would be a bias.
        let error = PowerLaw::new(-0.99, 0.0, 1.0).unwrap_err();
        assert_eq!((error.argument(), error.value()), ("exponent", "-0.99"));
        assert!(error.rule().contains("8.4e-4 of the mass"), "{error}");
        assert!(PowerLaw::new(-0.99, 0.0, 1e-200).is_err());
        assert!(PowerLaw::new(-0.99, 1e-300, 1.0).is_ok());
    }
}
