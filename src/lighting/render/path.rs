//! What a pixel integrates over: rays of the camera, and directions of light where they meet a surface.

use std::f64::consts::TAU;

use crate::discrete::Discrete;
use crate::integrand::Integrand;
use crate::lighting::bsdf::Bsdf;
use crate::lighting::direction::Direction;
use crate::lighting::incident::Incident;
use crate::lighting::spectrum::Spectrum;
use crate::lighting::surface::Surface;
use crate::lighting::turn::sin_cos_of_turn;
use crate::technique::{Technique, canonical};
use crate::vectors::vectorised;

/// A ray of the camera, by its number among those of a tile, and a direction of light at its end.
///
/// It carries what the integrand and the densities make of it: they have most of their work in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct Path<V> {
    pub(super) ray: usize,
    w: Direction,
    /// The radiance that comes along the ray from the direction `w`.
    value: V,
    /// The density of all lights, as one technique, and that of the BSDF.
    lights: f64,
    bsdf: f64,
}

/// The densities that an estimator looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Densities {
    /// Those of a sample's own technique.
    Own,
    /// Those of all, where light arrives: elsewhere, the weight of 0 is of no account.
    Lit,
    /// Those of all.
    All,
}

/// What a ray of the camera meets.
pub(super) enum End<'a, V> {
    /// Radiance as it is emitted; it does not depend on a direction of light.
    Emitted(V),
    /// A surface.
    Surface {
        surface: Surface,
        bsdf: &'a dyn Bsdf<Value = V>,
        /// What the point lights add.
        exact: V,
    },
}

impl<V: Spectrum> End<'_, V> {
    /// What needs no sample.
    pub(super) fn exact(&self) -> V {
        match self {
            End::Emitted(_) => V::zero(),
            End::Surface { exact, .. } => *exact,
        }
    }
}

/// The rays of a tile.
pub(super) struct Rays<'a, V> {
    /// Their numbers in the picture, in ascending order.
    pub(super) numbers: Vec<u64>,
    /// The pixels that they belong to, by their places in the tile.
    pub(super) places: Vec<usize>,
    pub(super) ends: Vec<End<'a, V>>,
    /// What arrives at each end, if it is a surface; and, beyond, memory of earlier tiles.
    incidents: Vec<Incident<V>>,
    /// The probabilities of the lights.
    probabilities: &'a [f64],
    densities: Densities,
}

/// 1 / (4π), the uniform density of directions: where there is no light or lobe to sample.
const UNIFORM: f64 = 0.5 / TAU;

/// A direction from the uniform density.
fn anywhere(xi: &[f64]) -> Direction {
    let z = 1.0 - 2.0 * canonical(xi, 0);
    let (sin_phi, cos_phi) = sin_cos_of_turn(canonical(xi, 1));
    let r = (1.0 - z * z).sqrt();
    Direction::from_unit(glam::DVec3::new(r * cos_phi, r * sin_phi, z))
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Own {
    Lights,
    Bsdf,
}

impl<'a, V: Spectrum> Rays<'a, V> {
    /// No ray yet.
    pub(super) fn new(probabilities: &'a [f64], densities: Densities) -> Self {
        let (numbers, places, ends) = (Vec::new(), Vec::new(), Vec::new());
        Self { numbers, places, ends, incidents: Vec::new(), probabilities, densities }
    }

    /// Forgets all rays.
    pub(super) fn clear(&mut self) {
        self.numbers.clear();
        self.places.clear();
        self.ends.clear();
    }

    /// Room for what arrives at the next end.
    pub(super) fn incident(&mut self) -> &mut Incident<V> {
        let next = self.ends.len();
        if next >= self.incidents.len() {
            self.incidents.resize_with(next + 1, Incident::nothing);
        }
        &mut self.incidents[next]
    }

    pub(super) fn push(&mut self, number: u64, place: usize, end: End<'a, V>) {
        self.incident();
        self.numbers.push(number);
        self.places.push(place);
        self.ends.push(end);
    }

    /// The path of this ray and the direction `w`, which its `own` technique has sampled.
    #[inline(always)]
    fn path(&self, ray: usize, w: Direction, own: Own) -> Path<V> {
        let (surface, bsdf) = match &self.ends[ray] {
            End::Emitted(radiance) => {
                let value = radiance.scaled(UNIFORM);
                return Path { ray, w, value, lights: UNIFORM, bsdf: UNIFORM };
            }
            End::Surface { surface, bsdf, .. } => (surface, *bsdf),
        };
        let incident = &self.incidents[ray];
        let mut lights = 0.0;
        let visible = incident.visible(&w, |light| {
            lights += self.probabilities[light.number] * light.directions().density();
        });
        if incident.lights().len() < self.probabilities.len() {
            let seen: f64 = incident.lights().iter().map(|l| self.probabilities[l.number]).sum();
            lights += (1.0 - seen).max(0.0) * UNIFORM;
        }
        let cos = w.cos(surface.normal());
        if let Some(light) = visible.filter(|_| cos > 0.0) {
            let (value, bsdf) = if own == Own::Lights && self.densities == Densities::Own {
                (bsdf.value(surface, &w), 0.0)
            } else {
                bsdf.value_and_pdf(surface, &w)
            };
            return Path {
                ray,
                w,
                value: value.scaled_product(&light.radiance, cos),
                lights,
                bsdf,
            };
        }
        // Without light, any positive density will do for a weight.
        let bsdf = match own {
            _ if self.densities == Densities::All => mean_pdf(bsdf, surface, &w),
            Own::Lights => 0.0,
            Own::Bsdf => UNIFORM,
        };
        Path { ray, w, value: V::zero(), lights, bsdf }
    }
}

/// The density of a lobe that is picked by chance.
fn mean_pdf<V: Spectrum>(bsdf: &dyn Bsdf<Value = V>, surface: &Surface, w: &Direction) -> f64 {
    let lobes = bsdf.lobes();
    (0..lobes).map(|lobe| bsdf.pdf(lobe, surface, w)).sum::<f64>() / lobes as f64
}

/// Which of so many a canonical number stands for.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "so it is defined")]
#[inline(always)]
fn index(xi: f64, of: usize) -> usize {
    // Rounding down is meant; the last one takes what rounds up to their number.
    ((xi * of as f64) as usize).min(of - 1)
}

/// The radiance along a path. Its integral over rays and directions, with the mean over the rays and
/// per steradian, is the mean radiance of the rays.
pub(super) struct Radiance;

impl<V: Spectrum> Integrand<Path<V>> for Radiance {
    type Value = V;

    fn eval(&self, path: &Path<V>) -> V {
        path.value
    }
}

/// What a technique samples a direction from, at the end of a ray.
#[derive(Debug, Clone)]
pub(super) enum Target {
    /// One light: uniform in its solid angle, or in all directions where it has none.
    Light(usize),
    /// Any of the lights, with these probabilities.
    Lights(Discrete),
    /// Any lobe of the surface, all equally likely.
    Bsdf,
}

/// The technique that samples a ray, then a direction.
///
/// Canonical numbers: the light or the lobe, the ray, and two for the direction.
pub(super) struct Towards<'a, V> {
    pub(super) rays: &'a Rays<'a, V>,
    pub(super) target: Target,
}

/// How many samples of one light or lobe at one ray are made at a time.
const RUN: usize = 32;

impl<V: Spectrum> Towards<'_, V> {
    /// The light or the lobe that a canonical number picks.
    #[inline(always)]
    fn pick(&self, end: &End<'_, V>, xi: f64) -> usize {
        match (&self.target, end) {
            (Target::Light(light), _) => *light,
            (Target::Lights(probabilities), _) => probabilities.select(xi),
            (Target::Bsdf, End::Surface { bsdf, .. }) => match bsdf.lobes() {
                1 => 0,
                lobes => index(xi, lobes),
            },
            (Target::Bsdf, End::Emitted(_)) => 0,
        }
    }

    /// Directions from what was picked.
    #[inline(always)]
    fn directions(&self, ray: usize, pick: usize, xi: &[[f64; 2]], ws: &mut [Direction]) {
        if let End::Surface { surface, bsdf, .. } = &self.rays.ends[ray] {
            if let Target::Bsdf = self.target {
                return bsdf.sample_batch(pick, surface, xi, ws);
            }
            if let Some(light) = self.rays.incidents[ray].numbered(pick) {
                return light.directions().fill(xi, ws);
            }
        }
        ws.iter_mut().zip(xi).for_each(|(w, xi)| *w = anywhere(xi));
    }

    #[inline(always)]
    fn fill(&self, xi: &[f64], xs: &mut Vec<Path<V>>) {
        let own = match self.target {
            Target::Light(_) | Target::Lights(_) => Own::Lights,
            Target::Bsdf => Own::Bsdf,
        };
        let (mut numbers, mut ws) = ([[0.0; 2]; RUN], [Direction::from_unit(glam::DVec3::Z); RUN]);
        let mut rows = xi.as_chunks::<4>().0;
        while let Some([first, number, ..]) = rows.first() {
            // Samples at one ray, of one light or lobe, follow each other.
            let ray = index(*number, self.rays.ends.len());
            let end = &self.rays.ends[ray];
            let pick = self.pick(end, *first);
            let mut run = 0;
            for ([select, other, u, v], numbers) in rows.iter().zip(&mut numbers) {
                if run > 0 && (other != number || self.pick(end, *select) != pick) {
                    break;
                }
                *numbers = [*u, *v];
                run += 1;
            }
            self.directions(ray, pick, &numbers[..run], &mut ws[..run]);
            xs.extend(ws[..run].iter().map(|w| self.rays.path(ray, *w, own)));
            rows = &rows[run..];
        }
    }
}

impl<V: Spectrum> Technique for Towards<'_, V> {
    type Point = Path<V>;

    fn dimension(&self) -> usize {
        4
    }

    fn sample(&self, xi: &[f64]) -> Path<V> {
        let mut xs = Vec::with_capacity(1);
        self.fill(xi, &mut xs);
        xs.pop()
            .unwrap_or_else(|| self.rays.path(0, Direction::from_unit(glam::DVec3::NAN), Own::Bsdf))
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<Path<V>>) {
        xs.clear();
        vectorised(
            #[inline(always)]
            || self.fill(xi, xs),
        );
    }

    fn pdf(&self, path: &Path<V>) -> f64 {
        match (&self.target, &self.rays.ends[path.ray]) {
            (Target::Lights(_), _) => path.lights,
            (Target::Bsdf, _) => path.bsdf,
            (Target::Light(light), End::Surface { .. }) => {
                let light = self.rays.incidents[path.ray].numbered(*light);
                light.map_or(UNIFORM, |light| light.pdf(&path.w))
            }
            (Target::Light(_), End::Emitted(_)) => UNIFORM,
        }
    }

    fn pdf_batch(&self, xs: &[Path<V>], out: &mut [f64]) {
        let paths = out.iter_mut().zip(xs);
        match self.target {
            Target::Lights(_) => paths.for_each(|(p, path)| *p = path.lights),
            Target::Bsdf => paths.for_each(|(p, path)| *p = path.bsdf),
            Target::Light(_) => paths.for_each(|(p, path)| *p = self.pdf(path)),
        }
    }
}
