//! The radiance that arrives at a point.

use super::direction::Direction;
use super::light::SeenLight;
use super::shape::Outline;
use super::spectrum::Spectrum;

/// The radiance L_i(p, ω) that arrives at a point p.
#[derive(Debug, Clone, PartialEq)]
pub struct Incident<V> {
    pub(super) lights: Vec<SeenLight<V>>,
    pub(super) point_lights: Vec<Ray<V>>,
    pub(super) occluders: Vec<Outline>,
}

/// What arrives from a point light if nothing is in the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ray<V> {
    pub(super) direction: Direction,
    pub(super) distance: f64,
    /// The power per area across the direction: the intensity over the squared distance.
    pub(super) flux: V,
}

impl<V: Spectrum> Incident<V> {
    /// No light, and nothing in its way.
    pub(super) fn nothing() -> Self {
        Self { lights: Vec::new(), point_lights: Vec::new(), occluders: Vec::new() }
    }

    /// The lights, each a technique of its own: those that fill a solid angle, in the order of the
    /// scene.
    #[must_use]
    pub fn lights(&self) -> &[SeenLight<V>] {
        &self.lights
    }

    /// The light with this number in the scene, if it fills a solid angle.
    #[inline(always)]
    pub(super) fn numbered(&self, number: usize) -> Option<&SeenLight<V>> {
        // Lights before it may be missing.
        let place = self.lights.get(number).filter(|light| light.number == number);
        place.or_else(|| self.lights.iter().find(|light| light.number == number))
    }

    /// The radiance that arrives from the direction `w`: that of the nearest light, 0 where there
    /// is none or where an occluder is nearer.
    #[must_use]
    pub fn radiance(&self, w: &Direction) -> V {
        self.source(w).unwrap_or_else(V::zero)
    }

    pub(super) fn source(&self, w: &Direction) -> Option<V> {
        self.visible(w, |_| ()).map(|light| light.radiance)
    }

    /// The light that is seen in the direction `w`; `meet` is told of every one that it meets, hidden or
    /// not.
    #[inline(always)]
    pub(super) fn visible(
        &self,
        w: &Direction,
        mut meet: impl FnMut(&SeenLight<V>),
    ) -> Option<&SeenLight<V>> {
        let mut nearest: Option<&SeenLight<V>> = None;
        for light in &self.lights {
            if light.directions().contains(w) {
                meet(light);
                let hidden = nearest.is_some_and(|other| other.distance(w) <= light.distance(w));
                nearest = if hidden { nearest } else { Some(light) };
            }
        }
        // How far away it is only matters where something may be in between.
        nearest.filter(|light| self.occluders.is_empty() || !self.occluded(w, light.distance(w)))
    }

    /// Whether an occluder is met in the direction `w` within `distance`.
    ///
    /// What touches the far end, to 1 part in 10⁹, is not met: a light may lie on a wall.
    #[must_use]
    pub fn occluded(&self, w: &Direction, distance: f64) -> bool {
        let limit = distance * (1.0 - 1e-9);
        self.occluders.iter().any(|shape| shape.hit(w).is_some_and(|t| t < limit))
    }

    /// The point lights that nothing hides, neither an occluder nor another light.
    pub(super) fn visible_point_lights(&self) -> impl Iterator<Item = &Ray<V>> {
        self.point_lights.iter().filter(|Ray { direction, distance, .. }| {
            let hides = |light: &SeenLight<V>| light.distance(direction) < *distance;
            !self.lights.iter().any(hides) && !self.occluded(direction, *distance)
        })
    }
}
