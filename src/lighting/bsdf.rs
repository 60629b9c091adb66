//! How a surface reflects: the interface, and the sum of two BSDFs.

use glam::DVec3;

use super::direction::Direction;
use super::scene::Spectrum;
use crate::error::ArgumentError;
use crate::integrand::Value;
use crate::technique::Technique;

/// A point of a surface, with the direction in which its light is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    position: DVec3,
    normal: Direction,
    outgoing: Direction,
    mirror: Direction,
}

impl Surface {
    /// The surface at `position` with this `normal`, seen from the direction `outgoing`.
    ///
    /// # Errors
    ///
    /// `position` must be finite, and `outgoing` on the side of the normal: surfaces are opaque.
    pub fn new(
        position: DVec3,
        normal: Direction,
        outgoing: Direction,
    ) -> Result<Self, ArgumentError> {
        if !position.is_finite() {
            return Err(ArgumentError::new("Surface", "position", position, "it must be finite"));
        }
        if !(outgoing.cos(normal) > 0.0) {
            let rule = "it must be on the side of the normal";
            return Err(ArgumentError::new("Surface", "outgoing", outgoing, rule));
        }
        Ok(Self { position, normal, outgoing, mirror: outgoing.reflected(normal) })
    }

    /// The point p.
    #[must_use]
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// The normal.
    #[must_use]
    pub fn normal(&self) -> Direction {
        self.normal
    }

    /// The direction ω_o towards the eye.
    #[must_use]
    pub fn outgoing(&self) -> Direction {
        self.outgoing
    }

    /// The mirror direction of ω_o.
    #[must_use]
    pub fn mirror(&self) -> Direction {
        self.mirror
    }
}

/// A bidirectional scattering distribution function, f_r(p, ω_i, ω_o).
///
/// The sum of two is the pair of them, `(diffuse, glossy)`.
#[doc(alias("BRDF", "material"))]
pub trait Bsdf: Sync {
    /// Grey or colour.
    type Value: Spectrum;

    /// f_r(p, ω_i, ω_o) for light from the direction `incident`, per steradian; 0 below the
    /// surface.
    fn value(&self, surface: &Surface, incident: &Direction) -> Self::Value;

    /// The techniques that sample the BSDF at `surface`, one a lobe, with pdfs per steradian.
    ///
    /// Samples may fall below the surface. They contribute 0 and count.
    fn techniques(&self, surface: &Surface) -> Vec<Box<dyn Technique<Point = Direction>>>;
}

impl<A: Bsdf, B: Bsdf<Value = A::Value>> Bsdf for (A, B) {
    type Value = A::Value;

    fn value(&self, surface: &Surface, incident: &Direction) -> Self::Value {
        let (a, b) = (self.0.value(surface, incident), self.1.value(surface, incident));
        Self::Value::each(|channel| a.times(channel, 1.0) + b.times(channel, 1.0))
    }

    fn techniques(&self, surface: &Surface) -> Vec<Box<dyn Technique<Point = Direction>>> {
        let mut all = self.0.techniques(surface);
        all.extend(self.1.techniques(surface));
        all
    }
}
