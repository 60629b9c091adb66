//! What can be wrong with an argument, and with a sample.

use std::borrow::Cow;
use std::fmt::{Debug, Display};

use crate::points::PointsExhausted;

/// An argument that breaks a rule: whose argument, which one, its value, and the rule.
///
/// Every constructor of this crate returns it, and techniques and weightings written elsewhere
/// can return it too.
///
/// ```
/// let error = mis::technique::Uniform::new(1.0, -1.0).unwrap_err();
/// assert_eq!(error.to_string(), "Uniform: `b` is -1.0, but it must be greater than a = 1");
/// ```
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{owner}: `{argument}` is {value}, but {rule}")]
#[non_exhaustive]
pub struct ArgumentError {
    owner: Cow<'static, str>,
    argument: Cow<'static, str>,
    value: String,
    rule: Cow<'static, str>,
}

impl ArgumentError {
    /// `owner`'s `argument` has this `value`, which breaks `rule` (a clause such as
    /// "it must be finite").
    pub fn new(
        owner: impl Into<Cow<'static, str>>,
        argument: impl Into<Cow<'static, str>>,
        value: impl Debug,
        rule: impl Into<Cow<'static, str>>,
    ) -> Self {
        Self {
            owner: owner.into(),
            argument: argument.into(),
            value: shortened(&value),
            rule: rule.into(),
        }
    }

    /// The type or function whose argument it is.
    #[must_use]
    pub fn owner(&self) -> &str {
        &self.owner
    }

    /// The argument's name.
    #[must_use]
    pub fn argument(&self) -> &str {
        &self.argument
    }

    /// The argument's value, as `Debug` prints it, cut after 300 characters.
    #[must_use]
    pub fn value(&self) -> &str {
        &self.value
    }

    /// The rule that the value breaks.
    #[must_use]
    pub fn rule(&self) -> &str {
        &self.rule
    }
}

/// An estimator that had to stop: for what the integrand or a technique did at a sample, or for
/// want of points.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EstimateError {
    /// The integrand is infinite or NaN.
    #[error(
        "the integrand is {value} at sample {sample} of technique {technique}, x = {point}; it \
         must be finite"
    )]
    Value {
        /// The technique that drew the sample.
        technique: usize,
        /// The sample's index.
        sample: u64,
        /// The point, as `Debug` prints it, cut after 300 characters.
        point: String,
        /// The value, as `Debug` prints it, cut after 300 characters.
        value: String,
    },
    /// A pdf is 0 or infinite at its own technique's sample, or negative or NaN at any sample.
    #[error(
        "the pdf of technique {technique} is {pdf} at sample {sample} of technique {sampled_by}, \
         x = {point}; a pdf must be at least 0, and finite and greater than 0 at its own samples"
    )]
    Density {
        /// The technique whose pdf it is.
        technique: usize,
        /// The technique that drew the sample.
        sampled_by: usize,
        /// The sample's index.
        sample: u64,
        /// The point, as `Debug` prints it, cut after 300 characters.
        point: String,
        /// The pdf.
        pdf: f64,
    },
    /// The integrand is finite, but divided by the density it is not.
    #[error(
        "the contribution of sample {sample} of technique {technique} is {contribution}, \
         x = {point}; it must be within the range of f64"
    )]
    Contribution {
        /// The technique that drew the sample.
        technique: usize,
        /// The sample's index.
        sample: u64,
        /// The point, as `Debug` prints it, cut after 300 characters.
        point: String,
        /// The contribution, times the number of samples.
        contribution: f64,
    },
    /// More samples without a usable contribution than were allowed to count as 0.
    #[error(
        "{faults} of {samples} samples have no usable contribution; at most the part {at_most} of \
         them may count as 0"
    )]
    Faults {
        /// How many.
        faults: u64,
        /// Of how many samples.
        samples: u64,
        /// The part that is allowed.
        at_most: f64,
    },
    /// A technique made fewer or more points than it was given canonical numbers for.
    #[error(
        "`sample_batch` of technique {technique} made {sampled} points from numbers for {asked}; \
         it must make one for each row"
    )]
    Batch {
        /// The technique.
        technique: usize,
        /// How many points it should have made.
        asked: usize,
        /// How many it made.
        sampled: usize,
    },
    /// A control variate is infinite or NaN, or over the density it is.
    #[error(
        "control variate {variate} is {value} at sample {sample} of technique {technique}, \
         x = {point}; it must be finite, over the density of the samples too"
    )]
    Variate {
        /// The control variate, by its index.
        variate: usize,
        /// The technique that drew the sample.
        technique: usize,
        /// The sample's index.
        sample: u64,
        /// The point, as `Debug` prints it, cut after 300 characters.
        point: String,
        /// The value.
        value: f64,
    },
    /// The point source ran out.
    #[error(transparent)]
    Points(#[from] PointsExhausted),
}

/// What is wrong with a sample.
#[derive(Debug)]
pub(crate) enum Fault {
    Value,
    Density { of: usize, pdf: f64 },
    Contribution(f64),
}

impl EstimateError {
    pub(crate) fn new(
        technique: usize,
        sample: u64,
        x: &impl Debug,
        value: &impl Debug,
        fault: &Fault,
    ) -> Self {
        let point = shortened(x);
        match *fault {
            Fault::Value => Self::Value { technique, sample, point, value: shortened(value) },
            Fault::Density { of, pdf } => {
                Self::Density { technique: of, sampled_by: technique, sample, point, pdf }
            }
            Fault::Contribution(contribution) => {
                Self::Contribution { technique, sample, point, contribution }
            }
        }
    }
}

/// `x` as `Debug` prints it, cut after 300 characters: it may have thousands of coordinates.
pub(crate) fn shortened(x: &impl Debug) -> String {
    let mut text = format!("{x:?}");
    if let Some((end, _)) = text.char_indices().nth(300) {
        text.truncate(end);
        text.push('…');
    }
    text
}

/// `value`, if it is finite.
pub(crate) fn finite(
    owner: &'static str,
    argument: impl Into<Cow<'static, str>>,
    value: f64,
) -> Result<f64, ArgumentError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(ArgumentError::new(owner, argument, value, "it must be finite"))
    }
}

/// `value`, if it is finite and greater than 0.
pub(crate) fn positive(
    owner: &'static str,
    argument: impl Into<Cow<'static, str>>,
    value: f64,
) -> Result<f64, ArgumentError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(ArgumentError::new(owner, argument, value, "it must be finite and greater than 0"))
    }
}

/// `value`, if it is greater than `lower`; NaN is not.
pub(crate) fn greater(
    owner: &'static str,
    argument: impl Into<Cow<'static, str>>,
    value: f64,
    lower_name: impl Display,
    lower: f64,
) -> Result<f64, ArgumentError> {
    if value > lower {
        Ok(value)
    } else {
        let rule = format!("it must be greater than {lower_name} = {lower}");
        Err(ArgumentError::new(owner, argument, value, rule))
    }
}
