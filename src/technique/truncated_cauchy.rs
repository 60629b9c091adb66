//! The Cauchy density, cut to an interval.

use super::cauchy::{density, ln_density, representable};
use super::elementary::{clamp, tan_pi};
use super::two_sided::{TwoSided, inverse_cdf_by_sides, split};
use super::{InverseCdf, Technique, batch, canonical};
use crate::error::{ArgumentError, finite, greater, positive};
use std::f64::consts::FRAC_1_PI;

/// The Cauchy density cut to \[a, b\], with respect to length; either end may be infinite.
///
/// With z = (x - x₀) / γ, t = (a - x₀) / γ, s = (b - x₀) / γ, and the angle
/// Φ = atan(s) - atan(t): p(x) = 1 / (Φ γ (1 + z²)), P(x) = (atan(z) - atan(t)) / Φ,
/// P⁻¹(u) = x₀ + γ tan(atan(t) + u Φ).
///
/// ```
/// use mis::technique::{InverseCdf, Technique, TruncatedCauchy};
/// # fn main() -> Result<(), mis::ArgumentError> {
/// let p = TruncatedCauchy::new(0.0, 1.0, 0.0, 1.0)?;
/// assert!((p.sample(&[0.5]) - (std::f64::consts::PI / 8.0).tan()).abs() < 1e-15);
/// // A narrow window far from the peak.
/// let p = TruncatedCauchy::new(0.0, 1.0, 1e9, 1e9 + 1.0)?;
/// assert!((p.pdf(&(1e9 + 0.5)) - 1.0).abs() < 1e-14);
/// # Ok(())
/// # }
/// ```
///
/// Differences of arc tangents are taken as one angle, atan2(z - t, 1 + t z), from the end that
/// is nearer in mass, and x is placed from that end by z - t = (1 + t²) tan φ / (1 - t tan φ)
/// where that is the shorter way: windows far off the peak keep their precision. Samples are within
/// 6 ε (|x₀| + γ + |x|), densities within 5 ε of the formulas in `std` (ε = 2⁻⁵²).
#[derive(Debug, Clone, Copy, PartialEq)]
#[doc(alias("Breit-Wigner", "Lorentz", "Lorentzian"))]
pub struct TruncatedCauchy {
    scale: f64,
    lower: End,
    /// The upper end of the mirrored density.
    upper: End,
}

impl TruncatedCauchy {
    /// The Cauchy density around `location` = x₀ with the half width `scale` = γ, cut to
    /// \[a, b\].
    ///
    /// # Errors
    ///
    /// `location` must be finite, `scale` finite and greater than 0, b > a. No length between
    /// finite ones of a, b and location may overflow, and no sample and no density at a sample may
    /// leave the range of normal numbers.
    pub fn new(location: f64, scale: f64, a: f64, b: f64) -> Result<Self, ArgumentError> {
        const OWNER: &str = "TruncatedCauchy";
        finite(OWNER, "location", location)?;
        positive(OWNER, "scale", scale)?;
        if a.is_nan() || a == f64::INFINITY {
            let rule = "it must be finite or negative infinity";
            return Err(ArgumentError::new(OWNER, "a", a, rule));
        }
        greater(OWNER, "b", b, "a", a)?;
        for (name, length) in
            [("b - a", b - a), ("a - location", a - location), ("b - location", b - location)]
        {
            if length.is_infinite() && a.is_finite() && b.is_finite() {
                return Err(ArgumentError::new(OWNER, name, length, "it must not overflow"));
            }
        }
        let lower = End::new(location, scale, a, b);
        let upper = End::new(-location, scale, -b, -a);
        let this = Self { scale, lower, upper };
        representable(OWNER, scale, &this, location.clamp(a, b))?;
        Ok(this)
    }
}

/// The density a ≤ x ≤ b, seen from a.
#[derive(Debug, Clone, Copy, PartialEq)]
struct End {
    edge: f64,
    location: f64,
    /// k γ = max(γ, |a - x₀|), with k = max(1, |t|).
    reach: f64,
    /// t / k.
    t: f64,
    /// 1 / k.
    one: f64,
    /// Φ.
    angle: f64,
}

impl End {
    fn new(location: f64, scale: f64, a: f64, b: f64) -> Self {
        let offset = a - location;
        let reach = scale.max(offset.abs());
        let t = if a.is_finite() { offset / reach } else { -1.0 };
        let mut this = Self { edge: a, location, reach, t, one: scale / reach, angle: 0.0 };
        this.angle = this.angle_to(b, scale);
        this
    }

    /// atan(z) - atan(t).
    fn angle_to(&self, x: f64, scale: f64) -> f64 {
        let z = (x - self.location) / scale;
        if z == f64::INFINITY {
            return self.one.atan2(self.t);
        }
        let distance = if self.edge.is_finite() { (x - self.edge) / self.reach } else { 1.0 };
        distance.atan2(self.one + self.t * z)
    }

    /// The part of the mass between the edge and x.
    fn mass_to(&self, x: f64, scale: f64) -> f64 {
        if x == f64::NEG_INFINITY { 0.0 } else { self.angle_to(x, scale) / self.angle }
    }

    /// The x with atan(z) - atan(t) = `angle`.
    fn place(&self, angle: f64, scale: f64) -> f64 {
        let turn = angle * FRAC_1_PI;
        let steep = turn > 0.25;
        // Numbers with the ratio of the sine and the cosine will do.
        let [near, far] = tan_pi(if steep { 0.5 - turn } else { turn });
        let (sin, cos) = (if steep { far } else { near }, if steep { near } else { far });
        let below = self.one * cos - self.t * sin;
        let from_peak = scale * ((self.t * cos + self.one * sin) / below);
        let from_edge = self.reach * (sin * (self.t * self.t + self.one * self.one) / below);
        if from_edge < from_peak.abs() { self.edge + from_edge } else { self.location + from_peak }
    }
}

impl TruncatedCauchy {
    fn contains(&self, x: f64) -> bool {
        self.lower.edge <= x && x <= -self.upper.edge
    }
}

impl Technique for TruncatedCauchy {
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        self.inverse_cdf(canonical(xi, 0))
    }

    fn pdf(&self, x: &f64) -> f64 {
        // Without branches, for loops over many points.
        let inside = (self.lower.edge <= *x) & (*x <= -self.upper.edge);
        let p = density(x - self.lower.location, self.scale, self.lower.angle);
        if inside { p } else { 0.0 }
    }

    fn ln_pdf(&self, x: &f64) -> f64 {
        if !self.contains(*x) {
            return f64::NEG_INFINITY;
        }
        let p = self.pdf(x);
        if p.is_normal() {
            return p.ln();
        }
        ln_density(x - self.lower.location, self.scale, self.lower.angle)
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<f64>) {
        batch::sample(self, xi, xs);
    }
}

impl TwoSided for TruncatedCauchy {
    fn ends(&self) -> (f64, f64) {
        (self.lower.edge, -self.upper.edge)
    }

    fn masses(&self, x: f64) -> (f64, f64) {
        let x = x.clamp(self.lower.edge, -self.upper.edge);
        split(self.lower.mass_to(x, self.scale), self.upper.mass_to(-x, self.scale))
    }

    fn place(&self, below: f64, above: f64) -> f64 {
        // Without branches, for loops over many masses.
        let (l, r) = (self.lower, self.upper);
        let lower = below < above;
        let pick = |of_lower, of_upper| if lower { of_lower } else { of_upper };
        let end = End {
            edge: pick(l.edge, r.edge),
            location: pick(l.location, r.location),
            reach: pick(l.reach, r.reach),
            t: pick(l.t, r.t),
            one: pick(l.one, r.one),
            angle: pick(l.angle, r.angle),
        };
        let x = end.place(pick(below, above) * end.angle, self.scale);
        clamp(if lower { x } else { -x }, l.edge, -r.edge)
    }

    fn places(&self, xi: &[f64], xs: &mut [f64]) {
        let this = *self; // which no write to `xs` can change
        batch::places(xi, xs, move |u| this.place(u, 1.0 - u));
    }
}

inverse_cdf_by_sides!(TruncatedCauchy);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mass_below_nan_is_nan() {
        let p = TruncatedCauchy::new(0.0, 1.0, -1.0, 2.0).unwrap();
        assert!(p.cdf(f64::NAN).is_nan() && p.survival(f64::NAN).is_nan());
    }

    #[test]
    fn wrong_arguments_are_named() {
        let inf = f64::INFINITY;
        for ((location, scale, a, b), message) in [
            ((inf, 1.0, 0.0, 1.0), "`location` is inf, but it must be finite"),
            ((0.0, -1.0, 0.0, 1.0), "`scale` is -1.0, but it must be finite and greater than 0"),
            ((0.0, 1.0, inf, 1.0), "`a` is inf, but it must be finite or negative infinity"),
            ((0.0, 1.0, f64::NAN, 1.0), "`a` is NaN, but it must be finite or negative infinity"),
            ((0.0, 1.0, 1.0, 0.0), "`b` is 0.0, but it must be greater than a = 1"),
            ((0.0, 1.0, -1e308, 1e308), "`b - a` is inf, but it must not overflow"),
            (
                (0.0, 1e-300, 1e300, 2e300),
                "`scale` is 1e-300, but samples and their densities must be within the range of \
                 normal numbers",
            ),
        ] {
            let error = TruncatedCauchy::new(location, scale, a, b).unwrap_err();
            assert_eq!(error.to_string(), format!("TruncatedCauchy: {message}"));
        }
    }
}
