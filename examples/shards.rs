//! One run in many processes: divided, merged, killed, resumed, tightened, always the same bits.
//!
//! The integral is of two narrow peaks and a broad one, over the real line. This
//! program starts itself, once for each shard; every process leaves its part in a file, and the
//! files are put together. Then a process is killed in the middle of its work, and another goes on
//! from its last checkpoint. Whatever happened on the way, the value and its error are those of the
//! run in one piece, to the last bit.
//!
//! `cargo run --release --example shards` or `... --example shards -- 5` for another number of
//! processes.

use std::env;
use std::error::Error;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use mis::points::Random;
use mis::technique::{Cauchy, Normal};
use mis::{MultiSample, Report, Run, RunError, Target};

const SEED: u64 = 2024;

/// Of the run that is divided; not a power of two, so that its last round is cut short.
const SAMPLES: u64 = 3_000_000;

/// Of the run that goes on.
const MORE: u64 = 5_000_000;

/// Two normal peaks and a broad line, of mass 0.5, 0.3 and 0.2.
fn f(x: &f64) -> f64 {
    let normal = |centre: f64, sd: f64| {
        let z = (x - centre) / sd;
        (-0.5 * z * z).exp() / (sd * (2.0 * std::f64::consts::PI).sqrt())
    };
    let line = 1.0 / (std::f64::consts::PI * (1.0 + x * x));
    0.5 * normal(-1.0, 0.1) + 0.3 * normal(2.0, 0.05) + 0.2 * line
}

const EXACT: f64 = 1.0;

/// Runs, with the same seed and techniques in every process.
fn execute(run: Run<'_>, f: &(impl Fn(&f64) -> f64 + Sync)) -> Result<Report, Failure> {
    with_estimator(|mis| run.execute(mis, f, SEED))
}

/// Merges the files of the shards.
fn merge(run: Run<'_>, files: &[&PathBuf]) -> Result<Report, Failure> {
    with_estimator(|mis| run.merge(mis, &f, &Random::new(SEED), files))
}

fn with_estimator(
    run: impl FnOnce(&MultiSample<'_, f64>) -> Result<Report, RunError>,
) -> Result<Report, Failure> {
    let first = Normal::new(-1.0, 0.125)?;
    let second = Normal::new(2.0, 0.0625)?;
    let broad = Cauchy::new(0.0, 1.0)?;
    let mis = MultiSample::new(&[(&first, 2), (&second, 1), (&broad, 2)])?;
    Ok(run(&mis)?)
}

type Failure = Box<dyn Error>;

fn target(samples: u64) -> Result<Target, Failure> {
    Ok(Target::new().samples(samples)?)
}

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match words[..] {
        [] => parent(3),
        ["shard", index, of, file] => shard(index, of, Path::new(file)),
        ["whole", file] => whole(Path::new(file)),
        [of] if of.parse().is_ok_and(|of| (2..=16).contains(&of)) => {
            parent(of.parse().unwrap_or(3))
        }
        _ => {
            eprintln!(
                "shards: the number of processes is {}, but it must be from 2 to 16",
                words.join(" ")
            );
            return ExitCode::from(2);
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("shards: {error}");
            ExitCode::FAILURE
        }
    }
}

/// A child: one shard, on one thread.
fn shard(index: &str, of: &str, file: &Path) -> Result<(), Failure> {
    let run = Run::new(target(SAMPLES)?).shard(index.parse()?, of.parse()?)?;
    let report = execute(run.threads(1)?.checkpoint(file), &f)?;
    println!("{} samples, {}", report.samples(), report.estimate());
    Ok(())
}

/// A child: the whole run, which says how far it is. It is going to be killed.
fn whole(file: &Path) -> Result<(), Failure> {
    let run = Run::new(target(SAMPLES)?)
        .threads(1)?
        .checkpoint(file)
        .save_every(Duration::from_millis(10))
        .progress(Duration::from_millis(10), |seen| {
            // To a pipe, line by line. If no one reads it, there is no one to run for.
            let told = writeln!(std::io::stdout(), "{}", seen.samples);
            if told.is_ok() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
    execute(run, &f)?;
    Ok(())
}

fn parent(of: u64) -> Result<(), Failure> {
    let folder = Folder::new()?;

    println!("The run in one piece");
    let one_piece = execute(Run::new(target(SAMPLES)?), &f)?;
    show(&one_piece);
    let (value, error) = (one_piece.value(), one_piece.standard_error().unwrap_or(f64::NAN));
    let z = (value - EXACT) / error;
    ensure(z.abs() < 5.0 && error < 1e-3, &format!("{value} is not {EXACT}: z = {z}"))?;

    println!("\nThe same in {of} processes, one shard each");
    let files: Vec<PathBuf> = (0..of).map(|k| folder.file(&format!("shard-{k}"))).collect();
    let mut children = Vec::new();
    for (index, file) in files.iter().enumerate() {
        children.push(child(&["shard", &index.to_string(), &of.to_string()], file)?);
    }
    for (index, child) in children.into_iter().enumerate() {
        let id = child.id();
        let output = child.wait_with_output()?;
        ensure(output.status.success(), &format!("shard {index}: {}", output.status))?;
        let said = String::from_utf8_lossy(&output.stdout);
        println!("  shard {index}, process {id:>7}: {}", said.trim());
    }

    println!("\nMerged, the last file first");
    let merged_file = folder.file("merged");
    let reversed: Vec<&PathBuf> = files.iter().rev().collect();
    let merged = merge(Run::new(target(SAMPLES)?).checkpoint(&merged_file), &reversed)?;
    show(&merged);
    same(&one_piece, &merged, "the merged shards")?;

    println!("\nWhat is not the whole run is refused");
    let without: Vec<&PathBuf> = files.iter().filter(|file| **file != files[1]).collect();
    refused(merge(Run::new(target(SAMPLES)?), &without), &format!("shard 1 of {of} is missing"))?;
    let twice: Vec<&PathBuf> = files.iter().chain([&files[1]]).collect();
    refused(merge(Run::new(target(SAMPLES)?), &twice), &format!("shard 1 of {of} is there twice"))?;

    println!("\nA process is killed in the middle of the run");
    let file = folder.file("killed");
    kill_in_the_middle(&file)?;
    let evaluated = AtomicU64::new(0);
    let counting = |x: &f64| {
        evaluated.fetch_add(1, Ordering::Relaxed);
        f(x)
    };
    let resumed = execute(Run::new(target(SAMPLES)?).checkpoint(&file), &counting)?;
    let evaluated = evaluated.into_inner();
    println!("  resumed from its checkpoint: {evaluated} evaluations were left to do");
    ensure(evaluated < SAMPLES, "nothing of the killed process was used")?;
    show(&resumed);
    same(&one_piece, &resumed, "the resumed run")?;

    println!("\nThe merged run goes on, from {SAMPLES} samples to {MORE}");
    let continued = execute(Run::new(target(MORE)?).checkpoint(&merged_file), &f)?;
    show(&continued);
    let scratch = execute(Run::new(target(MORE)?), &f)?;
    println!("  and from the start, without a break:");
    show(&scratch);
    same(&scratch, &continued, "the continued run")?;

    println!("\nEvery comparison is equal to the last bit.");
    Ok(())
}

/// Starts this program with these arguments, the last of them a file.
fn child(arguments: &[&str], file: &Path) -> Result<Child, Failure> {
    let program = env::current_exe()?;
    Ok(Command::new(program).args(arguments).arg(file).stdout(Stdio::piped()).spawn()?)
}

/// Starts the whole run in a process, and kills it after a third of the samples.
fn kill_in_the_middle(file: &Path) -> Result<(), Failure> {
    let mut child = child(&["whole"], file)?;
    let pipe = child.stdout.take().ok_or("no pipe")?;
    let mut reached = 0;
    for line in BufReader::new(pipe).lines() {
        reached = line?.parse::<u64>()?;
        if reached > SAMPLES / 3 {
            break;
        }
    }
    let id = child.id();
    child.kill()?;
    let status = child.wait()?;
    println!("  process {id} had drawn {reached} samples of {SAMPLES}: {status}");
    ensure(!status.success(), "it was over before it could be killed")
}

fn show(report: &Report) {
    let error = report.standard_error().unwrap_or(f64::NAN);
    println!(
        "  {}   bits {:016x} ± {:016x}   {} samples",
        report.estimate(),
        report.value().to_bits(),
        error.to_bits(),
        report.samples()
    );
}

fn same(a: &Report, b: &Report, what: &str) -> Result<(), Failure> {
    let bits = |report: &Report| {
        let error = report.standard_error().map(f64::to_bits);
        (report.value().to_bits(), error, report.samples())
    };
    ensure(bits(a) == bits(b), &format!("{what} has other bits"))
}

fn refused(result: Result<Report, Failure>, why: &str) -> Result<(), Failure> {
    let Err(error) = result else { return Err(format!("not refused: {why}").into()) };
    println!("  {error}");
    ensure(error.to_string().contains(why), &format!("refused, but not because {why}"))
}

fn ensure(holds: bool, otherwise: &str) -> Result<(), Failure> {
    if holds { Ok(()) } else { Err(otherwise.into()) }
}

/// A new folder, which is removed in the end.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Result<Self, Failure> {
        let path = env::temp_dir().join(format!("mis-shards-{}", std::process::id()));
        fs::create_dir(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(Self(path))
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if let Err(error) = fs::remove_dir_all(&self.0) {
            eprintln!("shards: {} stays: {error}", self.0.display());
        }
    }
}
