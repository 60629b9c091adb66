//! Glossy reflection from microfacets.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::bsdf::Bsdf;
use super::direction::{Direction, Frame};
use super::spectrum::{Spectrum, check_channels};
use super::surface::Surface;
use crate::error::ArgumentError;
use crate::technique::{Technique, canonical};

/// The smallest roughness: the lobe is then as wide as a direction is exact, times some millions.
const SMOOTHEST: f64 = 1e-9;

/// The GGX distribution of microfacet normals, with Smith's masking.
///
/// In the local frame of a surface, whose normal is the third coordinate:
/// D(m) = 1 / (π α² (|m_xy|² / α² + m_z²)²), and
/// G1(ω) = 2 / (1 + √(1 + α² tan² θ)).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Microfacets {
    alpha: f64,
}

impl Microfacets {
    /// D from m_xy and m_z: with the sine itself, not √(1 - m_z²), which has no digits left in a
    /// narrow lobe.
    fn density(self, m: DVec3) -> f64 {
        let k = (DVec2::new(m.x, m.y) / self.alpha).length_squared() + m.z * m.z;
        (PI * self.alpha * self.alpha * k * k).recip()
    }

    /// G1 / cos θ = 2 / (cos θ + √(cos² θ + α² sin² θ)), which is finite where cos θ is 0.
    fn masking_over_cos(self, w: DVec3) -> f64 {
        let sin2 = w.x * w.x + w.y * w.y;
        2.0 / (w.z + (w.z * w.z + self.alpha * self.alpha * sin2).sqrt())
    }
}

/// The directions of light that mirrors on the visible normals of a rough surface send to the eye, per
/// steradian.
///
/// With the half vector m of ω and the direction ω_o to the eye:
/// p(ω) = G1(ω_o) D(m) / (4 cos θ_o), 0 where ω_o and m are on different sides. Part of it is below
/// the surface.
///
/// ```
/// use mis::lighting::{DVec3, Direction, GgxLobe, Surface};
/// use mis::technique::Technique;
/// # fn main() -> Result<(), mis::ArgumentError> {
/// let up = Direction::new(DVec3::Z)?;
/// let p = GgxLobe::new(&Surface::new(DVec3::ZERO, up, up)?, 0.1)?;
/// // At normal incidence, the mirror direction has the density D / 4 = 1 / (4 π α²).
/// assert!((p.pdf(&up) * 4.0 * std::f64::consts::PI * 0.01 - 1.0).abs() < 1e-14);
/// # Ok(())
/// # }
/// ```
///
/// Sources: B. Walter, S. R. Marschner, H. Li and K. E. Torrance, *Microfacet Models for Refraction
/// through Rough Surfaces*, 2007, for D and G1; E. Heitz, *Sampling the GGX Distribution of Visible
/// Normals*, 2018; J. Dupuy and A. Benyoub, *Sampling Visible GGX Normals with Spherical Caps*, 2023,
/// for the sampling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GgxLobe {
    frame: Frame,
    facets: Microfacets,
    /// ω_o in the frame.
    outgoing: DVec3,
    /// G1(ω_o) / (4 cos θ_o).
    factor: f64,
}

impl GgxLobe {
    /// The lobe at `surface` with this `roughness`, α.
    ///
    /// # Errors
    ///
    /// `roughness` must be in \[1e-9, 1\].
    pub fn new(surface: &Surface, roughness: f64) -> Result<Self, ArgumentError> {
        check_roughness("GgxLobe", roughness)?;
        Ok(Self::at(surface, Microfacets { alpha: roughness }))
    }

    fn at(surface: &Surface, facets: Microfacets) -> Self {
        let frame = *surface.frame();
        let outgoing = frame.local(surface.outgoing());
        let factor = 0.25 * facets.masking_over_cos(outgoing);
        Self { frame, facets, outgoing, factor }
    }

    /// The half vector of ω_o and `incident`, on the side of ω_o.
    fn half_vector(&self, incident: DVec3) -> DVec3 {
        let sum = self.outgoing + incident;
        let length = sum.length();
        if length > 0.0 { sum / length } else { DVec3::ZERO }
    }
}

impl Technique for GgxLobe {
    type Point = Direction;

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> Direction {
        let alpha = self.facets.alpha;
        // In the space where the surface is a hemisphere, mirrors send light from a cap of directions.
        let v = self.outgoing * DVec3::new(alpha, alpha, 1.0);
        let v = v / v.length();
        let z = 1.0 - canonical(xi, 0) * (1.0 + v.z);
        let sin = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
        let (sin_phi, cos_phi) = (TAU * canonical(xi, 1)).sin_cos();
        let m = DVec3::new(sin * cos_phi + v.x, sin * sin_phi + v.y, z + v.z);
        let m = m * DVec3::new(alpha, alpha, 1.0);
        let m = m / m.length();
        self.frame.world(2.0 * self.outgoing.dot(m) * m - self.outgoing)
    }

    fn pdf(&self, w: &Direction) -> f64 {
        let m = self.half_vector(self.frame.local(*w));
        // The rim, where own samples may be, is as wide as a direction is exact.
        let within = m.z > -4.0 * f64::EPSILON && m != DVec3::ZERO;
        if within { self.factor * self.facets.density(m) } else { 0.0 }
    }
}

/// A conductor with microfacets: f_r = ρ D(m) G1(ω) G1(ω_o) / (4 cos θ cos θ_o), with the half vector m.
///
/// Masking and shadowing are taken as independent of each other; ρ is the same for all angles. It is
/// sampled by [`GgxLobe`].
///
/// Source: Walter, Marschner, Li and Torrance 2007.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GgxConductor<V> {
    reflectance: V,
    facets: Microfacets,
}

impl<V: Spectrum> GgxConductor<V> {
    /// The conductor that reflects the fraction `reflectance`, ρ, from facets of this `roughness`, α.
    ///
    /// # Errors
    ///
    /// Every channel of `reflectance` must be in \[0, 1\], and `roughness` in \[1e-9, 1\].
    pub fn new(reflectance: V, roughness: f64) -> Result<Self, ArgumentError> {
        const OWNER: &str = "GgxConductor";
        let rule = "every channel must be in [0, 1]";
        check_channels(OWNER, "reflectance", &reflectance, 1.0, rule)?;
        check_roughness(OWNER, roughness)?;
        Ok(Self { reflectance, facets: Microfacets { alpha: roughness } })
    }
}

impl<V: Spectrum> Bsdf for GgxConductor<V> {
    type Value = V;

    fn value(&self, surface: &Surface, incident: &Direction) -> V {
        let lobe = GgxLobe::at(surface, self.facets);
        let w = lobe.frame.local(*incident);
        if w.z > 0.0 {
            let m = lobe.half_vector(w);
            let masked = lobe.factor * self.facets.masking_over_cos(w);
            self.reflectance.scaled(masked * self.facets.density(m))
        } else {
            V::zero()
        }
    }

    fn sample(&self, _: usize, surface: &Surface, xi: &[f64]) -> Direction {
        GgxLobe::at(surface, self.facets).sample(xi)
    }

    fn pdf(&self, _: usize, surface: &Surface, incident: &Direction) -> f64 {
        GgxLobe::at(surface, self.facets).pdf(incident)
    }
}

fn check_roughness(owner: &'static str, roughness: f64) -> Result<(), ArgumentError> {
    if (SMOOTHEST..=1.0).contains(&roughness) {
        Ok(())
    } else {
        Err(ArgumentError::new(owner, "roughness", roughness, "it must be in [1e-9, 1]"))
    }
}
