//! Estimators: techniques and a weighting, applied to an integrand.

mod controls;
mod evidence;
mod kept;
mod kernel;
mod multi_sample;
mod one_sample;
mod optimal;
mod regression;
mod sample;

pub(crate) use crate::estimate::Design;
pub use controls::Controls;
pub(crate) use evidence::{Evidence, Seen};
pub(crate) use kept::Kept;
pub(crate) use kernel::{Buffers, Sums};
pub use multi_sample::MultiSample;
pub use one_sample::OneSample;
pub use optimal::{Fit, OptimalEstimate, OptimalMis};
pub(crate) use regression::{Regression, Solution};
pub use sample::{OnFault, Sample};

use std::fmt::Debug;
use std::ops::Range;

use crate::error::{ArgumentError, EstimateError};
use crate::estimate::Estimate;
use crate::integrand::{Integrand, Value};
use crate::part::Part;
use crate::points::{PointSource, Random, replicates};
use crate::technique::Technique;

/// Estimates integrals: [`MultiSample`] or [`OneSample`].
///
/// `P` is the type of the points.
pub trait Estimator<P: Debug>: Draw<P> {
    /// Estimates ∫ f from the canonical numbers of `points`, showing every sample to `inspect`.
    ///
    /// Histograms and derived observables are means of the samples' contributions; the mean of them
    /// all is the estimate, up to rounding. Samples come in blocks of one technique each.
    ///
    /// # Errors
    ///
    /// The integrand or a pdf is not what it must be at some sample (see [`OnFault`]), or the
    /// points run out.
    fn inspect<F, S, I>(
        &self,
        f: &F,
        points: &S,
        inspect: I,
    ) -> Result<Estimate<F::Value>, EstimateError>
    where
        F: Integrand<P> + ?Sized,
        S: PointSource + ?Sized,
        I: FnMut(&Sample<'_, P, F::Value>),
    {
        self.inspect_with(f, points, &mut Buffers::new(), inspect)
    }

    /// Estimates ∫ f from the canonical numbers of `points`.
    ///
    /// # Errors
    ///
    /// As [`inspect`](Estimator::inspect).
    fn estimate_from<F, S>(&self, f: &F, points: &S) -> Result<Estimate<F::Value>, EstimateError>
    where
        F: Integrand<P> + ?Sized,
        S: PointSource + ?Sized,
    {
        self.inspect(f, points, |_| ())
    }

    /// Estimates ∫ f from random numbers. The same seed gives the same bits.
    ///
    /// # Errors
    ///
    /// As [`inspect`](Estimator::inspect).
    fn estimate<F>(&self, f: &F, seed: u64) -> Result<Estimate<F::Value>, EstimateError>
    where
        F: Integrand<P> + ?Sized,
    {
        self.estimate_from(f, &Random::new(seed))
    }
}

impl<P: Debug, E: Draw<P>> Estimator<P> for E {}

/// [`Estimator::inspect`], in memory that is there already.
pub(crate) trait InspectWith<P: Debug>: Draw<P> {
    fn inspect_with<F, S, I>(
        &self,
        f: &F,
        points: &S,
        buffers: &mut Buffers<P, F::Value>,
        inspect: I,
    ) -> Result<Estimate<F::Value>, EstimateError>
    where
        F: Integrand<P> + ?Sized,
        S: PointSource + ?Sized,
        I: FnMut(&Sample<'_, P, F::Value>),
    {
        let frame = self.frame();
        let replicates = replicates(points);
        let mut part = Part::empty(frame.shares.len(), replicates, F::Value::COMPONENTS);
        let sums = Sums { part: &mut part, evidence: None };
        self.draw(f, points, 0..frame.samples, buffers, sums, inspect)?;
        let all = part.all();
        frame.on_fault.check(all.faults(), all.samples)?;
        Ok(Estimate::new(frame.design, frame.shares, part))
    }
}

impl<P: Debug, E: Draw<P> + ?Sized> InspectWith<P> for E {}

/// Draws any range of an estimator's samples: all at once, or by and by.
///
/// Samples are numbered over all techniques, without end: their shares stay what they are.
pub trait Draw<P>: Sync {
    fn frame(&self) -> Frame<'_>;

    /// Adds the samples of `range` to `sums`, which have room for all streams of `points`.
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
        I: FnMut(&Sample<'_, P, F::Value>);

    /// Shows the first `each` samples of every technique, or as many times as many as there are
    /// techniques.
    fn probe<F, S, I>(&self, f: &F, points: &S, each: u64, inspect: I) -> Result<(), EstimateError>
    where
        F: Integrand<P> + ?Sized,
        S: PointSource + ?Sized,
        I: FnMut(&Sample<'_, P, F::Value>);
}

/// What an estimator is, apart from its techniques.
#[derive(Clone, Copy)]
pub struct Frame<'a> {
    pub(crate) design: Design,
    /// α_i.
    pub(crate) shares: &'a [f64],
    /// N.
    pub(crate) samples: u64,
    pub(crate) on_fault: OnFault,
    pub(crate) weighting: &'a dyn Debug,
    pub(crate) controls: Option<&'a Controls>,
}

impl Debug for Frame<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (name, shares) = match self.design {
            Design::Stratified => ("multi-sample", "shares"),
            Design::Pooled => ("one-sample", "probabilities"),
        };
        write!(f, "{name}, {shares} {:?}, weighting {:?}", self.shares, self.weighting)?;
        if let Some(controls) = self.controls {
            write!(f, ", controls {controls:?}")?;
        }
        match self.on_fault {
            OnFault::Error => Ok(()),
            OnFault::CountAsZero { at_most } => write!(f, ", at most {at_most} may be faults"),
        }
    }
}

/// Samples per block: the buffers of a few techniques fit the first-level cache, and a virtual
/// call per block costs nothing.
const BLOCK: usize = 512;

/// Of a range of samples that are dealt in turn, those that fall to one replicate, as it numbers
/// them.
fn dealt(range: &Range<u64>, replicates: usize, replicate: usize) -> Range<u64> {
    let before = |n: u64| n.saturating_sub(replicate as u64).div_ceil(replicates as u64);
    before(range.start)..before(range.end)
}

/// How many of the `samples` that are left make the next block.
fn block_size(samples: u64) -> usize {
    usize::try_from(samples).map_or(BLOCK, |samples| samples.min(BLOCK))
}

/// A technique behind a reference.
type Dyn<'a, P> = &'a dyn Technique<Point = P>;

/// The most canonical numbers that a sample may use: a block of them is 4 GiB.
const LARGEST_DIMENSION: usize = 1 << 20;

/// The techniques' dimensions, if there is a technique, each uses canonical numbers, and their
/// points have one length.
fn check_techniques<P>(
    owner: &'static str,
    techniques: &[Dyn<'_, P>],
) -> Result<Vec<usize>, ArgumentError> {
    if techniques.is_empty() {
        return Err(ArgumentError::new(
            owner,
            "techniques",
            Vec::<()>::new(),
            "there must be at least one technique",
        ));
    }
    let mut length = None;
    let mut dimensions = Vec::with_capacity(techniques.len());
    for (i, technique) in techniques.iter().enumerate() {
        let dimension = technique.dimension();
        if !(1..=LARGEST_DIMENSION).contains(&dimension) {
            let argument = format!("techniques[{i}].dimension()");
            let rule = "it must be at least 1 and at most 2^20";
            return Err(ArgumentError::new(owner, argument, dimension, rule));
        }
        dimensions.push(dimension);
        if let Some(len) = technique.point_len() {
            let (first, expected) = *length.get_or_insert((i, len));
            if len != expected {
                let argument = format!("techniques[{i}].point_len()");
                let rule = format!("the points of technique {first} have {expected} coordinates");
                return Err(ArgumentError::new(owner, argument, len, rule));
            }
        }
    }
    Ok(dimensions)
}
