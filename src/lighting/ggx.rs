//! Glossy reflection from microfacets.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::bsdf::Bsdf;
use super::direction::{Direction, Frame};
use super::spectrum::{Spectrum, check_channels};
use super::surface::Surface;
use super::turn::sin_cos_of_turn;
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
    /// 1 / α².
    sharpness: f64,
}

impl Microfacets {
    fn new(owner: &'static str, alpha: f64) -> Result<Self, ArgumentError> {
        if (SMOOTHEST..=1.0).contains(&alpha) {
            Ok(Self { alpha, sharpness: (alpha * alpha).recip() })
        } else {
            Err(ArgumentError::new(owner, "roughness", alpha, "it must be in [1e-9, 1]"))
        }
    }

    /// The density of directions that mirrors on visible normals send light from to the direction
    /// `outgoing`, G1(ω_o) D(m) / (4 cos θ_o).
    ///
    /// D is made of a half vector of any length, and of its sine, not of √(1 - m_z²), which has no
    /// digits left in a narrow lobe.
    fn pdf(self, outgoing: DVec3, incident: DVec3) -> f64 {
        let m = outgoing + incident;
        let (sin2, cos2) = (m.x * m.x + m.y * m.y, m.z * m.z);
        let length2 = sin2 + cos2;
        // The rim, where own samples may be, is as wide as a direction is exact.
        let rim = 16.0 * f64::EPSILON * f64::EPSILON;
        if length2 > 0.0 && (m.z > 0.0 || cos2 < rim) {
            let k = self.sharpness * sin2 + cos2;
            let d = FRAC_1_PI * self.sharpness * length2 * length2;
            0.5 * d / (k * k * self.unmasking(outgoing))
        } else {
            0.0
        }
    }

    /// One of these directions.
    #[inline(always)]
    fn sample(self, outgoing: DVec3, xi: &[f64]) -> DVec3 {
        // In the space where the surface is a hemisphere, mirrors send light from the cap of directions
        // z >= -v.z: z = 1 - u (1 + v.z). In z + v.z and 1 + z, nothing cancels.
        let stretch = DVec3::new(self.alpha, self.alpha, 1.0);
        let v = (outgoing * stretch).normalize();
        let (u, height) = (canonical(xi, 0), 1.0 + v.z);
        let up = (1.0 - u) * height;
        let sin = (u * (v.x * v.x + v.y * v.y + up * height)).sqrt();
        let (sin_phi, cos_phi) = sin_cos_of_turn(canonical(xi, 1));
        let m = DVec3::new(sin * cos_phi + v.x, sin * sin_phi + v.y, up) * stretch;
        (2.0 * outgoing.dot(m) / m.length_squared()) * m - outgoing
    }

    /// 2 cos θ / G1 = cos θ + √(cos² θ + α² sin² θ).
    fn unmasking(self, w: DVec3) -> f64 {
        let sin2 = w.x * w.x + w.y * w.y;
        w.z + (w.z * w.z + self.alpha * self.alpha * sin2).sqrt()
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
}

impl GgxLobe {
    /// The lobe at `surface` with this `roughness`, α.
    ///
    /// # Errors
    ///
    /// `roughness` must be in \[1e-9, 1\].
    pub fn new(surface: &Surface, roughness: f64) -> Result<Self, ArgumentError> {
        let facets = Microfacets::new("GgxLobe", roughness)?;
        Ok(Self { frame: *surface.frame(), facets, outgoing: surface.local_outgoing() })
    }
}

impl Technique for GgxLobe {
    type Point = Direction;

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> Direction {
        self.frame.world(self.facets.sample(self.outgoing, xi))
    }

    fn pdf(&self, w: &Direction) -> f64 {
        self.facets.pdf(self.outgoing, self.frame.local(*w))
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
        Ok(Self { reflectance, facets: Microfacets::new(OWNER, roughness)? })
    }
}

impl<V: Spectrum> Bsdf for GgxConductor<V> {
    type Value = V;

    fn value(&self, surface: &Surface, incident: &Direction) -> V {
        self.value_and_pdf(surface, incident).0
    }

    fn value_and_pdf(&self, surface: &Surface, incident: &Direction) -> (V, f64) {
        let w = surface.frame().local(*incident);
        let pdf = self.facets.pdf(surface.local_outgoing(), w);
        let value = if w.z > 0.0 {
            self.reflectance.scaled(2.0 * pdf / self.facets.unmasking(w))
        } else {
            V::zero()
        };
        (value, pdf)
    }

    #[inline(always)]
    fn sample(&self, _: usize, surface: &Surface, xi: &[f64]) -> Direction {
        surface.frame().world(self.facets.sample(surface.local_outgoing(), xi))
    }

    fn pdf(&self, _: usize, surface: &Surface, incident: &Direction) -> f64 {
        self.facets.pdf(surface.local_outgoing(), surface.frame().local(*incident))
    }
}
