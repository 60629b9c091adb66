//! What can be wrong with an argument.

use std::borrow::Cow;
use std::fmt::{Debug, Display};

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
            value: format!("{value:?}"),
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

    /// The argument's value, as `Debug` prints it.
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

/// `value`, if it is finite.
pub(crate) fn finite(
    owner: &'static str,
    argument: impl Into<Cow<'static, str>>,
    value: f64,
) -> Result<f64, ArgumentError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(ArgumentError::new(
            owner,
            argument,
            value,
            "it must be finite",
        ))
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
        Err(ArgumentError::new(
            owner,
            argument,
            value,
            "it must be finite and greater than 0",
        ))
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
