//! The sixteen highlights: the mirror images of four lights in four plates.

use std::error::Error;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

use mis::lighting::{Camera, DVec3, Picture, Scene};

use crate::errors::Mean;
use crate::options::Options;
use crate::progress::Progress;
use crate::scene::{self, EYE, FILM, LAMPS, PLATES, Plate, Rgb, SMALL, grey};
use crate::strategies::{REFERENCE, Strategy};

/// A cell is so many pixels wide and high, on the film of 768 × 512.
const SIDE: u32 = 7;

/// Renderings of a cell by each strategy. Their variance is measured, not their difference to a
/// reference, which in some cells is less exact than they are.
const SEEDS: u64 = 8;

/// Rays for each pixel of a cell, for one of the picture.
const RAYS: u64 = 4;

/// The highlight of one light on one plate.
pub(crate) struct Cell {
    pub(crate) exponent: f64,
    pub(crate) radius: f64,
    columns: Range<u32>,
    rows: Range<u32>,
}

impl Cell {
    /// All of them: the lights of one plate after the other.
    pub(crate) fn all() -> Result<Vec<Self>, Box<dyn Error>> {
        let lamps = LAMPS.iter().take(SMALL);
        let cells = PLATES.iter().flat_map(|plate| lamps.clone().map(move |lamp| (plate, lamp)));
        let cell = |(plate, lamp): (&Plate, &scene::Lamp)| {
            let [x, y] = scene::project(mirrored(plate, lamp.centre)?, FILM);
            let [columns, rows] = [window(x), window(y)];
            Ok(Self { exponent: plate.exponent, radius: lamp.radius, columns, rows })
        };
        cells.map(cell).collect()
    }
}

/// The point of a plate in which the eye sees the mirror image of `point`.
fn mirrored(plate: &Plate, point: DVec3) -> Result<DVec3, Box<dyn Error>> {
    let rectangle = plate.rectangle()?;
    let (normal, centre) = (rectangle.normal().vector(), rectangle.centre());
    let height = |p: DVec3| normal.dot(p - centre);
    let image = point - 2.0 * height(point) * normal;
    let seen = EYE + height(EYE) / (height(EYE) - height(image)) * (image - EYE);
    // Across, the plates are 1 wide.
    let across = normal.cross(DVec3::X).dot(seen - centre).abs();
    if seen.x.abs() < 4.0 && across < 0.5 {
        Ok(seen)
    } else {
        Err(format!("the mirror image of {point} is beside its plate, at {seen}").into())
    }
}

/// The pixels about a position.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // It is on the film.
fn window(position: f64) -> Range<u32> {
    let first = (position - 0.5 * f64::from(SIDE)).round() as u32;
    first..first + SIDE
}

/// How well a strategy does in a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Measured {
    /// The variance of a pixel, over the squared mean of the cell, with its standard error.
    pub(crate) variance: f64,
    pub(crate) error: f64,
    /// The fastest rendering, on one thread.
    pub(crate) seconds: f64,
}

impl Measured {
    pub(crate) fn rmse(&self) -> f64 {
        self.variance.sqrt()
    }

    pub(crate) fn efficiency(&self) -> f64 {
        1.0 / (self.variance * self.seconds)
    }
}

/// How many rays the cells take.
pub(crate) fn rays(options: &Options) -> u64 {
    PLATES.len() as u64 * SMALL as u64 * rays_of_one(options)
}

fn rays_of_one(options: &Options) -> u64 {
    let of_strategies = SEEDS * RAYS * options.rays * options.strategies.len() as u64;
    u64::from(SIDE * SIDE) * (of_strategies + options.reference_rays)
}

/// What is measured, for each cell and each strategy.
pub(crate) fn measure(
    scene: &Scene<Rgb>,
    cells: &[Cell],
    options: &Options,
    progress: &Progress,
) -> Result<Vec<Vec<Measured>>, Box<dyn Error>> {
    let camera = scene::camera(FILM)?;
    let next = AtomicUsize::new(0);
    let worker = || {
        let mut done = Vec::new();
        while let number = next.fetch_add(1, Ordering::Relaxed)
            && let Some(cell) = cells.get(number)
        {
            let measured = measure_one(scene, &camera, cell, options);
            done.push((number, measured.map_err(|error| error.to_string())?));
            progress.add(rays_of_one(options));
        }
        Ok::<_, String>(done)
    };
    let mut all = thread::scope(|scope| {
        let threads: Vec<_> =
            (0..options.threads.min(cells.len())).map(|_| scope.spawn(worker)).collect();
        let mut all = Vec::new();
        for thread in threads {
            all.extend(thread.join().map_err(|_| "a thread has panicked")??);
        }
        Ok::<_, Box<dyn Error>>(all)
    })?;
    all.sort_by_key(|(number, _)| *number);
    Ok(all.into_iter().map(|(_, measured)| measured).collect())
}

fn measure_one(
    scene: &Scene<Rgb>,
    camera: &Camera,
    cell: &Cell,
    options: &Options,
) -> Result<Vec<Measured>, Box<dyn Error>> {
    let render = |strategy: &Strategy, rays: u64, seed: u64| {
        let renderer = strategy.renderer(scene, camera, rays, options.samples)?.threads(1)?;
        let renderer = renderer.window(cell.columns.clone(), cell.rows.clone())?;
        let start = Instant::now();
        let picture = renderer.render(seed)?;
        Ok::<(Picture<Rgb>, f64), Box<dyn Error>>((picture, start.elapsed().as_secs_f64()))
    };
    let (reference, _) = render(&REFERENCE, options.reference_rays, options.seed)?;
    let scale = grey(&reference.mean()).powi(-2);
    let pixels = (SIDE * SIDE) as usize;
    let mut values = vec![vec![Mean::default(); pixels]; options.strategies.len()];
    let mut fastest = vec![f64::INFINITY; options.strategies.len()];
    for seed in 1..=SEEDS {
        // One strategy after the other, so that whatever else the machine does hits all.
        for ((strategy, values), fastest) in
            options.strategies.iter().zip(&mut values).zip(&mut fastest)
        {
            let seed = options.seed.wrapping_add(seed);
            let (picture, seconds) = render(strategy, RAYS * options.rays, seed)?;
            *fastest = fastest.min(seconds);
            for (pixel, value) in picture.pixels().iter().zip(values) {
                value.push(grey(&pixel.value()));
            }
        }
    }
    let measured = values.iter().zip(fastest).map(|(values, seconds)| {
        let mut variances = Mean::default();
        for value in values {
            variances.push(scale * value.variance());
        }
        Measured { variance: variances.value(), error: variances.error(), seconds }
    });
    Ok(measured.collect())
}
