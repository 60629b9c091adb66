//! Estimates: a value, its error, and where both come from.

mod combine;
mod display;
mod interval;

pub use interval::Interval;

use std::marker::PhantomData;

use crate::error::ArgumentError;
use crate::integrand::Value;
use crate::part::{Counts, Part};

/// The result of an estimator.
///
/// `V` is the integrand's value type; what concerns a component is given once for each,
/// as a number for scalar integrands, as an array for arrays.
///
/// `Display` prints the value with its standard error in brackets, in units of the last digits:
/// `0.50012(21)` is 0.50012 ± 0.00021; `0.5(?)` has an unknown error. A precision sets the digits
/// of the error, but for those before its decimal point: `{:.1}` prints `0.5001(2)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate<V = f64> {
    design: Design,
    /// α_i: the share that a technique was to have of the samples.
    shares: Vec<f64>,
    part: Part,
    /// The counts of all techniques together.
    all: Counts,
    /// Value and standard error of each component.
    results: Vec<(f64, Option<f64>)>,
    value: PhantomData<V>,
}

/// What the numbers of samples were.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Design {
    /// Fixed for each technique: the variances within techniques add.
    Stratified,
    /// Random: all contributions are one sample of the same variable.
    Pooled,
}

/// What one technique did for an estimate.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TechniqueSummary<V: Value = f64> {
    /// How many samples it drew.
    pub samples: u64,
    /// The part of the value that its samples contribute; `None` where the value is 0.
    pub share_of_value: V::Each<Option<f64>>,
    /// The part of the variance that it is responsible for; `None` where the variance is unknown
    /// or 0.
    pub share_of_variance: V::Each<Option<f64>>,
}

/// The largest contribution to one component of an estimate.
///
/// If its share of the value is not small, the samples have hardly found what there is to find, and
/// neither the value nor its error is to be believed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Largest {
    /// The technique that drew the sample.
    pub technique: usize,
    /// The sample's index, counted within the technique (multi-sample) or over all samples
    /// (one-sample).
    pub sample: u64,
    /// The contribution; the estimate is the sum of all of them.
    pub contribution: f64,
    /// The contribution over the value; `None` where the value is 0.
    pub share_of_value: Option<f64>,
}

impl<V: Value> Estimate<V> {
    pub(crate) fn new(design: Design, shares: &[f64], part: Part) -> Self {
        let shares = shares.to_vec();
        let all = part.all();
        let mut estimate =
            Self { design, shares, part, all, results: Vec::new(), value: PhantomData };
        for c in 0..V::COMPONENTS {
            let value = estimate.mean(c);
            estimate.results.push((value, estimate.combined_error(c, value)));
        }
        estimate
    }

    /// The estimate of ∫ f.
    #[must_use]
    pub fn value(&self) -> V::Each<f64> {
        V::each(|c| self.value_of(c))
    }

    /// The standard error: an estimate of the value's standard deviation.
    ///
    /// - Multi-sample: √(Σ α_i² s_i² / n_i), with α_i = n_i / N and s_i² the sample variance of
    ///   technique i's contributions times N.
    /// - One-sample: √(s² / N), over all contributions.
    ///
    /// `None` where it cannot be known: a technique drew a single sample, or every
    /// contribution is 0.
    #[must_use]
    pub fn standard_error(&self) -> V::Each<Option<f64>> {
        V::each(|c| self.error_of(c))
    }

    /// The variance of the value, the square of the [standard error](Estimate::standard_error);
    /// it may over- or underflow where the standard error does not.
    #[must_use]
    pub fn variance(&self) -> V::Each<Option<f64>> {
        V::each(|c| self.error_of(c).map(|e| e * e))
    }

    /// The confidence interval at `level`, such as 0.95, from Student's t distribution: the
    /// value ± t · standard error. The whole line where the standard error is unknown.
    ///
    /// The degrees of freedom are N - 1 (one-sample) or those of Welch and Satterthwaite,
    /// V² / Σ v_i² / (n_i - 1) for V = Σ v_i (multi-sample). The interval holds its level where
    /// the mean of contributions is close to normal; strongly skewed contributions need many
    /// samples for that. Where a technique with two or three samples dominates the variance, even
    /// these degrees of freedom are too many: from normal contributions with n = (2, 1000), 95 %
    /// intervals cover 92 %.
    ///
    /// Source: F. E. Satterthwaite, *An Approximate Distribution of Estimates of Variance
    /// Components*, 1946, doi:10.2307/3002019.
    ///
    /// # Errors
    ///
    /// `level` must be greater than 0 and less than 1.
    pub fn interval(&self, level: f64) -> Result<V::Each<Interval>, ArgumentError> {
        if !(level > 0.0 && level < 1.0) {
            let rule = "it must be greater than 0 and less than 1";
            return Err(ArgumentError::new("Estimate::interval", "level", level, rule));
        }
        Ok(V::each(|c| {
            let error = self.error_of(c).map(|error| (error, self.degrees_of_freedom(c, error)));
            Interval::student(self.value_of(c), error, level)
        }))
    }

    /// How many samples were drawn in all.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.all.samples
    }

    /// What each technique did, in the order in which they were given.
    #[must_use]
    pub fn techniques(&self) -> impl ExactSizeIterator<Item = TechniqueSummary<V>> {
        self.techniques_drawn().map(|i| TechniqueSummary {
            samples: self.part.counts[i].samples,
            share_of_value: V::each(|c| {
                let value = self.value_of(c);
                (value != 0.0).then(|| self.alpha(i) * self.moments(i, c).mean / value)
            }),
            share_of_variance: V::each(|c| {
                let error = self.error_of(c).filter(|error| *error > 0.0)?;
                Some((self.error_from(i, c, self.value_of(c)) / error).powi(2))
            }),
        })
    }

    /// How many contributions are 0 (in every component).
    #[must_use]
    pub fn zero(&self) -> u64 {
        self.all.zero
    }

    /// How many samples were at points that, by its pdf, their own technique does not cover, or
    /// where another fault of a pdf left no weight. They count as 0; by default, one is an error
    /// instead (see [`OnFault`](crate::OnFault)).
    #[must_use]
    pub fn uncovered(&self) -> u64 {
        self.all.uncovered
    }

    /// How many samples had a value or a contribution that is not finite. They count as 0; by
    /// default, one is an error instead (see [`OnFault`](crate::OnFault)).
    #[must_use]
    pub fn non_finite(&self) -> u64 {
        self.all.non_finite
    }

    /// The contribution of the largest magnitude; `None` if all are 0.
    #[must_use]
    pub fn largest(&self) -> V::Each<Option<Largest>> {
        V::each(|c| {
            let mut largest: Option<Largest> = None;
            for technique in self.techniques_drawn() {
                let extreme = self.of(technique, c).extreme;
                let samples = self.part.counts[technique].samples as f64;
                let contribution = self.alpha(technique) * extreme.y / samples;
                if contribution.abs() > largest.map_or(0.0, |l| l.contribution.abs()) {
                    let value = self.value_of(c);
                    largest = Some(Largest {
                        technique,
                        sample: extreme.index,
                        contribution,
                        share_of_value: (value != 0.0).then(|| contribution / value),
                    });
                }
            }
            largest
        })
    }
}
