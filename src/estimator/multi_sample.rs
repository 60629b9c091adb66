//! The multi-sample estimator.

use std::fmt::Debug;
use std::ops::Range;

use super::controls::Controls;
use super::kernel::{Batch, Buffers, Kernel, Sums};
use super::sample::{OnFault, Sample};
use super::{BLOCK, Draw, Dyn, Frame, block_size, check_techniques, dealt};
use crate::error::{ArgumentError, EstimateError};
use crate::estimate::Design;
use crate::integrand::{Integrand, Value};
use crate::part::Part;
use crate::points::{PointSource, replicates};
use crate::technique::Technique;
use crate::weighting::{Balance, Weighting};

/// The multi-sample estimator: n_i samples from each technique i, combined by a weighting.
///
/// F = Σ_i 1/n_i Σ_j w_i(X_ij) f(X_ij) / p_i(X_ij), unbiased if Σ w_i = 1 wherever f ≠ 0, and
/// w_i = 0 wherever p_i = 0. Its variance is the sum of the techniques' variances, each divided by n_i.
/// With a single technique it is plain importance sampling. A technique with no samples takes no
/// part: its pdf is not evaluated.
///
/// ```
/// use mis::{Estimator, MultiSample, technique::{Linear, Uniform}, weighting::Power};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let flat = Uniform::new(0.0, 1.0)?;
/// let ramp = Linear::new(0.0, 1.0, 0.0, 2.0)?;
/// let mis = MultiSample::new(&[(&flat, 512), (&ramp, 512)])?.weighting(Power::squared())?;
/// let estimate = mis.estimate(&|x: &f64| x.exp(), 1)?;
/// assert!(estimate.interval(0.999)?.contains(1f64.exp() - 1.0));
/// # Ok(())
/// # }
/// ```
///
/// Source: E. Veach and L. J. Guibas, *Optimally Combining Sampling Techniques for Monte Carlo
/// Rendering*, SIGGRAPH 1995, doi:10.1145/218380.218498.
pub struct MultiSample<'a, P, W = Balance> {
    techniques: Vec<Dyn<'a, P>>,
    dimensions: Vec<usize>,
    samples: Vec<u64>,
    /// N.
    total: u64,
    /// n_i / N.
    alpha: Vec<f64>,
    weighting: W,
    controls: Option<Controls>,
    on_fault: OnFault,
}

impl<'a, P> MultiSample<'a, P> {
    /// Techniques with their numbers of samples n_i, combined by the [balance heuristic](Balance).
    ///
    /// A list that is made at run time has to be told its type:
    ///
    /// ```
    /// # use mis::{Estimator, MultiSample, Technique, technique::{Linear, Uniform}};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let owned: Vec<Box<dyn Technique<Point = f64>>> =
    ///     vec![Box::new(Uniform::unit()), Box::new(Linear::new(0.0, 1.0, 0.0, 2.0)?)];
    /// let list: Vec<(&dyn Technique<Point = f64>, u64)> =
    ///     owned.iter().map(|technique| (technique.as_ref(), 500)).collect();
    /// let estimate = MultiSample::new(&list)?.estimate(&|x: &f64| x.exp(), 1)?;
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// There must be at least one technique and one sample, at most 2⁵³ samples, and techniques
    /// whose points have a run-time length must agree on it.
    pub fn new(techniques: &[(&'a dyn Technique<Point = P>, u64)]) -> Result<Self, ArgumentError> {
        let (techniques, samples): (Vec<Dyn<'a, P>>, Vec<u64>) = techniques.iter().copied().unzip();
        let dimensions = check_techniques("MultiSample", &techniques)?;
        // Counts are exact as f64 up to here.
        let total = samples.iter().try_fold(0_u64, |sum, n| sum.checked_add(*n));
        let Some(total) = total.filter(|total| (1..=1 << 53).contains(total)) else {
            let rule = "their sum must be at least 1 and at most 2^53";
            return Err(ArgumentError::new("MultiSample", "samples", samples, rule));
        };
        let alpha = samples.iter().map(|n| *n as f64 / total as f64).collect();
        let (weighting, controls, on_fault) = (Balance, None, OnFault::Error);
        Ok(Self { techniques, dimensions, samples, total, alpha, weighting, controls, on_fault })
    }
}

impl<'a, P, W> MultiSample<'a, P, W> {
    /// The same techniques and samples, combined by another weighting.
    ///
    /// # Errors
    ///
    /// The weighting must fit the techniques (see [`Weighting::check`]).
    pub fn weighting<U: Weighting>(
        self,
        weighting: U,
    ) -> Result<MultiSample<'a, P, U>, ArgumentError> {
        weighting.check(&self.alpha)?;
        let Self { techniques, dimensions, samples, total, alpha, controls, on_fault, .. } = self;
        Ok(MultiSample {
            techniques,
            dimensions,
            samples,
            total,
            alpha,
            weighting,
            controls,
            on_fault,
        })
    }

    /// Subtracts a combination of the pdfs from every contribution, whose mean is known.
    ///
    /// # Errors
    ///
    /// There must be one coefficient for each technique. The pdf of a technique without samples is not
    /// evaluated, and its mean not known: its coefficients must be 0, and it cannot be the reference.
    pub fn controls(self, controls: Controls) -> Result<Self, ArgumentError> {
        controls.check(self.techniques.len())?;
        controls.check_shares(&self.alpha)?;
        Ok(Self { controls: Some(controls), ..self })
    }

    /// What to do with samples that have no usable contribution; an error by default.
    #[must_use]
    pub fn on_fault(self, on_fault: OnFault) -> Self {
        Self { on_fault, ..self }
    }
}

impl<P, W> MultiSample<'_, P, W> {
    /// How many of the first `samples` samples are technique `i`'s: its share of them, rounded
    /// down.
    pub(super) fn of_the_first(&self, samples: u64, i: usize) -> u64 {
        let part = u128::from(samples) * u128::from(self.samples[i]) / u128::from(self.total);
        u64::try_from(part).unwrap_or(u64::MAX)
    }
}

impl<P: Debug, W: Weighting> Draw<P> for MultiSample<'_, P, W> {
    fn frame(&self) -> Frame<'_> {
        let (shares, samples, on_fault) = (&self.alpha, self.total, self.on_fault);
        let (weighting, controls) = (&self.weighting, self.controls.as_ref());
        Frame { design: Design::Stratified, shares, samples, on_fault, weighting, controls }
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
        let own = |i| self.of_the_first(range.start, i)..self.of_the_first(range.end, i);
        self.draw_each(f, points, own, buffers, sums, inspect)
    }

    fn probe<F, S, I>(&self, f: &F, points: &S, each: u64, inspect: I) -> Result<(), EstimateError>
    where
        F: Integrand<P> + ?Sized,
        S: PointSource + ?Sized,
        I: FnMut(&Sample<'_, P, F::Value>),
    {
        let own = |i: usize| 0..if self.alpha[i] > 0.0 { each } else { 0 };
        let replicates = replicates(points);
        let mut part = Part::empty(self.techniques.len(), replicates, F::Value::COMPONENTS);
        let sums = Sums { part: &mut part, evidence: None };
        self.draw_each(f, points, own, &mut Buffers::new(), sums, inspect)
    }
}

impl<P: Debug, W: Weighting> MultiSample<'_, P, W> {
    /// Draws a range of each technique's samples, `own` of its number.
    fn draw_each<F, S, I>(
        &self,
        f: &F,
        points: &S,
        own: impl Fn(usize) -> Range<u64>,
        buffers: &mut Buffers<P, F::Value>,
        mut sums: Sums<'_>,
        mut inspect: I,
    ) -> Result<(), EstimateError>
    where
        F: Integrand<P> + ?Sized,
        S: PointSource + ?Sized,
        I: FnMut(&Sample<'_, P, F::Value>),
    {
        let replicates = replicates(points);
        let samples = (0..self.techniques.len()).map(&own).map(|range| range.end - range.start);
        let most = samples.max().unwrap_or(0);
        let kernel = Kernel {
            techniques: &self.techniques,
            alpha: &self.alpha,
            density_factors: &self.alpha,
            weighting: &self.weighting,
            controls: self.controls.as_ref(),
            on_fault: self.on_fault,
            replicates,
            block: block_size(most.div_ceil(replicates as u64)),
        };
        let buffers = &mut buffers.block;
        kernel.start(buffers);
        for (technique, dimension) in self.dimensions.iter().enumerate() {
            let range = own(technique);
            for replicate in 0..replicates {
                let range = dealt(&range, replicates, replicate);
                for first in range.clone().step_by(BLOCK) {
                    let samples = block_size(range.end - first);
                    buffers.xi.resize(samples * dimension, 0.0);
                    let stream = technique * replicates + replicate;
                    points.fill(stream, first, *dimension, &mut buffers.xi)?;
                    let index = |j| (first + j as u64) * replicates as u64 + replicate as u64;
                    let batch = Batch { technique, replicate, samples };
                    kernel.block(&batch, index, f, buffers, &mut sums, &mut inspect)?;
                }
            }
        }
        buffers.finish(sums.part);
        Ok(())
    }
}

impl<P, W: Clone> Clone for MultiSample<'_, P, W> {
    fn clone(&self) -> Self {
        Self {
            techniques: self.techniques.clone(),
            dimensions: self.dimensions.clone(),
            samples: self.samples.clone(),
            total: self.total,
            alpha: self.alpha.clone(),
            weighting: self.weighting.clone(),
            controls: self.controls.clone(),
            on_fault: self.on_fault,
        }
    }
}

impl<P, W: Debug> Debug for MultiSample<'_, P, W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MultiSample")
            .field("samples", &self.samples)
            .field("weighting", &self.weighting)
            .field("controls", &self.controls)
            .field("on_fault", &self.on_fault)
            .finish_non_exhaustive()
    }
}
