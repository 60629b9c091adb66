//! Tiles: the rays of a few pixels, sampled together.

use super::numbers::Numbers;
use super::path::{Densities, End, FromBsdf, Path, Radiance, Rays, ToLight, ToLights};
use super::picture::Pixel;
use super::{Combination, LightChoice, RenderError, Renderer};
use crate::lighting::reflected::ReflectedRadiance;
use crate::lighting::scene::{Seen, View};
use crate::lighting::spectrum::Spectrum;
use crate::points::{PointSource, Random};
use crate::technique::{Mixture, Technique};
use crate::weighting::{Constant, Maximum, Power};
use crate::{Estimate, EstimateError, Estimator, MultiSample, OneSample, OptimalMis, Sample};

/// How many rays are sampled together: what is known of their ends fits the second-level cache.
const RAYS: u64 = 128;

/// The most rays of a pixel in a strip; optimal weights are fitted to so many.
const MOST_RAYS: u64 = 4096;

/// About so many rays are a worker's task.
const TASK: u64 = 2048;

/// The stream of the positions on the film; those of the techniques are the first ones.
const FILM: usize = usize::MAX;

/// Some rays of each of some consecutive pixels in a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Strip {
    pub(super) row: u32,
    pub(super) column: u32,
    pub(super) pixels: u32,
    /// The first ray of each pixel.
    pub(super) first: u64,
    pub(super) rays: u64,
}

impl Strip {
    /// All strips of a window with so many rays for each pixel. Those of one pixel follow each other.
    pub(super) fn all(
        columns: std::ops::Range<u32>,
        rows: std::ops::Range<u32>,
        rays: u64,
    ) -> Vec<Self> {
        let wide = u32::try_from(TASK.div_ceil(rays)).unwrap_or(u32::MAX);
        let mut strips = Vec::new();
        for row in rows {
            for column in columns.clone().step_by(wide as usize) {
                let pixels = wide.min(columns.end - column);
                for first in (0..rays).step_by(MOST_RAYS as usize) {
                    let rays = MOST_RAYS.min(rays - first);
                    strips.push(Self { row, column, pixels, first, rays });
                }
            }
        }
        strips
    }
}

/// The renderer at work: what is the same for all tiles.
pub(super) struct Worker<'a, V> {
    renderer: &'a Renderer<'a, V>,
    view: View<'a, V>,
    random: Random,
    /// The probabilities of the lights, where they are one technique.
    probabilities: Vec<f64>,
}

/// What the samples at one ray add up to.
#[derive(Clone)]
struct Sum<V> {
    radiance: V,
    parts: [f64; 2],
}

impl<'a, V: Spectrum> Worker<'a, V> {
    pub(super) fn new(renderer: &'a Renderer<'a, V>, seed: u64) -> Self {
        let view = renderer.scene.view_from(renderer.camera.eye());
        let probabilities = renderer.light_probabilities();
        Self { renderer, view, random: Random::new(seed), probabilities }
    }

    /// The densities that the estimator needs.
    fn densities(&self) -> Densities {
        match self.renderer.combination {
            Combination::Optimal => Densities::All,
            Combination::Constant => Densities::Own,
            // A single technique needs no other.
            _ if self.renderer.samples.contains(&0)
                && self.renderer.light_choice != LightChoice::Each =>
            {
                Densities::Own
            }
            _ => Densities::Lit,
        }
    }

    /// The pixels of a strip.
    pub(super) fn strip(&self, strip: &Strip) -> Result<Vec<Pixel<V>>, RenderError> {
        let mut pixels = vec![Pixel::empty(); strip.pixels as usize];
        // Some pixels at a time, or some rays of one.
        let (wide, deep) = if self.renderer.combination == Combination::Optimal {
            (1, strip.rays)
        } else {
            (usize::try_from(RAYS / strip.rays).unwrap_or(1).max(1), RAYS.min(strip.rays))
        };
        for (pixels, column) in pixels.chunks_mut(wide).zip((strip.column..).step_by(wide)) {
            for first in (0..strip.rays).step_by(deep as usize) {
                let rays = deep.min(strip.rays - first);
                let rays = Strip { column, first: strip.first + first, rays, ..*strip };
                let rays = self.rays(&rays, pixels)?;
                if !rays.ends.is_empty() {
                    self.sample(&rays, pixels)?;
                }
            }
        }
        Ok(pixels)
    }

    /// What the rays of a strip meet. Those that end at a light are added to their pixels, unless weights
    /// are fitted to all of them.
    fn rays(&self, strip: &Strip, pixels: &mut [Pixel<V>]) -> Result<Rays<'_, V>, RenderError> {
        let Renderer { scene, camera, .. } = *self.renderer;
        let first = u64::from(strip.row) * u64::from(camera.width()) + u64::from(strip.column);
        let first = first * self.renderer.rays + strip.first;
        let per_pixel = usize::try_from(strip.rays).unwrap_or(usize::MAX);
        let mut film = vec![0.0; 2 * per_pixel * pixels.len()];
        // Where there are several pixels, these are all their rays.
        self.random.fill(FILM, first, 2, &mut film).map_err(EstimateError::from)?;
        let mut rays = Rays::new(film.len() / 2, &self.probabilities, self.densities());
        let positions = film.as_chunks::<2>().0.iter().enumerate();
        for (([x, y], place), number) in positions.map(|(at, xy)| (xy, at / per_pixel)).zip(first..)
        {
            let column = f64::from(strip.column) + place as f64;
            let end = match self.view.along(&camera.direction(column + x, f64::from(strip.row) + y))
            {
                Seen::Emitted(radiance) if self.renderer.combination != Combination::Optimal => {
                    pixels[place].push(&radiance, [0.0; 2]);
                    continue;
                }
                Seen::Emitted(radiance) => End::Emitted(radiance),
                Seen::Surface { surface, bsdf, number } => {
                    let incident = scene.seen_from_surface(surface.position(), Some(number))?;
                    let exact =
                        ReflectedRadiance::new(&incident, surface, bsdf).from_point_lights();
                    End::Surface { surface, bsdf, incident, exact }
                }
            };
            rays.push(number, place, end);
        }
        Ok(rays)
    }

    /// Adds the radiances of rays to their pixels.
    fn sample(&self, rays: &Rays<'_, V>, pixels: &mut [Pixel<V>]) -> Result<(), RenderError> {
        let Renderer { light_choice, samples: [of_lights, of_bsdf], .. } = *self.renderer;
        let lights = self.probabilities.iter().zip(0..);
        let each: Vec<_> = lights.map(|(p, light)| (ToLight { rays, light }, *p)).collect();
        let (any, bsdf) = (ToLights(Mixture::new(each.clone())?), FromBsdf(rays));
        let mut techniques: Vec<(&dyn Technique<Point = Path<V>>, u64)> = Vec::new();
        match light_choice {
            LightChoice::Each => {
                techniques.extend(each.iter().map(|(light, _)| (light as _, of_lights)));
            }
            LightChoice::Uniform | LightChoice::Power => techniques.push((&any, of_lights)),
        }
        let lights = techniques.len();
        techniques.push((&bsdf, of_bsdf));
        let per_ray: Vec<u64> = techniques.iter().map(|(_, n)| *n).collect();
        let of_a_ray: u64 = per_ray.iter().sum();
        let n = rays.ends.len() as u64;
        let mut numbers = Numbers {
            random: self.random,
            rays: &rays.numbers,
            per_ray,
            replicates: 1,
            selects: false,
        };
        let mut sums = vec![Sum { radiance: V::zero(), parts: [0.0; 2] }; rays.ends.len()];
        let add = |sample: &Sample<'_, Path<V>, V>| {
            let (sum, y) = (&mut sums[sample.x().ray], sample.contribution());
            sum.radiance = sum.radiance.plus(&y);
            sum.parts[usize::from(sample.technique() >= lights)] += y.total();
        };
        let all = techniques.iter().map(|(technique, m)| (*technique, m * n));
        let all: Vec<(&dyn Technique<Point = Path<V>>, u64)> = all.collect();
        let multi = || MultiSample::new(&all);
        let f = &Radiance;
        match self.renderer.combination {
            Combination::Constant => {
                multi()?.weighting(Constant::equal())?.inspect(f, &numbers, add)?
            }
            Combination::Balance => multi()?.inspect(f, &numbers, add)?,
            Combination::Power => {
                multi()?.weighting(Power::squared())?.inspect(f, &numbers, add)?
            }
            Combination::Maximum => multi()?.weighting(Maximum)?.inspect(f, &numbers, add)?,
            Combination::OneSample => {
                let probability = |m: u64| m as f64 / of_a_ray as f64;
                let alone: Vec<_> = each.iter().map(|(light, _)| Alone(*light)).collect();
                let mut selection: Vec<(&dyn Technique<Point = Path<V>>, f64)> =
                    techniques.iter().map(|(t, m)| (*t, probability(*m))).collect();
                if light_choice == LightChoice::Each {
                    for ((technique, _), light) in selection.iter_mut().zip(&alone) {
                        *technique = light;
                    }
                }
                (numbers.per_ray, numbers.selects) = (vec![of_a_ray], true);
                OneSample::new(&selection, n * of_a_ray)?.inspect(f, &numbers, add)?
            }
            Combination::Optimal => {
                numbers.replicates = replicates(n);
                let optimal = OptimalMis::new(&all)?.estimate_from(f, &numbers)?;
                let estimated = estimated(n, optimal.estimate(), &rays.ends);
                pixels.iter_mut().for_each(|pixel| *pixel = pixel.merge(&estimated));
                return Ok(());
            }
        };
        for ((end, sum), place) in rays.ends.iter().zip(&sums).zip(&rays.places) {
            let sampled = sum.radiance.scaled((of_a_ray as f64).recip());
            pixels[*place].push(&sampled.plus(&end.exact()), sum.parts);
        }
        Ok(())
    }
}

/// A technique of one light that leaves out the canonical number that selects a light or a lobe in the
/// others: where samples select their technique, the ray is at the same place in the rows of all.
struct Alone<'a, V>(ToLight<'a, V>);

impl<V: Spectrum> Technique for Alone<'_, V> {
    type Point = Path<V>;

    fn dimension(&self) -> usize {
        1 + self.0.dimension()
    }

    fn sample(&self, xi: &[f64]) -> Path<V> {
        self.0.sample(xi.get(1..).unwrap_or(&[]))
    }

    fn pdf(&self, path: &Path<V>) -> f64 {
        self.0.pdf(path)
    }
}

/// The pixel of all `rays` together, which `estimate` is of but for the point lights.
fn estimated<V: Spectrum>(rays: u64, estimate: &Estimate<V>, ends: &[End<'_, V>]) -> Pixel<V> {
    let mut exact = Pixel::empty();
    for end in ends {
        exact.push(&end.exact(), [0.0; 2]);
    }
    let n = rays as f64;
    // How the two errors go together is not known: at worst, they add up.
    let squares = V::each(|c| {
        let of_exact = (exact.squares.times(c, 1.0) / (n * (n - 1.0))).sqrt();
        // Unknown only where all is 0, as it is for single rays.
        let error = estimate.error_of(c).unwrap_or(0.0) + of_exact;
        if rays > 1 { error * error * n * (n - 1.0) } else { 0.0 }
    });
    Pixel { rays, mean: estimate.value().plus(&exact.mean), squares, parts: [0.0; 2] }
}

/// The fewest groups of equal size that so many rays make, but at least eight: the error is told from
/// their values.
fn replicates(rays: u64) -> u64 {
    (8..=rays / 2).find(|groups| rays.is_multiple_of(*groups)).unwrap_or(rays)
}
