//! How the techniques' moments combine to a value, an error and its shape.

use std::ops::Range;

use super::{Design, Estimate};
use crate::integrand::Value;
use crate::moments::Moments;
use crate::part::Contributions;

impl<V: Value> Estimate<V> {
    /// Moments of technique `i`, component `c`.
    pub(super) fn moments(&self, i: usize, c: usize) -> Moments {
        self.of(i, c).moments
    }

    /// Contributions of technique `i`, component `c`.
    pub(super) fn of(&self, i: usize, c: usize) -> Contributions {
        self.part.contributions.get(i * V::COMPONENTS + c).copied().unwrap_or_default()
    }

    pub(super) fn techniques_drawn(&self) -> Range<usize> {
        0..self.part.counts.len()
    }

    /// n_i.
    pub(super) fn count(&self, i: usize) -> u64 {
        self.part.counts[i].samples
    }

    /// What technique `i`'s mean counts for: its share if that fixed its samples, the part that it
    /// has of them if that is random.
    pub(super) fn alpha(&self, i: usize) -> f64 {
        match self.design {
            Design::Stratified => self.shares[i],
            Design::Pooled => self.count(i) as f64 / self.samples() as f64,
        }
    }

    /// Σ α_i m_i. NaN as long as a technique that has a share has not drawn a sample: its part of
    /// the integral is missing.
    pub(super) fn mean(&self, c: usize) -> f64 {
        let mut sum = 0.0;
        for i in self.techniques_drawn() {
            let alpha = self.alpha(i);
            if alpha != 0.0 {
                let drawn = self.count(i) > 0;
                sum += if drawn { alpha * self.moments(i, c).mean } else { f64::NAN };
            }
        }
        sum
    }

    /// NaN for a component that there is not: a [`Value`] may ask for one against its contract.
    pub(super) fn value_of(&self, c: usize) -> f64 {
        self.results.get(c).map_or(f64::NAN, |result| result.0)
    }

    pub(super) fn error_of(&self, c: usize) -> Option<f64> {
        self.results.get(c)?.1
    }

    /// The standard error of component `c`, whose value is `value`.
    pub(super) fn combined_error(&self, c: usize, value: f64) -> Option<f64> {
        let techniques = self.techniques_drawn();
        let known = match self.design {
            Design::Stratified => {
                techniques.clone().all(|i| self.alpha(i) == 0.0 || self.count(i) > 1)
            }
            Design::Pooled => self.samples() > 1,
        };
        let signal = techniques.clone().any(|i| self.moments(i, c).largest != 0.0);
        // Squares of the parts over the largest of them: no over- or underflow.
        let parts = techniques.map(|i| self.error_from(i, c, value));
        let largest = parts.clone().fold(0.0, f64::max);
        if !(known && signal) {
            None
        } else if largest == 0.0 {
            Some(0.0)
        } else {
            Some(largest * parts.map(|part| (part / largest).powi(2)).sum::<f64>().sqrt())
        }
    }

    /// Technique `i`'s part of the standard error of component `c`; the parts add as squares.
    pub(super) fn error_from(&self, i: usize, c: usize, value: f64) -> f64 {
        match self.design {
            Design::Stratified => {
                self.alpha(i) * self.moments(i, c).standard_error().unwrap_or(0.0)
            }
            Design::Pooled => {
                let n = self.samples() as f64;
                self.moments(i, c).deviation_from(value, (n * (n - 1.0)).sqrt())
            }
        }
    }

    pub(super) fn degrees_of_freedom(&self, c: usize, error: f64) -> f64 {
        match self.design {
            Design::Stratified if error > 0.0 => self
                .techniques_drawn()
                .filter(|i| self.count(*i) > 1)
                .map(|i| {
                    let part = self.error_from(i, c, self.value_of(c)) / error;
                    part.powi(4) / (self.count(i) - 1) as f64
                })
                .sum::<f64>()
                .recip(),
            _ => self.samples().saturating_sub(1) as f64,
        }
    }

    /// What each technique adds to the skewness of the value, Σ α_i³ μ_3i / n_i² / V^(3/2); none
    /// where the error is unknown or 0.
    pub(super) fn skewness_parts(&self, c: usize) -> Vec<f64> {
        let Some(error) = self.error_of(c).filter(|error| *error > 0.0) else {
            return Vec::new();
        };
        match self.design {
            Design::Stratified => self
                .techniques_drawn()
                .map(|i| {
                    let part = self.error_from(i, c, self.value_of(c)) / error;
                    part.powi(3) * self.moments(i, c).skewness_of_mean()
                })
                .collect(),
            Design::Pooled => {
                let all = self.techniques_drawn().map(|i| self.moments(i, c));
                vec![all.fold(Moments::default(), Moments::merge).skewness_of_mean()]
            }
        }
    }
}
