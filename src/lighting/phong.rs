//! Glossy reflection.

use std::f64::consts::TAU;

use super::bsdf::Bsdf;
use super::direction::{Direction, Frame};
use super::spectrum::{Spectrum, check_channels};
use super::surface::Surface;
use crate::error::ArgumentError;
use crate::technique::{Technique, canonical};

/// The largest exponent: the lobe is then 1e-12 wide, some thousand times the resolution of a
/// direction.
const LARGEST: f64 = 1e24;

/// The cosine lobe about an axis, per steradian.
///
/// With the angle α to the axis: p(ω) = (n + 1) / (2π) cosⁿ α for α ≤ 90°, else 0. A sample has
/// 1 - cos α = 1 - (1 - ξ₀)^(1 / (n + 1)) and the azimuth 2π ξ₁.
///
/// ```
/// use mis::lighting::{DVec3, Direction, PhongLobe};
/// use mis::technique::Technique;
/// # fn main() -> Result<(), mis::ArgumentError> {
/// let p = PhongLobe::new(Direction::new(DVec3::Z)?, 1.0)?;
/// let w = p.sample(&[0.75, 0.1]);
/// assert!((w.vector().z - 0.5).abs() < 1e-15);
/// assert!((p.pdf(&w) - 0.5 / std::f64::consts::PI).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
///
/// # Numerics
///
/// 1 - cos α = -expm1(ln(1 - ξ₀) / (n + 1)), and cosⁿ α = exp(n ln(1 - q)) with q = 1 - cos α from
/// the distance of the unit vectors: neither cancels in a narrow lobe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhongLobe {
    frame: Frame,
    exponent: f64,
}

impl PhongLobe {
    /// The lobe about `axis` with the exponent n.
    ///
    /// # Errors
    ///
    /// `exponent` must be in \[0, 1e24\]: narrower lobes cannot be told from a mirror.
    pub fn new(axis: Direction, exponent: f64) -> Result<Self, ArgumentError> {
        check_exponent("PhongLobe", exponent)?;
        Ok(Self { frame: Frame::new(axis), exponent })
    }
}

impl Technique for PhongLobe {
    type Point = Direction;

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> Direction {
        let q = -((-canonical(xi, 0)).ln_1p() / (self.exponent + 1.0)).exp_m1();
        self.frame.around(q, canonical(xi, 1))
    }

    fn pdf(&self, w: &Direction) -> f64 {
        pdf(self.exponent, self.frame.axis, w)
    }

    fn ln_pdf(&self, w: &Direction) -> f64 {
        ln_pdf(self.exponent, self.frame.axis, w)
    }
}

/// Glossy reflection by the modified Phong model: f_r = ρ (n + 2) / (2π) cosⁿ α above the
/// surface, with the angle α to the mirror direction.
///
/// It is sampled by [`PhongLobe`], part of which is below the surface at grazing angles.
///
/// Source: E. P. Lafortune and Y. D. Willems, *Using the Modified Phong Reflectance Model for
/// Physically Based Rendering*, report CW 197, KU Leuven, 1994.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModifiedPhong<V> {
    albedo: V,
    exponent: f64,
}

impl<V: Spectrum> ModifiedPhong<V> {
    /// The glossy surface with the albedo ρ (that of light along the normal) and the exponent n.
    ///
    /// # Errors
    ///
    /// Every channel of `albedo` must be in \[0, 1\], and `exponent` in \[0, 1e24\].
    pub fn new(albedo: V, exponent: f64) -> Result<Self, ArgumentError> {
        let rule = "every channel must be in [0, 1]";
        check_channels("ModifiedPhong", "albedo", &albedo, 1.0, rule)?;
        check_exponent("ModifiedPhong", exponent)?;
        Ok(Self { albedo, exponent })
    }
}

impl<V: Spectrum> Bsdf for ModifiedPhong<V> {
    type Value = V;

    fn value_and_pdf(&self, surface: &Surface, incident: &Direction) -> (V, f64) {
        let pdf = pdf(self.exponent, surface.mirror(), incident);
        let value = if incident.cos(surface.normal()) > 0.0 {
            self.albedo.scaled((self.exponent + 2.0) / (self.exponent + 1.0) * pdf)
        } else {
            V::zero()
        };
        (value, pdf)
    }

    fn value(&self, surface: &Surface, incident: &Direction) -> V {
        self.value_and_pdf(surface, incident).0
    }

    fn sample(&self, _: usize, surface: &Surface, xi: &[f64]) -> Direction {
        PhongLobe { frame: Frame::new(surface.mirror()), exponent: self.exponent }.sample(xi)
    }

    fn pdf(&self, _: usize, surface: &Surface, incident: &Direction) -> f64 {
        pdf(self.exponent, surface.mirror(), incident)
    }

    fn ln_pdf(&self, _: usize, surface: &Surface, incident: &Direction) -> f64 {
        ln_pdf(self.exponent, surface.mirror(), incident)
    }
}

/// (n + 1) / (2π) cosⁿ α.
fn pdf(exponent: f64, axis: Direction, w: &Direction) -> f64 {
    ln_lobe(exponent, axis, w).map_or(0.0, |ln_lobe| (exponent + 1.0) / TAU * ln_lobe.exp())
}

fn ln_pdf(exponent: f64, axis: Direction, w: &Direction) -> f64 {
    let ln_lobe = ln_lobe(exponent, axis, w);
    ln_lobe.map_or(f64::NEG_INFINITY, |ln_lobe| ((exponent + 1.0) / TAU).ln() + ln_lobe)
}

/// ln cosⁿ α of the angle between `axis` and `w`, or `None` where α > 90°.
fn ln_lobe(exponent: f64, axis: Direction, w: &Direction) -> Option<f64> {
    let q = w.one_minus_cos(axis);
    // A direction at 90° counts as within the lobe, to the rounding of a direction.
    let within = q <= 1.0 + 4.0 * f64::EPSILON;
    within.then(|| exponent * (-q.min(1.0 - f64::EPSILON / 2.0)).ln_1p())
}

fn check_exponent(owner: &'static str, exponent: f64) -> Result<(), ArgumentError> {
    if (0.0..=LARGEST).contains(&exponent) {
        Ok(())
    } else {
        Err(ArgumentError::new(owner, "exponent", exponent, "it must be in [0, 1e24]"))
    }
}
