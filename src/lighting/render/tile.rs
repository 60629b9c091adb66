//! Tiles: the rays of a few pixels, sampled together.

use super::numbers::Numbers;
use super::path::{Densities, End, Path, Radiance, Rays, Target, Towards};
use super::picture::Pixel;
use super::{Combination, LightChoice, RenderError, Renderer};
use crate::discrete::Discrete;
use crate::estimator::{Buffers, InspectWith};
use crate::lighting::reflected::ReflectedRadiance;
use crate::lighting::scene::{Seen, View};
use crate::lighting::spectrum::Spectrum;
use crate::points::{PointSource, Random};
use crate::technique::Technique;
use crate::weighting::{Constant, Maximum, Power};
use crate::{Estimate, EstimateError, MultiSample, OneSample, OptimalMis, Sample};

/// How many rays are sampled together: what is known of their ends fits the second-level cache.
const RAYS: u64 = 128;

/// The most rays of a pixel in a strip; optimal weights are fitted to so many.
const MOST_RAYS: usize = 4096;

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
                for first in (0..rays).step_by(MOST_RAYS) {
                    let rays = (MOST_RAYS as u64).min(rays - first);
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
    /// The lights, where they are one technique.
    lights: Discrete,
}

/// What a worker needs for a tile, used again for the next.
pub(super) struct Memory<'a, V> {
    /// Positions on the film.
    film: Vec<f64>,
    rays: Rays<'a, V>,
    buffers: Buffers<Path<V>, V>,
}

/// What the samples at one ray add up to.
#[derive(Clone)]
struct Sum<V> {
    radiance: V,
    parts: [f64; 2],
}

impl<'a, V: Spectrum> Worker<'a, V> {
    pub(super) fn new(renderer: &'a Renderer<'a, V>, seed: u64) -> Result<Self, RenderError> {
        let view = renderer.scene.view_from(renderer.camera.eye());
        let probabilities = renderer.light_probabilities();
        let lights = Discrete::new("Renderer", "light_choice", &probabilities)?;
        Ok(Self { renderer, view, random: Random::new(seed), lights })
    }

    pub(super) fn memory(&self) -> Memory<'_, V> {
        let rays = Rays::new(self.lights.probabilities(), self.densities());
        Memory { film: Vec::new(), rays, buffers: Buffers::new() }
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
    pub(super) fn strip<'w>(
        &'w self,
        strip: &Strip,
        Memory { film, rays, buffers }: &mut Memory<'w, V>,
    ) -> Result<Vec<Pixel<V>>, RenderError> {
        let mut pixels = vec![Pixel::empty(); strip.pixels as usize];
        // Some pixels at a time, or some rays of one. Samples that select their techniques are added block by
        // block: where a block ends must not depend on the pixels before.
        let (wide, deep) = match self.renderer.combination {
            Combination::Optimal => (1, strip.rays),
            Combination::OneSample => (1, RAYS.min(strip.rays)),
            _ => {
                let wide = usize::try_from(RAYS / strip.rays).unwrap_or(1).max(1);
                (wide, RAYS.min(strip.rays))
            }
        };
        for (pixels, column) in pixels.chunks_mut(wide).zip((strip.column..).step_by(wide)) {
            let mut left = Strip { column, ..*strip };
            while left.rays > 0 {
                let tile = Strip { rays: deep.min(left.rays), ..left };
                (left.first, left.rays) = (tile.first + tile.rays, left.rays - tile.rays);
                self.look(&tile, film, rays, pixels)?;
                if !rays.ends.is_empty() {
                    self.sample(rays, pixels, buffers)?;
                }
            }
        }
        Ok(pixels)
    }

    /// Makes `rays` those of a strip, with what they meet. Those that end at a light are added to their
    /// pixels, unless weights are fitted to all of them.
    fn look<'w>(
        &'w self,
        strip: &Strip,
        film: &mut Vec<f64>,
        rays: &mut Rays<'w, V>,
        pixels: &mut [Pixel<V>],
    ) -> Result<(), RenderError> {
        let Renderer { scene, camera, .. } = *self.renderer;
        let first = u64::from(strip.row) * u64::from(camera.width()) + u64::from(strip.column);
        let first = first * self.renderer.rays + strip.first;
        let per_pixel = usize::try_from(strip.rays).unwrap_or(usize::MAX);
        film.resize(2 * per_pixel * pixels.len(), 0.0);
        // Where there are several pixels, these are all their rays.
        self.random.fill(FILM, first, 2, film).map_err(EstimateError::from)?;
        rays.clear();
        let positions = film.as_chunks::<2>().0.iter().enumerate();
        for (([x, y], place), number) in positions.map(|(at, xy)| (xy, at / per_pixel)).zip(first..)
        {
            let column = f64::from(strip.column) + place as f64;
            let end = match self.view.along(&camera.direction(column + x, f64::from(strip.row) + y))
            {
                Seen::Emitted(radiance) if self.renderer.combination != Combination::Optimal => {
                    pixels[place].push_emitted(&radiance);
                    continue;
                }
                Seen::Emitted(radiance) => End::Emitted(radiance),
                Seen::Surface { surface, bsdf, number } => {
                    let incident = rays.incident();
                    scene.see_from(surface.position(), Some(number), incident)?;
                    let exact = ReflectedRadiance::new(incident, surface, bsdf).from_point_lights();
                    End::Surface { surface, bsdf, exact }
                }
            };
            rays.push(number, place, end);
        }
        Ok(())
    }

    /// Adds the radiances of rays to their pixels.
    fn sample(
        &self,
        rays: &Rays<'_, V>,
        pixels: &mut [Pixel<V>],
        buffers: &mut Buffers<Path<V>, V>,
    ) -> Result<(), RenderError> {
        let Renderer { light_choice, samples: [of_lights, of_bsdf], .. } = *self.renderer;
        let lights = match light_choice {
            LightChoice::Each => {
                (0..self.lights.probabilities().len()).map(Target::Light).collect()
            }
            LightChoice::Uniform | LightChoice::Power => vec![Target::Lights(self.lights.clone())],
        };
        let lights: Vec<_> = lights.into_iter().map(|target| Towards { rays, target }).collect();
        let bsdf = Towards { rays, target: Target::Bsdf };
        let mut techniques: Vec<(&dyn Technique<Point = Path<V>>, u64)> = Vec::new();
        techniques.extend(lights.iter().map(|light| (light as _, of_lights)));
        techniques.push((&bsdf, of_bsdf));
        let lights = lights.len();
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
                multi()?.weighting(Constant::equal())?.inspect_with(f, &numbers, buffers, add)?
            }
            Combination::Optimal if n >= FEWEST => {
                numbers.replicates = replicates(n);
                let optimal = OptimalMis::new(&all)?.estimate_from(f, &numbers)?;
                let estimated = estimated(n, optimal.estimate(), &rays.ends);
                for pixel in pixels {
                    *pixel = pixel.merge(&estimated);
                }
                return Ok(());
            }
            Combination::Balance | Combination::Optimal => {
                multi()?.inspect_with(f, &numbers, buffers, add)?
            }
            Combination::Power => {
                multi()?.weighting(Power::squared())?.inspect_with(f, &numbers, buffers, add)?
            }
            Combination::Maximum => {
                multi()?.weighting(Maximum)?.inspect_with(f, &numbers, buffers, add)?
            }
            Combination::OneSample => {
                let probability = |m: u64| m as f64 / of_a_ray as f64;
                let selection =
                    techniques.iter().map(|(technique, m)| (*technique, probability(*m)));
                let selection: Vec<(&dyn Technique<Point = Path<V>>, f64)> = selection.collect();
                (numbers.per_ray, numbers.selects) = (vec![of_a_ray], true);
                OneSample::new(&selection, n * of_a_ray)?.inspect_with(f, &numbers, buffers, add)?
            }
        };
        for ((end, sum), place) in rays.ends.iter().zip(&sums).zip(&rays.places) {
            let sampled = sum.radiance.scaled((of_a_ray as f64).recip());
            match end {
                End::Emitted(radiance) => pixels[*place].push_emitted(radiance),
                // A pixel whose other rays have optimal weights has no shares.
                End::Surface { exact, .. } if self.renderer.combination == Combination::Optimal => {
                    pixels[*place].push(&sampled.plus(exact), [0.0; 2]);
                }
                End::Surface { exact, .. } => pixels[*place].push(&sampled.plus(exact), sum.parts),
            }
        }
        Ok(())
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
        let error = match estimate.error_of(c) {
            Some(error) => error + of_exact,
            // A channel that is 0 in all samples; where all channels are, the pixel knows.
            None if estimate.value_of(c) == 0.0 => of_exact,
            None => f64::INFINITY,
        };
        if rays > 1 { error * error * n * (n - 1.0) } else { 0.0 }
    });
    let sampled = ends.iter().any(|end| matches!(end, End::Surface { .. }));
    Pixel { rays, sampled, mean: estimate.value().plus(&exact.mean), squares, parts: [0.0; 2] }
}

/// With fewer rays, there are no optimal weights to tell.
const FEWEST: u64 = 8;

/// How many groups of equal size the rays are divided into, from whose values the error is told: at least
/// eight, and 32 where there are many rays, for which that costs next to nothing.
fn replicates(rays: u64) -> u64 {
    let least = (rays / 8).clamp(8, 32);
    (least..=rays / 2).find(|groups| rays.is_multiple_of(*groups)).unwrap_or(rays)
}
