//! How a run is watched, and stopped.

use std::fmt::{self, Display};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::session::Session;
use super::state::Leaf;
use super::target::Target;
use crate::estimate::{Estimate, with_error};
use crate::estimator::Frame;
use crate::integrand::Value;

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
    /// The most that it will draw; of a shard, its part.
    pub limit: u64,
    /// The value so far, of the first component; NaN if there is none yet.
    pub value: f64,
    /// Its standard error.
    pub standard_error: Option<f64>,
    /// The half-width of the interval over the tolerance, by the norm of the target: the run
    /// converges where this is at most 1. `None` without a tolerance.
    pub excess: Option<f64>,
    /// Whether all samples before this round were good enough for it to confirm the tolerance.
    pub confirming: bool,
    /// The time since this session began.
    pub elapsed: Duration,
    /// Samples a second, in this session.
    pub rate: f64,
    /// How long it may take from here, to the end of the round that confirms the tolerance, if the
    /// error goes on falling as 1/√N, or 1/N from replicates; at most until the time of the target
    /// is up. `None` while nothing can be said.
    pub remaining: Option<Duration>,
    /// Whether the last checkpoint could not be written.
    pub unsaved: bool,
}

/// A round is taken for large enough if its half-width times this is within the tolerance, so that
/// the next one hardly ever fails to confirm it.
pub(super) const MARGIN: f64 = 1.1;

impl Progress {
    /// That of a run whose first `samples` samples came to `all`.
    pub(super) fn new<V: Value>(
        frame: &Frame<'_>,
        target: &Target,
        round: u32,
        samples: u64,
        all: &Leaf,
        session: &Session,
    ) -> Self {
        let Session { loaded, began, confirming, .. } = session;
        let limit = session.own_limit();
        let estimate = Estimate::<V>::new(frame.design, frame.shares, all.node.part.clone());
        let elapsed = began.elapsed();
        let rate = samples.saturating_sub(*loaded) as f64 / elapsed.as_secs_f64().max(1e-9);
        let excess = target.has_tolerance().then(|| target.excess(&estimate));
        // A shard has no tolerance.
        let end = |number| session.span(number).end;
        let last = match excess {
            Some(excess) if !confirming => {
                let power = if estimate.replicates() > 1 { 1 } else { 2 };
                let needed = samples as f64 * (MARGIN * excess).powi(power);
                let enough = |number: &u32| end(*number) as f64 >= needed || end(*number) == limit;
                // And one more, to confirm it.
                (round..=round.saturating_add(64))
                    .find(enough)
                    .map_or(limit, |number| end(number + 1))
            }
            Some(_) => end(round),
            None => limit,
        };
        let seconds = last.saturating_sub(samples) as f64 / rate;
        let remaining = Duration::try_from_secs_f64(seconds).ok();
        let until = target.limit_of_time().map(|time| time.saturating_sub(elapsed));
        Self {
            round,
            samples,
            limit,
            value: estimate.value_of(0),
            standard_error: estimate.error_of(0),
            excess,
            confirming: *confirming,
            elapsed,
            rate,
            remaining: [remaining, until].into_iter().flatten().min(),
            unsaved: session.save_error.is_some(),
        }
    }
}

/// `0.50012(21), 4194304 samples`.
impl Display for Progress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = with_error(self.value, self.standard_error, 2);
        write!(f, "{value}, {} samples", self.samples)
    }
}

/// A function that is told of the progress.
pub(super) type Watcher<'a> = Box<dyn FnMut(&Progress) -> ControlFlow<()> + 'a>;
