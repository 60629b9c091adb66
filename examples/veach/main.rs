//! Veach's figure: four glossy plates under five lights, by every strategy.
//!
//! Each strategy has the same number of samples for each ray of the camera. Its picture is compared with
//! a converged one: time, error and efficiency, over the whole picture and in the sixteen highlights of
//! four lights in four plates. All of them must agree with the reference to their errors.
//!
//! It writes, for each strategy, the picture as PNG (tone-mapped, sRGB) and as PFM (linear radiances, which
//! other programs read), its errors and the shares of the two techniques; a contact sheet of all; and a
//! figure of either technique alone beside the power heuristic.
//!
//! `cargo run --release --example veach`, or with options:
//! `... --example veach -- --size 768x512 --rays 64 --strategy power --out /tmp/veach`

mod canvas;
mod cells;
mod checks;
mod colours;
mod errors;
mod files;
mod options;
mod progress;
mod scene;
mod sheet;
mod strategies;
mod tables;

use std::error::Error;
use std::process::ExitCode;
use std::time::Instant;

use mis::lighting::{Camera, Picture, Scene};

use cells::Cell;
use checks::Deviations;
use errors::{Errors, Reference, Shot};
use options::{Options, USAGE};
use progress::Progress;
use scene::Rgb;
use strategies::{REFERENCE, Strategy};

fn main() -> ExitCode {
    let arguments = std::env::args_os().skip(1).map(|a| a.to_string_lossy().into_owned());
    let options = match Options::of_command_line(arguments) {
        Ok(Some(options)) => options,
        Ok(None) => {
            println!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        Err(message) => {
            eprintln!("veach: {message}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match run(&options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("veach: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<(), Box<dyn Error>> {
    let start = Instant::now();
    std::fs::create_dir_all(&options.out)
        .map_err(|error| format!("--out {}: {error}", options.out.display()))?;
    let work = Work { scene: scene::scene()?, camera: scene::camera(options.size)?, options };
    let progress = Progress::new(work.rays())?;

    let (reference, seconds) =
        work.render(&REFERENCE, options.reference_rays, options.seed.wrapping_add(1), &progress)?;
    let mut shots = Vec::new();
    for strategy in options.strategies.iter().copied() {
        let (picture, seconds) = work.render(strategy, options.rays, options.seed, &progress)?;
        shots.push(Shot { strategy, picture, seconds });
    }
    progress.name("cells");
    let cells = Cell::all()?;
    let measured = cells::measure(&work.scene, &cells, options, &progress)?;
    progress.finish();

    let reference = Reference::new(reference, options.size);
    let errors: Vec<Errors> = shots.iter().map(|shot| reference.errors(&shot.picture)).collect();
    let deviations: Vec<Deviations> =
        shots.iter().map(|shot| Deviations::of(shot, &reference)).collect();
    let [width, height] = options.size;
    println!(
        "{width} x {height} pixels, {} rays each, {} samples a ray; the reference: {} rays, {seconds:.1} s",
        options.rays, options.samples, options.reference_rays
    );
    tables::picture(&shots, &errors, &deviations);
    tables::cells(&cells, &measured, &options.strategies);
    println!("\n{HOW_TO_READ}\n");

    write(&shots, &reference, &errors, options)?;
    for line in tables::assert_cells(&cells, &measured, &options.strategies)? {
        println!("{line}");
    }
    println!("{}", checks::assert(&shots, &deviations)?);
    let out = options.out.display();
    println!("written to {out}, after {:.1} s", start.elapsed().as_secs_f64());
    Ok(())
}

const HOW_TO_READ: &str = "\
How to read it
- Every strategy has the same number of samples. The reference is the balance heuristic with more rays
  and another seed; its own errors are taken off. Pixels that see a light are left out: nothing is
  sampled there.
- mean err: the mean of |x - r| / (r + 1 % of the mean radiance). RMS error: the root of the mean square of
  the same. efficiency: 1 / (its square * seconds), relative to the first row. Seconds are of the clock:
  what else the machine does is in them.
- z: the deviation of the mean radiance, in standard errors. bias: the factor to the reference, less 1,
  that fits all blocks of 8 x 8 pixels best. block, pixel: the largest deviations, in standard errors;
  beyond 3: the pixels that deviate by more. Light only, BSDF only and constant weights may miss rare
  large samples: downwards, only what they are sure to see is asked of a block or a pixel.
- The cells are 7 x 7 pixels, of 768 x 512, about the mirror image of a light in a plate, with 4 times the
  rays; their errors are those among 8 renderings. Behind the best of a row, in brackets, are those that
  the measured errors do not tell from it. What all have in common is from the rays of the camera.";

/// What is rendered.
struct Work<'a> {
    scene: Scene<Rgb>,
    camera: Camera,
    options: &'a Options,
}

impl Work<'_> {
    fn pixels(&self) -> u64 {
        u64::from(self.camera.width()) * u64::from(self.camera.height())
    }

    /// How many rays there are in all.
    fn rays(&self) -> u64 {
        let Options { rays, reference_rays, strategies, .. } = self.options;
        let of_pictures = self.pixels() * (rays * strategies.len() as u64 + reference_rays);
        of_pictures + cells::rays(self.options)
    }

    /// A picture, and how long it took.
    fn render(
        &self,
        strategy: &Strategy,
        rays: u64,
        seed: u64,
        progress: &Progress,
    ) -> Result<(Picture<Rgb>, f64), Box<dyn Error>> {
        progress.name(strategy.title);
        let all = rays * self.pixels();
        let watch = |part: f64| progress.part(part, all);
        let renderer = strategy.renderer(&self.scene, &self.camera, rays, self.options.samples)?;
        let renderer = renderer.threads(self.options.threads)?.watch(&watch);
        let start = Instant::now();
        let picture = renderer.render(seed)?;
        progress.add(all);
        Ok((picture, start.elapsed().as_secs_f64()))
    }
}

fn write(
    shots: &[Shot],
    reference: &Reference,
    errors: &[Errors],
    options: &Options,
) -> Result<(), Box<dyn Error>> {
    let path = |name: &str, end: &str| options.out.join(format!("{name}{end}"));
    let both = |name: &str, picture: &Picture<Rgb>| {
        files::png(&path(name, ".png"), &sheet::shown(picture))?;
        files::pfm(&path(name, ".pfm"), picture)
    };
    both(REFERENCE.name, &reference.picture)?;
    for shot in shots {
        let name = shot.strategy.name;
        both(name, &shot.picture)?;
        files::png(&path(name, "-error.png"), &sheet::errors(shot, reference))?;
        files::png(&path(name, "-weights.png"), &sheet::weights(&shot.picture))?;
    }
    let errors: Vec<f64> = errors.iter().map(|errors| errors.absolute.value()).collect();
    files::png(&path("figure", ".png"), &sheet::figure(shots))?;
    files::png(&path("sheet", ".png"), &sheet::sheet(shots, reference, &errors))
}
