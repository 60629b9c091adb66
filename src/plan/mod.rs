//! Plans: which estimator, with how many samples of each technique, from one small pilot.
//!
//! The samples of a pilot carry the pdfs of all techniques. So the variance that any estimator,
//! weighting and allocation would have can be predicted from the same numbers, and what a sample costs
//! is measured on the way. The best by 1 / (variance · cost) is the plan.
//!
//! [`integrate`] does it all in one call:
//!
//! ```
//! use mis::technique::{Exponential, Uniform};
//! use mis::{Target, integrate};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // ∫ e^(-5x) / (1 + x) over [0, 2] is 0.170 42.
//! let decay = Exponential::new(5.0, 0.0, 2.0)?;
//! let flat = Uniform::new(0.0, 2.0)?;
//! let f = |x: &f64| (-5.0 * x).exp() / (1.0 + x);
//!
//! let integral = integrate(&f, &[&decay, &flat], Target::new().relative(1e-3)?, 1)?;
//! assert!((integral.report().value() - 0.170_419).abs() < 2e-3 * 0.170_419);
//! println!("{integral}"); // why it was done so, and the report of the run
//! # Ok(())
//! # }
//! ```
//!
//! A [`Planner`] has the settings, and a [`Plan`] can be printed, saved, edited and executed at any time:
//!
//! ```
//! use mis::plan::{Costs, Planner};
//! use mis::technique::{Linear, Uniform};
//! use mis::{Run, Target};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let (flat, ramp) = (Uniform::unit(), Linear::new(0.0, 1.0, 0.0, 2.0)?);
//! let f = |x: &f64| x.exp();
//! // With declared costs, no clock is read: the same plan every time.
//! let costs = Costs::declared([1.0, 1.0], [1.0, 1.0], 10.0, 5.0)?;
//! let planner = Planner::new().costs(costs);
//! let plan = planner.plan(&f, &[&flat, &ramp], 1)?;
//! println!("{plan}");
//! let estimator = plan.estimator(&[&flat, &ramp])?;
//! let report = Run::new(Target::new().samples(100_000)?).execute(&estimator, &f, 2)?;
//! assert!((report.value() - (1f64.exp() - 1.0)).abs() < 1e-2);
//! # Ok(())
//! # }
//! ```
//!
#![doc = include_str!("measured.md")]

mod adaptive;
mod allocation;
mod combining;
mod cost;
mod data;
mod display;
mod method;
mod newton;
mod pilot;
mod planner;
mod predict;
mod prediction;

pub use adaptive::{Adapted, AdaptedRound, Adaptive};
pub use allocation::Allocation;
pub use cost::Costs;
pub use method::{Method, Planned};
pub use pilot::Pilot;
pub use planner::Planner;
pub use prediction::{Caution, Prediction};

use std::fmt::Debug;

use serde::{Deserialize, Serialize};

use crate::error::ArgumentError;
use crate::estimator::OnFault;
use crate::integrand::{Integrand, Value};
use crate::run::{Report, Run, RunError, Target};
use crate::technique::Technique;

/// A method, the samples of each technique, and what a pilot predicts of these and of all others.
///
/// A plain value: it can be printed as a table, saved with `serde`, and edited.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Plan {
    /// The estimator.
    pub method: Method,
    /// n_i, in proportion: a run draws as many as its target takes.
    pub counts: Vec<u64>,
    /// What is predicted of every method, the best first; those that would be biased are last.
    pub predictions: Vec<Prediction>,
    /// What samples cost.
    pub costs: Costs,
    /// How many samples the pilot drew.
    pub pilot_samples: u64,
    /// The pilot's own estimate of every component, to a few per cent: what is relative in predictions is relative to
    /// it.
    pub pilot_value: Vec<f64>,
    /// Whether and when samples without a usable contribution count as 0 in the run: the largest part
    /// of them, if so.
    pub faults_at_most: Option<f64>,
}

/// The counts of a plan with these shares: about 2²⁰ together, so that equal shares have equal counts.
fn counts(shares: &[f64]) -> Vec<u64> {
    allocation::counts(shares, (1_u64 << 20).next_multiple_of(shares.len().max(1) as u64))
}

/// The shares that such counts come to. What an estimator does is predicted for these: where little
/// variance is left, controls that fit other shares leave more, though they differ by 10⁻⁶.
fn counted(shares: &[f64]) -> Vec<f64> {
    let counts = counts(shares);
    let all: u64 = counts.iter().sum();
    counts.iter().map(|n| *n as f64 / all as f64).collect()
}

impl Plan {
    /// The same pilot, with another one of the [predictions](Plan::predictions) as the plan.
    ///
    /// # Errors
    ///
    /// There must be as many predictions.
    pub fn choose(&mut self, number: usize) -> Result<(), ArgumentError> {
        let Some(prediction) = self.predictions.get(number) else {
            let rule = format!("there are {} predictions", self.predictions.len());
            return Err(ArgumentError::new("Plan::choose", "number", number, rule));
        };
        self.method = prediction.method.clone();
        self.counts = counts(&prediction.shares);
        Ok(())
    }

    /// What is predicted of the plan; `None` if it has been edited to something else.
    #[must_use]
    pub fn prediction(&self) -> Option<&Prediction> {
        let own = |p: &&Prediction| p.method == self.method && counts(&p.shares) == self.counts;
        self.predictions.iter().find(own)
    }

    /// The estimator, for a [`Run`] or by itself. `techniques` are those of the pilot, in their order.
    ///
    /// # Errors
    ///
    /// The techniques are not as many, or the plan has been edited to something that is none.
    pub fn estimator<'a, P>(
        &self,
        techniques: &[&'a dyn Technique<Point = P>],
    ) -> Result<Planned<'a, P>, ArgumentError> {
        let on_fault = self.faults_at_most.map_or(Ok(OnFault::Error), OnFault::count_as_zero)?;
        Planned::new(&self.method, techniques, &self.counts, on_fault)
    }
}

/// What [`integrate`] came to: the plan, and the report of its run.
///
/// `Display` prints the reasons for the plan in words, then the report.
#[derive(Debug)]
pub struct Integral<V: Value = f64> {
    plan: Plan,
    target: Target,
    report: Report<V>,
}

impl<V: Value> Integral<V> {
    /// The plan that was executed.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The report of its run.
    #[must_use]
    pub fn report(&self) -> &Report<V> {
        &self.report
    }
}

/// Estimates ∫ f with these techniques to a target: a pilot of a few thousand samples, the best plan that
/// it finds, and a run of that plan on all threads.
///
/// The pilot's samples are not part of the result. As costs are measured with a clock, another call may
/// come to another plan; a [`Planner`] with [declared costs](Planner::costs) does not.
///
/// # Errors
///
/// No technique, a target without a tolerance, a number of samples or a time, or what
/// [`Run::execute`] fails for.
pub fn integrate<P, F>(
    f: &F,
    techniques: &[&dyn Technique<Point = P>],
    target: Target,
    seed: u64,
) -> Result<Integral<F::Value>, RunError<F::Value>>
where
    P: Debug,
    F: Integrand<P> + Sync + ?Sized,
{
    Planner::new().target(target).integrate(f, techniques, seed)
}

impl Planner {
    /// Makes a plan, and executes it to the [target](Planner::target).
    ///
    /// # Errors
    ///
    /// As [`integrate`].
    pub fn integrate<P, F>(
        &self,
        f: &F,
        techniques: &[&dyn Technique<Point = P>],
        seed: u64,
    ) -> Result<Integral<F::Value>, RunError<F::Value>>
    where
        P: Debug,
        F: Integrand<P> + Sync + ?Sized,
    {
        let target = self.aim();
        if target.limit(0) == 0 {
            let rule = "it must have a tolerance, a number of samples or a time";
            return Err(ArgumentError::new("integrate", "target", target, rule).into());
        }
        let plan = self.plan(f, techniques, seed)?;
        let estimator = plan.estimator(techniques)?;
        let report = Run::new(target).execute(&estimator, f, seed)?;
        Ok(Integral { plan, target, report })
    }
}
