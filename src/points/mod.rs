//! Point sources: where the canonical numbers ξ come from.
//!
//! | source | samples of a stream | use |
//! |---|---|---|
//! | [`Random`] | independent | the default |
//! | [`Antithetic`] | pairs ξ, 1 - ξ | contributions that rise or fall with every coordinate |
//! | [`Stratified`] | S at a time, one in each of S strata of every coordinate | contributions that are nearly sums of functions of one coordinate |
//! | [`Sobol`] | even in all coordinates at once | smooth contributions: the error falls faster |
//! | [`Replay`] | given numbers | tables, other generators, faults |
//!
//! But for random and given numbers, samples depend on each other, and the error comes from
//! independent replicates.

mod antithetic;
mod directions;
mod hash;
mod random;
mod replay;
mod sobol;
mod stratified;

pub use antithetic::Antithetic;
pub use random::Random;
pub use replay::Replay;
pub use sobol::Sobol;
pub use stratified::Stratified;

use std::fmt::Debug;

use crate::error::ArgumentError;

/// A source of canonical numbers in the unit interval.
///
/// The numbers are a function of (stream, sample, coordinate), so that any block of them can be
/// had at any time, in any order.
///
/// The samples of a technique (multi-sample) or of all together (one-sample) are dealt to
/// R = [`replicates`](PointSource::replicates) streams in turn. Technique i's sample j is sample
/// ⌊j / R⌋ of stream i R + j mod R; one-sample, the streams are 0 to R - 1.
///
/// What an estimator makes of them relies on this:
///
/// - Each number is uniform in \[0, 1), and different streams are independent of each other.
/// - Where R = 1, so are the samples of a stream. Otherwise the samples of a stream may depend on
///   each other, and standard errors and intervals come from the R replicates alone.
/// - Numbers outside \[0, 1\] are not looked for; techniques move them to the nearer end.
pub trait PointSource: Sync + Debug {
    /// Fills `xi` with rows of `dimension` numbers: the rows belong to samples `first`,
    /// `first + 1`, … of `stream`.
    ///
    /// # Errors
    ///
    /// The source has no such numbers: too few samples, no such stream, or not as many dimensions.
    fn fill(
        &self,
        stream: usize,
        first: u64,
        dimension: usize,
        xi: &mut [f64],
    ) -> Result<(), PointsExhausted>;

    /// R, how many independent streams the samples of a technique are dealt to; 1 where all samples
    /// are independent, which is the default. It must not change, and be at least 1 and at most
    /// 4096; beyond, estimators take the nearer of these for R.
    ///
    /// A source that wraps another must hand this on with [`fill`](PointSource::fill): otherwise the
    /// error is that of independent samples, and wrong.
    fn replicates(&self) -> usize {
        1
    }
}

/// The most replicates: every one of them has sums of its own for each technique.
const MOST_REPLICATES: usize = 4096;

/// A number of replicates from which an error can be told.
fn checked_replicates(owner: &'static str, replicates: usize) -> Result<usize, ArgumentError> {
    if (2..=MOST_REPLICATES).contains(&replicates) {
        Ok(replicates)
    } else {
        let rule = "it must be at least 2 and at most 4096";
        Err(ArgumentError::new(owner, "replicates", replicates, rule))
    }
}

/// R, within its bounds.
pub(crate) fn replicates(points: &(impl PointSource + ?Sized)) -> usize {
    points.replicates().clamp(1, MOST_REPLICATES)
}

/// A point source that has fewer samples than an estimator asked for.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "the point source has {available} canonical numbers in stream {stream}, but sample {sample} \
     of dimension {dimension} needs more"
)]
pub struct PointsExhausted {
    /// The stream that ran out.
    pub stream: usize,
    /// The first sample for which numbers are missing.
    pub sample: u64,
    /// How many numbers each sample uses.
    pub dimension: usize,
    /// How many numbers the stream has.
    pub available: usize,
}
