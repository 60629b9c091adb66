//! Rounds, each with the shares that those before it suggest.

use std::fmt::Debug;

use super::allocation;
use super::cost::Costs;
use super::data::Data;
use super::method::Method;
use super::newton::newton;
use super::pilot::look;
use super::predict::controls;
use crate::error::ArgumentError;
use crate::estimate::Estimate;
use crate::estimator::{Buffers, Controls, Design, Draw, Kept, MultiSample, OnFault, Sums};
use crate::integrand::{Integrand, Value};
use crate::part::Part;
use crate::points::{PointSource, PointsExhausted, Random, replicates};
use crate::run::{Report, Run, RunError, Status, Target};
use crate::technique::Technique;

/// Multi-sample in rounds: each has as many samples as all before it, and takes its shares, and its
/// [controls](Controls), from them.
///
/// A round's shares are fixed before it begins, and rounds are combined by their numbers of samples: so
/// the estimate is unbiased, and rounds that are low by chance count no more than others. The first
/// round has equal shares and no controls. Against a [`Plan`](crate::Plan), there is no pilot that is
/// thrown away, and what a small pilot would miss is met later; but half of the samples are drawn by what
/// the other half had to say.
///
/// ```
/// use mis::plan::Adaptive;
/// use mis::technique::{Linear, Uniform};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let (flat, ramp) = (Uniform::unit(), Linear::new(0.0, 1.0, 0.0, 2.0)?);
/// let adapted = Adaptive::new(100_000)?.execute(&|x: &f64| x.exp(), &[&flat, &ramp], 1)?;
/// assert!(adapted.estimate().interval(0.999)?.contains(1f64.exp() - 1.0));
/// for round in adapted.rounds() {
///     println!("{:?}: {}", round.counts(), round.report().estimate());
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Adaptive {
    samples: u64,
    rounds: u32,
    controls: bool,
    floor: f64,
    costs: Option<Costs>,
    threads: Option<usize>,
    on_fault: OnFault,
}

/// Samples of each technique in a round, at least; with replicates, it is two of each.
const LEAST: u64 = 8;

/// The counts of a round, and its controls.
type Lesson = (Vec<u64>, Option<Controls>);

/// Samples of a round that the next one learns from, at most.
const LESSON: u64 = 1 << 14;

impl Adaptive {
    /// So many samples in six rounds, with controls, and a floor of 0.01.
    ///
    /// # Errors
    ///
    /// There must be at least 1024, and at most 2⁵³.
    pub fn new(samples: u64) -> Result<Self, ArgumentError> {
        if !(1024..=1 << 53).contains(&samples) {
            let rule = "it must be at least 1024 and at most 2^53";
            return Err(ArgumentError::new("Adaptive", "samples", samples, rule));
        }
        let (rounds, controls, floor, costs, threads) = (6, true, 0.01, None, None);
        Ok(Self { samples, rounds, controls, floor, costs, threads, on_fault: OnFault::Error })
    }

    /// In so many rounds; fewer if the first would have less than 256 samples.
    ///
    /// # Errors
    ///
    /// There must be at least 1, and at most 40.
    pub fn with_rounds(self, rounds: u32) -> Result<Self, ArgumentError> {
        if !(1..=40).contains(&rounds) {
            let rule = "it must be at least 1 and at most 40";
            return Err(ArgumentError::new("Adaptive", "rounds", rounds, rule));
        }
        Ok(Self { rounds, ..self })
    }

    /// Without controls: the balance heuristic with adapted shares.
    #[must_use]
    pub fn without_controls(self) -> Self {
        Self { controls: false, ..self }
    }

    /// Every technique has at least the share `floor` / K in every round, and 8 samples where there are
    /// enough (with points in replicates, two of each).
    ///
    /// # Errors
    ///
    /// It must be greater than 0 and at most 1.
    pub fn floor(self, floor: f64) -> Result<Self, ArgumentError> {
        if !(floor > 0.0 && floor <= 1.0) {
            let rule = "it must be greater than 0 and at most 1";
            return Err(ArgumentError::new("Adaptive", "floor", floor, rule));
        }
        Ok(Self { floor, ..self })
    }

    /// What samples cost; by default, all the same.
    #[must_use]
    pub fn costs(self, costs: Costs) -> Self {
        Self { costs: Some(costs), ..self }
    }

    /// On so many [threads](Run::threads).
    ///
    /// # Errors
    ///
    /// As [`Run::threads`].
    pub fn threads(self, threads: usize) -> Result<Self, ArgumentError> {
        Run::new(Target::new()).threads(threads).map(|_| Self { threads: Some(threads), ..self })
    }

    /// What to do with samples that have no usable contribution; an error by default.
    #[must_use]
    pub fn on_fault(self, on_fault: OnFault) -> Self {
        Self { on_fault, ..self }
    }

    /// Estimates ∫ f from random numbers. The same seed gives the same bits, on any number of threads.
    ///
    /// # Errors
    ///
    /// As [`Run::execute`]; costs must fit the techniques.
    pub fn execute<P, F>(
        &self,
        f: &F,
        techniques: &[&dyn Technique<Point = P>],
        seed: u64,
    ) -> Result<Adapted<F::Value>, RunError<F::Value>>
    where
        P: Debug,
        F: Integrand<P> + Sync + ?Sized,
    {
        self.execute_from(f, techniques, &Random::new(seed))
    }

    /// Estimates ∫ f from the canonical numbers of `points`: round t has streams of its own, from
    /// t K R on.
    ///
    /// # Errors
    ///
    /// As [`execute`](Adaptive::execute).
    pub fn execute_from<P, F, S>(
        &self,
        f: &F,
        techniques: &[&dyn Technique<Point = P>],
        points: &S,
    ) -> Result<Adapted<F::Value>, RunError<F::Value>>
    where
        P: Debug,
        F: Integrand<P> + Sync + ?Sized,
        S: PointSource + ?Sized,
    {
        let k = techniques.len();
        if let Some(costs) = &self.costs {
            costs.check(k)?;
        }
        let rounds = (1..=self.rounds).rev().find(|r| self.samples >> (r - 1) >= 256).unwrap_or(1);
        let ends: Vec<u64> = (0..rounds).rev().map(|h| self.samples >> h).collect();
        let equal = vec![1.0 / k.max(1) as f64; k];
        let mut counts = allocation::counts(&equal, ends[0]);
        let mut own: Option<Controls> = None;
        let (mut start, mut done) = (0, Vec::new());
        for (number, end) in ends.iter().enumerate() {
            let samples = end - start;
            start = *end;
            let list: Vec<_> = techniques.iter().copied().zip(counts.iter().copied()).collect();
            let plain = MultiSample::new(&list)?.on_fault(self.on_fault);
            let points = Shifted { points, streams: number * k * replicates(points) };
            let mut run = Run::new(Target::new().samples(samples)?);
            if let Some(threads) = self.threads {
                run = run.threads(threads)?;
            }
            let report = match &own {
                Some(controls) => {
                    let controlled = plain.clone().controls(controls.clone())?;
                    run.execute_from(&controlled, f, &points)?
                }
                None => run.execute_from(&plain, f, &points)?,
            };
            // The next round has as many samples as all before it, or one more.
            let next = match ends.get(number + 1) {
                Some(later) => {
                    Some(self.learn(&plain, f, &points, samples.min(LESSON), later - end)?)
                }
                None => None,
            };
            done.push(AdaptedRound { counts: counts.clone(), controls: own.clone(), report });
            if let Some((adapted, controls)) = next {
                (counts, own) = (adapted, controls);
            }
        }
        Ok(Adapted::new(done))
    }

    /// Counts and controls for a round of `next` samples, from the first `samples` of this one.
    fn learn<P, F, S>(
        &self,
        plain: &MultiSample<'_, P>,
        f: &F,
        points: &S,
        samples: u64,
        next: u64,
    ) -> Result<Lesson, RunError<F::Value>>
    where
        P: Debug,
        F: Integrand<P> + ?Sized,
        S: PointSource + ?Sized,
    {
        let (shares, components) = (plain.frame().shares, F::Value::COMPONENTS);
        let k = shares.len();
        let mut kept = Kept::new(k, components);
        let mut densities = vec![0.0; k];
        let mut part = Part::empty(k, replicates(points), components);
        let sums = Sums { part: &mut part, evidence: None };
        plain.draw(f, points, 0..samples, &mut Buffers::new(), sums, |sample| {
            sample.relative_densities(&mut densities);
            kept.push(sample, |row| row.extend_from_slice(&densities));
        })?;
        let data = Data::new(&kept, k, components);
        let scales: Vec<f64> = (0..components)
            .map(|c| {
                let squares: f64 = data.y(c).iter().map(|y| y * y).sum();
                if squares > 0.0 { data.samples as f64 / squares } else { 0.0 }
            })
            .collect();
        if scales.iter().all(|scale| *scale == 0.0) {
            return Ok((allocation::counts(shares, next), None));
        }
        let fitted = |shares: &[f64]| controls(&data, shares).filter(|_| self.controls);
        let method = match fitted(shares) {
            Some((controls, _)) => Method::Optimal(controls),
            None => Method::Balance,
        };
        let adapted = newton(shares, self.floor, |shares| {
            let costs = match &self.costs {
                Some(costs) => costs.of(&method, shares, costs.combining),
                None => vec![1.0; k],
            };
            look(&data, &method, shares, &scales, costs)
        })
        .shares;
        let mut counts = allocation::counts(&adapted, next);
        // From fewer there is no error, or none that means much.
        let each = if replicates(points) > 1 { 2 * replicates(points) as u64 } else { LEAST };
        allocation::raise(&mut counts, each);
        // Those that fit the shares as they are drawn.
        let drawn: Vec<f64> = counts.iter().map(|n| *n as f64 / next as f64).collect();
        let controls = fitted(&drawn).map(|(controls, _)| controls);
        Ok((counts, controls))
    }
}

/// Points of streams further on.
#[derive(Debug)]
struct Shifted<'a, S: ?Sized> {
    points: &'a S,
    streams: usize,
}

impl<S: PointSource + ?Sized> PointSource for Shifted<'_, S> {
    fn fill(
        &self,
        stream: usize,
        first: u64,
        dimension: usize,
        xi: &mut [f64],
    ) -> Result<(), PointsExhausted> {
        self.points.fill(self.streams + stream, first, dimension, xi)
    }

    fn replicates(&self) -> usize {
        self.points.replicates()
    }
}

/// The result of an [`Adaptive`] run.
#[derive(Debug)]
pub struct Adapted<V: Value = f64> {
    estimate: Estimate<V>,
    rounds: Vec<AdaptedRound<V>>,
}

/// One round of an [`Adaptive`] run.
#[derive(Debug)]
pub struct AdaptedRound<V: Value = f64> {
    counts: Vec<u64>,
    controls: Option<Controls>,
    report: Report<V>,
}

impl<V: Value> Adapted<V> {
    fn new(rounds: Vec<AdaptedRound<V>>) -> Self {
        let all: u64 = rounds.iter().flat_map(|round| &round.counts).sum();
        let techniques = rounds.first().map_or(0, |round| round.counts.len());
        let (mut shares, mut part) = (Vec::new(), Part::default());
        for round in &rounds {
            shares.extend(round.counts.iter().map(|n| *n as f64 / all as f64));
            let own = round.report.estimate().part();
            part.contributions.extend_from_slice(&own.contributions);
            part.counts.extend_from_slice(&own.counts);
        }
        let estimate = Estimate::in_batches(Design::Stratified, shares, part, techniques, 0);
        Self { estimate, rounds }
    }

    /// All rounds together, by their numbers of samples.
    #[must_use]
    pub fn estimate(&self) -> &Estimate<V> {
        &self.estimate
    }

    /// The value of the [estimate](Adapted::estimate).
    #[must_use]
    pub fn value(&self) -> V::Each<f64> {
        self.estimate.value()
    }

    /// The standard error of the [estimate](Adapted::estimate).
    #[must_use]
    pub fn standard_error(&self) -> V::Each<Option<f64>> {
        self.estimate.standard_error()
    }

    /// The rounds, in their order.
    #[must_use]
    pub fn rounds(&self) -> &[AdaptedRound<V>] {
        &self.rounds
    }

    /// Whether to believe it, as the last round has it, which is half of all samples; `None` if there
    /// was no round.
    #[must_use]
    pub fn status(&self) -> Option<&Status> {
        self.rounds.last().map(|round| round.report.status())
    }
}

impl<V: Value> AdaptedRound<V> {
    /// n_i, the samples of each technique.
    #[must_use]
    pub fn counts(&self) -> &[u64] {
        &self.counts
    }

    /// The controls, if it had any.
    #[must_use]
    pub fn controls(&self) -> Option<&Controls> {
        self.controls.as_ref()
    }

    /// What its own samples came to.
    #[must_use]
    pub fn report(&self) -> &Report<V> {
        &self.report
    }
}
