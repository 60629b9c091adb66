//! Diffuse reflection.

use std::f64::consts::FRAC_1_PI;

use super::bsdf::Bsdf;
use super::direction::{Direction, Frame};
use super::spectrum::{Spectrum, check_channels};
use super::surface::Surface;
use crate::error::ArgumentError;
use crate::technique::{Technique, canonical};

/// The cosine-weighted density on the hemisphere about a normal, per steradian.
///
/// p(ω) = cos θ / π above the surface, else 0. A sample has cos θ = √(1 - ξ₀) and the azimuth
/// 2π ξ₁.
///
/// ```
/// use mis::lighting::{CosineHemisphere, DVec3, Direction};
/// use mis::technique::Technique;
/// # fn main() -> Result<(), mis::ArgumentError> {
/// let p = CosineHemisphere::new(Direction::new(DVec3::Z)?);
/// let w = p.sample(&[0.75, 0.1]);
/// assert!((w.vector().z - 0.5).abs() < 1e-16);
/// assert!((p.pdf(&w) - 0.5 / std::f64::consts::PI).abs() < 1e-16);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CosineHemisphere {
    frame: Frame,
}

impl CosineHemisphere {
    /// The density about `normal`.
    #[must_use]
    pub fn new(normal: Direction) -> Self {
        Self { frame: Frame::new(normal) }
    }
}

impl Technique for CosineHemisphere {
    type Point = Direction;

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> Direction {
        let u = canonical(xi, 0);
        self.frame.around(u / (1.0 + (1.0 - u).sqrt()), canonical(xi, 1))
    }

    fn pdf(&self, w: &Direction) -> f64 {
        FRAC_1_PI * w.cos(self.frame.axis).max(0.0)
    }
}

/// Diffuse reflection: f_r = ρ / π above the surface.
///
/// It is sampled by [`CosineHemisphere`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lambert<V> {
    albedo: V,
}

impl<V: Spectrum> Lambert<V> {
    /// The diffuse surface that reflects the fraction `albedo`, ρ.
    ///
    /// # Errors
    ///
    /// Every channel of `albedo` must be in \[0, 1\].
    pub fn new(albedo: V) -> Result<Self, ArgumentError> {
        check_channels("Lambert", "albedo", &albedo, 1.0, "every channel must be in [0, 1]")?;
        Ok(Self { albedo })
    }
}

impl<V: Spectrum> Bsdf for Lambert<V> {
    type Value = V;

    fn value(&self, surface: &Surface, incident: &Direction) -> V {
        if incident.cos(surface.normal()) > 0.0 { self.albedo.scaled(FRAC_1_PI) } else { V::zero() }
    }

    fn sample(&self, _: usize, surface: &Surface, xi: &[f64]) -> Direction {
        CosineHemisphere { frame: *surface.frame() }.sample(xi)
    }

    fn pdf(&self, _: usize, surface: &Surface, incident: &Direction) -> f64 {
        CosineHemisphere { frame: *surface.frame() }.pdf(incident)
    }
}
