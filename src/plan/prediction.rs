//! What a plan may come to.

use std::fmt::{self, Display};

use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, Normal};

use super::method::Method;
use crate::run::Target;

/// What a pilot predicts of a method with certain shares of the samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Prediction {
    /// The method.
    pub method: Method,
    /// α_i: the share of each technique in the samples.
    pub shares: Vec<f64>,
    /// Whether the shares were [optimised](super::Pilot::allocate), or are equal (or all of one technique).
    pub optimised: bool,
    /// N times the variance of an estimate from N samples, for each component.
    pub variance: Vec<f64>,
    /// The standard error of `variance`, over it.
    pub uncertainty: Vec<f64>,
    /// What a sample costs, in the unit of [`Costs`](super::Costs).
    pub cost: f64,
    /// 1 / (variance · cost); of several components, with the sum of their variances, each over the mean
    /// of its squared contributions.
    pub efficiency: f64,
    /// Why not to believe it, if there is a reason.
    pub caution: Option<Caution>,
}

/// Why a [`Prediction`] is not to be believed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Caution {
    /// The estimate would be wrong: the method relies on a technique where f is not 0 and its pdf is.
    Biased {
        /// The technique.
        technique: usize,
    },
    /// Few samples make up the variance, which may be far larger, or infinite.
    HeavyTail,
    /// Too few samples for the variance to be known within 20 % or so.
    Uncertain,
    /// No sample had a contribution other than 0.
    NoSignal,
}

/// In words.
impl Display for Caution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Biased { technique } => {
                write!(f, "biased: technique {technique} does not reach all of f")
            }
            Self::HeavyTail => {
                f.write_str("few samples make up the variance, it may be far larger")
            }
            Self::Uncertain => {
                f.write_str("the pilot is too small to tell the variance within 20 %")
            }
            Self::NoSignal => f.write_str("no sample of the pilot met f"),
        }
    }
}

impl Caution {
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Biased { .. } => "biased",
            Self::HeavyTail => "heavy tail",
            Self::Uncertain => "uncertain",
            Self::NoSignal => "no signal",
        }
    }
}

impl Prediction {
    /// How many samples the [interval](crate::Estimate::interval) takes to be within the tolerance of
    /// `target`, of integrals of these `values`; a run that has to [confirm](crate::run) it draws two to
    /// four times as many. Infinite without a tolerance.
    #[must_use]
    pub fn samples_for(&self, target: &Target, values: &[f64]) -> f64 {
        let z = Normal::standard().inverse_cdf(0.5 + 0.5 * target.level());
        let one = |(v, value): (&f64, &f64)| Some((z * v.sqrt(), value.abs()));
        target.excess_of(self.variance.iter().zip(values).map(one)).powi(2)
    }

    /// What [so many](Prediction::samples_for) samples cost.
    #[must_use]
    pub fn cost_for(&self, target: &Target, values: &[f64]) -> f64 {
        self.samples_for(target, values) * self.cost
    }

    /// The standard error of each component after samples that cost this together.
    #[must_use]
    pub fn error_within(&self, cost: f64) -> Vec<f64> {
        self.variance.iter().map(|v| (v * self.cost / cost).sqrt()).collect()
    }
}
