//! Lights, surfaces, and what casts shadows.

use std::sync::Arc;

use glam::DVec3;

use super::bsdf::Bsdf;
use super::direction::{Direction, length};
use super::incident::{Incident, Ray};
use super::light::{Light, PointLight};
use super::rectangle::Rectangle;
use super::shape::{Outline, Shape};
use super::spectrum::Spectrum;
use super::surface::Surface;
use crate::error::ArgumentError;

/// Lights, surfaces that reflect them, and what casts shadows.
///
/// Lights hide one another; surfaces and occluders hide lights. Empty space elsewhere is black.
#[derive(Debug, Clone)]
pub struct Scene<V> {
    lights: Vec<Light<V>>,
    point_lights: Vec<PointLight<V>>,
    surfaces: Vec<(Rectangle, Arc<dyn Bsdf<Value = V>>)>,
    occluders: Vec<Shape>,
}

impl<V> Default for Scene<V> {
    fn default() -> Self {
        let (lights, point_lights) = (Vec::new(), Vec::new());
        Self { lights, point_lights, surfaces: Vec::new(), occluders: Vec::new() }
    }
}

impl<V: Spectrum> Scene<V> {
    /// The scene with nothing in it.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// With one more light.
    #[must_use]
    pub fn light(mut self, light: Light<V>) -> Self {
        self.lights.push(light);
        self
    }

    /// With one more light that has no size.
    #[must_use]
    pub fn point_light(mut self, light: PointLight<V>) -> Self {
        self.point_lights.push(light);
        self
    }

    /// With one more surface, which reflects by `bsdf` on both sides, and casts shadows.
    #[must_use]
    pub fn surface(mut self, rectangle: Rectangle, bsdf: impl Bsdf<Value = V> + 'static) -> Self {
        self.surfaces.push((rectangle, Arc::new(bsdf)));
        self
    }

    /// With one more shape that casts shadows; it is black.
    ///
    /// A shape does not shadow a point on itself, except where a direction leads into a sphere. A
    /// point is on it if it is to a few roundings of the coordinates; one that was computed along a
    /// ray from far away may have lost more digits, and lie below.
    #[must_use]
    pub fn occluder(mut self, shape: impl Into<Shape>) -> Self {
        self.occluders.push(shape.into());
        self
    }

    /// The lights that have a size.
    #[must_use]
    pub fn lights(&self) -> &[Light<V>] {
        &self.lights
    }

    /// The radiance that arrives at `point`.
    ///
    /// # Errors
    ///
    /// `point` must be finite, and not the position of a point light.
    pub fn seen_from(&self, point: DVec3) -> Result<Incident<V>, ArgumentError> {
        let mut incident = Incident::nothing();
        self.see_from(point, None, &mut incident)?;
        Ok(incident)
    }

    /// Makes `incident` the radiance that arrives at a point, which is on the surface with this number if
    /// there is one.
    pub(super) fn see_from(
        &self,
        point: DVec3,
        surface: Option<usize>,
        incident: &mut Incident<V>,
    ) -> Result<(), ArgumentError> {
        if !point.is_finite() {
            return Err(ArgumentError::new("Scene", "point", point, "it must be finite"));
        }
        // What fills no solid angle neither lights nor shadows the point.
        let Incident { lights, point_lights, occluders } = incident;
        lights.clear();
        point_lights.clear();
        occluders.clear();
        for (number, light) in self.lights.iter().enumerate() {
            if light.is_behind(point) {
                occluders.extend(light.shape().outline_from(point));
            } else if let Ok(mut seen) = light.seen_from(point) {
                seen.number = number;
                lights.push(seen);
            }
        }
        let others = (0..).zip(&self.surfaces).filter(|(number, _)| Some(*number) != surface);
        let outlines = others.filter_map(|(_, (rectangle, _))| rectangle.outline_from(point));
        occluders.extend(outlines.map(Outline::Rectangle));
        occluders.extend(self.occluders.iter().filter_map(|shape| shape.outline_from(point)));
        for light in &self.point_lights {
            let to_light = light.position() - point;
            let distance = length(to_light);
            let direction = Direction::new(to_light).map_err(|_| {
                let rule = "it must not be the position of a point light";
                ArgumentError::new("Scene", "point", point, rule)
            })?;
            let flux = light.intensity().scaled(1.0 / distance).scaled(1.0 / distance);
            point_lights.push(Ray { direction, distance, flux });
        }
        Ok(())
    }

    /// The scene as it is seen from an eye at `point`.
    pub(super) fn view_from(&self, point: DVec3) -> View<'_, V> {
        let lights = self.lights.iter().filter_map(|light| {
            let radiance = if light.is_behind(point) { V::zero() } else { light.radiance() };
            Some((light.shape().outline_from(point)?, Met::Light(radiance)))
        });
        let surfaces = self.surfaces.iter().enumerate().filter_map(|(number, (rectangle, _))| {
            Some((Outline::Rectangle(rectangle.outline_from(point)?), Met::Surface(number)))
        });
        let occluders = self
            .occluders
            .iter()
            .filter_map(|shape| Some((shape.outline_from(point)?, Met::Light(V::zero()))));
        View { scene: self, eye: point, shapes: lights.chain(surfaces).chain(occluders).collect() }
    }
}

/// A scene as it is seen from an eye.
#[derive(Debug)]
pub(super) struct View<'a, V> {
    scene: &'a Scene<V>,
    eye: DVec3,
    shapes: Vec<(Outline, Met<V>)>,
}

#[derive(Debug, Clone, Copy)]
enum Met<V> {
    /// The emitted radiance.
    Light(V),
    Surface(usize),
}

/// What is seen in a direction.
pub(super) enum Seen<'a, V> {
    /// This radiance, without any reflection.
    Emitted(V),
    /// A point of a surface.
    Surface { surface: Surface, bsdf: &'a dyn Bsdf<Value = V>, number: usize },
}

impl<'a, V: Spectrum> View<'a, V> {
    /// What is nearest in the direction `w`.
    pub(super) fn along(&self, w: &Direction) -> Seen<'a, V> {
        let mut nearest: Option<(f64, &Met<V>)> = None;
        for (outline, met) in &self.shapes {
            if let Some(distance) = outline.hit(w)
                && nearest.is_none_or(|(least, _)| distance < least)
            {
                nearest = Some((distance, met));
            }
        }
        match nearest {
            None => Seen::Emitted(V::zero()),
            Some((_, Met::Light(radiance))) => Seen::Emitted(*radiance),
            Some((distance, Met::Surface(number))) => self.surface(*number, distance, w),
        }
    }

    fn surface(&self, number: usize, distance: f64, w: &Direction) -> Seen<'a, V> {
        let Some((rectangle, bsdf)) = self.scene.surfaces.get(number) else {
            return Seen::Emitted(V::zero());
        };
        let outgoing = Direction::from_unit(-w.vector());
        let normal = rectangle.normal();
        let normal = if outgoing.cos(normal) < 0.0 { normal.opposite() } else { normal };
        let position = rectangle.projected(self.eye + distance * w.vector());
        let surface = Surface::seen(position, normal, outgoing);
        Seen::Surface { surface, bsdf: &**bsdf, number }
    }
}
