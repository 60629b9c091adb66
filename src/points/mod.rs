//! Point sources: where the canonical numbers ξ come from.

mod random;
mod replay;

pub use random::Random;
pub use replay::Replay;

use std::fmt::Debug;

/// A source of canonical numbers in the unit interval.
///
/// The numbers are a function of (stream, sample, coordinate), so that any block of them can be
/// had at any time, in any order. An estimator reads one stream a technique (multi-sample) or one
/// stream in all (one-sample).
///
/// What an estimator makes of them relies on this:
///
/// - Each number is uniform in (0, 1), and different streams are independent of each other.
/// - Standard errors and intervals hold for samples that are independent as well. From points that
///   are spread more evenly, such as quasi-random ones, the value is better than its error says;
///   estimate the error from several independent randomisations instead.
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
