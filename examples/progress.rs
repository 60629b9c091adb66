//! A run to a tolerance, watched on a progress bar, cancelled if asked, and reported in full.
//!
//! Neutrons whose flux falls as 1/E go into a slab that absorbs a few of them at any energy, and
//! nearly all at three narrow resonances. The part that is absorbed, by energy E and depth x,
//!
//! f(E, x) = τ(E) e^(-τ(E) x) / E, for E from 1 to 100 eV and x from 0 to 1 (the slab's thickness),
//!
//! has several peaks and factors, and no density suits it: at a resonance everything happens just
//! below the surface, and beside it everywhere. Three techniques share it.
//!
//! `cargo run --release --example progress`, or with options:
//! `... --example progress -- --relative 1e-3 --seconds 5 --threads 1 --seed 7 --cancel-after 300`

use std::error::Error;
use std::io::{IsTerminal, stderr};
use std::ops::ControlFlow;
use std::process::ExitCode;
use std::str::FromStr;
use std::thread;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use mis::technique::{Exponential, Mixture, PowerLaw, Product, TruncatedCauchy, Uniform};
use mis::{
    ArgumentError, Cancel, InverseCdf, MultiSample, Progress, Report, Run, Status, Stop, Target,
};

/// The range of energies, in eV.
const ENERGIES: [f64; 2] = [1.0, 100.0];

/// τ away from resonances, at 1 eV; it falls as 1/√E.
const SMOOTH: f64 = 0.05;

/// A resonance; τ there is a Lorentz curve.
struct Resonance {
    /// In eV.
    energy: f64,
    /// Half of the width at half of the height, in eV.
    half_width: f64,
    /// τ at the maximum.
    height: f64,
}

const RESONANCES: [Resonance; 3] = [
    Resonance { energy: 6.67, half_width: 0.013, height: 60.0 },
    Resonance { energy: 20.87, half_width: 0.018, height: 40.0 },
    Resonance { energy: 36.68, half_width: 0.030, height: 50.0 },
];

/// How many free paths the slab is thick.
fn tau(energy: f64) -> f64 {
    let peak = |r: &Resonance| r.height / (1.0 + ((energy - r.energy) / r.half_width).powi(2));
    SMOOTH / energy.sqrt() + RESONANCES.iter().map(peak).sum::<f64>()
}

fn f(&[energy, x]: &[f64; 2]) -> f64 {
    let tau = tau(energy);
    tau * (-tau * x).exp() / energy
}

/// The integral over x is (1 - e^-τ) / E; what remains is smooth in ln E on the scale of the
/// narrowest resonance, which Simpson's rule divides into more than 100 steps.
fn exact() -> f64 {
    let (from, to) = (ENERGIES[0].ln(), ENERGIES[1].ln());
    let steps = 400_000_u32;
    let h = (to - from) / f64::from(steps);
    let term = |k: u32| {
        let weight = match k {
            0 => 1.0,
            k if k == steps => 1.0,
            k if k % 2 == 1 => 4.0,
            _ => 2.0,
        };
        weight * -(-tau((from + f64::from(k) * h).exp())).exp_m1()
    };
    (0..=steps).map(term).sum::<f64>() * h / 3.0
}

fn main() -> ExitCode {
    let options = match Options::of_command_line(std::env::args().skip(1)) {
        Ok(Some(options)) => options,
        Ok(None) => {
            println!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        Err(message) => {
            eprintln!("progress: {message}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match run(&options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("progress: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<(), Box<dyn Error>> {
    let smooth = density(|| PowerLaw::new(-1.0, ENERGIES[0], ENERGIES[1]), Uniform::unit())?;
    // 1 - e^-τ is near 1 as long as τ > 1, which is wider than the resonance by √height.
    let beside =
        at_resonances(|r| Ok((r.half_width * r.height.sqrt(), Box::new(Uniform::unit()) as Axis)))?;
    let surface = at_resonances(|r| {
        Ok((r.half_width, Box::new(Exponential::new(r.height, 0.0, 1.0)?) as Axis))
    })?;
    let mis = MultiSample::new(&[(&smooth, 2), (&beside, 1), (&surface, 1)])?;

    let target =
        Target::new().relative(options.relative)?.time(Duration::from_secs_f64(options.seconds));
    let cancel = Cancel::new();
    if let Some(after) = options.cancel_after {
        let cancel = cancel.clone();
        // It ends with the process, if the run is over before.
        thread::spawn(move || {
            thread::sleep(after);
            cancel.cancel();
        });
    }
    let bar = bar()?;
    let mut run = Run::new(target).cancel(&cancel).progress(Duration::from_millis(50), |seen| {
        show(&bar, seen);
        ControlFlow::Continue(())
    });
    if let Some(threads) = options.threads {
        run = run.threads(threads)?;
    }
    let report = run.execute(&mis, &f, options.seed)?;
    bar.finish_and_clear();

    println!("{report}\n");
    println!("{HOW_TO_READ}\n");
    check(&report, options)
}

/// A density of energy or of depth.
type Axis = Box<dyn InverseCdf>;

/// A density of energy times one of depth.
fn density<E: InverseCdf + 'static>(
    energy: impl FnOnce() -> Result<E, ArgumentError>,
    depth: impl InverseCdf + 'static,
) -> Result<Product<Axis, 2>, ArgumentError> {
    Product::new([Box::new(energy()?), Box::new(depth)])
}

/// The densities at the resonances, each as often as the resonance absorbs, roughly.
/// `of` says how wide one is in energy, and its density of depth.
fn at_resonances(
    of: impl Fn(&Resonance) -> Result<(f64, Axis), ArgumentError>,
) -> Result<Mixture<Product<Axis, 2>>, ArgumentError> {
    let absorbs = |r: &Resonance| r.half_width * r.height.sqrt() / r.energy;
    let total: f64 = RESONANCES.iter().map(absorbs).sum();
    let one = |r: &Resonance| {
        let (scale, depth) = of(r)?;
        let energy = || TruncatedCauchy::new(r.energy, scale, ENERGIES[0], ENERGIES[1]);
        Ok((density(energy, depth)?, absorbs(r) / total))
    };
    Mixture::new(RESONANCES.iter().map(one).collect::<Result<_, ArgumentError>>()?)
}

/// A bar on stderr; it draws nothing if that is no terminal.
fn bar() -> Result<ProgressBar, Box<dyn Error>> {
    let target = if stderr().is_terminal() {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    };
    let style = ProgressStyle::with_template("[{bar:12}] {percent:>3} % {msg}")?;
    let bar = ProgressBar::with_draw_target(Some(1), target);
    Ok(bar.with_style(style.progress_chars("=> ")))
}

/// The whole of the bar is the samples so far and those that are still expected.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // Counts, far below 2^53.
fn show(bar: &ProgressBar, seen: &Progress) {
    let expected = seen.remaining.map_or(0.0, |time| time.as_secs_f64() * seen.rate);
    bar.set_length(seen.samples + expected as u64);
    bar.set_position(seen.samples);
    let error = seen.standard_error.map_or("?".into(), |error| format!("{error:.1e}"));
    let remaining =
        seen.remaining.map_or("?".into(), |time| format!("{:.1} s", time.as_secs_f64()));
    bar.set_message(format!(
        "{:.1e} samples, {:.6} ± {error}, {:.1e}/s, {remaining} left",
        seen.samples as f64, seen.value, seen.rate
    ));
}

const HOW_TO_READ: &str = "\
How to read it
- The first line: the value, with its standard error in the last digits; whether to believe it; why
  the run ended. \"converged\" and \"budget spent\" are good news. \"SUSPECT\" is not, and the lines
  below it say why.
- The interval contains the integral in 95 % of such runs (or at the level that was asked for).
- The rounds: what each found alone, and all up to it. chi2/dof is near 1 where rounds differ as
  their errors allow; much more means that errors are too small. When a run converges, its last
  round is reported alone: the others decided when to stop, and are biased by that.
- The techniques: how much of the value and of the variance comes from each. A technique with much
  of the variance deserves more samples, or a better density. z says whether the samples agree with
  the pdfs; beyond 4 or so, a sampler and its pdf differ.
- kappa is the skewness of the value: the interval is too narrow on one side if it is large. k-hat
  is the tail of the contributions: from 0.5 the variance may be infinite. The largest contribution
  is small in a healthy run.
- target, estimator, seed: what it takes to run it again. The same number of samples gives the same
  bits, on any number of threads.";

/// The report against the exact value.
fn check(report: &Report, options: &Options) -> Result<(), Box<dyn Error>> {
    let exact = exact();
    let Some(error) = report.standard_error() else {
        println!("exact value {exact:.8}; the run was over before it had an error");
        return Ok(());
    };
    let z = (report.value() - exact) / error;
    let relative = (report.value() / exact - 1.0).abs();
    println!(
        "exact value {exact:.8}: the run is off by {relative:.1e}, {:.2} standard errors",
        z.abs()
    );
    if z.is_nan() || z.abs() >= 5.0 {
        return Err(format!("{} is not {exact}: z = {z}", report.value()).into());
    }
    match report.stop() {
        // 95 % are within the tolerance, and all but 1e-6 within 2.5 times that.
        Stop::Tolerance if relative > 2.5 * options.relative => {
            Err(format!("the error {relative:e} is far beyond the tolerance").into())
        }
        Stop::Tolerance if *report.status() != Status::Converged => {
            Err(format!("at the tolerance, and yet {}", report.status()).into())
        }
        _ => Ok(()),
    }
}

const USAGE: &str = "\
options:
  --relative T        stop at the relative error T, at 95 % (default 1e-3)
  --seconds S         stop after S seconds (default 30)
  --threads N         on N threads (default: all)
  --seed N            the seed of the random numbers (default 1)
  --cancel-after MS   cancel from another thread after MS milliseconds";

struct Options {
    relative: f64,
    seconds: f64,
    threads: Option<usize>,
    seed: u64,
    cancel_after: Option<Duration>,
}

impl Options {
    /// `None` if help was asked for.
    fn of_command_line(
        mut arguments: impl Iterator<Item = String>,
    ) -> Result<Option<Self>, String> {
        let mut options =
            Self { relative: 1e-3, seconds: 30.0, threads: None, seed: 1, cancel_after: None };
        while let Some(name) = arguments.next() {
            if name == "--help" || name == "-h" {
                return Ok(None);
            }
            let known = ["--relative", "--seconds", "--threads", "--seed", "--cancel-after"];
            if !known.contains(&name.as_str()) {
                return Err(format!("there is no option {name}"));
            }
            let text = arguments.next().ok_or_else(|| format!("{name} needs a value"))?;
            match name.as_str() {
                "--relative" => options.relative = positive(&name, &text)?,
                "--seconds" => options.seconds = positive(&name, &text)?,
                "--threads" => {
                    let rule = "a whole number from 1 to 1024";
                    let threads = number(&name, &text, rule)?;
                    if !(1..=1024).contains(&threads) {
                        return Err(format!("--threads is {threads}, but must be {rule}"));
                    }
                    options.threads = Some(threads);
                }
                "--seed" => {
                    options.seed = number(&name, &text, "a whole number of at least 0")?;
                }
                _ => {
                    let milliseconds = number(&name, &text, "a whole number of milliseconds")?;
                    options.cancel_after = Some(Duration::from_millis(milliseconds));
                }
            }
        }
        Ok(Some(options))
    }
}

fn number<T: FromStr>(name: &str, text: &str, rule: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("{name} is {text}, but must be {rule}"))
}

/// Greater than 0, and no more than a year of seconds.
fn positive(name: &str, text: &str) -> Result<f64, String> {
    let rule = "a number greater than 0 and at most 3e7";
    let x: f64 = number(name, text, rule)?;
    if x > 0.0 && x <= 3e7 { Ok(x) } else { Err(format!("{name} is {text}, but must be {rule}")) }
}
