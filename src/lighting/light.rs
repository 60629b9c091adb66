//! Lights, and lights as they are seen from a point.

use glam::DVec3;

use super::direction::Direction;
use super::rectangle::Rectangle;
use super::shape::{Shape, SolidAngle};
use super::spectrum::{Spectrum, check_channels};
use crate::error::ArgumentError;
use crate::technique::Technique;

/// A shape that emits the same radiance from every point of its surface, in every direction, and
/// reflects nothing.
///
/// A rectangle emits from both sides, or [from one](Light::one_sided). A sphere does too: within it,
/// the radiance arrives from everywhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light<V> {
    shape: Shape,
    radiance: V,
    /// The normal of the side that emits, if only one does.
    front: Option<Direction>,
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
        Ok(Self { shape: shape.into(), radiance, front: None })
    }

    /// The light that emits from one side of a rectangle, that of its [normal](Rectangle::normal).
    /// The other side is black.
    ///
    /// # Errors
    ///
    /// As [`new`](Light::new).
    pub fn one_sided(rectangle: Rectangle, radiance: V) -> Result<Self, ArgumentError> {
        Ok(Self { front: Some(rectangle.normal()), ..Self::new(rectangle, radiance)? })
    }

    /// The shape.
    #[must_use]
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The radiance that it emits.
    #[must_use]
    pub fn radiance(&self) -> V {
        self.radiance
    }

    /// What it emits over its whole surface, up to the factor π: the radiance times the area.
    #[must_use]
    pub fn power(&self) -> V {
        let sides = if self.front.is_some() { 0.5 } else { 1.0 };
        self.radiance.scaled(sides * self.shape.area())
    }

    /// Whether `point` is where nothing is emitted to.
    pub(super) fn is_behind(&self, point: DVec3) -> bool {
        let ahead = |front: Direction| front.vector().dot(point - self.shape.centre()) > 0.0;
        !self.front.is_none_or(ahead)
    }

    /// The light as it is seen from `point`.
    ///
    /// # Errors
    ///
    /// As [`Shape::seen_from`]; and `point` must not be behind a one-sided light.
    pub fn seen_from(&self, point: DVec3) -> Result<SeenLight<V>, ArgumentError> {
        if self.is_behind(point) {
            let rule = "it must be on the side that emits";
            return Err(ArgumentError::new("Light", "point", point, rule));
        }
        let directions = self.shape.seen_from(point)?;
        Ok(SeenLight { directions, radiance: self.radiance, number: 0 })
    }
}

/// A light without size: a position, from which an intensity goes out in every direction.
///
/// There is no density of directions towards it, so that no technique can sample it. What arrives from
/// it is a sum, not an integral: [`ReflectedRadiance::from_point_lights`].
///
/// [`ReflectedRadiance::from_point_lights`]: super::ReflectedRadiance::from_point_lights
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointLight<V> {
    position: DVec3,
    intensity: V,
}

impl<V: Spectrum> PointLight<V> {
    /// The light at `position` with this `intensity`, in W / sr: that of a small sphere is its radiance
    /// times π r².
    ///
    /// # Errors
    ///
    /// `position` must be finite; every channel of `intensity` finite and at least 0.
    pub fn new(position: DVec3, intensity: V) -> Result<Self, ArgumentError> {
        const OWNER: &str = "PointLight";
        if !position.is_finite() {
            return Err(ArgumentError::new(OWNER, "position", position, "it must be finite"));
        }
        let rule = "every channel must be finite and at least 0";
        check_channels(OWNER, "intensity", &intensity, f64::MAX, rule)?;
        Ok(Self { position, intensity })
    }

    /// The position.
    #[must_use]
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// The intensity.
    #[must_use]
    pub fn intensity(&self) -> V {
        self.intensity
    }
}

/// A light seen from a point: the technique "sample the light", per steradian.
///
/// A sample is a direction towards the light, uniform in its solid angle.
#[derive(Debug, Clone, PartialEq)]
pub struct SeenLight<V> {
    directions: SolidAngle,
    pub(super) radiance: V,
    /// Its place among the lights of the scene.
    pub(super) number: usize,
}

impl<V: Spectrum> SeenLight<V> {
    /// The emitted radiance that arrives from the direction `w` if nothing is in the way: 0 where
    /// `w` misses the light.
    #[must_use]
    pub fn emitted(&self, w: &Direction) -> V {
        if self.directions.hit(w).is_some() { self.radiance } else { V::zero() }
    }

    /// The distance in the direction `w`; infinite where that misses the light.
    pub(super) fn distance(&self, w: &Direction) -> f64 {
        self.directions.hit(w).unwrap_or(f64::INFINITY)
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

    #[inline(always)]
    fn sample(&self, xi: &[f64]) -> Direction {
        self.directions.sample(xi)
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<Direction>) {
        self.directions.sample_batch(xi, xs);
    }

    fn pdf(&self, w: &Direction) -> f64 {
        self.directions.pdf(w)
    }
}
