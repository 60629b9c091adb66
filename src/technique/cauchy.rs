//! The Cauchy density on the whole line.

use super::elementary::tan_pi;
use super::{InverseCdf, Technique, batch, canonical};
use crate::error::{ArgumentError, finite, positive};
use std::f64::consts::{FRAC_1_PI, PI};

/// The Cauchy density on the whole line, with respect to length.
///
/// With z = (x - x₀) / γ: p(x) = 1 / (π γ (1 + z²)), P(x) = 1/2 + atan(z) / π,
/// P⁻¹(u) = x₀ + γ tan(π (u - 1/2)). In physics it is the Breit-Wigner or Lorentz line of full
/// width 2 γ at half maximum.
///
/// ```
/// use mis::technique::{Cauchy, InverseCdf, Technique};
/// # fn main() -> Result<(), mis::ArgumentError> {
/// let p = Cauchy::new(1.0, 2.0)?;
/// assert_eq!(p.cdf(1.0), 0.5);
/// assert!((p.cdf(3.0) - 0.75).abs() < 1e-15);
/// assert!((p.survival(1e300) / 6.366_197_723_675_814e-301 - 1.0).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
///
/// Tails are taken as angles from their own end, P(x) = atan2(γ, x₀ - x) / π and
/// P⁻¹(u) = x₀ - γ / tan(π u), without subtracting from 1/2. Distances of samples from x₀, and
/// densities, are within 4 ε (ε = 2⁻⁵²) of the formulas in `std`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[doc(alias("Breit-Wigner", "Lorentz", "Lorentzian"))]
pub struct Cauchy {
    location: f64,
    scale: f64,
}

impl Cauchy {
    /// The Cauchy density around `location` = x₀ with the half width `scale` = γ.
    ///
    /// # Errors
    ///
    /// `location` must be finite, `scale` finite and greater than 0, and no sample and no density
    /// at a sample may leave the range of normal numbers.
    pub fn new(location: f64, scale: f64) -> Result<Self, ArgumentError> {
        finite("Cauchy", "location", location)?;
        positive("Cauchy", "scale", scale)?;
        let this = Self { location, scale };
        representable("Cauchy", scale, &this, location)?;
        Ok(this)
    }

    /// The inverse CDF: the angle from the peak up to π/4, beyond from the end that is nearer.
    #[inline]
    fn place(&self, u: f64) -> f64 {
        let (inner, outer) = (u - 0.5, if u < 0.5 { -u } else { 1.0 - u });
        let central = inner.abs() <= 0.25;
        let [sine, cosine] = tan_pi(if central { inner } else { outer });
        let tan = if central { sine / cosine } else { cosine / sine };
        self.location + self.scale * tan
    }
}

/// The peak and the outermost samples must have normal densities.
pub(super) fn representable(
    owner: &'static str,
    scale: f64,
    p: &impl Technique<Point = f64>,
    peak: f64,
) -> Result<(), ArgumentError> {
    let points = [p.sample(&[0.0]), peak, p.sample(&[1.0])];
    if points.iter().all(|x| x.is_finite() && p.pdf(x).is_normal()) {
        return Ok(());
    }
    let rule = "samples and their densities must be within the range of normal numbers";
    Err(ArgumentError::new(owner, "scale", scale, rule))
}

/// 1 / (angle γ (1 + z²)) at the distance `dx` = γ z from the peak.
pub(super) fn density(dx: f64, scale: f64, angle: f64) -> f64 {
    // By the ratio of dx and γ that is at most 1: z² may overflow.
    let far = dx.abs() > scale;
    let larger = if far { dx.abs() } else { scale };
    let ratio = if far { scale } else { dx.abs() } / larger;
    let share = if far { ratio } else { 1.0 };
    share * angle.recip() / (larger * (1.0 + ratio * ratio))
}

/// ln of [`density`], where that is not a normal number.
pub(super) fn ln_density(dx: f64, scale: f64, angle: f64) -> f64 {
    scale.ln() - angle.ln() - 2.0 * dx.hypot(scale).ln()
}

impl Technique for Cauchy {
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        self.inverse_cdf(canonical(xi, 0))
    }

    fn pdf(&self, x: &f64) -> f64 {
        density(x - self.location, self.scale, PI)
    }

    fn ln_pdf(&self, x: &f64) -> f64 {
        let p = self.pdf(x);
        if p.is_normal() { p.ln() } else { ln_density(x - self.location, self.scale, PI) }
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<f64>) {
        batch::sample(self, xi, xs);
    }
}

impl InverseCdf for Cauchy {
    fn cdf(&self, x: f64) -> f64 {
        self.scale.atan2(self.location - x) * FRAC_1_PI
    }

    fn inverse_cdf(&self, u: f64) -> f64 {
        if !(0.0..=1.0).contains(&u) {
            return f64::NAN;
        }
        self.place(u)
    }

    fn survival(&self, x: f64) -> f64 {
        self.scale.atan2(x - self.location) * FRAC_1_PI
    }

    fn inverse_survival(&self, v: f64) -> f64 {
        if v >= 0.25 {
            return self.inverse_cdf(1.0 - v);
        }
        if !(0.0..=1.0).contains(&v) {
            return f64::NAN;
        }
        self.location + self.scale / (PI * v).tan()
    }

    fn sample_slice(&self, xi: &[f64], xs: &mut [f64]) {
        let this = *self; // which no write to `xs` can change
        batch::places(xi, xs, move |u| this.place(u));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ln_pdf_outlives_the_density() {
        let p = Cauchy::new(0.0, 1e-300).unwrap();
        assert_eq!(p.pdf(&1e20), 0.0);
        let expected = -340.0 * std::f64::consts::LN_10 - std::f64::consts::PI.ln();
        assert!((p.ln_pdf(&1e20) - expected).abs() < 1e-12);
    }

    #[test]
    fn wrong_arguments_are_named() {
        for ((location, scale), message) in [
            ((f64::NAN, 1.0), "Cauchy: `location` is NaN, but it must be finite"),
            ((0.0, 0.0), "Cauchy: `scale` is 0.0, but it must be finite and greater than 0"),
            (
                (0.0, 1e300),
                "Cauchy: `scale` is 1e300, but samples and their densities must be within the \
                 range of normal numbers",
            ),
        ] {
            assert_eq!(Cauchy::new(location, scale).unwrap_err().to_string(), message);
        }
    }
}
