//! How a surface reflects: the interface, its lobes as techniques, and the sum of two BSDFs.

use std::fmt::Debug;

use super::direction::Direction;
use super::spectrum::Spectrum;
use super::surface::Surface;
use crate::technique::Technique;
use crate::vectors::vectorised;

/// A bidirectional scattering distribution function, f_r(p, ω_i, ω_o), and the lobes that sample it.
///
/// The sum of two is the pair of them, `(diffuse, glossy)`.
#[doc(alias("BRDF", "material"))]
pub trait Bsdf: Debug + Send + Sync {
    /// Grey or colour.
    type Value: Spectrum;

    /// f_r(p, ω_i, ω_o) for light from the direction `incident`, per steradian; 0 below the
    /// surface.
    fn value(&self, surface: &Surface, incident: &Direction) -> Self::Value;

    /// How many lobes there are to sample, at least 1; at every surface as many.
    fn lobes(&self) -> usize {
        1
    }

    /// The direction of light that the two canonical numbers `xi` map to, from the lobe with this
    /// number. It may be below the surface.
    fn sample(&self, lobe: usize, surface: &Surface, xi: &[f64]) -> Direction;

    /// [`sample`](Bsdf::sample) for each pair of `xi`, at its place in `ws`.
    fn sample_batch(&self, lobe: usize, surface: &Surface, xi: &[[f64; 2]], ws: &mut [Direction]) {
        vectorised(
            #[inline(always)]
            || ws.iter_mut().zip(xi).for_each(|(w, xi)| *w = self.sample(lobe, surface, xi)),
        );
    }

    /// The density of these samples of the lobe, per steradian.
    fn pdf(&self, lobe: usize, surface: &Surface, incident: &Direction) -> f64;

    /// The logarithm of the density, where that itself may underflow.
    fn ln_pdf(&self, lobe: usize, surface: &Surface, incident: &Direction) -> f64 {
        self.pdf(lobe, surface, incident).ln()
    }

    /// [`value`](Bsdf::value), and the density of a lobe that is picked by chance, all equally likely.
    ///
    /// Override it where the two have work in common.
    fn value_and_pdf(&self, surface: &Surface, incident: &Direction) -> (Self::Value, f64) {
        let lobes = self.lobes();
        let sum: f64 = (0..lobes).map(|lobe| self.pdf(lobe, surface, incident)).sum();
        (self.value(surface, incident), sum / lobes as f64)
    }

    /// The lobes at `surface`, each a technique.
    ///
    /// Samples below the surface contribute 0 and count.
    fn techniques(&self, surface: &Surface) -> Vec<Lobe<'_, Self>>
    where
        Self: Sized,
    {
        (0..self.lobes()).map(|number| Lobe { bsdf: self, number, surface: *surface }).collect()
    }
}

/// A lobe of a BSDF at a surface: the technique "sample the BSDF", per steradian.
#[derive(Debug)]
pub struct Lobe<'a, B: ?Sized> {
    bsdf: &'a B,
    number: usize,
    surface: Surface,
}

impl<B: Bsdf + ?Sized> Technique for Lobe<'_, B> {
    type Point = Direction;

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> Direction {
        self.bsdf.sample(self.number, &self.surface, xi)
    }

    fn pdf(&self, w: &Direction) -> f64 {
        self.bsdf.pdf(self.number, &self.surface, w)
    }

    fn ln_pdf(&self, w: &Direction) -> f64 {
        self.bsdf.ln_pdf(self.number, &self.surface, w)
    }
}

impl<A: Bsdf, B: Bsdf<Value = A::Value>> Bsdf for (A, B) {
    type Value = A::Value;

    fn value(&self, surface: &Surface, incident: &Direction) -> Self::Value {
        self.0.value(surface, incident).plus(&self.1.value(surface, incident))
    }

    fn value_and_pdf(&self, surface: &Surface, incident: &Direction) -> (Self::Value, f64) {
        let (a, p) = self.0.value_and_pdf(surface, incident);
        let (b, q) = self.1.value_and_pdf(surface, incident);
        let [n, m] = [self.0.lobes() as f64, self.1.lobes() as f64];
        (a.plus(&b), (n * p + m * q) / (n + m))
    }

    fn lobes(&self) -> usize {
        self.0.lobes() + self.1.lobes()
    }

    fn sample(&self, lobe: usize, surface: &Surface, xi: &[f64]) -> Direction {
        match lobe.checked_sub(self.0.lobes()) {
            None => self.0.sample(lobe, surface, xi),
            Some(lobe) => self.1.sample(lobe, surface, xi),
        }
    }

    fn pdf(&self, lobe: usize, surface: &Surface, incident: &Direction) -> f64 {
        match lobe.checked_sub(self.0.lobes()) {
            None => self.0.pdf(lobe, surface, incident),
            Some(lobe) => self.1.pdf(lobe, surface, incident),
        }
    }

    fn ln_pdf(&self, lobe: usize, surface: &Surface, incident: &Direction) -> f64 {
        match lobe.checked_sub(self.0.lobes()) {
            None => self.0.ln_pdf(lobe, surface, incident),
            Some(lobe) => self.1.ln_pdf(lobe, surface, incident),
        }
    }
}
