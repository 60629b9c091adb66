//! The radiance that leaves a surface.

use super::bsdf::Bsdf;
use super::direction::Direction;
use super::incident::Incident;
use super::spectrum::Spectrum;
use super::surface::Surface;
use crate::integrand::{Integrand, Value};

/// The integrand of the reflected radiance L_r(p, ω_o), with respect to solid angle:
///
/// f(ω) = f_r(p, ω, ω_o) L_i(p, ω) max(cos θ, 0).
///
/// Its integral over all directions is the radiance that leaves p towards ω_o. Any set of
/// techniques will do that together cover the directions from which light arrives: the lights
/// ([`Incident::lights`]), the lobes of the BSDF ([`Bsdf::techniques`]), or both.
#[derive(Debug)]
pub struct ReflectedRadiance<'a, B: Bsdf + ?Sized> {
    incident: &'a Incident<B::Value>,
    surface: Surface,
    bsdf: &'a B,
}

impl<'a, B: Bsdf + ?Sized> ReflectedRadiance<'a, B> {
    /// The integrand at `surface`, where the light `incident` arrives and `bsdf` reflects it.
    ///
    /// `incident` is what arrives at the surface's position.
    #[must_use]
    pub fn new(incident: &'a Incident<B::Value>, surface: Surface, bsdf: &'a B) -> Self {
        Self { incident, surface, bsdf }
    }

    /// The radiance that the point lights add to the integral: Σ f_r(p, ω, ω_o) I cos θ / d², over
    /// those that nothing hides, with intensities I, directions ω and distances d. It is exact.
    #[must_use]
    pub fn from_point_lights(&self) -> B::Value {
        self.incident.visible_point_lights().fold(B::Value::zero(), |sum, ray| {
            let cos = ray.direction.cos(self.surface.normal());
            if cos > 0.0 {
                let value = self.bsdf.value(&self.surface, &ray.direction);
                sum.plus(&value.scaled_product(&ray.flux, cos))
            } else {
                sum
            }
        })
    }
}

impl<B: Bsdf + ?Sized> Integrand<Direction> for ReflectedRadiance<'_, B> {
    type Value = B::Value;

    fn eval(&self, w: &Direction) -> B::Value {
        let cos = w.cos(self.surface.normal());
        if !(cos > 0.0) {
            return B::Value::zero();
        }
        match self.incident.source(w) {
            Some(radiance) => self.bsdf.value(&self.surface, w).scaled_product(&radiance, cos),
            None => B::Value::zero(),
        }
    }
}
