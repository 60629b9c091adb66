//! Why a run ended, and whether to believe it.

use std::fmt::{self, Display};

/// Why a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stop {
    /// The tolerance was reached, and a round of fresh samples confirmed it.
    Tolerance,
    /// All samples were drawn.
    Samples,
    /// The time was up.
    Time,
    /// It was cancelled.
    Cancelled,
    /// A sample, or a file, failed; see the error.
    Fault,
}

impl Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Tolerance => "the tolerance is reached",
            Self::Samples => "all samples are drawn",
            Self::Time => "the time is up",
            Self::Cancelled => "it was cancelled",
            Self::Fault => "a fault stopped it",
        })
    }
}

/// Whether to believe a run, in one word.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Status {
    /// The tolerance is reached, and nothing speaks against the error.
    Converged,
    /// The samples or the time are spent; nothing speaks against the error.
    BudgetSpent,
    /// Cancelled, or stopped by a fault; nothing speaks against the error of what was finished.
    Cancelled,
    /// The value, its error, or both may be wrong, for these reasons.
    Suspect(Vec<Doubt>),
    /// Every contribution to what the target counts is 0. At 95 % confidence, at most the part `at_most` of all samples have
    /// one that is not: 3 / N, the rule of three. How large those are, no sample says.
    #[non_exhaustive]
    NoSignal {
        /// 3 / N, or 1 if that is more.
        at_most: f64,
    },
}

/// A reason to doubt a value or its error.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// A technique has drawn fewer samples than an error can be had from; with none, its part of
    /// the integral is missing.
    #[non_exhaustive]
    Samples {
        /// The technique.
        technique: usize,
        /// How many samples it has drawn.
        samples: u64,
    },
    /// There are fewer samples than replicates to divide them among, so that no error is known.
    #[non_exhaustive]
    EmptyReplicates {
        /// How many samples were drawn.
        samples: u64,
        /// How many replicates there are.
        replicates: usize,
    },
    /// Few contributions are not 0: of a technique that matters, or of all together.
    #[non_exhaustive]
    FewContributions {
        /// The technique; `None` for all together.
        technique: Option<usize>,
        /// How many are not 0.
        contributions: u64,
    },
    /// All contributions are equal, so that the error is 0. If they are not so everywhere, then at 95 %
    /// confidence at most the part `at_most` of all samples have another: 3 / N, the rule of three.
    #[non_exhaustive]
    Constant {
        /// The component.
        component: usize,
        /// 3 / N, or 1 if that is more.
        at_most: f64,
    },
    /// The contributions are so skewed that their mean is not close to normal: κ is large.
    #[non_exhaustive]
    Skewed {
        /// The component.
        component: usize,
        /// See [`Estimate::kappa`](crate::Estimate::kappa).
        kappa: f64,
    },
    /// The contributions of a technique have a tail so heavy that the variance may be infinite; from
    /// replicates, too heavy for the interval of so few values.
    #[non_exhaustive]
    HeavyTail {
        /// The technique.
        technique: usize,
        /// The component.
        component: usize,
        /// See [`Report::k_hat`](crate::Report::k_hat).
        k_hat: f64,
    },
    /// The samples of the techniques do not agree with their pdfs.
    #[non_exhaustive]
    Density {
        /// The technique whose pdf integrates to something else than 1, as the samples have it.
        technique: usize,
        /// See [`Report::density_scores`](crate::Report::density_scores).
        z: f64,
    },
}

impl Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Samples { technique, samples: 0 } => {
                write!(f, "technique {technique} has drawn no sample: its part is missing")
            }
            Self::Samples { technique, samples: 1 } => {
                write!(f, "technique {technique} has drawn 1 sample: no error is known")
            }
            Self::Samples { technique, samples } => write!(
                f,
                "technique {technique} has drawn {samples} samples, fewer than there are \
                 replicates: no error is known"
            ),
            Self::EmptyReplicates { samples, replicates } => write!(
                f,
                "there are {replicates} replicates, but {samples} samples: no error is known"
            ),
            Self::FewContributions { technique: None, contributions } => {
                write!(f, "only {contributions} contributions are not 0")
            }
            Self::FewContributions { technique: Some(technique), contributions } => {
                write!(f, "only {contributions} contributions of technique {technique} are not 0")
            }
            Self::Constant { component, at_most } => write!(
                f,
                "all contributions to component {component} are equal: the error is 0 if they always \
                 are; at 95 % confidence, at most {at_most:.1e} of them are not"
            ),
            Self::Skewed { component, kappa } => write!(
                f,
                "the contributions to component {component} are too skewed for so few samples \
                 (kappa {kappa:.2})"
            ),
            Self::HeavyTail { technique, component, k_hat } => {
                let why = if *k_hat < 0.5 {
                    "the interval of a few replicates is too narrow for it"
                } else {
                    "the variance may be infinite"
                };
                write!(
                    f,
                    "the contributions of technique {technique} to component {component} have a \
                     heavy tail (k-hat {k_hat:.2}): {why}"
                )
            }
            Self::Density { technique, z } => write!(
                f,
                "the samples do not agree with the pdf of technique {technique} (z {z:.1}): a \
                 sampler and its pdf differ, or a pdf does not integrate to 1"
            ),
        }
    }
}

impl Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Converged => f.write_str("converged"),
            Self::BudgetSpent => f.write_str("budget spent"),
            Self::Cancelled => f.write_str("cancelled"),
            Self::Suspect(doubts) => {
                f.write_str("suspect: ")?;
                for (k, doubt) in doubts.iter().enumerate() {
                    let separator = if k == 0 { "" } else { "; " };
                    write!(f, "{separator}{doubt}")?;
                }
                Ok(())
            }
            Self::NoSignal { at_most } => write!(
                f,
                "no signal: every contribution is 0; at 95 % confidence, at most {at_most:.2e} of \
                 all samples have another"
            ),
        }
    }
}
