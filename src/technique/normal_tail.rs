//! Integrals of the normal density, and their inverses.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, SQRT_2};

/// The mass of the standard normal density above `z`.
pub(super) fn upper_tail(z: f64) -> f64 {
    0.5 * libm::erfc(z * FRAC_1_SQRT_2)
}

/// The z with the mass `v` of the standard normal density above it, v in \[0, 1\].
pub(super) fn inverse_upper_tail(v: f64) -> f64 {
    SQRT_2 * statrs::function::erf::erfc_inv(2.0 * v)
}

/// A window from z = α to β on the whole line; all 0 where the window is small or off the peak.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Line {
    /// The masses below α and above β.
    pub(super) tails: [f64; 2],
    /// 2 Φ(α) - 1 and 2 Φ(β) - 1.
    pub(super) ends: [f64; 2],
    /// Φ(β) - Φ(α), and twice that.
    pub(super) mass: f64,
    pub(super) span: f64,
}

impl Line {
    pub(super) fn new(alpha: f64, beta: f64) -> Self {
        if alpha > 0.0 || beta - alpha < 1.0 {
            return Self::default();
        }
        let ends = [alpha, beta].map(|z| libm::erf(z * FRAC_1_SQRT_2));
        let span = ends[1] - ends[0];
        Self { tails: [upper_tail(-alpha), upper_tail(beta)], ends, mass: 0.5 * span, span }
    }
}

/// Distances d where |z| d + d²/2 <= 1.
pub(super) fn series_limit(z: f64) -> f64 {
    2.0 / (z.abs() + z.hypot(SQRT_2)) // z² may overflow
}

/// ∫ e^(-z t - t²/2) dt from 0 to d: the Taylor series at 0, whose coefficients are Hermite
/// polynomials.
pub(super) fn series(z: f64, d: f64) -> f64 {
    let (slope, square) = (z * d, d * d);
    let (mut before, mut term, mut sum) = (0.0, 1.0, 1.0);
    for k in 1..40 {
        let next = -(slope * term + square * before) / f64::from(k);
        (before, term) = (term, next);
        sum += term / f64::from(k + 1);
        if term.abs() + before.abs() < 0.125 * f64::EPSILON {
            break;
        }
    }
    d * sum
}

/// The d with `series(z, d)` = `mass`, by Halley's method from the root without t²/2.
pub(super) fn inverse_series(z: f64, mass: f64) -> f64 {
    let y = z * mass;
    let mut d = if y.abs() < f64::MIN_POSITIVE { mass } else { -(-y).ln_1p() / z };
    d = d.min(series_limit(z));
    for _ in 0..6 {
        let newton = (series(z, d) - mass) / (-d * (z + 0.5 * d)).exp();
        let step = newton / (1.0 + 0.5 * newton * (z + d));
        d -= step;
        if step.abs() <= f64::EPSILON * d {
            break;
        }
    }
    d
}

/// Mills' ratio, e^(z²/2) ∫ e^(-t²/2) dt from z to infinity, for z >= 0.
///
/// Source of the continued fraction: M. Abramowitz, I. A. Stegun, *Handbook of Mathematical
/// Functions*, 1964, 26.2.14.
pub(super) fn mills(z: f64) -> f64 {
    if z < 5.0 {
        // e^(w²) from a part of w that squares exactly, and the rest.
        let w = z * FRAC_1_SQRT_2;
        let head = f64::from_bits(w.to_bits() & !0x7FF_FFFF);
        let scale = (head * head).exp() * ((w - head) * (w + head)).exp();
        return FRAC_PI_2.sqrt() * (scale * libm::erfc(w));
    }
    // 26 levels reach the last digit at z = 5.
    let fraction = (1..=26).rev().fold(z, |f, k| z + f64::from(k) / f);
    fraction.recip()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mills_ratio_on_both_sides_of_the_switch() {
        // mpmath, 30 digits.
        for (z, ratio) in [
            (0.0, 1.253_314_137_315_500_3),
            (1.0, 0.655_679_542_418_798_4),
            (4.999, 0.192_844_070_698_244_9),
            (5.0, 0.192_808_104_715_315_76),
            (1e10, 1e-10),
        ] {
            assert!((mills(z) / ratio - 1.0).abs() <= 4.0 * f64::EPSILON, "{z}: {}", mills(z));
        }
    }
}
