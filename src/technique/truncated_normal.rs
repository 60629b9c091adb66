//! The normal density, cut to an interval.

use super::elementary::{NORMAL_TAIL, clamp, exp, normal_quantile};
use super::normal_tail::{
    Line, inverse_series, inverse_upper_tail, mills, series, series_limit, upper_tail,
};
use super::two_sided::{TwoSided, inverse_cdf_by_sides, split};
use super::{InverseCdf, Technique, batch, canonical, open};
use crate::error::{ArgumentError, finite, greater, positive};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, TAU};

/// The normal density cut to \[a, b\], with respect to length; either end may be infinite.
///
/// With z = (x - mean) / sd, α and β the same for a and b, φ and Φ the standard normal density
/// and CDF: p(x) = φ(z) / (sd (Φ(β) - Φ(α))), P(x) = (Φ(z) - Φ(α)) / (Φ(β) - Φ(α)),
/// P⁻¹(u) = mean + sd Φ⁻¹(Φ(α) + u (Φ(β) - Φ(α))).
///
/// ```
/// use mis::technique::{InverseCdf, Technique, TruncatedNormal};
/// # fn main() -> Result<(), mis::ArgumentError> {
/// // 100 standard deviations out, where Φ is 1 to the last digit, and more.
/// let p = TruncatedNormal::new(0.0, 1.0, 100.0, 101.0)?;
/// assert!((p.pdf(&100.0) - 100.009_998).abs() < 1e-6);
/// assert!((p.cdf(p.inverse_cdf(0.3)) - 0.3).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
///
/// Nothing is a difference of two values of Φ where these are close. The density is mirrored so
/// that most of its mass is above the mean. Masses are in units of the density at a, where that
/// is above the mean; large ones are differences of Mills' ratios, small ones the Taylor series
/// of ∫ e^(-α t - t²/2) dt from the end at hand. Far out, the inverse is a root by Newton's
/// method on the logarithm of the tail. In a window of at least one standard deviation that holds
/// the mean, samples with 1/512 of the mass on either side are by the quantile of the whole line,
/// within 6 ε (|mean| + sd + |x|), ε = 2⁻⁵².
#[derive(Debug, Clone, Copy, PartialEq)]
#[doc(alias("Gauss", "Gaussian"))]
pub struct TruncatedNormal {
    /// Whether x -> -x has been applied to the following.
    mirrored: bool,
    mean: f64,
    sd: f64,
    a: f64,
    b: f64,
    /// At a, which is not further below the mean than b is above it.
    alpha: Score,
    beta: Score,
    /// Where [`Self::ln_shape`] is counted from, and its slope there.
    origin: f64,
    slope: f64,
    /// ∫ e^(-z²/2) dz from α to β, in the unit of [`Self::ln_shape`].
    total: f64,
    /// 1 / (total sd).
    peak: f64,
    line: Line,
    /// Masses up to which the series from a, and from b, serves.
    reach: [f64; 2],
}

/// A standard score z and the value of e^(-z²/2) there, in the unit of
/// [`TruncatedNormal::ln_shape`].
#[derive(Debug, Clone, Copy, PartialEq)]
struct Score {
    z: f64,
    shape: f64,
}

impl TruncatedNormal {
    /// The normal density of mean `mean` and standard deviation `sd`, cut to \[a, b\].
    ///
    /// # Errors
    ///
    /// `mean` must be finite, `sd` finite and greater than 0, b > a. The window must not lie more
    /// standard deviations away from the mean than `f64` can count, and no sample and no
    /// density at a sample may leave the range of normal numbers.
    pub fn new(mean: f64, sd: f64, a: f64, b: f64) -> Result<Self, ArgumentError> {
        const OWNER: &str = "TruncatedNormal";
        finite(OWNER, "mean", mean)?;
        positive(OWNER, "sd", sd)?;
        if a.is_nan() || a == f64::INFINITY {
            let rule = "it must be finite or negative infinity";
            return Err(ArgumentError::new(OWNER, "a", a, rule));
        }
        greater(OWNER, "b", b, "a", a)?;
        let mirrored = (a - mean) / sd + (b - mean) / sd < 0.0;
        let (mean, a, b) = if mirrored { (-mean, -b, -a) } else { (mean, a, b) };
        let (alpha, beta) = ((a - mean) / sd, (b - mean) / sd);
        let width = (b - a) / sd;
        let mut this = Self {
            mirrored,
            mean,
            sd,
            a,
            b,
            alpha: Score { z: alpha, shape: 1.0 },
            beta: Score { z: beta, shape: 1.0 },
            origin: if alpha > 0.0 { a } else { mean },
            slope: if alpha > 0.0 { alpha } else { 0.0 },
            total: 1.0,
            peak: 1.0,
            line: Line::new(alpha, beta),
            reach: [0.0; 2],
        };
        this.alpha.shape = this.ln_shape(a).exp();
        this.beta.shape = this.ln_shape(b).exp();
        this.total = this.mass(this.alpha, this.beta, width);
        this.peak = this.total.recip() / sd;
        this.reach = [alpha, -beta]
            .map(|z| if z.is_finite() { series(z, width.min(series_limit(z))) } else { 0.0 });
        let points = [this.sample(&[0.0]), mean.clamp(a, b), this.sample(&[1.0])];
        let points = [points[0], if mirrored { -points[1] } else { points[1] }, points[2]];
        if !points.iter().all(|x| x.is_finite() && this.pdf(x).is_normal()) {
            let rule = "samples and their densities must be within the range of normal numbers";
            return Err(ArgumentError::new(OWNER, "sd", sd, rule));
        }
        Ok(this)
    }

    /// ln of e^(-z²/2), in units of its value at a where a is above the mean: from the distance
    /// to a then, since z² loses digits far out.
    #[inline]
    fn ln_shape(&self, x: f64) -> f64 {
        let d = (x - self.origin) / self.sd;
        -d * (self.slope + 0.5 * d)
    }

    /// The x with the masses `below` and `above` on its sides, by the quantile of the whole line.
    /// NaN where that is no way: near an end, in a tail, in a small window or one off the peak.
    #[inline(always)]
    fn central(&self, below: f64, above: f64) -> f64 {
        let Line { tails, ends, mass, span } = self.line;
        let low = if self.mirrored { above } else { below };
        let high = if self.mirrored { below } else { above };
        let product = 4.0 * (tails[0] + low * mass) * (tails[1] + high * mass);
        let lower = low < high;
        let nearer = if lower { low } else { high };
        let from = if lower { ends[0] } else { ends[1] };
        let difference = from + nearer * if lower { span } else { -span };
        let x = clamp(self.mean + self.sd * normal_quantile(difference, product), self.a, self.b);
        let central = (product >= NORMAL_TAIL) & (nearer >= 1.0 / 512.0);
        if central { if self.mirrored { -x } else { x } } else { f64::NAN }
    }

    /// The same for any window and masses.
    fn near_end(&self, below: f64, above: f64) -> f64 {
        let (below, above) = if self.mirrored { (above, below) } else { (below, above) };
        let x = self.polish(self.mirrored_place(below, above), below, above);
        self.mirror(x.clamp(self.a, self.b))
    }

    /// The mass above z >= 0, of the density that is not cut.
    fn tail(&self, at: Score) -> f64 {
        if self.alpha.z <= 0.0 {
            FRAC_PI_2.sqrt() * libm::erfc(at.z * FRAC_1_SQRT_2)
        } else if at.shape > 0.0 {
            at.shape * mills(at.z)
        } else {
            0.0
        }
    }

    /// The mass between `low` and `high`, which are `d` apart.
    fn mass(&self, low: Score, high: Score, d: f64) -> f64 {
        if low.z.abs() <= high.z.abs() && d <= series_limit(low.z) {
            return low.shape * series(low.z, d);
        }
        if d <= series_limit(high.z) {
            return high.shape * series(-high.z, d);
        }
        if low.z >= 0.0 {
            self.tail(low) - self.tail(high)
        } else if high.z <= 0.0 {
            self.tail(high.mirrored()) - self.tail(low.mirrored())
        } else {
            let erf = libm::erf(high.z * FRAC_1_SQRT_2) - libm::erf(low.z * FRAC_1_SQRT_2);
            FRAC_PI_2.sqrt() * erf
        }
    }

    /// The mirrored x with the masses `below` and `above` on its sides, of sum 1.
    ///
    /// From the smaller of the two, whose rounding error is the smaller.
    fn mirrored_place(&self, below: f64, above: f64) -> f64 {
        let (low, high) = (below * self.total, above * self.total);
        if below < above {
            let from_a = low / self.alpha.shape;
            if from_a <= self.reach[0] {
                return self.a + self.sd * inverse_series(self.alpha.z, from_a);
            }
            if self.alpha.z <= 0.0 {
                let tail = self.tail(self.alpha.mirrored()) + low;
                return self.mean - self.sd * inverse_upper_tail(tail / TAU.sqrt());
            }
        } else {
            let from_b = high / self.beta.shape;
            if from_b <= self.reach[1] {
                return self.b - self.sd * inverse_series(-self.beta.z, from_b);
            }
            if self.alpha.z <= 0.0 {
                let tail = self.tail(self.beta) + high;
                return self.mean + self.sd * inverse_upper_tail(tail / TAU.sqrt());
            }
        }
        self.a + self.sd * self.off_peak(below, above)
    }

    /// `x` after one Newton step towards the masses `below` and `above`, unless the density
    /// changes over the step, as it does where sd is less than the spacing of the floats.
    fn polish(&self, x: f64, below: f64, above: f64) -> f64 {
        let (low, high) = self.mirrored_masses(x);
        let excess = if below < above { low - below } else { above - high };
        let step = excess * self.total / self.ln_shape(x).exp();
        let slope = 1.0 + ((x - self.mean) / self.sd).abs();
        if step.abs() * slope < 1e-6 { x - self.sd * step } else { x }
    }

    /// The distance d to a in standard deviations, for α > 0: the root of
    /// ln(tail(α + d) / tail(α)) = ln(1 - `below` total / tail(α)).
    fn off_peak(&self, below: f64, above: f64) -> f64 {
        let alpha = self.alpha.z;
        let first = mills(alpha);
        let last = self.tail(self.beta) / first;
        let target = if below < above {
            (-below * (1.0 - last)).ln_1p()
        } else {
            (above + below * last).ln()
        };
        let mut d = if alpha < 4.0 {
            let tail = target.exp() * upper_tail(alpha);
            inverse_upper_tail(tail.max(f64::MIN_POSITIVE)) - alpha // it may underflow
        } else {
            -2.0 * target / (alpha + (alpha * alpha - 2.0 * target).sqrt())
        };
        for _ in 0..4 {
            let ratio = mills(alpha + d);
            let step = ratio * ((ratio / first).ln() - d * (alpha + 0.5 * d) - target);
            d += step;
            if step.abs() <= f64::EPSILON * d {
                break;
            }
        }
        d
    }

    fn mirror(&self, x: f64) -> f64 {
        if self.mirrored { -x } else { x }
    }

    /// The masses below and above the mirrored `x`.
    fn mirrored_masses(&self, x: f64) -> (f64, f64) {
        let x = x.clamp(self.a, self.b);
        if x == self.a {
            return (0.0, 1.0);
        }
        if x == self.b {
            return (1.0, 0.0);
        }
        let at = Score { z: (x - self.mean) / self.sd, shape: self.ln_shape(x).exp() };
        let below = self.mass(self.alpha, at, (x - self.a) / self.sd) / self.total;
        let above = self.mass(at, self.beta, (self.b - x) / self.sd) / self.total;
        split(below, above)
    }
}

impl Score {
    fn mirrored(self) -> Self {
        Self { z: -self.z, shape: self.shape }
    }
}

impl Technique for TruncatedNormal {
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        self.inverse_cdf(canonical(xi, 0))
    }

    #[inline]
    fn pdf(&self, x: &f64) -> f64 {
        let x = if self.mirrored { -x } else { *x };
        let inside = (self.a <= x) & (x <= self.b);
        let p = self.peak * exp(self.ln_shape(x));
        if inside { p } else { 0.0 }
    }

    fn ln_pdf(&self, x: &f64) -> f64 {
        // Where sd is huge or tiny, the logarithms of the factors cancel.
        let p = self.pdf(x);
        let x = self.mirror(*x);
        if p.is_normal() {
            p.ln()
        } else if self.a <= x && x <= self.b {
            self.ln_shape(x) - self.total.ln() - self.sd.ln()
        } else {
            f64::NEG_INFINITY
        }
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<f64>) {
        batch::sample(self, xi, xs);
    }
}

impl TwoSided for TruncatedNormal {
    fn ends(&self) -> (f64, f64) {
        if self.mirrored { (-self.b, -self.a) } else { (self.a, self.b) }
    }

    fn masses(&self, x: f64) -> (f64, f64) {
        let (below, above) = self.mirrored_masses(self.mirror(x));
        if self.mirrored { (above, below) } else { (below, above) }
    }

    fn place(&self, below: f64, above: f64) -> f64 {
        batch::one(below, |below| self.central(below, above), |_| self.near_end(below, above))
    }

    fn places(&self, xi: &[f64], xs: &mut [f64]) {
        let this = *self; // which no write to `xs` can change
        let central = move |u| this.central(open(u), 1.0 - open(u));
        batch::map(xi, xs, central, |u| self.near_end(open(u), 1.0 - open(u)));
    }
}

inverse_cdf_by_sides!(TruncatedNormal);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_probability_has_a_place() {
        let p = TruncatedNormal::new(0.0, 1.0, 2.85, f64::INFINITY).unwrap();
        let x = p.inverse_survival(5e-324);
        assert!((x - 38.6).abs() < 0.1, "{x}");
    }

    #[test]
    fn a_spread_below_the_spacing_of_the_floats() {
        let mean = 8e-4;
        let p = TruncatedNormal::new(mean, 2.5e-20, -0.25, f64::INFINITY).unwrap();
        for u in [1e-16, 5e-4, 0.3, 0.994] {
            assert!((p.inverse_cdf(u) - mean).abs() <= 4e-19, "{u}");
        }
    }

    #[test]
    fn a_window_so_far_off_that_the_square_of_its_score_overflows() {
        let p = TruncatedNormal::new(-1e242, 1.0, 0.0, f64::INFINITY).unwrap();
        for u in [1e-30, 1e-10, 0.3, 0.9] {
            assert!((p.cdf(p.inverse_cdf(u)) - u).abs() <= 4.0 * f64::EPSILON * u, "{u}");
        }
    }

    #[test]
    fn wrong_arguments_are_named() {
        let inf = f64::INFINITY;
        for ((mean, sd, a, b), message) in [
            ((f64::NAN, 1.0, 0.0, 1.0), "`mean` is NaN, but it must be finite"),
            ((0.0, 0.0, 0.0, 1.0), "`sd` is 0.0, but it must be finite and greater than 0"),
            ((0.0, 1.0, f64::NAN, 1.0), "`a` is NaN, but it must be finite or negative infinity"),
            ((0.0, 1.0, inf, inf), "`a` is inf, but it must be finite or negative infinity"),
            ((0.0, 1.0, 1.0, -1.0), "`b` is -1.0, but it must be greater than a = 1"),
            (
                (0.0, 1e-300, 1e300, 2e300),
                "`sd` is 1e-300, but samples and their densities must be within the range of \
                 normal numbers",
            ),
        ] {
            let error = TruncatedNormal::new(mean, sd, a, b).unwrap_err();
            assert_eq!(error.to_string(), format!("TruncatedNormal: {message}"));
        }
    }
}
