//! Lights and occluders, and the radiance that arrives at a point.

use glam::DVec3;

use super::direction::Direction;
use super::shape::{Shape, SolidAngle};
use crate::error::ArgumentError;
use crate::integrand::Value;
use crate::technique::Technique;

/// A grey value or one of `K` colour channels: `f64` or `[f64; K]`.
pub trait Spectrum: Value<Each<f64> = Self> + Copy + Send + Sync {
    /// The product, channel by channel, times `factor`.
    #[must_use]
    fn scaled_product(&self, other: &Self, factor: f64) -> Self {
        Self::each(|channel| self.times(channel, other.times(channel, factor)))
    }

    /// Every channel times `factor`.
    #[must_use]
    fn scaled(&self, factor: f64) -> Self {
        Self::each(|channel| self.times(channel, factor))
    }
}

impl<V: Value<Each<f64> = V> + Copy + Send + Sync> Spectrum for V {}

/// Checks every channel of `value` against `lower..=upper`.
pub(super) fn check_channels<V: Spectrum>(
    owner: &'static str,
    argument: &'static str,
    value: &V,
    upper: f64,
    rule: &'static str,
) -> Result<(), ArgumentError> {
    let valid =
        (0..V::COMPONENTS).all(|channel| (0.0..=upper).contains(&value.times(channel, 1.0)));
    if valid { Ok(()) } else { Err(ArgumentError::new(owner, argument, value, rule)) }
}

/// A shape that emits the same radiance from every point of its surface, in every direction.
///
/// A rectangle emits from both sides. A sphere does too: within it, the radiance arrives from
/// everywhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light<V> {
    shape: Shape,
    radiance: V,
}

impl<V: Spectrum> Light<V> {
    /// The light of this `shape` that emits `radiance`, in W / (m² sr) or any unit of the user's.
    ///
    /// # Errors
    ///
    /// Every channel of `radiance` must be finite and at least 0.
    pub fn new(shape: impl Into<Shape>, radiance: V) -> Result<Self, ArgumentError> {
        let rule = "every channel must be finite and at least 0";
        check_channels("Light", "radiance", &radiance, f64::MAX, rule)?;
        Ok(Self { shape: shape.into(), radiance })
    }

    /// The light as it is seen from `point`.
    ///
    /// # Errors
    ///
    /// As [`Shape::seen_from`].
    pub fn seen_from(&self, point: DVec3) -> Result<SeenLight<V>, ArgumentError> {
        let directions = self.shape.seen_from(point)?;
        Ok(SeenLight { directions, radiance: self.radiance })
    }
}

/// A light seen from a point: the technique "sample the light", per steradian.
///
/// A sample is a direction towards the light, uniform in its solid angle.
#[derive(Debug, Clone, PartialEq)]
pub struct SeenLight<V> {
    directions: SolidAngle,
    radiance: V,
}

impl<V: Spectrum> SeenLight<V> {
    /// The emitted radiance that arrives from the direction `w` if nothing is in the way: 0 where
    /// `w` misses the light.
    #[must_use]
    pub fn emitted(&self, w: &Direction) -> V {
        if self.directions.hit(w).is_some() { self.radiance } else { V::zero() }
    }

    /// The directions towards the light.
    #[must_use]
    pub fn directions(&self) -> &SolidAngle {
        &self.directions
    }
}

impl<V: Spectrum> Technique for SeenLight<V> {
    type Point = Direction;

    fn dimension(&self) -> usize {
        self.directions.dimension()
    }

    fn sample(&self, xi: &[f64]) -> Direction {
        self.directions.sample(xi)
    }

    fn pdf(&self, w: &Direction) -> f64 {
        self.directions.pdf(w)
    }
}

/// Lights, and what casts shadows.
///
/// Lights hide one another; occluders hide lights. Empty space elsewhere is black.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene<V> {
    lights: Vec<Light<V>>,
    occluders: Vec<Shape>,
}

impl<V: Spectrum> Scene<V> {
    /// The scene with nothing in it.
    #[must_use]
    pub fn new() -> Self {
        Self { lights: Vec::new(), occluders: Vec::new() }
    }

    /// With one more light.
    #[must_use]
    pub fn light(mut self, light: Light<V>) -> Self {
        self.lights.push(light);
        self
    }

    /// With one more shape that casts shadows and emits nothing.
    ///
    /// A surface does not shadow a point on itself, except where a direction leads into a sphere. A
    /// point is on it if it is to a few roundings of the coordinates; one that was computed along a
    /// ray from far away may have lost more digits, and lie below.
    #[must_use]
    pub fn occluder(mut self, shape: impl Into<Shape>) -> Self {
        self.occluders.push(shape.into());
        self
    }

    /// The radiance that arrives at `point`.
    ///
    /// # Errors
    ///
    /// `point` must be finite.
    pub fn seen_from(&self, point: DVec3) -> Result<Incident<V>, ArgumentError> {
        if !point.is_finite() {
            return Err(ArgumentError::new("Scene", "point", point, "it must be finite"));
        }
        // What fills no solid angle neither lights nor shadows the point.
        Ok(Incident {
            lights: self.lights.iter().filter_map(|light| light.seen_from(point).ok()).collect(),
            occluders: self.occluders.iter().filter_map(|s| s.seen_from(point).ok()).collect(),
        })
    }
}

/// The radiance L_i(p, ω) that arrives at a point p.
#[derive(Debug, Clone, PartialEq)]
pub struct Incident<V> {
    lights: Vec<SeenLight<V>>,
    occluders: Vec<SolidAngle>,
}

impl<V: Spectrum> Incident<V> {
    /// The lights, each a technique of its own: those that fill a solid angle, in the order of the
    /// scene.
    #[must_use]
    pub fn lights(&self) -> &[SeenLight<V>] {
        &self.lights
    }

    /// The radiance that arrives from the direction `w`: that of the nearest light, 0 where there
    /// is none or where an occluder is nearer.
    #[must_use]
    pub fn radiance(&self, w: &Direction) -> V {
        self.source(w).unwrap_or_else(V::zero)
    }

    pub(super) fn source(&self, w: &Direction) -> Option<V> {
        let mut nearest: Option<(f64, V)> = None;
        for light in &self.lights {
            if let Some(distance) = light.directions.hit(w)
                && nearest.is_none_or(|(least, _)| distance < least)
            {
                nearest = Some((distance, light.radiance));
            }
        }
        let (distance, radiance) = nearest?;
        let visible = !self.occluded(w, distance);
        visible.then_some(radiance)
    }

    /// Whether an occluder is met in the direction `w` within `distance`.
    ///
    /// What touches the far end, to 1 part in 10⁹, is not met: a light may lie on a wall.
    #[must_use]
    pub fn occluded(&self, w: &Direction, distance: f64) -> bool {
        let limit = distance * (1.0 - 1e-9);
        self.occluders.iter().any(|shape| shape.hit(w).is_some_and(|t| t < limit))
    }
}
