//! How the techniques' moments combine to a value, an error and its shape.

use std::ops::Range;

use super::interval::Bounded;
use super::{Design, Estimate, Interval, Largest};
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
        let all = (0..self.replicates).map(|r| self.of_replicate(i, r, c));
        all.reduce(Contributions::merge).unwrap_or_default()
    }

    /// The part of them that is replicate `r`'s.
    pub(super) fn of_replicate(&self, i: usize, r: usize, c: usize) -> Contributions {
        let at = (i * self.replicates + r) * V::COMPONENTS + c;
        self.part.contributions.get(at).copied().unwrap_or_default()
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
    /// the integral is missing. From replicates, the mean of their values.
    pub(super) fn mean(&self, c: usize) -> f64 {
        if let Some(values) = self.replicate_values(c) {
            return values.mean;
        }
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
    pub(crate) fn value_of(&self, c: usize) -> f64 {
        self.results.get(c).map_or(f64::NAN, |result| result.value)
    }

    pub(crate) fn error_of(&self, c: usize) -> Option<f64> {
        self.results.get(c)?.error
    }

    /// The largest of the techniques' parts of the standard error of component `c`, whose value is
    /// `value`, and the sum of the squares of all over its square: no over- or underflow.
    pub(super) fn sum_of_parts(&self, c: usize, value: f64) -> (f64, f64) {
        let parts: Vec<f64> =
            self.techniques_drawn().map(|i| self.error_from(i, c, value)).collect();
        let largest = parts.iter().copied().fold(0.0, f64::max);
        let squares = parts.iter().map(|part| (part / largest).powi(2));
        (largest, if largest == 0.0 { 0.0 } else { squares.sum() })
    }

    /// The standard error of component `c`, given its [parts](Self::sum_of_parts).
    pub(super) fn combined_error(&self, c: usize, (largest, squares): (f64, f64)) -> Option<f64> {
        if self.replicates > 1 {
            return self.replicate_values(c).filter(|_| self.has_signal(c))?.standard_error();
        }
        let known = match self.design {
            Design::Stratified => {
                self.techniques_drawn().all(|i| self.alpha(i) == 0.0 || self.count(i) > 1)
            }
            Design::Pooled => self.samples() > 1,
        };
        // Of hardly more samples than coefficients that were fitted to them, too little is left.
        let known = known && (self.fitted == 0 || self.fitted + self.means() < self.samples());
        (known && self.has_signal(c)).then(|| largest * squares.sqrt())
    }

    /// How many means there are.
    fn means(&self) -> u64 {
        self.shares.iter().filter(|share| **share > 0.0).count() as u64
    }

    /// Technique `i`'s part of the standard error of component `c`; the parts add as squares.
    pub(crate) fn error_from(&self, i: usize, c: usize, value: f64) -> f64 {
        if self.replicates > 1 {
            return self.replicate_parts(i, c).and_then(|m| m.standard_error()).unwrap_or(0.0);
        }
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
        if self.replicates > 1 {
            return (self.replicates - 1) as f64;
        }
        let of_samples = match self.design {
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
        };
        if self.fitted == 0 { of_samples } else { (of_samples - self.fitted as f64).max(1.0) }
    }

    pub(super) fn error_with_freedom(&self, c: usize) -> Option<(f64, f64)> {
        self.error_of(c).map(|error| (error, self.degrees_of_freedom(c, error)))
    }

    /// What each technique adds to the skewness of the value, Σ α_i³ μ_i / n_i² / V^(3/2); nothing
    /// where the error is unknown or 0.
    fn skewness_parts(&self, c: usize) -> Vec<f64> {
        let Some(error) = self.error_of(c).filter(|error| *error > 0.0) else {
            return Vec::new();
        };
        // The variances of the errors are unbiased, but the third moments are divided by n.
        let biased = |n: u64| (1.0 - 1.0 / n as f64).powf(1.5);
        if self.replicates > 1 {
            let values = self.replicate_values(c).unwrap_or_default();
            return vec![values.skewness_of_mean()];
        }
        match self.design {
            Design::Stratified => self
                .techniques_drawn()
                .filter(|i| self.count(*i) > 1)
                .map(|i| {
                    let part = self.error_from(i, c, self.value_of(c)) / error;
                    part.powi(3) * self.moments(i, c).skewness_of_mean() * biased(self.count(i))
                })
                .collect(),
            Design::Pooled => {
                let all = self.techniques_drawn().map(|i| self.moments(i, c));
                let all = all.fold(Moments::default(), Moments::merge);
                vec![all.skewness_of_mean() * biased(all.count)]
            }
        }
    }

    pub(crate) fn interval_of(&self, c: usize, level: f64) -> Interval {
        // Of few replicates, the skewness is mostly noise.
        let skewness = if self.replicates > 1 { 0.0 } else { self.skewness_parts(c).iter().sum() };
        Interval::hall(self.value_of(c), self.error_with_freedom(c), skewness, level)
    }

    pub(crate) fn kappa_of(&self, c: usize) -> Option<f64> {
        self.error_of(c)?;
        Some(self.skewness_parts(c).iter().map(|part| part.abs()).sum())
    }

    /// How far the interval reaches from the value; infinite where the error is unknown.
    pub(crate) fn half_width(&self, c: usize, level: f64) -> f64 {
        let value = self.value_of(c);
        let Interval { lower, upper } = self.interval_of(c, level);
        (upper - value).max(value - lower)
    }

    /// Whether any contribution to a component is not 0.
    pub(crate) fn has_signal(&self, c: usize) -> bool {
        self.techniques_drawn().any(|i| self.moments(i, c).largest != 0.0)
    }

    /// The techniques, for the interval of bounded contributions.
    pub(super) fn bounded(&self, c: usize, bounds: (f64, f64)) -> Vec<Bounded> {
        let of = |alpha, m: Moments| {
            let deviation = m.standard_error().unwrap_or(0.0) * (m.count as f64).sqrt();
            Bounded { alpha, samples: m.count, deviation, bounds }
        };
        if self.replicates > 1 {
            // The value of a replicate is a mean of contributions: within their bounds.
            return vec![of(1.0, self.replicate_values(c).unwrap_or_default())];
        }
        let all = self.techniques_drawn().map(|i| (self.alpha(i), self.moments(i, c)));
        match self.design {
            Design::Stratified => all.map(|(alpha, m)| of(alpha, m)).collect(),
            Design::Pooled => {
                vec![of(1.0, all.map(|(_, m)| m).fold(Moments::default(), Moments::merge))]
            }
        }
    }

    pub(crate) fn largest_of(&self, c: usize) -> Option<Largest> {
        let mut largest: Option<Largest> = None;
        for technique in self.techniques_drawn() {
            let extreme = self.of(technique, c).extreme;
            let (share, samples) = self.share_of_sample(technique, extreme.index, c);
            let contribution = share * extreme.y / samples;
            if contribution.abs() > largest.map_or(0.0, |l| l.contribution.abs()) {
                let value = self.value_of(c);
                largest = Some(Largest {
                    technique: technique % self.techniques,
                    sample: extreme.index,
                    contribution,
                    share_of_value: (value != 0.0).then(|| contribution / value),
                });
            }
        }
        largest
    }

    /// What y counts for in the value at a sample, as a share and the samples that have it.
    fn share_of_sample(&self, i: usize, sample: u64, c: usize) -> (f64, f64) {
        let replicates = self.replicates as u64;
        let r = usize::try_from(sample % replicates).unwrap_or(0);
        match (self.dealt.get(r), self.design) {
            (None, _) => (self.alpha(i), self.count(i) as f64),
            (Some(_), Design::Stratified) => {
                let own = self.of_replicate(i, r, c).moments.count;
                (self.shares[i], replicates as f64 * own as f64)
            }
            (Some(dealt), Design::Pooled) => (1.0, replicates as f64 * *dealt as f64),
        }
    }

    /// The part of component `c` that technique `i`'s samples contribute.
    pub(crate) fn share_of_value(&self, i: usize, c: usize) -> Option<f64> {
        let value = self.value_of(c);
        let part = self.replicate_parts(i, c).map(|parts| parts.mean);
        let part = part.unwrap_or_else(|| self.alpha(i) * self.moments(i, c).mean);
        (value != 0.0).then(|| part / value)
    }

    /// The part of the variance of component `c` that technique `i` is responsible for.
    pub(crate) fn share_of_variance(&self, i: usize, c: usize) -> Option<f64> {
        self.error_of(c).filter(|error| *error > 0.0)?;
        // Over the sum of all parts: that of replicates is not their error to the last digit.
        let (largest, squares) = self.results.get(c)?.parts;
        Some((self.error_from(i, c, self.value_of(c)) / largest).powi(2) / squares)
    }
}
