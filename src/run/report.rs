//! What a run came to.

use std::time::Duration;

use super::error::CheckpointError;
use super::judge::Judged;
use super::status::{Status, Stop};
use super::tally::Tallied;
use super::target::Target;
use crate::estimate::Estimate;
use crate::integrand::Value;

/// The result of a run: an [`Estimate`], why the run ended, and whether to believe it.
///
/// `Display` prints it all as a table.
#[derive(Debug)]
pub struct Report<V: Value = f64> {
    pub(super) judged: Judged<V>,
    pub(super) stop: Stop,
    pub(super) status: Status,
    pub(super) rounds: Vec<RoundSummary<V>>,
    pub(super) tallied: Vec<Tallied>,
    pub(super) misplaced: u64,
    /// Of all rounds.
    pub(super) samples: u64,
    pub(super) elapsed: Duration,
    pub(super) drawn: u64,
    pub(super) settings: Settings,
    pub(super) checkpoint_error: Option<CheckpointError>,
}

/// What a run was asked for.
#[derive(Debug, Clone)]
pub(super) struct Settings {
    pub(super) target: Target,
    pub(super) estimator: String,
    pub(super) others: Vec<(&'static str, String)>,
}

/// One round of a run.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct RoundSummary<V: Value = f64> {
    /// What its own samples came to.
    pub estimate: Estimate<V>,
    /// What all samples up to its end came to.
    pub cumulative: Estimate<V>,
}

impl<V: Value> Report<V> {
    /// The estimate. Of the confirming round alone, if the run [converged](Stop::Tolerance) and its
    /// samples are independent; of all samples, if it ended otherwise, or from replicates.
    ///
    /// The rounds before a confirming one decided when to stop, and their error is one of those
    /// that are small by chance; the confirming round is as large as all of them, and had no say.
    /// Replicates of twice the points have an error that hardly depends on the one before.
    #[must_use]
    pub fn estimate(&self) -> &Estimate<V> {
        &self.judged.estimate
    }

    /// The value of the [estimate](Report::estimate).
    #[must_use]
    pub fn value(&self) -> V::Each<f64> {
        self.estimate().value()
    }

    /// The standard error of the [estimate](Report::estimate).
    #[must_use]
    pub fn standard_error(&self) -> V::Each<Option<f64>> {
        self.estimate().standard_error()
    }

    /// Why the run ended.
    #[must_use]
    pub fn stop(&self) -> Stop {
        self.stop
    }

    /// Whether to believe it.
    #[must_use]
    pub fn status(&self) -> &Status {
        &self.status
    }

    /// The rounds, in their order. Each has as many samples as all before it together, but for the
    /// last, where the run may end.
    #[must_use]
    pub fn rounds(&self) -> &[RoundSummary<V>] {
        &self.rounds
    }

    /// How many samples the run drew in all its rounds, those of earlier sessions included.
    ///
    /// A run with that many as its target draws the same samples, however this one was ended; unless
    /// it converged, the estimate has the same bits. The techniques' own samples may add to a few
    /// less: the share of each is rounded down.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// The sums of a [tally](crate::Run::tally), from the samples of the
    /// [estimate](Report::estimate).
    #[must_use]
    pub fn tallied(&self) -> &[Tallied] {
        &self.tallied
    }

    /// How often something was added to a sum that there is not.
    #[must_use]
    pub fn misplaced(&self) -> u64 {
        self.misplaced
    }

    /// The shape k̂ of the heaviest tail of the contributions of a technique that matters, as a
    /// generalised Pareto distribution. `None` where there is no tail to speak of.
    ///
    /// Moments of order 1/k̂ and above are infinite: the variance from 1/2 on. Above 0.7, means of
    /// practical size are far from normal, and no error can be believed.
    ///
    /// Sources: J. Zhang and M. A. Stephens, *A New and Efficient Estimation Method for the
    /// Generalized Pareto Distribution*, 2009, doi:10.1198/tech.2009.08017; A. Vehtari, D. Simpson,
    /// A. Gelman, Y. Yao and J. Gabry, *Pareto Smoothed Importance Sampling*, 2024.
    #[must_use]
    pub fn k_hat(&self) -> V::Each<Option<f64>> {
        V::each(|c| self.judged.k_hat(c).map(|(_, k)| k))
    }

    /// For each technique, whether its pdf integrates to 1 as the samples of all techniques have
    /// it: the standard score of Σ α_i mean_i(p_k / Σ α_m p_m) - 1, which is 0 on average if every
    /// technique samples the pdf that it states.
    ///
    /// From replicates, scores are smaller than that: points are more even than independent ones, of
    /// which the variance is taken.
    ///
    /// `None` where it cannot be said: with one technique, with constant weights (the other pdfs are
    /// not evaluated), and where densities leave the range of `f64`. A large score names no culprit:
    /// if one sampler is wrong, several scores are large.
    #[must_use]
    pub fn density_scores(&self) -> &[Option<f64>] {
        &self.judged.density_scores
    }

    /// How many samples this session drew: all but those that were in the checkpoint.
    #[must_use]
    pub fn drawn(&self) -> u64 {
        self.drawn
    }

    /// How long this session took.
    #[must_use]
    pub fn elapsed(&self) -> Duration {
        self.elapsed
    }

    /// Why the run could not be saved at its end, where it ended for another fault.
    #[must_use]
    pub fn checkpoint_error(&self) -> Option<&CheckpointError> {
        self.checkpoint_error.as_ref()
    }
}
