//! The settings of a pilot, and its samples.

use std::fmt::Debug;

use super::Plan;
use super::combining::{combining, cost_of};
use super::cost::{Clock, Costs, TimedIntegrand, TimedTechnique};
use super::data::Data;
use super::method::Method;
use super::pilot::Pilot;
use crate::error::ArgumentError;
use crate::estimator::{Buffers, Draw, Kept, MultiSample, OnFault, Sums};
use crate::integrand::{Integrand, Value};
use crate::part::Part;
use crate::points::Random;
use crate::run::{RunFault, Target};
use crate::technique::Technique;

/// How plans are made.
///
/// See the [module](crate::plan).
#[derive(Debug, Clone, Default)]
pub struct Planner {
    samples: Option<u64>,
    costs: Option<Costs>,
    floor: Option<f64>,
    target: Target,
    on_fault: OnFault,
}

/// Samples of each technique, unless there are many techniques.
const SAMPLES: u64 = 4096;

/// The most densities that a pilot holds by default, times the number of techniques.
const DENSITIES: u64 = 1 << 17;

/// The share of all samples that optimised allocations leave to be divided equally.
const FLOOR: f64 = 0.01;

/// Pilots draw other samples than runs with the same seed.
const APART: u64 = 0x70_69_6c_6f_74;

impl Planner {
    /// 4096 samples of each technique (fewer if there are more than 5), measured costs, a floor of 0.01.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The pilot draws so many samples of each technique.
    ///
    /// # Errors
    ///
    /// There must be at least 16, and at most 2²⁰.
    pub fn samples(self, samples: u64) -> Result<Self, ArgumentError> {
        if !(16..=1 << 20).contains(&samples) {
            let rule = "it must be at least 16 and at most 2^20";
            return Err(ArgumentError::new("Planner", "samples", samples, rule));
        }
        Ok(Self { samples: Some(samples), ..self })
    }

    /// The costs are these; no clock is read.
    #[must_use]
    pub fn costs(self, costs: Costs) -> Self {
        Self { costs: Some(costs), ..self }
    }

    /// Optimised allocations give every technique at least the share `floor` / K. A technique without
    /// samples could not show that it is needed.
    ///
    /// # Errors
    ///
    /// It must be greater than 0 and at most 1.
    pub fn floor(self, floor: f64) -> Result<Self, ArgumentError> {
        if !(floor > 0.0 && floor <= 1.0) {
            let rule = "it must be greater than 0 and at most 1";
            return Err(ArgumentError::new("Planner", "floor", floor, rule));
        }
        Ok(Self { floor: Some(floor), ..self })
    }

    /// What runs of the plan are for: which components count, and what [`integrate`](Planner::integrate)
    /// goes on to reach.
    #[must_use]
    pub fn target(self, target: Target) -> Self {
        Self { target, ..self }
    }

    /// What to do with samples that have no usable contribution, in the pilot and in the plan; an error
    /// by default.
    #[must_use]
    pub fn on_fault(self, on_fault: OnFault) -> Self {
        Self { on_fault, ..self }
    }

    pub(super) fn aim(&self) -> Target {
        self.target
    }

    /// A pilot, and the plan that it leads to.
    ///
    /// # Errors
    ///
    /// As [`pilot`](Planner::pilot).
    pub fn plan<P, F>(
        &self,
        f: &F,
        techniques: &[&dyn Technique<Point = P>],
        seed: u64,
    ) -> Result<Plan, RunFault>
    where
        P: Debug,
        F: Integrand<P> + ?Sized,
    {
        Ok(self.pilot(f, techniques, seed)?.plan()?)
    }

    /// Draws a pilot. Its samples are others than those of a run with the same seed.
    ///
    /// # Errors
    ///
    /// There must be at least one technique, and declared costs for each. The integrand or a pdf is
    /// not what it must be at some sample.
    pub fn pilot<P, F>(
        &self,
        f: &F,
        techniques: &[&dyn Technique<Point = P>],
        seed: u64,
    ) -> Result<Pilot, RunFault>
    where
        P: Debug,
        F: Integrand<P> + ?Sized,
    {
        let k = techniques.len();
        if let Some(costs) = &self.costs {
            costs.check(k)?;
        }
        self.target.check(F::Value::COMPONENTS)?;
        let all = k.max(1) as u64;
        let samples = self.samples.unwrap_or((DENSITIES / (all * all)).clamp(64, SAMPLES));
        let timed: Vec<_> = techniques.iter().map(|inner| TimedTechnique::new(*inner)).collect();
        let integrand = TimedIntegrand { inner: f, clock: Clock::default() };
        let list: Vec<(&dyn Technique<Point = P>, u64)> = timed
            .iter()
            .zip(techniques)
            // Without a clock where costs are declared.
            .map(|(timed, plain)| (if self.costs.is_some() { *plain } else { timed as _ }, samples))
            .collect();
        let mis = MultiSample::new(&list)?.on_fault(self.on_fault);
        let mut part = Part::empty(k, 1, F::Value::COMPONENTS);
        let sums = Sums { part: &mut part, evidence: None };
        let mut kept = Kept::new(k, F::Value::COMPONENTS);
        let mut densities = vec![0.0; k];
        let (range, points) = (0..samples * all, Random::new(seed ^ APART));
        let inspect = |sample: &crate::Sample<'_, P, F::Value>| {
            sample.relative_densities(&mut densities);
            kept.push(sample, |row| row.extend_from_slice(&densities));
        };
        let mut buffers = Buffers::new();
        if self.costs.is_some() {
            mis.draw(f, &points, range, &mut buffers, sums, inspect)?;
        } else {
            mis.draw(&integrand, &points, range, &mut buffers, sums, inspect)?;
        }
        let counts = part.all();
        self.on_fault.check(counts.faults(), counts.samples)?;

        let data = Data::new(&kept, k, F::Value::COMPONENTS);
        let (costs, combining) = if let Some(costs) = &self.costs {
            (costs.clone(), Vec::new())
        } else {
            let combining = combining::<P, F::Value>(techniques)?;
            let balance = cost_of(&combining, &Method::Balance).unwrap_or(1e-12);
            let costs = Costs {
                sampling: timed.iter().map(|t| t.sampling.per_sample()).collect(),
                pdf: timed.iter().map(|t| t.pdf.per_sample()).collect(),
                integrand: integrand.clock.per_sample(),
                combining: balance,
            };
            (costs, combining)
        };
        let scale = |c: usize| {
            let squares: Vec<f64> = data.y(c).iter().map(|y| y * y).collect();
            let (square, _) = data.mean(&squares);
            if square > 0.0 && self.target.counts(c) { square.recip() } else { 0.0 }
        };
        let scales = (0..F::Value::COMPONENTS).map(scale).collect();
        let values = (0..F::Value::COMPONENTS).map(|c| data.mean(data.y(c)).0).collect();
        let (floor, on_fault) = (self.floor.unwrap_or(FLOOR), self.on_fault);
        Ok(Pilot { data, costs, combining, scales, values, floor, on_fault })
    }
}
