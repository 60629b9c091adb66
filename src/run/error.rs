//! What can end a run before its target.

use std::path::PathBuf;

use super::report::Report;
use crate::error::{ArgumentError, EstimateError};
use crate::integrand::Value;

/// A run that failed, with what was finished before.
#[derive(Debug, thiserror::Error)]
#[error("{cause}")]
pub struct RunError<V: Value = f64> {
    cause: Box<RunFault>,
    report: Option<Box<Report<V>>>,
}

impl<V: Value> RunError<V> {
    pub(super) fn new(cause: impl Into<RunFault>, report: Option<Report<V>>) -> Self {
        Self { cause: Box::new(cause.into()), report: report.map(Box::new) }
    }

    /// What went wrong.
    #[must_use]
    pub fn fault(&self) -> &RunFault {
        &self.cause
    }

    /// What was finished: the samples before the one that failed. `None` if there are none.
    #[must_use]
    pub fn report(&self) -> Option<&Report<V>> {
        self.report.as_deref()
    }
}

impl<V: Value, E: Into<RunFault>> From<E> for RunError<V> {
    fn from(cause: E) -> Self {
        Self::new(cause, None)
    }
}

/// What went wrong in a run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunFault {
    /// The settings of the run, or of its target, are wrong.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// A sample is not what it must be. Of several, the one that comes first in the order of the
    /// samples, whatever the number of threads.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// The integrand or a technique panicked.
    #[error("a panic while samples {first} to {last} were drawn: {message}")]
    Panic {
        /// The first sample of the chunk, counted over all techniques.
        first: u64,
        /// The last sample of the chunk.
        last: u64,
        /// What the panic said.
        message: String,
    },
    /// A checkpoint could not be read or written.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// The threads could not be started.
    #[error("{threads} threads could not be started: {message}")]
    Threads {
        /// How many.
        threads: usize,
        /// What the system said.
        message: String,
    },
}

/// A checkpoint that could not be written, or that cannot be continued.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The system refused to read or write.
    #[error("checkpoint {}: {action} failed: {error}", path.display())]
    System {
        /// The file.
        path: PathBuf,
        /// What was being done.
        action: &'static str,
        /// What the system said.
        #[source]
        error: std::io::Error,
    },
    /// The file is no checkpoint, or not a whole one, or holds what no run of its kind has.
    #[error("checkpoint {}: {problem}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// The file belongs to another run.
    #[error("checkpoint {}: it is of another run: {difference}", path.display())]
    OtherRun {
        /// The file.
        path: PathBuf,
        /// In what they differ.
        difference: String,
    },
    /// Shards do not make up a run.
    #[error("the shards do not make up a run: {problem}")]
    Shards {
        /// Which is missing, or there twice.
        problem: String,
    },
}
