//! The estimators that a plan chooses among.

use std::fmt::{self, Debug, Display};
use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::error::{ArgumentError, EstimateError};
use crate::estimator::{
    Buffers, Controls, Draw, Frame, MultiSample, OnFault, OneSample, Sample, Sums,
};
use crate::integrand::Integrand;
use crate::points::PointSource;
use crate::technique::Technique;
use crate::weighting::{Balance, Constant, Cutoff, Maximum, Power, VarianceAware, Weighting};

/// An estimator with its weighting, apart from the numbers of samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Method {
    /// One technique, by its index, and no other.
    Single(usize),
    /// Multi-sample, with [constant weights](Constant), one a technique.
    Constant(Vec<f64>),
    /// Multi-sample, with the [balance heuristic](Balance).
    Balance,
    /// Multi-sample, with the [power heuristic](Power) of this exponent.
    Power(f64),
    /// Multi-sample, with the [cutoff heuristic](Cutoff) of this threshold.
    Cutoff(f64),
    /// Multi-sample, with the [maximum heuristic](Maximum).
    Maximum,
    /// Multi-sample, with [variance-aware](VarianceAware) balance weights of these factors.
    VarianceAware(Vec<f64>),
    /// [One-sample](OneSample), with the balance heuristic; the shares are the probabilities.
    OneSample,
    /// Multi-sample, with the balance heuristic on what these [controls](Controls) leave: optimal MIS,
    /// with coefficients from the pilot.
    Optimal(Controls),
}

impl Method {
    /// Whether it evaluates every technique's pdf at every sample.
    pub(super) fn evaluates_all(&self) -> bool {
        !matches!(self, Self::Single(_) | Self::Constant(_))
    }

    /// Whether the contributions of samples do not change with the shares but by the mixture, or in
    /// proportion.
    pub(super) fn keeps_contributions(&self) -> bool {
        matches!(self, Self::Balance | Self::OneSample | Self::Optimal(_) | Self::Constant(_))
    }

    /// Whether it is a method for so many techniques.
    pub(super) fn check(&self, techniques: usize) -> Result<(), ArgumentError> {
        match self {
            Self::Single(i) if *i >= techniques => {
                let rule = format!("there are {techniques} techniques");
                Err(ArgumentError::new("Method", "Single", i, rule))
            }
            _ => Ok(()),
        }
    }

    /// The weighting, of multi-sample methods.
    pub(super) fn weighting(&self) -> Result<Box<dyn Weighting>, ArgumentError> {
        Ok(match self {
            Self::Single(_) | Self::Balance | Self::OneSample | Self::Optimal(_) => {
                Box::new(Balance)
            }
            Self::Constant(weights) => Box::new(Constant::new(weights.clone())?),
            Self::Power(beta) => Box::new(Power::new(*beta)?),
            Self::Cutoff(a) => Box::new(Cutoff::new(*a)?),
            Self::Maximum => Box::new(Maximum),
            Self::VarianceAware(factors) => Box::new(VarianceAware::new(factors.clone())?),
        })
    }
}

/// In words: "balance heuristic".
impl Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Single(i) => f.pad(&format!("technique {i} alone")),
            Self::Constant(weights) => {
                let equal = weights.windows(2).all(|pair| pair[0] == pair[1]);
                f.pad(if equal { "equal constant weights" } else { "constant weights" })
            }
            Self::Balance => f.pad("balance heuristic"),
            Self::Power(beta) => f.pad(&format!("power heuristic {beta}")),
            Self::Cutoff(a) => f.pad(&format!("cutoff heuristic {a}")),
            Self::Maximum => f.pad("maximum heuristic"),
            Self::VarianceAware(_) => f.pad("variance-aware balance"),
            Self::OneSample => f.pad("one-sample balance"),
            Self::Optimal(_) => f.pad("optimal MIS"),
        }
    }
}

/// The estimator of a [`Plan`](crate::Plan): what a [`Run`](crate::Run) executes.
pub struct Planned<'a, P>(Inner<'a, P>);

enum Inner<'a, P> {
    Multi(MultiSample<'a, P, Box<dyn Weighting>>),
    One(OneSample<'a, P>),
}

impl<'a, P> Planned<'a, P> {
    /// A method with `counts` of samples of these techniques.
    ///
    /// # Errors
    ///
    /// They do not go together.
    pub(super) fn new(
        method: &Method,
        techniques: &[&'a dyn Technique<Point = P>],
        counts: &[u64],
        on_fault: OnFault,
    ) -> Result<Self, ArgumentError> {
        const OWNER: &str = "Plan";
        if techniques.len() != counts.len() {
            let rule = format!("there must be one for each of {} techniques", techniques.len());
            return Err(ArgumentError::new(OWNER, "counts", counts, rule));
        }
        method.check(techniques.len())?;
        let sum = counts.iter().try_fold(0_u64, |sum, n| sum.checked_add(*n));
        if !sum.is_some_and(|sum| (1..=1 << 53).contains(&sum)) {
            let rule = "their sum must be at least 1 and at most 2^53";
            return Err(ArgumentError::new(OWNER, "counts", counts, rule));
        }
        let list: Vec<_> = techniques.iter().copied().zip(counts.iter().copied()).collect();
        let multi = MultiSample::new(&list)?;
        match method {
            Method::OneSample => {
                let samples: u64 = counts.iter().sum();
                let list: Vec<_> = techniques
                    .iter()
                    .copied()
                    .zip(counts.iter().map(|n| *n as f64 / samples as f64))
                    .collect();
                return Ok(Self(Inner::One(OneSample::new(&list, samples)?.on_fault(on_fault))));
            }
            Method::Single(i) if counts.iter().enumerate().any(|(k, n)| (*n > 0) != (k == *i)) => {
                let rule = format!("only technique {i} may have samples, and must");
                return Err(ArgumentError::new(OWNER, "counts", counts, rule));
            }
            _ => {}
        }
        let multi = multi.weighting(method.weighting()?)?.on_fault(on_fault);
        Ok(Self(Inner::Multi(match method {
            Method::Optimal(controls) => multi.controls(controls.clone())?,
            _ => multi,
        })))
    }
}

impl<P: Debug> Draw<P> for Planned<'_, P> {
    fn frame(&self) -> Frame<'_> {
        match &self.0 {
            Inner::Multi(multi) => multi.frame(),
            Inner::One(one) => one.frame(),
        }
    }

    fn draw<F, S, I>(
        &self,
        f: &F,
        points: &S,
        range: Range<u64>,
        buffers: &mut Buffers<P, F::Value>,
        sums: Sums<'_>,
        inspect: I,
    ) -> Result<(), EstimateError>
    where
        F: Integrand<P> + ?Sized,
        S: PointSource + ?Sized,
        I: FnMut(&Sample<'_, P, F::Value>),
    {
        match &self.0 {
            Inner::Multi(multi) => multi.draw(f, points, range, buffers, sums, inspect),
            Inner::One(one) => one.draw(f, points, range, buffers, sums, inspect),
        }
    }

    fn probe<F, S, I>(&self, f: &F, points: &S, each: u64, inspect: I) -> Result<(), EstimateError>
    where
        F: Integrand<P> + ?Sized,
        S: PointSource + ?Sized,
        I: FnMut(&Sample<'_, P, F::Value>),
    {
        match &self.0 {
            Inner::Multi(multi) => multi.probe(f, points, each, inspect),
            Inner::One(one) => one.probe(f, points, each, inspect),
        }
    }
}

impl<P> Debug for Planned<'_, P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Inner::Multi(multi) => multi.fmt(f),
            Inner::One(one) => one.fmt(f),
        }
    }
}
