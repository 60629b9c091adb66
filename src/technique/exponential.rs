//! The exponential density, cut to an interval.

use super::elementary::{clamp, exp, ln_sum};
use super::two_sided::{TwoSided, inverse_cdf_by_sides, split};
use super::{InverseCdf, SMALLEST, Technique, batch, canonical};
use crate::error::{ArgumentError, finite, greater};

/// The exponential density of rate λ on \[a, b\], with respect to length.
///
/// With m = 1 - e^(-λ (b - a)): p(x) = λ e^(-λ (x - a)) / m, P(x) = (1 - e^(-λ (x - a))) / m,
/// P⁻¹(u) = a - ln(1 - m u) / λ.
///
/// The rate has any sign: a negative one makes the density grow towards b, and 0 is the uniform
/// density, which is approached continuously. Where λ > 0, b may be infinite.
///
/// ```
/// use mis::technique::{Exponential, InverseCdf, Technique};
/// # fn main() -> Result<(), mis::ArgumentError> {
/// let p = Exponential::new(2.0, 0.0, f64::INFINITY)?;
/// assert_eq!(p.pdf(&0.0), 2.0);
/// assert!((p.survival(10.0) / (-20.0_f64).exp() - 1.0).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
///
/// Masses are taken from the dense end with `exp_m1` and `ln_1p`, and those of the thin end
/// without subtracting from 1, so both tails keep their relative accuracy. Distances of samples
/// from the end at hand, and densities, are within 2 ε (ε = 2⁻⁵²) of the formulas in `std`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exponential {
    a: f64,
    b: f64,
    decay: Decay,
    /// The dense end is b.
    grows: bool,
    /// The dense and the thin end, and the rate with its sign: what loops need without a branch.
    near: f64,
    far: f64,
    rate: f64,
}

impl Exponential {
    /// The exponential density of rate `rate` on \[a, b\].
    ///
    /// # Errors
    ///
    /// `rate` and `a` must be finite, b > a, and `b` finite unless rate > 0. No density and no
    /// sample may leave the range of normal numbers.
    pub fn new(rate: f64, a: f64, b: f64) -> Result<Self, ArgumentError> {
        finite("Exponential", "rate", rate)?;
        finite("Exponential", "a", a)?;
        greater("Exponential", "b", b, "a", a)?;
        if b.is_infinite() && rate <= 0.0 {
            let rule = "it must be finite, since the rate is not greater than 0";
            return Err(ArgumentError::new("Exponential", "b", b, rule));
        }
        if b.is_finite() && !(b - a).is_normal() {
            let rule = "it must be within the range of normal numbers";
            return Err(ArgumentError::new("Exponential", "b - a", b - a, rule));
        }
        let decay = Decay::new(rate.abs(), b - a);
        let grows = rate < 0.0;
        let (near, far) = if grows { (b, a) } else { (a, b) };
        let this = Self { a, b, decay, grows, near, far, rate };
        let samples = [this.sample(&[0.0]), this.sample(&[1.0])];
        let densities = [decay.density(0.0), this.pdf(&samples[0]), this.pdf(&samples[1])];
        if !(samples.iter().all(|x| x.is_finite()) && densities.iter().all(|p| p.is_normal())) {
            let rule = "samples and their densities must be within the range of normal numbers";
            return Err(ArgumentError::new("Exponential", "rate", rate, rule));
        }
        Ok(this)
    }

    /// [`place`](TwoSided::place) by the logarithm of a mass.
    #[inline(always)]
    fn in_lanes(&self, logarithm: &Logarithm, below: f64, above: f64) -> f64 {
        let grows = self.grows;
        let dense = if grows { above } else { below };
        let thin = if grows { below } else { above };
        let (y, from_thin) = logarithm.place(dense, thin);
        let end = if from_thin { self.far } else { self.near };
        clamp(end + y / self.rate, self.a, self.b)
    }

    /// The distances of `x` to the dense and to the thin end.
    fn distances(&self, x: f64) -> (f64, f64) {
        let x = x.clamp(self.a, self.b);
        let above = if x == self.b { 0.0 } else { self.b - x }; // b may be infinite
        if self.grows { (above, x - self.a) } else { (x - self.a, above) }
    }
}

impl Technique for Exponential {
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        self.inverse_cdf(canonical(xi, 0))
    }

    #[inline]
    fn pdf(&self, x: &f64) -> f64 {
        let inside = (self.a <= *x) & (*x <= self.b);
        let p = self.decay.peak * exp(-self.rate * (x - self.near));
        if inside { p } else { 0.0 }
    }

    fn ln_pdf(&self, x: &f64) -> f64 {
        if self.a <= *x && *x <= self.b {
            self.decay.ln_density(self.distances(*x).0)
        } else {
            f64::NEG_INFINITY
        }
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<f64>) {
        batch::sample(self, xi, xs);
    }
}

impl TwoSided for Exponential {
    fn ends(&self) -> (f64, f64) {
        (self.a, self.b)
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
        let away = if self.grows { -1.0 } else { 1.0 };
        let x = match self.decay.place(dense, thin) {
            Place::Dense(t) => self.near + away * t,
            Place::Thin(t) => self.far - away * t,
        };
        x.clamp(self.a, self.b)
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

inverse_cdf_by_sides!(Exponential);

/// The density of e^(-rate t) on \[0, width\], t counted from the dense end, rate >= 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Decay {
    rate: f64,
    width: f64,
    /// ∫ e^(-rate t) over the width.
    norm: f64,
    /// The density at the dense end.
    pub(super) peak: f64,
    /// None where masses are so small that places are a matter of other formulas.
    pub(super) logarithm: Option<Logarithm>,
}

/// Where a mass ends, counted from the nearer end.
pub(super) enum Place {
    /// This far from the dense end.
    Dense(f64),
    /// This far from the thin end.
    Thin(f64),
}

impl Decay {
    /// `rate` >= 0 is finite; `width` > 0 may be infinite where rate > 0.
    pub(super) fn new(rate: f64, width: f64) -> Self {
        let depth = rate * width;
        let logarithm =
            Logarithm { dense: -(-depth).exp_m1(), thin: depth.exp_m1(), ratio: (-depth).exp() };
        let normal = logarithm.dense * SMALLEST >= f64::MIN_POSITIVE;
        let logarithm = normal.then_some(logarithm);
        let norm = integral(rate, width);
        Self { rate, width, norm, peak: norm.recip(), logarithm }
    }

    pub(super) fn density(&self, t: f64) -> f64 {
        self.peak * exp(-self.rate * t)
    }

    pub(super) fn ln_density(&self, t: f64) -> f64 {
        -self.rate * t - self.norm.ln()
    }

    /// The masses between the dense end and `t`, and between `t` and the thin end, which is at
    /// the distance `rest` from `t`.
    pub(super) fn masses(&self, t: f64, rest: f64) -> (f64, f64) {
        let dense = integral(self.rate, t) / self.norm;
        let thin = (-self.rate * t).exp() * (integral(self.rate, rest) / self.norm);
        split(dense, thin)
    }

    /// What serves instead of [`place`](Self::place) where neither mass is tiny.
    pub(super) fn logarithm_of(&self, below: f64, above: f64) -> Option<&Logarithm> {
        self.logarithm.as_ref().filter(|_| below.min(above) >= SMALLEST)
    }

    /// The place with the mass `dense` on one side and `thin` = 1 - `dense` on the other.
    pub(super) fn place(&self, dense: f64, thin: f64) -> Place {
        let depth = self.rate * self.width;
        if dense < thin {
            let y = dense * -(-depth).exp_m1();
            if y < f64::MIN_POSITIVE {
                return Place::Dense(dense * self.norm);
            }
            return Place::Dense(-(-y).ln_1p() / self.rate);
        }
        let y = thin * depth.exp_m1();
        if y < f64::MIN_POSITIVE {
            return Place::Thin(thin * (self.norm * depth.exp()));
        }
        if y < 1.0 {
            return Place::Thin(y.ln_1p() / self.rate);
        }
        Place::Dense(-(thin + dense * (-depth).exp()).ln() / self.rate)
    }
}

/// [`Decay::place`] without branches, for masses that are canonical numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Logarithm {
    /// 1 - e^-d, e^d - 1 and e^-d for the depth d = rate · width.
    dense: f64,
    thin: f64,
    ratio: f64,
}

impl Logarithm {
    /// rate t, where t leads from the end at hand to the place with these masses on its sides,
    /// and is positive from the dense end; and whether that end is the thin one.
    #[inline]
    pub(super) fn place(&self, dense: f64, thin: f64) -> (f64, bool) {
        // The cases of `Decay::place`, which differ in the argument of one logarithm.
        let up = thin * self.thin;
        let near_dense = dense < thin;
        let near_thin = !near_dense & (up < 1.0);
        let y = if near_dense { -dense * self.dense } else { up };
        let near_one = 1.0 + y;
        let between = thin + dense * self.ratio;
        let near = near_dense | near_thin;
        let s = if near { near_one } else { between };
        let lost = if near { y - (near_one - 1.0) } else { 0.0 * between }; // 0, or NaN
        (-ln_sum(s, lost), near_thin)
    }
}

/// ∫ e^(-rate s) ds from 0 to t.
fn integral(rate: f64, t: f64) -> f64 {
    let y = rate * t;
    if y < f64::MIN_POSITIVE {
        t // y has lost digits or is 0
    } else {
        -(-y).exp_m1() / rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_arguments_are_named() {
        let inf = f64::INFINITY;
        for ((rate, a, b), message) in [
            ((f64::NAN, 0.0, 1.0), "Exponential: `rate` is NaN, but it must be finite"),
            ((1.0, -inf, 1.0), "Exponential: `a` is -inf, but it must be finite"),
            ((1.0, 1.0, 0.0), "Exponential: `b` is 0.0, but it must be greater than a = 1"),
            ((1.0, 1.0, f64::NAN), "Exponential: `b` is NaN, but it must be greater than a = 1"),
            (
                (0.0, 0.0, inf),
                "Exponential: `b` is inf, but it must be finite, since the rate is not greater than 0",
            ),
            (
                (1.0, -1e308, 1e308),
                "Exponential: `b - a` is inf, but it must be within the range of normal numbers",
            ),
            (
                (1e-308, 0.0, inf),
                "Exponential: `rate` is 1e-308, but samples and their densities must be within \
                 the range of normal numbers",
            ),
        ] {
            assert_eq!(Exponential::new(rate, a, b).unwrap_err().to_string(), message);
        }
    }

    #[test]
    fn the_tail_of_the_last_canonical_number_is_finite() {
        let p = Exponential::new(1.0, 0.0, f64::INFINITY).unwrap();
        assert!((36.7..=36.74).contains(&p.sample(&[1.0])));
    }

    #[test]
    fn rate_zero_is_the_uniform_density_and_its_neighbours_are_close() {
        let uniform = crate::technique::Uniform::new(1.0, 3.0).unwrap();
        for rate in [0.0, 5e-324, -5e-324, 1e-310, 1e-20, -1e-20] {
            let p = Exponential::new(rate, 1.0, 3.0).unwrap();
            for u in [1e-9, 0.25, 0.5, 0.75, 0.999] {
                let x = uniform.inverse_cdf(u);
                assert!((p.inverse_cdf(u) - x).abs() <= 2.0 * f64::EPSILON * x);
                assert!((p.pdf(&x) - 0.5).abs() <= f64::EPSILON);
            }
        }
    }
}
