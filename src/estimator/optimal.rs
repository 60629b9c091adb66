//! Optimal multiple importance sampling.

use std::fmt::{self, Debug, Display};
use std::ops::Range;

use super::controls::Controls;
use super::kept::{Adjusted, Kept, Origin};
use super::regression::{Regression, Solution};
use super::{Buffers, Design, Draw, MultiSample, OnFault, Sample, Sums};
use crate::error::{ArgumentError, EstimateError, finite};
use crate::estimate::Estimate;
use crate::integrand::{Integrand, Value};
use crate::part::Part;
use crate::points::{PointSource, Random, replicates};
use crate::technique::Technique;

/// Optimal MIS: multi-sample, with the weights of the least variance.
///
/// No weights of given techniques and samples, negative ones included, have a lower variance than
///
/// w_i = a_i p_i / f + (n_i p_i / c) (1 - Σ a_k p_k / f), with c = Σ n_k p_k,
///
/// where Σ a_k p_k is the combination of the pdfs that is closest to f, in the norm ∫ (…)² / c. The
/// estimate is then Σ a_k + Σ (f - Σ a_k p_k) / c, over all samples: the balance heuristic applied to
/// what Σ a_k p_k leaves of f. If f is in the span of the pdfs, nothing is left.
///
/// The a_k have to be estimated: y = f N / c is regressed on the differences z_k = (p_k - p_r) N / c
/// (r is the first technique with samples), and the value is the mean of y - Σ β_k z_k. The two forms
/// are one, with a_k = μ α_k + β_k. [`Fit`] says of which samples β is made.
///
/// Worth its cost where techniques are good in parts and bad in others: balance weights then let the
/// bad ones spoil what the good ones would give. Samples with f = 0 count like any other. The value
/// may be negative though f is not. With fewer samples than make sense, it is the balance heuristic, and
/// [`uncontrolled`](OptimalEstimate::uncontrolled) says so.
///
/// ```
/// use mis::technique::{Linear, Uniform};
/// use mis::OptimalMis;
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let (flat, ramp) = (Uniform::unit(), Linear::new(0.0, 1.0, 0.0, 2.0)?);
/// let mis = OptimalMis::new(&[(&flat, 500), (&ramp, 500)])?;
/// // 3 + 4x is a combination of the two pdfs.
/// let estimate = mis.estimate(&|x: &f64| 3.0 + 4.0 * x, 1)?;
/// assert!((estimate.value() - 5.0).abs() < 1e-13);
/// # Ok(())
/// # }
/// ```
///
/// Sources: I. Kondapaneni, P. Vévoda, P. Grittmann, T. Skřivan, P. Slusallek and J. Křivánek,
/// *Optimal Multiple Importance Sampling*, 2019, doi:10.1145/3306346.3323009; A. B. Owen and Y. Zhou,
/// *Safe and Effective Importance Sampling*, 2000, doi:10.1080/01621459.2000.10473909.
pub struct OptimalMis<'a, P> {
    mis: MultiSample<'a, P>,
    fit: Fit,
    variates: Vec<Variate<'a, P>>,
}

/// Of which samples the coefficients of [`OptimalMis`] are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fit {
    /// Of all samples, which they are then applied to: the least squares themselves. Biased by
    /// O(K/N) of the standard deviation of a sample, which fades faster than the standard error.
    Direct,
    /// The samples are divided in so many folds; the coefficients for each are made of the others.
    /// Unbiased. Fewer folds, down to 2, if techniques have fewer than 8 samples for each. All samples
    /// are held in memory, K + 2 numbers and more for each.
    CrossFit {
        /// How many, at least 2.
        folds: u64,
    },
    /// Samples are drawn in batches, each as large as all before it, and the coefficients for each are
    /// made of these. Unbiased, and only a piece of the samples is ever held in memory.
    Progressive,
}

/// Five folds.
impl Default for Fit {
    fn default() -> Self {
        Self::CrossFit { folds: 5 }
    }
}

/// Samples that are held at a time.
const PIECE: u64 = 1 << 14;

/// Batches of [`Fit::Progressive`], at most.
const BATCHES: u32 = 7;

/// Past samples for each coefficient, without which there is no control.
const ENOUGH: u64 = 10;

/// A function with a known integral.
struct Variate<'a, P> {
    h: &'a (dyn Fn(&P) -> f64 + Sync),
    integral: f64,
}

impl<'a, P> OptimalMis<'a, P> {
    /// Techniques with their numbers of samples; [`Fit::CrossFit`] with five folds.
    ///
    /// # Errors
    ///
    /// As [`MultiSample::new`].
    pub fn new(techniques: &[(&'a dyn Technique<Point = P>, u64)]) -> Result<Self, ArgumentError> {
        let mis = MultiSample::new(techniques)?;
        Ok(Self { mis, fit: Fit::default(), variates: Vec::new() })
    }

    /// The same, with the coefficients made of other samples.
    ///
    /// # Errors
    ///
    /// There must be at least 2 folds.
    pub fn fit(self, fit: Fit) -> Result<Self, ArgumentError> {
        match fit {
            Fit::CrossFit { folds: folds @ ..2 } => {
                let rule = "there must be at least 2";
                Err(ArgumentError::new("OptimalMis::fit", "folds", folds, rule))
            }
            _ => Ok(Self { fit, ..self }),
        }
    }

    /// Control variates: functions h with known integrals θ = ∫ h, which the regression may use as it
    /// does the pdfs. They must be 0 where no technique reaches.
    ///
    /// ```
    /// use mis::{OptimalMis, technique::Uniform};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let flat = Uniform::unit();
    /// let h = |x: &f64| x * x; // 1/3
    /// let mis = OptimalMis::new(&[(&flat, 1000)])?.control_variates([(&h as _, 1.0 / 3.0)])?;
    /// let estimate = mis.estimate(&|x: &f64| 2.0 * x * x + 1.0, 1)?;
    /// assert!((estimate.value() - 5.0 / 3.0).abs() < 1e-2);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// The integrals must be finite.
    pub fn control_variates(
        self,
        variates: impl IntoIterator<Item = (&'a (dyn Fn(&P) -> f64 + Sync), f64)>,
    ) -> Result<Self, ArgumentError> {
        let one = |(h, integral)| {
            let integral = finite("OptimalMis::control_variates", "integral", integral)?;
            Ok(Variate { h, integral })
        };
        let variates = variates.into_iter().map(one).collect::<Result<_, ArgumentError>>()?;
        Ok(Self { variates, ..self })
    }

    /// What to do with samples that have no usable contribution; an error by default.
    #[must_use]
    pub fn on_fault(self, on_fault: OnFault) -> Self {
        Self { mis: self.mis.on_fault(on_fault), ..self }
    }
}

impl<P: Debug> OptimalMis<'_, P> {
    /// Estimates ∫ f from random numbers. The same seed gives the same bits.
    ///
    /// # Errors
    ///
    /// As [`Estimator::inspect`](crate::Estimator::inspect).
    pub fn estimate<F>(&self, f: &F, seed: u64) -> Result<OptimalEstimate<F::Value>, EstimateError>
    where
        F: Integrand<P> + ?Sized,
    {
        self.estimate_from(f, &Random::new(seed))
    }

    /// Estimates ∫ f from the canonical numbers of `points`.
    ///
    /// From [replicates](crate::points::PointSource::replicates), folds are of whole replicates; batches
    /// of [`Fit::Progressive`] depend on the points before, which makes it only nearly unbiased.
    ///
    /// # Errors
    ///
    /// As [`Estimator::inspect`](crate::Estimator::inspect).
    pub fn estimate_from<F, S>(
        &self,
        f: &F,
        points: &S,
    ) -> Result<OptimalEstimate<F::Value>, EstimateError>
    where
        F: Integrand<P> + ?Sized,
        S: PointSource + ?Sized,
    {
        let shares = self.mis.frame().shares;
        let active: Vec<usize> = (0..shares.len()).filter(|k| shares[*k] > 0.0).collect();
        let work = Work {
            mis: self,
            f,
            points,
            replicates: replicates(points),
            reference: active.first().copied().unwrap_or(0),
            active,
        };
        match self.fit {
            Fit::Direct => work.direct(),
            Fit::CrossFit { folds } => work.cross_fit(folds),
            Fit::Progressive => work.progressive(),
        }
    }
}

/// One estimate at work.
struct Work<'a, P, F: ?Sized, S: ?Sized> {
    mis: &'a OptimalMis<'a, P>,
    f: &'a F,
    points: &'a S,
    replicates: usize,
    /// Techniques that have samples, and the first of them.
    active: Vec<usize>,
    reference: usize,
}

impl<P, F, S> Work<'_, P, F, S>
where
    P: Debug,
    F: Integrand<P> + ?Sized,
    S: PointSource + ?Sized,
{
    const COMPONENTS: usize = <F::Value as Value>::COMPONENTS;

    fn samples(&self) -> u64 {
        self.mis.mis.frame().samples
    }

    fn shares(&self) -> &[f64] {
        self.mis.mis.frame().shares
    }

    /// How many columns the regression has: differences of pdfs, and control variates.
    fn regressors(&self) -> usize {
        self.active.len() - 1 + self.mis.variates.len()
    }

    fn empty(&self) -> Regression {
        Regression::new(self.regressors(), Self::COMPONENTS)
    }

    /// Keeps the samples of a range; returns what it had of faults.
    fn keep(&self, range: Range<u64>, kept: &mut Kept) -> Result<Part, EstimateError> {
        let techniques = self.shares().len();
        let mut part = Part::empty(techniques, self.replicates, Self::COMPONENTS);
        let sums = Sums { part: &mut part, evidence: None };
        let mut differences = vec![0.0; techniques];
        let inspect = |sample: &Sample<'_, P, F::Value>| {
            sample.differences(self.reference, &mut differences);
            kept.push(sample, |row| {
                let start = row.len();
                row.extend(self.active[1..].iter().map(|k| differences[*k]));
                row.extend(self.mis.variates.iter().map(|v| {
                    // The balance heuristic's factor is 1 / Σ α_k p_k.
                    (v.h)(sample.x()) * sample.weight() - v.integral
                }));
                // A sample at fault, which is counted.
                if row[start..].iter().any(|z| !z.is_finite()) {
                    row[start..].fill(0.0);
                }
            });
        };
        self.mis.mis.draw(self.f, self.points, range, &mut Buffers::new(), sums, inspect)?;
        Ok(part)
    }

    fn direct(&self) -> Result<OptimalEstimate<F::Value>, EstimateError> {
        let mut kept = Kept::new(self.regressors(), Self::COMPONENTS);
        let part = self.keep(0..self.samples(), &mut kept)?;
        let mut fit = self.empty();
        kept.add_to(&mut fit, |_| true);
        // As many coefficients as samples would leave nothing, whatever f is.
        let enough = fit.rows() > self.regressors() as u64 + 1;
        let solution = fit.solve().filter(|_| enough);
        let beta = solution.as_ref().map_or(&[][..], |s| &s.coefficients);
        let mut sums = Adjusted::new(self.shares().len(), self.replicates, Self::COMPONENTS);
        sums.add(&kept, |of| (of.technique, beta));
        sums.add_faults(0, &part.counts);
        let fitted = solution.as_ref().map_or(0, |s| s.rank as u64);
        let uncontrolled = if solution.is_some() { 0 } else { self.samples() };
        self.finish(sums, self.shares().to_vec(), fitted, solution, uncontrolled)
    }

    fn cross_fit(&self, folds: u64) -> Result<OptimalEstimate<F::Value>, EstimateError> {
        let techniques = self.shares().len();
        let in_replicates = self.replicates > 1;
        let fewest =
            self.active.iter().map(|i| self.mis.mis.of_the_first(self.samples(), *i)).min();
        let most = if in_replicates { self.replicates as u64 } else { fewest.unwrap_or(0) / 8 };
        let folds = folds.min(most.max(2));
        let fold_of = |of: &Origin| {
            let number = if in_replicates { of.replicate as u64 } else { of.index };
            usize::try_from(number % folds).unwrap_or(0)
        };
        let mut kept = Kept::new(self.regressors(), Self::COMPONENTS);
        let part = self.keep(0..self.samples(), &mut kept)?;

        let parts: Vec<Regression> = (0..folds as usize)
            .map(|fold| {
                let mut fit = self.empty();
                kept.add_to(&mut fit, |of| fold_of(of) == fold);
                fit
            })
            .collect();
        let others = |fold: usize| {
            let mut all = self.empty();
            let fits = parts.iter().enumerate().filter(|(k, _)| *k != fold);
            fits.for_each(|(_, fit)| all.merge(fit));
            all
        };
        let enough = |fit: &Regression| fit.rows() > 2 * (self.regressors() as u64 + 1);
        let solutions: Vec<Option<Solution>> = (0..folds as usize)
            .map(others)
            .map(|fit| fit.solve().filter(|_| enough(&fit)))
            .collect();
        // Every technique's mean within a fold counts for its share, so that none is biased.
        let several = !in_replicates && fewest >= Some(2 * folds);
        let strata = if several { techniques * folds as usize } else { techniques };
        let usable = (several || in_replicates) && solutions.iter().all(Option::is_some);
        let mut sums = Adjusted::new(strata, self.replicates, Self::COMPONENTS);
        sums.add(&kept, |of| {
            let fold = fold_of(of);
            let stratum = if several { fold * techniques } else { 0 } + of.technique;
            let solution = solutions[fold].as_ref().filter(|_| usable);
            (stratum, solution.map_or(&[][..], |s| &s.coefficients))
        });
        sums.add_faults(0, &part.counts);
        let shares = if several {
            // A fold has the part of all samples that its own are.
            let size = |fold: usize| parts[fold].rows() as f64 / self.samples() as f64;
            let shares = |fold| self.shares().iter().map(move |share| size(fold) * share);
            (0..folds as usize).flat_map(shares).collect()
        } else {
            self.shares().to_vec()
        };
        let all = others(usize::MAX).solve().filter(|_| usable);
        let uncontrolled = if usable { 0 } else { self.samples() };
        self.finish(sums, shares, 0, all, uncontrolled)
    }

    fn progressive(&self) -> Result<OptimalEstimate<F::Value>, EstimateError> {
        let (all, techniques) = (self.samples(), self.shares().len());
        let regressors = self.regressors() as u64;
        // The first batch is large enough for all techniques to have an error of their own.
        let sound = |first: u64| {
            let each = self.active.iter().map(|i| self.mis.mis.of_the_first(first, *i));
            first >= ENOUGH * (regressors + 1) && each.min() >= Some(2 * self.replicates as u64)
        };
        let halvings = (0..BATCHES).rev().find(|h| sound(all >> h)).unwrap_or(0);
        let ends: Vec<u64> = (0..=halvings).rev().map(|h| all >> h).collect();
        let strata = techniques * ends.len();
        let mut sums = Adjusted::new(strata, self.replicates, Self::COMPONENTS);
        let mut kept = Kept::new(self.regressors(), Self::COMPONENTS);
        let (mut fit, mut shares) = (self.empty(), Vec::with_capacity(strata));
        let (mut start, mut uncontrolled) = (0, 0);
        for (batch, end) in ends.iter().enumerate() {
            let solution = fit.solve().filter(|_| batch > 0);
            if solution.is_none() {
                uncontrolled += end - start;
            }
            let beta = solution.as_ref().map_or(&[][..], |s| &s.coefficients);
            for first in (start..*end).step_by(PIECE as usize) {
                kept.clear();
                let part = self.keep(first..(first + PIECE).min(*end), &mut kept)?;
                sums.add(&kept, |of| (batch * techniques + of.technique, beta));
                sums.add_faults(batch * techniques, &part.counts);
                kept.add_to(&mut fit, |_| true);
            }
            let size = (end - start) as f64 / all as f64;
            shares.extend(self.shares().iter().map(|share| size * share));
            start = *end;
        }
        let solution = fit.solve().filter(|_| ends.len() > 1);
        self.finish(sums, shares, 0, solution, uncontrolled)
    }

    fn finish(
        &self,
        sums: Adjusted,
        shares: Vec<f64>,
        fitted: u64,
        solution: Option<Solution>,
        uncontrolled: u64,
    ) -> Result<OptimalEstimate<F::Value>, EstimateError> {
        let part = sums.into_part();
        let counts = part.all();
        self.mis.mis.frame().on_fault.check(counts.faults(), counts.samples)?;
        let techniques = self.shares().len();
        let estimate = Estimate::in_batches(Design::Stratified, shares, part, techniques, fitted);
        let rank = solution.as_ref().map_or(0, |s| s.rank);
        let rows = solution.map(|s| s.coefficients).unwrap_or_default();
        let (pdfs, variates) = rows
            .iter()
            .map(|row| {
                let (own, variates) = row.split_at(self.active.len() - 1);
                let mut all = vec![0.0; techniques];
                self.active[1..].iter().zip(own).for_each(|(k, beta)| all[*k] = *beta);
                (all, variates.to_vec())
            })
            .unzip();
        let controls = Controls::fitted(self.reference, pdfs);
        Ok(OptimalEstimate { estimate, controls, variates, rank, uncontrolled })
    }
}

/// The result of [`OptimalMis`].
///
/// `Display` prints the estimate, and how many samples went without controls, if any.
#[derive(Debug, Clone, PartialEq)]
pub struct OptimalEstimate<V: Value = f64> {
    estimate: Estimate<V>,
    controls: Controls,
    variates: Vec<Vec<f64>>,
    rank: usize,
    uncontrolled: u64,
}

impl<V: Value> OptimalEstimate<V> {
    /// The value with its error. The contributions are those that the controls have left.
    ///
    /// [`Fit::Direct`]: the residuals are smaller than the errors, and the standard error is that of
    /// the residuals times √((N - K) / (N - K - [rank](OptimalEstimate::rank))), with as many degrees of
    /// freedom less. Otherwise each batch, or fold, has an error of its own, given its coefficients.
    #[must_use]
    pub fn estimate(&self) -> &Estimate<V> {
        &self.estimate
    }

    /// The value of the [estimate](OptimalEstimate::estimate).
    #[must_use]
    pub fn value(&self) -> V::Each<f64> {
        self.estimate.value()
    }

    /// The standard error of the [estimate](OptimalEstimate::estimate).
    #[must_use]
    pub fn standard_error(&self) -> V::Each<Option<f64>> {
        self.estimate.standard_error()
    }

    /// The coefficients of the pdfs that all samples together give: those for a
    /// [`MultiSample::controls`] of other samples, say.
    #[must_use]
    pub fn controls(&self) -> &Controls {
        &self.controls
    }

    /// The coefficients of the [control variates](OptimalMis::control_variates), a row for each component.
    #[must_use]
    pub fn variate_coefficients(&self) -> &[Vec<f64>] {
        &self.variates
    }

    /// How many of the regressors, K - 1 differences of pdfs and the control variates, are independent
    /// of each other. One that is not, as of a technique that is there twice, has the coefficient 0.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// How many samples went without controls, which is the balance heuristic: the first batch of
    /// [`Fit::Progressive`]; all, where there are too few.
    #[must_use]
    pub fn uncontrolled(&self) -> u64 {
        self.uncontrolled
    }
}

impl<V: Value> Display for OptimalEstimate<V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Display::fmt(&self.estimate, f)?;
        match self.uncontrolled {
            0 => Ok(()),
            n if n == self.estimate.samples() => {
                f.write_str(", by the balance heuristic: too few samples")
            }
            n => write!(f, ", {n} samples by the balance heuristic"),
        }
    }
}

impl<P> Debug for OptimalMis<'_, P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("OptimalMis")
            .field("mis", &self.mis)
            .field("fit", &self.fit)
            .field("control_variates", &self.variates.len())
            .finish()
    }
}
