//! Rendering: every pixel is an integral over its square and over the directions of light.

mod numbers;
mod path;
mod picture;
mod tile;

pub use picture::{Picture, Pixel};

use std::fmt::{self, Debug};
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use super::camera::Camera;
use super::scene::Scene;
use super::spectrum::Spectrum;
use crate::error::{ArgumentError, EstimateError};
use tile::{Strip, Worker};

/// How the samples of the lights and those of the BSDF are combined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Combination {
    /// The multi-sample estimator with [constant](crate::weighting::Constant) weights, 1/2 and 1/2.
    ///
    /// A light so small that samples of the BSDF hardly ever find it shows half of its radiance in nearly
    /// all pictures, and more in a few; the error tells nothing of those that it is not in.
    Constant,
    /// The multi-sample estimator with the [balance heuristic](crate::weighting::Balance).
    #[default]
    Balance,
    /// The multi-sample estimator with the [power heuristic](crate::weighting::Power), β = 2.
    Power,
    /// The multi-sample estimator with the [maximum heuristic](crate::weighting::Maximum).
    Maximum,
    /// The [one-sample estimator](crate::OneSample): each sample is of the lights or of the BSDF, by
    /// chance, with probabilities as the numbers of samples. Nothing is stratified.
    OneSample,
    /// [Optimal MIS](crate::OptimalMis), fitted to the rays of each pixel, up to 4096 at a time.
    ///
    /// Its error is told from groups of rays, eight below 128 rays, 32 from 256 on: intervals take
    /// Student's t. Where there are point lights, it is an upper bound. With fewer than eight rays, the
    /// balance heuristic.
    Optimal,
}

/// Of which light a sample of the lights is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum LightChoice {
    /// All lights are one technique, which picks each with the same probability. The picks are
    /// stratified: as many samples as lights take each of them once.
    #[default]
    Uniform,
    /// All lights are one technique, which picks them by their [power](super::Light::power).
    Power,
    /// Every light is a technique, with as many samples as are asked for.
    Each,
}

/// Renders a [`Scene`] as a [`Camera`] shows it.
///
/// The radiance of a pixel is the mean over its square (the box filter) of what the eye sees: the
/// radiance that a light emits, or the light that a surface reflects once, directly from the lights.
/// For each ray through the pixel, the reflected part is estimated from samples of the lights and of the
/// BSDF at the point that it meets; the rays of a pixel are independent, and its error is told from them.
///
/// ```
/// use mis::lighting::{Camera, DVec3, Lambert, Light, Rectangle, Renderer, Scene, Sphere};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let lamp = Sphere::new(DVec3::new(0.0, 0.0, 2.0), 0.5)?;
/// let floor = Rectangle::new(DVec3::ZERO, 5.0 * DVec3::X, 5.0 * DVec3::Y)?;
/// let scene = Scene::new().light(Light::new(lamp, 3.0)?).surface(floor, Lambert::new(0.5)?);
///
/// let eye = DVec3::new(0.0, -4.0, 3.0);
/// let camera = Camera::new(eye, DVec3::ZERO, DVec3::Z, 0.5, 12, 9)?;
/// let picture = Renderer::new(&scene, &camera).rays(4)?.samples(2, 1)?.render(1)?;
/// assert!(picture.pixels().iter().all(|pixel| pixel.value() > 0.0));
/// # Ok(())
/// # }
/// ```
///
/// The same scene, camera, settings and seed give the same bits, whatever the number of threads. A pixel
/// is the same in any window.
#[derive(Clone)]
pub struct Renderer<'a, V> {
    scene: &'a Scene<V>,
    camera: &'a Camera,
    combination: Combination,
    light_choice: LightChoice,
    rays: u64,
    /// Of the lights and of the BSDF, for each ray.
    samples: [u64; 2],
    columns: Range<u32>,
    rows: Range<u32>,
    threads: Option<usize>,
    watch: Option<&'a (dyn Fn(f64) + Sync)>,
}

const OWNER: &str = "Renderer";

impl<'a, V: Spectrum> Renderer<'a, V> {
    /// The whole picture, with 16 rays for each pixel, and one sample of the lights and one of the BSDF
    /// for each ray, combined by the balance heuristic.
    #[must_use]
    pub fn new(scene: &'a Scene<V>, camera: &'a Camera) -> Self {
        Self {
            scene,
            camera,
            combination: Combination::default(),
            light_choice: LightChoice::default(),
            rays: 16,
            samples: [1, 1],
            columns: 0..camera.width(),
            rows: 0..camera.height(),
            threads: None,
            watch: None,
        }
    }

    /// How samples are combined.
    #[must_use]
    pub fn combination(self, combination: Combination) -> Self {
        Self { combination, ..self }
    }

    /// How lights are picked.
    #[must_use]
    pub fn light_choice(self, light_choice: LightChoice) -> Self {
        Self { light_choice, ..self }
    }

    /// How many rays go through each pixel.
    ///
    /// A ray costs as much as five to ten samples at its end. More of them show edges, small highlights
    /// and the error; more samples for each are faster where a pixel's points are alike.
    ///
    /// # Errors
    ///
    /// There must be at least 1, and at most 2³².
    pub fn rays(self, rays: u64) -> Result<Self, ArgumentError> {
        check(OWNER, "rays", rays, 1)?;
        Ok(Self { rays, ..self })
    }

    /// How many samples of the lights and of the BSDF there are for each ray; 0 leaves them out. Point
    /// lights are added exactly, whatever the numbers.
    ///
    /// # Errors
    ///
    /// There must be at least 1 together, and at most 2³² of each.
    pub fn samples(self, of_lights: u64, of_bsdf: u64) -> Result<Self, ArgumentError> {
        check(OWNER, "of_lights", of_lights, 0)?;
        if of_lights == 0 && of_bsdf == 0 {
            let rule = "it must be at least 1 where there are none of the lights";
            return Err(ArgumentError::new(OWNER, "of_bsdf", of_bsdf, rule));
        }
        check(OWNER, "of_bsdf", of_bsdf, 0)?;
        Ok(Self { samples: [of_lights, of_bsdf], ..self })
    }

    /// A part of the picture: the pixels in these columns and rows.
    ///
    /// # Errors
    ///
    /// There must be at least one of each, and none beyond the film.
    pub fn window(self, columns: Range<u32>, rows: Range<u32>) -> Result<Self, ArgumentError> {
        let [width, height] = [self.camera.width(), self.camera.height()];
        for (name, range, size) in [("columns", &columns, width), ("rows", &rows, height)] {
            if range.is_empty() || range.end > size {
                let rule = format!("it must not be empty, nor end beyond {size}");
                return Err(ArgumentError::new(OWNER, name, range, rule));
            }
        }
        Ok(Self { columns, rows, ..self })
    }

    /// On so many threads; by default, as many as rayon's global pool has. Without the feature
    /// `parallel`, there is one.
    ///
    /// # Errors
    ///
    /// There must be at least 1.
    pub fn threads(self, threads: usize) -> Result<Self, ArgumentError> {
        if threads == 0 {
            return Err(ArgumentError::new(OWNER, "threads", threads, "it must be at least 1"));
        }
        Ok(Self { threads: Some(threads), ..self })
    }

    /// Calls `watch` now and then, from any thread, with the part of the picture that is done, from 0 to
    /// 1; it may be called with a smaller part after a larger one.
    #[must_use]
    pub fn watch(self, watch: &'a (dyn Fn(f64) + Sync)) -> Self {
        Self { watch: Some(watch), ..self }
    }

    /// Renders the picture from random numbers.
    ///
    /// # Errors
    ///
    /// [`Combination::Constant`] needs one technique for all lights, not [`LightChoice::Each`]. A whole
    /// picture may have at most 2⁶³ samples of the lights and of the BSDF. A scene with a BSDF that breaks the rules of techniques makes the estimators' errors.
    pub fn render(&self, seed: u64) -> Result<Picture<V>, RenderError> {
        if self.combination == Combination::Constant && self.light_choice == LightChoice::Each {
            let rule = "constant weights need one technique for all lights";
            return Err(ArgumentError::new(OWNER, "light_choice", self.light_choice, rule).into());
        }
        let [of_lights, of_bsdf] = self.samples;
        let pixels = u128::from(self.camera.width()) * u128::from(self.camera.height());
        let rays = pixels * u128::from(self.rays);
        if rays * u128::from(of_lights + of_bsdf) > 1 << 63 {
            let rule = "a whole picture may have at most 2^63";
            return Err(ArgumentError::new(OWNER, "samples", self.samples, rule).into());
        }
        let worker = Worker::new(self, seed)?;
        let strips = Strip::all(self.columns.clone(), self.rows.clone(), self.rays);
        let done = AtomicU64::new(0);
        let work = |memory: &mut _, strip: &Strip| {
            let pixels = worker.strip(strip, memory)?;
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            if let Some(watch) = self.watch {
                watch(done as f64 / strips.len() as f64);
            }
            Ok(pixels)
        };
        let done = self.run(&strips, || worker.memory(), work)?;
        let width = self.columns.len();
        let mut picture: Vec<Pixel<V>> = vec![Pixel::empty(); width * self.rows.len()];
        for (strip, pixels) in strips.iter().zip(done) {
            let row = (strip.row - self.rows.start) as usize;
            let start = row * width + (strip.column - self.columns.start) as usize;
            for (pixel, part) in picture.iter_mut().skip(start).zip(&pixels) {
                *pixel = pixel.merge(part);
            }
        }
        Ok(Picture::new(width, picture))
    }

    #[cfg(feature = "parallel")]
    fn run<M, T: Send>(
        &self,
        strips: &[Strip],
        memory: impl Fn() -> M + Sync + Send,
        work: impl Fn(&mut M, &Strip) -> Result<T, RenderError> + Sync + Send,
    ) -> Result<Vec<T>, RenderError> {
        use rayon::prelude::*;
        match self.threads {
            None => strips.par_iter().map_init(memory, work).collect(),
            Some(1) => {
                let mut memory = memory();
                strips.iter().map(|strip| work(&mut memory, strip)).collect()
            }
            Some(threads) => {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                let pool = pool.map_err(|error| RenderError::Threads {
                    threads,
                    message: error.to_string(),
                })?;
                pool.install(|| strips.par_iter().map_init(memory, work).collect())
            }
        }
    }

    #[cfg(not(feature = "parallel"))]
    #[expect(clippy::unused_self, reason = "with the feature, it tells the number of threads")]
    fn run<M, T>(
        &self,
        strips: &[Strip],
        memory: impl Fn() -> M,
        work: impl Fn(&mut M, &Strip) -> Result<T, RenderError>,
    ) -> Result<Vec<T>, RenderError> {
        let mut memory = memory();
        strips.iter().map(|strip| work(&mut memory, strip)).collect()
    }

    /// The probabilities of the lights, where all are one technique.
    fn light_probabilities(&self) -> Vec<f64> {
        let lights = self.scene.lights();
        // Without a light, there is one that is never seen.
        let equal = vec![1.0 / lights.len().max(1) as f64; lights.len().max(1)];
        if self.light_choice != LightChoice::Power {
            return equal;
        }
        let powers: Vec<f64> = lights.iter().map(|light| light.power().total()).collect();
        let largest = powers.iter().copied().fold(0.0, f64::max);
        let sum: f64 = powers.iter().map(|power| power / largest).sum();
        let by_power: Vec<f64> = powers.iter().map(|power| power / largest / sum).collect();
        if by_power.iter().all(|p| p.is_finite()) && !by_power.is_empty() {
            by_power
        } else {
            equal
        }
    }
}

fn check(
    owner: &'static str,
    argument: &'static str,
    number: u64,
    least: u64,
) -> Result<(), ArgumentError> {
    if (least..=1 << 32).contains(&number) {
        Ok(())
    } else {
        let rule = format!("it must be at least {least} and at most 2^32");
        Err(ArgumentError::new(owner, argument, number, rule))
    }
}

impl<V: Debug> Debug for Renderer<'_, V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Renderer")
            .field("combination", &self.combination)
            .field("light_choice", &self.light_choice)
            .field("rays", &self.rays)
            .field("samples", &self.samples)
            .field("columns", &self.columns)
            .field("rows", &self.rows)
            .field("threads", &self.threads)
            .finish_non_exhaustive()
    }
}

/// Why there is no picture.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// Settings that do not go together, or a scene that cannot be seen from some point.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// An estimate failed.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// The threads could not be started.
    #[error("{threads} threads could not be started: {message}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// Why.
        message: String,
    },
}
