//! How a run is watched, and stopped.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Stops a run from another thread.
///
/// Clones are one and the same switch. Samples are drawn in blocks, of up to 512 of one technique;
/// no block is begun after it is thrown, and those that are being evaluated are waited for.
#[derive(Debug, Clone, Default)]
pub struct Cancel(Arc<AtomicBool>);

impl Cancel {
    /// A switch that has not been thrown.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Stops every run that has this switch, now and later.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it has been thrown.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// How far a run has come.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// The present round, from 0; each has as many samples as all before it together.
    pub round: u32,
    /// The samples drawn so far, those of earlier sessions included.
    pub samples: u64,
    /// The most that it will draw.
    pub limit: u64,
    /// The value so far, of the first component; NaN if there is none yet.
    pub value: f64,
    /// Its standard error.
    pub standard_error: Option<f64>,
    /// The half-width of the interval over the tolerance, by the norm of the target: the run
    /// converges where this is at most 1. `None` without a tolerance.
    pub excess: Option<f64>,
    /// The time since this session began.
    pub elapsed: Duration,
    /// Samples a second, in this session.
    pub rate: f64,
    /// How long it may take from here, if the error goes on falling as 1/√N; at most until the
    /// time of the target is up. `None` while nothing can be said.
    pub remaining: Option<Duration>,
}

/// A function that is told of the progress.
pub(super) type Watcher<'a> = Box<dyn FnMut(&Progress) -> ControlFlow<()> + 'a>;
