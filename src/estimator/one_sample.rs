//! The one-sample estimator.

use std::fmt::Debug;
use std::ops::Range;

use super::kernel::{Batch, Buffers, Kernel, Selection, Sums};
use super::sample::{OnFault, Sample};
use super::{BLOCK, Draw, Dyn, Frame, block_size, check_techniques, dealt};
use crate::discrete::Discrete;
use crate::error::{ArgumentError, EstimateError};
use crate::estimate::Design;
use crate::integrand::{Integrand, Value};
use crate::part::Part;
use crate::points::{PointSource, replicates};
use crate::technique::Technique;
use crate::weighting::{Balance, Weighting};

/// The one-sample estimator: each of N samples selects one technique at random and draws from it.
///
/// F = 1/N Σ_j w_i(x_j) f(x_j) / (P_i p_i(x_j)), where i is the technique that sample j selected,
/// with probability P_i. Each sample uses one canonical number to select and the technique's own
/// to draw, so its row of canonical numbers has 1 + the largest dimension.
///
/// By default the weights are made of the densities q_k = P_k p_k. The balance heuristic is then
/// w_i = P_i p_i / Σ P_k p_k, and no other weights have a lower variance. They can be
/// [made of p_k alone](OneSample::weights_without_probabilities).
///
/// Use it where one sample at a time is wanted, or as many techniques as samples. Where all
/// techniques can be given samples of their own, [`MultiSample`](crate::MultiSample) has the lower
/// variance.
///
/// ```
/// use mis::{Estimator, OneSample, technique::{Linear, Uniform}};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let flat = Uniform::new(0.0, 1.0)?;
/// let ramp = Linear::new(0.0, 1.0, 0.0, 2.0)?;
/// let mis = OneSample::new(&[(&flat, 0.25), (&ramp, 0.75)], 1024)?;
/// let estimate = mis.estimate(&|x: &f64| x.exp(), 1)?;
/// assert!(estimate.interval(0.999)?.contains(1f64.exp() - 1.0));
/// # Ok(())
/// # }
/// ```
///
/// Source: E. Veach, *Robust Monte Carlo Methods for Light Transport Simulation*, PhD thesis,
/// Stanford University, 1997, section 9.2.4.
pub struct OneSample<'a, P, W = Balance> {
    techniques: Vec<Dyn<'a, P>>,
    dimensions: Vec<usize>,
    probabilities: Vec<f64>,
    selection: Discrete,
    density_factors: Vec<f64>,
    samples: u64,
    weighting: W,
    on_fault: OnFault,
}

impl<'a, P> OneSample<'a, P> {
    /// Techniques with the probabilities P_i of selecting them, N = `samples`, and the
    /// [balance heuristic](Balance).
    ///
    /// # Errors
    ///
    /// There must be at least one technique and one sample, at most 2⁵³ samples; probabilities
    /// must be at least 0 and sum to 1 up to rounding; techniques whose points have a run-time
    /// length must agree on it.
    pub fn new(
        techniques: &[(&'a dyn Technique<Point = P>, f64)],
        samples: u64,
    ) -> Result<Self, ArgumentError> {
        let (techniques, probabilities): (Vec<Dyn<'a, P>>, Vec<f64>) =
            techniques.iter().copied().unzip();
        let dimensions = check_techniques("OneSample", &techniques)?;
        if !(1..=1 << 53).contains(&samples) {
            let rule = "it must be at least 1 and at most 2^53";
            return Err(ArgumentError::new("OneSample", "samples", samples, rule));
        }
        let selection = Discrete::new("OneSample", "probabilities", &probabilities)?;
        let density_factors = probabilities.clone();
        let (weighting, on_fault) = (Balance, OnFault::Error);
        Ok(Self {
            techniques,
            dimensions,
            probabilities,
            selection,
            density_factors,
            samples,
            weighting,
            on_fault,
        })
    }
}

impl<'a, P, W> OneSample<'a, P, W> {
    /// The same selection, combined by another weighting.
    ///
    /// # Errors
    ///
    /// The weighting must fit the techniques (see [`Weighting::check`]).
    pub fn weighting<U: Weighting>(
        self,
        weighting: U,
    ) -> Result<OneSample<'a, P, U>, ArgumentError> {
        weighting.check(&self.probabilities)?;
        let Self { techniques, dimensions, probabilities, selection, density_factors, .. } = self;
        let (samples, on_fault) = (self.samples, self.on_fault);
        Ok(OneSample {
            techniques,
            dimensions,
            probabilities,
            selection,
            density_factors,
            samples,
            weighting,
            on_fault,
        })
    }

    /// Makes the weights of q_k = p_k, not of P_k p_k: the balance heuristic is then
    /// w_i = p_i / Σ p_k, and a sample contributes f / (P_i Σ p_k).
    ///
    /// Unbiased as well. Under the balance heuristic the variance is at least that of the default,
    /// and equal to it if the probabilities are equal.
    #[must_use]
    pub fn weights_without_probabilities(self) -> Self {
        Self { density_factors: vec![1.0; self.techniques.len()], ..self }
    }

    /// What to do with samples that have no usable contribution; an error by default.
    #[must_use]
    pub fn on_fault(self, on_fault: OnFault) -> Self {
        Self { on_fault, ..self }
    }
}

impl<P: Debug, W: Weighting> Draw<P> for OneSample<'_, P, W> {
    fn frame(&self) -> Frame<'_> {
        let (shares, samples, on_fault) = (&self.probabilities, self.samples, self.on_fault);
        let weighting = &self.weighting;
        Frame { design: Design::Pooled, shares, samples, on_fault, weighting, controls: None }
    }

    fn draw<F, S, I>(
        &self,
        f: &F,
        points: &S,
        range: Range<u64>,
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
        let kernel = Kernel {
            techniques: &self.techniques,
            alpha: &self.probabilities,
            density_factors: &self.density_factors,
            weighting: &self.weighting,
            controls: None,
            on_fault: self.on_fault,
            replicates,
            block: block_size((range.end - range.start).div_ceil(replicates as u64)),
        };
        let Buffers { block: buffers, selection: Selection { rows, choices, selected } } = buffers;
        kernel.start(buffers);
        let dimension = 1 + self.dimensions.iter().copied().max().unwrap_or(0);
        for replicate in 0..replicates {
            let range = dealt(&range, replicates, replicate);
            for first in range.clone().step_by(BLOCK) {
                let n = block_size(range.end - first);
                rows.resize(n * dimension, 0.0);
                points.fill(replicate, first, dimension, rows)?;
                let rows = rows.chunks_exact(dimension);
                choices.clear();
                choices.extend(rows.clone().map(|row| self.selection.select(row[0])));
                for (technique, own) in self.dimensions.iter().enumerate() {
                    let xi = &mut buffers.xi;
                    xi.clear();
                    selected.clear();
                    for ((row, choice), number) in rows.clone().zip(&*choices).zip(first..) {
                        if *choice == technique {
                            xi.extend_from_slice(&row[1..=*own]);
                            selected.push(number * replicates as u64 + replicate as u64);
                        }
                    }
                    if selected.is_empty() {
                        continue;
                    }
                    let index = |j: usize| selected.get(j).copied().unwrap_or(u64::MAX);
                    let batch = Batch { technique, replicate, samples: selected.len() };
                    kernel.block(&batch, index, f, buffers, &mut sums, &mut inspect)?;
                }
            }
        }
        buffers.finish(sums.part);
        Ok(())
    }

    fn probe<F, S, I>(&self, f: &F, points: &S, each: u64, inspect: I) -> Result<(), EstimateError>
    where
        F: Integrand<P> + ?Sized,
        S: PointSource + ?Sized,
        I: FnMut(&Sample<'_, P, F::Value>),
    {
        let samples = each * self.techniques.len() as u64;
        let replicates = replicates(points);
        let mut part = Part::empty(self.techniques.len(), replicates, F::Value::COMPONENTS);
        let sums = Sums { part: &mut part, evidence: None };
        self.draw(f, points, 0..samples, &mut Buffers::new(), sums, inspect)
    }
}

impl<P, W: Clone> Clone for OneSample<'_, P, W> {
    fn clone(&self) -> Self {
        Self {
            techniques: self.techniques.clone(),
            dimensions: self.dimensions.clone(),
            probabilities: self.probabilities.clone(),
            selection: self.selection.clone(),
            density_factors: self.density_factors.clone(),
            samples: self.samples,
            weighting: self.weighting.clone(),
            on_fault: self.on_fault,
        }
    }
}

impl<P, W: Debug> Debug for OneSample<'_, P, W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("OneSample")
            .field("probabilities", &self.probabilities)
            .field("density_factors", &self.density_factors)
            .field("samples", &self.samples)
            .field("weighting", &self.weighting)
            .field("on_fault", &self.on_fault)
            .finish_non_exhaustive()
    }
}
