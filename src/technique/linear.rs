//! The linear ramp.

use super::elementary::clamp;
use super::two_sided::{TwoSided, inverse_cdf_by_sides, split};
use super::{InverseCdf, Technique, batch, canonical};
use crate::error::{ArgumentError, finite, greater};

/// The density on \[a, b\] that is proportional to a straight line, from the value f at a to the
/// value g at b, with respect to length.
///
/// With s = (x - a) / (b - a): p(x) = 2 (f (1 - s) + g s) / ((f + g) (b - a)),
/// P(x) = s (2 f + (g - f) s) / (f + g), and P⁻¹(u) is at
/// s = u (f + g) / (f + √((1 - u) f² + u g²)).
///
/// ```
/// use mis::technique::{InverseCdf, Linear, Technique};
/// # fn main() -> Result<(), mis::ArgumentError> {
/// let p = Linear::new(0.0, 2.0, 0.0, 1.0)?;
/// assert_eq!(p.pdf(&1.0), 0.5);
/// assert_eq!(p.cdf(1.0), 0.25);
/// assert_eq!(p.sample(&[0.25]), 1.0);
/// # Ok(())
/// # }
/// ```
///
/// This root of the quadratic equation has no cancellation, a level line included. An end where
/// the density is 0 is not sampled: a sample that would round to it is the number next to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linear {
    a: f64,
    b: f64,
    /// The values at the ends, the larger of them 1.
    f: f64,
    g: f64,
}

impl Linear {
    /// The density on \[a, b\] proportional to the line from `value_a` at a to `value_b` at b.
    ///
    /// # Errors
    ///
    /// `a` and `b` must be finite, b > a, and b - a must neither overflow nor be subnormal. The
    /// values must be finite, at least 0, and not both 0.
    pub fn new(a: f64, b: f64, value_a: f64, value_b: f64) -> Result<Self, ArgumentError> {
        finite("Linear", "a", a)?;
        finite("Linear", "b", b)?;
        greater("Linear", "b", b, "a", a)?;
        if !(b - a).is_normal() {
            let rule = "it must be within the range of normal numbers";
            return Err(ArgumentError::new("Linear", "b - a", b - a, rule));
        }
        for (name, value) in [("value_a", value_a), ("value_b", value_b)] {
            if !(value.is_finite() && value >= 0.0) {
                let rule = "it must be finite and at least 0";
                return Err(ArgumentError::new("Linear", name, value, rule));
            }
        }
        let largest = value_a.max(value_b);
        if largest == 0.0 {
            let rule = "it must be greater than 0, since value_a is 0";
            return Err(ArgumentError::new("Linear", "value_b", value_b, rule));
        }
        let mut this = Self { a, b, f: value_a / largest, g: value_b / largest };
        // A density that underflows at an end counts as 0 there, so that the end is not sampled.
        this.f = if this.pdf(&a) == 0.0 { 0.0 } else { this.f };
        this.g = if this.pdf(&b) == 0.0 { 0.0 } else { this.g };
        Ok(this)
    }

    /// The share of the width between the end of value `f` and the point that cuts off the mass
    /// `u` there.
    fn share(u: f64, f: f64, g: f64) -> f64 {
        u * (f + g) / (f + ((1.0 - u) * f * f + u * g * g).sqrt())
    }

    /// The point with the mass `below` under it and `above` over it, but for rounding beyond an end.
    fn root(&self, below: f64, above: f64) -> f64 {
        // One square root for both sides, for loops over many masses.
        let near_a = below < above;
        let mass = if near_a { below } else { above };
        let (near, far) = if near_a { (self.f, self.g) } else { (self.g, self.f) };
        let distance = (self.b - self.a) * Self::share(mass, near, far);
        if near_a { self.a + distance } else { self.b - distance }
    }

    /// The ends of what is sampled.
    fn sampled(&self) -> (f64, f64) {
        let lowest = if self.f == 0.0 { self.a.next_up() } else { self.a };
        let highest = if self.g == 0.0 { self.b.next_down() } else { self.b };
        (lowest, highest)
    }

    /// The mass between the end of value `f` and the share `s` of the width.
    fn mass(s: f64, f: f64, g: f64) -> f64 {
        s * ((2.0 - s) * f + s * g) / (f + g)
    }
}

impl Technique for Linear {
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        self.inverse_cdf(canonical(xi, 0))
    }

    fn pdf(&self, x: &f64) -> f64 {
        // Without branches, for loops over many points.
        let inside = (self.a <= *x) & (*x <= self.b);
        let width = self.b - self.a;
        let line = self.f * ((self.b - x) / width) + self.g * ((x - self.a) / width);
        let p = 2.0 * line / (self.f + self.g) / width;
        if inside { p } else { 0.0 }
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<f64>) {
        batch::sample(self, xi, xs);
    }
}

impl TwoSided for Linear {
    fn ends(&self) -> (f64, f64) {
        (self.a, self.b)
    }

    fn masses(&self, x: f64) -> (f64, f64) {
        let (x, width) = (x.clamp(self.a, self.b), self.b - self.a);
        let below = Self::mass((x - self.a) / width, self.f, self.g);
        let above = Self::mass((self.b - x) / width, self.g, self.f);
        split(below, above)
    }

    fn place(&self, below: f64, above: f64) -> f64 {
        let (lowest, highest) = self.sampled();
        self.root(below, above).clamp(lowest, highest)
    }

    fn places(&self, xi: &[f64], xs: &mut [f64]) {
        let (lowest, highest) = self.sampled();
        let this = *self; // which no write to `xs` can change
        batch::places(xi, xs, move |u| clamp(this.root(u, 1.0 - u), lowest, highest));
    }
}

inverse_cdf_by_sides!(Linear);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_arguments_are_named() {
        for ((a, b, f, g), message) in [
            ((f64::NAN, 1.0, 1.0, 1.0), "Linear: `a` is NaN, but it must be finite"),
            ((0.0, f64::INFINITY, 1.0, 1.0), "Linear: `b` is inf, but it must be finite"),
            ((1.0, 0.0, 1.0, 1.0), "Linear: `b` is 0.0, but it must be greater than a = 1"),
            (
                (-1e308, 1e308, 1.0, 1.0),
                "Linear: `b - a` is inf, but it must be within the range of normal numbers",
            ),
            (
                (0.0, 1.0, -1.0, 1.0),
                "Linear: `value_a` is -1.0, but it must be finite and at least 0",
            ),
            (
                (0.0, 1.0, 1.0, f64::NAN),
                "Linear: `value_b` is NaN, but it must be finite and at least 0",
            ),
            (
                (0.0, 1.0, 0.0, 0.0),
                "Linear: `value_b` is 0.0, but it must be greater than 0, since value_a is 0",
            ),
        ] {
            assert_eq!(Linear::new(a, b, f, g).unwrap_err().to_string(), message);
        }
    }

    #[test]
    fn an_end_of_density_zero_is_not_sampled() {
        let p = Linear::new(1.0, 1.0 + f64::EPSILON, 0.0, 1.0).unwrap();
        let q = Linear::new(1.0, 1.0 + f64::EPSILON, 1.0, 0.0).unwrap();
        for xi in [0.0, 0.1, 0.9, 1.0] {
            assert!(p.pdf(&p.sample(&[xi])) > 0.0);
            assert!(q.pdf(&q.sample(&[xi])) > 0.0);
        }
        // The density at an end underflows.
        let p = Linear::new(-4e52, -3.999_999_999_999_9e52, 5.0, 7e303).unwrap();
        let q = Linear::new(-4e52, -3.999_999_999_999_9e52, 7e303, 5.0).unwrap();
        for xi in [0.0, 1.0] {
            assert!(p.pdf(&p.sample(&[xi])) > 0.0);
            assert!(q.pdf(&q.sample(&[xi])) > 0.0);
        }
    }
}
