//! What a pixel integrates over: rays of the camera, and directions of light where they meet a surface.

use std::f64::consts::TAU;

use crate::integrand::Integrand;
use crate::lighting::bsdf::Bsdf;
use crate::lighting::direction::Direction;
use crate::lighting::incident::Incident;
use crate::lighting::reflected::ReflectedRadiance;
use crate::lighting::spectrum::Spectrum;
use crate::lighting::surface::Surface;
use crate::technique::{Technique, canonical};

/// A ray of the camera, by its number among those of a tile, and a direction of light at its end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Path {
    pub(super) ray: usize,
    pub(super) w: Direction,
}

/// What a ray of the camera meets.
pub(super) enum End<'a, V> {
    /// Radiance as it is emitted; it does not depend on a direction of light.
    Emitted(V),
    /// A surface, and what arrives there.
    Surface {
        surface: Surface,
        bsdf: &'a dyn Bsdf<Value = V>,
        incident: Incident<V>,
        /// What the point lights add.
        exact: V,
    },
}

/// 1 / (4π), the uniform density of directions.
const UNIFORM: f64 = 0.5 / TAU;

/// The radiance that comes along a ray from a direction of light. The integral over both, with the mean
/// over the rays and per steradian, is the mean radiance of the rays.
pub(super) struct Radiance<'a, V>(pub(super) &'a [End<'a, V>]);

impl<V: Spectrum> Integrand<Path> for Radiance<'_, V> {
    type Value = V;

    fn eval(&self, path: &Path) -> V {
        match &self.0[path.ray] {
            End::Emitted(radiance) => radiance.scaled(UNIFORM),
            End::Surface { surface, bsdf, incident, .. } => {
                ReflectedRadiance::new(incident, *surface, *bsdf).eval(&path.w)
            }
        }
    }
}

/// The ray that a canonical number stands for.
fn ray(rays: usize, xi: f64) -> usize {
    // Rounding down is meant; the last ray takes what rounds up to the number of rays.
    ((xi * rays as f64) as usize).min(rays.saturating_sub(1))
}

/// A direction from the uniform density, for what no light or lobe is sampled.
fn anywhere(xi: &[f64]) -> Direction {
    let z = 1.0 - 2.0 * canonical(xi, 0);
    let (sin_phi, cos_phi) = (TAU * canonical(xi, 1)).sin_cos();
    let r = (1.0 - z * z).sqrt();
    Direction::from_unit(glam::DVec3::new(r * cos_phi, r * sin_phi, z))
}

/// A ray, then a direction towards one light: uniform in its solid angle, or in all directions where it
/// has none. Canonical numbers: the ray, and two for the direction.
#[derive(Clone, Copy)]
pub(super) struct ToLight<'a, V> {
    pub(super) ends: &'a [End<'a, V>],
    pub(super) light: usize,
}

impl<V: Spectrum> Technique for ToLight<'_, V> {
    type Point = Path;

    fn dimension(&self) -> usize {
        3
    }

    fn sample(&self, xi: &[f64]) -> Path {
        let ray = ray(self.ends.len(), canonical(xi, 0));
        let xi = xi.get(1..).unwrap_or_default();
        let w = match &self.ends[ray] {
            End::Surface { incident, .. } if let Some(light) = incident.numbered(self.light) => {
                light.sample(xi)
            }
            _ => anywhere(xi),
        };
        Path { ray, w }
    }

    fn pdf(&self, path: &Path) -> f64 {
        match &self.ends[path.ray] {
            End::Surface { incident, .. } => {
                incident.numbered(self.light).map_or(UNIFORM, |light| light.pdf(&path.w))
            }
            End::Emitted(_) => UNIFORM,
        }
    }
}

/// A ray, then a direction from the lobes of its surface, all equally likely. Canonical numbers: the
/// lobe, the ray, and two for the direction.
pub(super) struct FromBsdf<'a, V>(pub(super) &'a [End<'a, V>]);

impl<V: Spectrum> Technique for FromBsdf<'_, V> {
    type Point = Path;

    fn dimension(&self) -> usize {
        4
    }

    fn sample(&self, xi: &[f64]) -> Path {
        let ray = ray(self.0.len(), canonical(xi, 1));
        let own = xi.get(2..).unwrap_or_default();
        let w = match &self.0[ray] {
            End::Surface { surface, bsdf, .. } => {
                let lobes = bsdf.lobes();
                let lobe = ((canonical(xi, 0) * lobes as f64) as usize).min(lobes - 1);
                bsdf.sample(lobe, surface, own)
            }
            End::Emitted(_) => anywhere(own),
        };
        Path { ray, w }
    }

    fn pdf(&self, path: &Path) -> f64 {
        match &self.0[path.ray] {
            End::Surface { surface, bsdf, .. } => {
                let lobes = bsdf.lobes();
                let sum: f64 = (0..lobes).map(|lobe| bsdf.pdf(lobe, surface, &path.w)).sum();
                sum / lobes as f64
            }
            End::Emitted(_) => UNIFORM,
        }
    }
}
