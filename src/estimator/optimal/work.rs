//! How an estimate of optimal MIS is made.

use std::fmt::Debug;
use std::ops::Range;

use super::OptimalMis;
use super::estimate::OptimalEstimate;
use super::left_out::LeftOut;
use crate::error::{EstimateError, shortened};
use crate::estimate::Estimate;
use crate::estimator::controls::Controls;
use crate::estimator::kept::{Adjusted, Kept, Origin, controlled};
use crate::estimator::regression::{Regression, Solution};
use crate::estimator::{Buffers, Design, Draw, Sample, Sums};
use crate::integrand::{Integrand, Value};
use crate::part::Part;
use crate::points::{PointSource, replicates};

/// Samples that are held at a time.
const PIECE: usize = 1 << 14;

/// Batches of [`Fit::Progressive`], at most: the first has no controls, so it is to be small.
const BATCHES: u32 = 40;

/// Past samples for each coefficient, without which there is no control.
const ENOUGH: u64 = 10;

/// One estimate at work.
pub(super) struct Work<'a, P, F: ?Sized, S: ?Sized> {
    mis: &'a OptimalMis<'a, P>,
    f: &'a F,
    points: &'a S,
    replicates: usize,
    /// Techniques that have samples, and the first of them.
    active: Vec<usize>,
    reference: usize,
}

impl<'a, P, F, S> Work<'a, P, F, S>
where
    P: Debug,
    F: Integrand<P> + ?Sized,
    S: PointSource + ?Sized,
{
    pub(super) fn new(mis: &'a OptimalMis<'a, P>, f: &'a F, points: &'a S) -> Self {
        let shares = mis.mis.frame().shares;
        let active: Vec<usize> = (0..shares.len()).filter(|k| shares[*k] > 0.0).collect();
        let reference = active.first().copied().unwrap_or(0);
        Self { mis, f, points, replicates: replicates(points), active, reference }
    }

    const COMPONENTS: usize = <F::Value as Value>::COMPONENTS;

    fn samples(&self) -> u64 {
        self.mis.mis.frame().samples
    }

    fn shares(&self) -> &[f64] {
        self.mis.mis.frame().shares
    }

    /// How many columns the regression has: differences of pdfs, and control variates.
    pub(super) fn regressors(&self) -> usize {
        self.active.len() - 1 + self.mis.variates.len()
    }

    fn empty(&self) -> Regression {
        Regression::new(self.regressors(), Self::COMPONENTS)
    }

    /// More samples than these make coefficients for others.
    fn least(&self) -> u64 {
        2 * (self.regressors() as u64 + 1)
    }

    /// The coefficients that samples make for others, if there are enough that say something: of few
    /// where f is not 0, they would be noise.
    fn solved(&self, fit: &Regression) -> Option<Solution> {
        fit.solve().filter(|_| fit.informative() > self.regressors() as u64)
    }

    /// Keeps the samples of a range; returns what it had of faults.
    fn keep(&self, range: Range<u64>, kept: &mut Kept) -> Result<Part, EstimateError> {
        let techniques = self.shares().len();
        let mut part = Part::empty(techniques, self.replicates, Self::COMPONENTS);
        let sums = Sums { part: &mut part, evidence: None };
        let mut differences = vec![0.0; techniques];
        let mut fault = None;
        let inspect = |sample: &Sample<'_, P, F::Value>| {
            sample.differences(self.reference, &mut differences);
            kept.push(sample, |row| {
                let start = row.len();
                let weight = sample.inverse_mixture();
                row.extend(self.active[1..].iter().map(|k| differences[*k]));
                for (number, variate) in self.mis.variates.iter().enumerate() {
                    let h = (variate.h)(sample.x());
                    let z = h * weight - variate.integral;
                    row.push(z);
                    if !z.is_finite() && weight.is_finite() {
                        fault.get_or_insert_with(|| EstimateError::Variate {
                            variate: number,
                            technique: sample.technique(),
                            sample: sample.index(),
                            point: shortened(sample.x()),
                            value: h,
                        });
                    }
                }
                // A sample at fault has no densities to speak of; it is counted.
                if row[start..].iter().any(|z| !z.is_finite()) {
                    row[start..].fill(0.0);
                }
            });
        };
        self.mis.mis.draw(self.f, self.points, range, &mut Buffers::new(), sums, inspect)?;
        if let Some(fault) = fault {
            return Err(fault);
        }
        Ok(part)
    }

    pub(super) fn direct(&self) -> Result<OptimalEstimate<F::Value>, EstimateError> {
        let mut kept = Kept::new(self.regressors(), Self::COMPONENTS);
        let part = self.keep(0..self.samples(), &mut kept)?;
        let mut fit = self.empty();
        kept.add_to(&mut fit, |_| true);
        let factored = fit.factored();
        // As many coefficients as samples would leave nothing, whatever f is.
        let enough = fit.rows() > self.regressors() as u64 + 1;
        let solution = factored.solution().filter(|_| enough);
        let mut sums = Adjusted::new(self.shares().len(), self.replicates, Self::COMPONENTS);
        match &solution {
            // Nothing is fitted, or the values of replicates tell the error.
            Some(solution) if solution.rank == 0 || self.replicates > 1 => {
                sums.add(&kept, |of| (of.technique, &solution.coefficients));
            }
            Some(solution) => {
                let left_out = LeftOut::new(&kept, &factored, solution, self.shares().len());
                sums.add_each(
                    &kept,
                    |of| of.technique,
                    |j, of, c, y, z| {
                        left_out.contribution(j, of, c, controlled(y, z, &solution.coefficients[c]))
                    },
                );
            }
            None => sums.add(&kept, |of| (of.technique, &[])),
        }
        sums.add_faults(0, &part.counts);
        let fitted = solution.as_ref().map_or(0, |s| s.rank as u64);
        let uncontrolled = if solution.is_some() { 0 } else { self.samples() };
        self.finish(sums, self.shares().to_vec(), fitted, solution, uncontrolled)
    }

    pub(super) fn cross_fit(&self, folds: u64) -> Result<OptimalEstimate<F::Value>, EstimateError> {
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

        let count = usize::try_from(folds).unwrap_or(usize::MAX);
        let parts: Vec<Regression> = (0..count)
            .map(|fold| {
                let mut fit = self.empty();
                kept.add_to(&mut fit, |of| fold_of(of) == fold);
                fit
            })
            .collect();
        // The folds before each one, and those after it: all others.
        let mut before = vec![self.empty()];
        for fit in &parts {
            let mut all = before[before.len() - 1].clone();
            all.merge(fit);
            before.push(all);
        }
        let mut after = self.empty();
        let mut solutions: Vec<Option<Solution>> = Vec::with_capacity(count);
        for (fit, before) in parts.iter().zip(&before).rev() {
            let mut others = before.clone();
            others.merge(&after);
            solutions.push(self.solved(&others));
            after.merge(fit);
        }
        solutions.reverse();
        let enough = parts.iter().all(|fit| after.rows() - fit.rows() > self.least());
        let usable = enough && (in_replicates || fewest >= Some(2 * folds));
        // Every technique's mean within a fold counts for its share, so that none is biased.
        let several = usable && !in_replicates;
        let strata = if several { techniques * count } else { techniques };
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
            (0..count).flat_map(shares).collect()
        } else {
            self.shares().to_vec()
        };
        let used = usable && solutions.iter().any(Option::is_some);
        let all = after.solve().filter(|_| used);
        let without = |(_, solution): &(_, &Option<_>)| !usable || solution.is_none();
        let folds = parts.iter().zip(&solutions);
        let uncontrolled = folds.filter(without).map(|(fit, _)| fit.rows()).sum();
        self.finish(sums, shares, 0, all, uncontrolled)
    }

    pub(super) fn progressive(&self) -> Result<OptimalEstimate<F::Value>, EstimateError> {
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
            let solution = self.solved(&fit);
            if solution.is_none() {
                uncontrolled += end - start;
            }
            let beta = solution.as_ref().map_or(&[][..], |s| &s.coefficients);
            for first in (start..*end).step_by(PIECE) {
                kept.clear();
                let part = self.keep(first..(first + PIECE as u64).min(*end), &mut kept)?;
                sums.add(&kept, |of| (batch * techniques + of.technique, beta));
                sums.add_faults(batch * techniques, &part.counts);
                kept.add_to(&mut fit, |_| true);
            }
            let size = (end - start) as f64 / all as f64;
            shares.extend(self.shares().iter().map(|share| size * share));
            start = *end;
        }
        let solution = self.solved(&fit).filter(|_| ends.len() > 1);
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
