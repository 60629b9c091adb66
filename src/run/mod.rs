//! Runs: an estimator driven to a target, by all threads, and judged.
//!
//! An [`Estimator`] draws the samples that it was made with. A [`Run`] draws as many as a
//! [`Target`] takes, in rounds of chunks, and tells in its [`Report`] whether to believe the result.
//!
//! ```
//! use mis::technique::{Exponential, Uniform};
//! use mis::{MultiSample, Run, Status, Target};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let decay = Exponential::new(5.0, 0.0, 2.0)?;
//! let flat = Uniform::new(0.0, 2.0)?;
//! let mis = MultiSample::new(&[(&decay, 3), (&flat, 1)])?; // shares of the samples
//! let f = |x: &f64| (-5.0 * x).exp() / (1.0 + x);
//!
//! let report = Run::new(Target::new().relative(1e-2)?).execute(&mis, &f, 1)?;
//! assert_eq!(*report.status(), Status::Converged);
//! assert!((report.value() - 0.170_419).abs() < 1e-2 * 0.170_419);
//! # Ok(())
//! # }
//! ```
//!
//! # Rounds and chunks
//!
//! The first round has 1024 samples, each later one as many as all before it together. A round's
//! samples are fixed before it begins, and rounds are combined by their numbers of samples, never by
//! their estimated errors, which would be biased towards the rounds that are low by chance. A round is
//! divided into chunks, and chunks are merged in a fixed binary tree.
//!
//! **The same inputs and seed give the same bits**, whatever the number of threads, the features of
//! the crate, and the build profile; however often a run is interrupted and continued, and into
//! however many shards it is divided. That holds on one target (processor family, operating system,
//! C library): `sin` and its like differ in the last digit between platforms. A limit of time is an
//! input that no one controls: such a run reports how many samples it took, and that number
//! reproduces it.
//!
//! # When a tolerance is reached
//!
//! At the end of a round, all samples so far must pass the judgement below, and 1.1 times the
//! half-width of their interval must be within the tolerance. Then the next round has to confirm it:
//! its samples *alone* must have their half-width within the tolerance (and pass a wider judgement).
//! If they do, they alone are reported. Stopping at the first error bar that is small enough, and
//! reporting it, would be to select the error bars that are too small.
//!
//! From [replicates](crate::points::PointSource::replicates), it is all samples that have to be
//! within the tolerance at the end of that next round, and are reported: points are added to those
//! that are there, and only together are they evenly spread.
//!
//! # The judgement
//!
//! [`Status::Suspect`] is for what can be seen in the samples:
//!
//! - κ, the skewness of the value, [`Estimate::kappa`](crate::Estimate::kappa), greater than
//!   0.07 (1 - 2 k̂): too few samples for such contributions. (Of a confirming round, 0.1. From
//!   replicates, 3.5 standard deviations of what it is if they are normal: 0.49 for 16 of them,
//!   or 0.07 if that is more.)
//! - k̂, the shape of the tail, [`Report::k_hat`], at 1/2 or above: the variance may be infinite. (Of a
//!   confirming round, above 0.7. From replicates, above 0.12: the end of a tail stays random.)
//! - Fewer than 30 contributions that are not 0, of a technique that matters or of all.
//! - Contributions that are all equal: their error of 0 reaches any tolerance, but may be for want of
//!   others.
//! - Samples that do not agree with the pdfs, [`Report::density_scores`].
//!
//! A region that no technique reaches, and a peak that no sample has met, cannot be seen.
#![doc = include_str!("coverage.md")]

mod cell;
mod checkpoint;
mod display;
mod driver;
mod error;
mod judge;
mod k_hat;
mod progress;
mod report;
mod schedule;
mod session;
mod shape;
mod state;
mod status;
mod tally;
mod target;
mod threads;
mod tree;
mod worker;

pub use error::{CheckpointError, RunError, RunFault};
pub(crate) use k_hat::k_hat;
pub use progress::{Cancel, Progress};
pub use report::{Report, RoundSummary};
pub use status::{Doubt, Status, Stop};
pub use tally::{Tallied, Tally};
pub use target::{Norm, Target};

use std::fmt::Debug;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::error::ArgumentError;
use crate::estimator::{Estimator, Sample};
use crate::integrand::Integrand;
use crate::points::{PointSource, Random};
use checkpoint::Shard;
use driver::Driver;
use progress::Watcher;

/// A run of an estimator: its target, its threads, and how it is watched, stopped and saved.
///
/// See the [module](crate::run) for what it promises.
pub struct Run<'a> {
    target: Target,
    threads: Option<usize>,
    cancel: Option<Cancel>,
    watcher: Option<(Duration, Watcher<'a>)>,
    checkpoint: Option<PathBuf>,
    save_every: Duration,
    label: String,
    shard: Shard,
}

impl<'a> Run<'a> {
    /// A run to this target, on all threads.
    #[must_use]
    pub fn new(target: Target) -> Self {
        Self {
            target,
            threads: None,
            cancel: None,
            watcher: None,
            checkpoint: None,
            save_every: Duration::from_secs(30),
            label: String::new(),
            shard: Shard { index: 0, of: 1 },
        }
    }

    /// On so many threads, the calling one included. By default, as many as rayon's global pool has;
    /// without the feature `parallel`, it is always one.
    ///
    /// With a number, the other threads are a pool of their own, which rayon's functions use where
    /// the integrand calls them on one of these threads. A run may be started from within a pool,
    /// and the integrand may use rayon's `join`, `scope` and parallel iterators, or execute another
    /// run: a thread of the pool that waits so goes on with other work, with chunks of this run too.
    /// The integrand must not wait for the pool in any other way, as at a channel for a job that it
    /// has spawned, nor hold a lock while it waits: once all threads of the pool wait, or one
    /// for its own lock, **the run hangs**, and neither a [`Cancel`] nor a time ends it.
    ///
    /// # Errors
    ///
    /// There must be at least one, and at most 4096.
    pub fn threads(self, threads: usize) -> Result<Self, ArgumentError> {
        // Tens of thousands would bring the machine to a halt before the system refused one.
        if !(1..=4096).contains(&threads) {
            let rule = "it must be at least 1 and at most 4096";
            return Err(ArgumentError::new("Run", "threads", threads, rule));
        }
        Ok(Self { threads: Some(threads), ..self })
    }

    /// Stops when this switch is thrown, with what is finished.
    #[must_use]
    pub fn cancel(self, cancel: &Cancel) -> Self {
        Self { cancel: Some(cancel.clone()), ..self }
    }

    /// Calls `watcher` on the calling thread at the end of every round, and every time that
    /// `interval` has passed and the calling thread has finished a chunk. `ControlFlow::Break`
    /// stops the run, with what is finished.
    #[must_use]
    pub fn progress(
        self,
        interval: Duration,
        watcher: impl FnMut(&Progress) -> ControlFlow<()> + 'a,
    ) -> Self {
        Self { watcher: Some((interval, Box::new(watcher))), ..self }
    }

    /// Saves the run to the file at `path`, and continues it if the file is there already.
    ///
    /// It is saved at the end of every round, at the end, and every 30 seconds (see
    /// [`save_every`](Run::save_every)), whole or not at all. A file of another run is refused, not
    /// overwritten: the estimator, the label, and of the first 16 samples of every technique the
    /// points, weights, contributions, and what a tally makes of them must be the same, which tells
    /// another seed, integrand, technique or weighting. An integrand or a tally that differs at other
    /// points only, as one of a rare event may, cannot be told; give it another label.
    ///
    /// The target may be another: a tighter tolerance, or more samples, continue from the file as
    /// if they had been asked for from the start.
    ///
    /// A process that is killed while it writes may leave a file beside it, with `.<process>.tmp`
    /// behind the name. No run reads it; it can be deleted.
    ///
    /// If the file cannot be written at the start, nothing is run. If it cannot be written later,
    /// the run goes on and tries again (see [`Progress::unsaved`]), and the file keeps what it had; a
    /// run whose end cannot be saved is an error with the report in it.
    #[must_use]
    pub fn checkpoint(self, path: impl AsRef<Path>) -> Self {
        Self { checkpoint: Some(path.as_ref().into()), ..self }
    }

    /// How much time may pass between checkpoints.
    #[must_use]
    pub fn save_every(self, interval: Duration) -> Self {
        Self { save_every: interval, ..self }
    }

    /// A name that a checkpoint must have to be continued.
    #[must_use]
    pub fn label(self, label: impl Into<String>) -> Self {
        Self { label: label.into(), ..self }
    }

    /// Draws only the part `index` (from 0) of `of` parts of the run, to be
    /// [merged](Run::merge) with the others, which other processes draw. Processes on one machine
    /// should be given [`threads`](Run::threads), or each takes them all.
    ///
    /// # Errors
    ///
    /// `index` must be less than `of`. That the run has a checkpoint, a number of samples, and
    /// neither a tolerance nor a time, is checked when it is executed.
    pub fn shard(self, index: u64, of: u64) -> Result<Self, ArgumentError> {
        if index >= of {
            let rule = format!("it must be less than of = {of}");
            return Err(ArgumentError::new("Run::shard", "index", index, rule));
        }
        Ok(Self { shard: Shard { index, of }, ..self })
    }

    /// Runs `estimator` on f with random numbers. From within a pool of threads, or with an
    /// integrand that uses one, see [`threads`](Run::threads).
    ///
    /// # Errors
    ///
    /// Wrong settings, a sample that is not what it must be, a panic, or a checkpoint that cannot be
    /// used. What was finished before is in the error.
    pub fn execute<P, F, E>(
        self,
        estimator: &E,
        f: &F,
        seed: u64,
    ) -> Result<Report<F::Value>, RunError<F::Value>>
    where
        P: Debug,
        F: Integrand<P> + Sync + ?Sized,
        E: Estimator<P> + ?Sized,
    {
        self.execute_from(estimator, f, &Random::new(seed))
    }

    /// Runs `estimator` on f with the canonical numbers of `points`.
    ///
    /// # Errors
    ///
    /// As [`execute`](Run::execute).
    pub fn execute_from<P, F, E, S>(
        self,
        estimator: &E,
        f: &F,
        points: &S,
    ) -> Result<Report<F::Value>, RunError<F::Value>>
    where
        P: Debug,
        F: Integrand<P> + Sync + ?Sized,
        E: Estimator<P> + ?Sized,
        S: PointSource + ?Sized,
    {
        Driver::new(self, estimator, f, points, &()).run(None)
    }

    /// Runs as [`execute_from`](Run::execute_from), and shows every sample to `observe`, which adds
    /// to `sums` sums: a histogram, say, or integrals of f times something.
    ///
    /// The sums come with standard errors, in [`Report::tallied`], and are as reproducible as the
    /// value. `observe` is called on several threads; it must be a function of the sample. Where a
    /// run is interrupted, it may be shown samples that do not count in the end.
    ///
    /// ```
    /// use mis::points::Random;
    /// use mis::{MultiSample, Run, Target, technique::Linear};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let p = Linear::new(0.0, 1.0, 0.5, 1.5)?;
    /// let mis = MultiSample::new(&[(&p, 10_000)])?;
    /// // The parts of ∫ x² on each tenth of the unit interval.
    /// let f = |x: &f64| x * x;
    /// let report = Run::new(Target::new()).tally(&mis, &f, &Random::new(1), 10, |sample, tally| {
    ///     tally.add((sample.x() * 10.0) as usize, sample.value() * sample.weight());
    /// })?;
    /// let total: f64 = report.tallied().iter().map(|bin| bin.value).sum();
    /// assert!((total - report.value()).abs() < 1e-12);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// As [`execute`](Run::execute); and `sums` may be at most 2²⁴ over the number of techniques,
    /// times that of replicates.
    pub fn tally<P, F, E, S, O>(
        self,
        estimator: &E,
        f: &F,
        points: &S,
        sums: usize,
        observe: O,
    ) -> Result<Report<F::Value>, RunError<F::Value>>
    where
        P: Debug,
        F: Integrand<P> + Sync + ?Sized,
        E: Estimator<P> + ?Sized,
        S: PointSource + ?Sized,
        O: Fn(&Sample<'_, P, F::Value>, &mut Tally<'_>) + Sync,
    {
        Driver::new(self, estimator, f, points, &(sums, observe)).run(None)
    }

    /// Puts the files of all shards of a run together, to the bits of the run in one piece. The
    /// order of the files does not matter.
    ///
    /// The settings are those of the run in one piece. With a [checkpoint](Run::checkpoint), the
    /// whole run is saved there, and can be continued to another target.
    ///
    /// # Errors
    ///
    /// A file that is damaged, of another run, or not finished; shards that are missing or there
    /// twice.
    pub fn merge<P, F, E, S>(
        self,
        estimator: &E,
        f: &F,
        points: &S,
        files: &[impl AsRef<Path>],
    ) -> Result<Report<F::Value>, RunError<F::Value>>
    where
        P: Debug,
        F: Integrand<P> + Sync + ?Sized,
        E: Estimator<P> + ?Sized,
        S: PointSource + ?Sized,
    {
        let files: Vec<&Path> = files.iter().map(AsRef::as_ref).collect();
        Driver::new(self, estimator, f, points, &()).run(Some(&files))
    }
}

impl Debug for Run<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Run")
            .field("target", &self.target)
            .field("threads", &self.threads)
            .field("checkpoint", &self.checkpoint)
            .field("shard", &self.shard)
            .finish_non_exhaustive()
    }
}
