//! Samples as an estimator shows them, and what becomes of the unusable ones.

use crate::error::{ArgumentError, EstimateError};
use crate::integrand::Value;

/// What to do with a sample that has no usable contribution: the integrand is not finite, the
/// contribution overflows, the technique's own pdf is 0 or infinite, or any pdf is negative or NaN.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum OnFault {
    /// Stop with an [`EstimateError`](crate::EstimateError) that names the sample.
    #[default]
    Error,
    /// Let it contribute 0, and count it. The estimate is then biased by what is missing.
    #[non_exhaustive]
    CountAsZero {
        /// The largest part of all samples that may be like this; more are an error.
        at_most: f64,
    },
}

impl OnFault {
    /// [`CountAsZero`](OnFault::CountAsZero), up to the part `at_most` of all samples.
    ///
    /// # Errors
    ///
    /// `at_most` must be in \[0, 1\].
    pub fn count_as_zero(at_most: f64) -> Result<Self, ArgumentError> {
        if (0.0..=1.0).contains(&at_most) {
            Ok(Self::CountAsZero { at_most })
        } else {
            let rule = "it must be at least 0 and at most 1";
            Err(ArgumentError::new("OnFault::count_as_zero", "at_most", at_most, rule))
        }
    }

    /// Whether so many faults are too many for any `limit` samples of which these are the first, or
    /// by far for these.
    pub(crate) fn is_hopeless(self, faults: u64, samples: u64, limit: u64) -> bool {
        let Self::CountAsZero { at_most } = self else { return false };
        let (faults, expected) = (faults as f64, at_most * samples as f64);
        // Ten more than five standard deviations: by chance in less than 1e-6 of runs.
        let far = faults > expected + 5.0 * expected.sqrt() + 10.0;
        far || faults > at_most * limit as f64
    }

    /// Whether so many faults are too many.
    pub(crate) fn check(self, faults: u64, samples: u64) -> Result<(), EstimateError> {
        match self {
            Self::CountAsZero { at_most } if faults as f64 > at_most * samples as f64 => {
                Err(EstimateError::Faults { faults, samples, at_most })
            }
            _ => Ok(()),
        }
    }
}

/// A sample, as an estimator shows it.
#[derive(Debug, Clone, Copy)]
pub struct Sample<'a, P, V> {
    pub(super) technique: usize,
    pub(super) replicate: usize,
    pub(super) index: u64,
    pub(super) x: &'a P,
    pub(super) value: &'a V,
    pub(super) weight: f64,
    /// One a component, `stride` apart.
    pub(super) y: &'a [f64],
    pub(super) stride: usize,
    pub(super) densities: DensitiesAt<'a>,
}

/// The pdfs of all techniques at a point, up to a factor that they have in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct DensitiesAt<'a> {
    /// α_k.
    pub(super) alpha: &'a [f64],
    /// One a technique, `stride` apart.
    pub(super) rows: &'a [f64],
    pub(super) stride: usize,
}

impl DensitiesAt<'_> {
    /// p_k / Σ α_m p_m for every technique, into `out`.
    ///
    /// Each is at most 1 / α_k. Where a pdf is subnormal, the quotient has only its digits.
    fn relative(&self, out: &mut [f64]) {
        let pdfs = self.rows.iter().step_by(self.stride.max(1));
        let sum: f64 = self.alpha.iter().zip(pdfs.clone()).map(|(alpha, p)| alpha * p).sum();
        for (out, p) in out.iter_mut().zip(pdfs) {
            *out = p / sum;
        }
    }

    /// 1 / Σ α_m p_m.
    fn inverse(&self) -> f64 {
        let pdfs = self.rows.iter().step_by(self.stride.max(1));
        self.alpha.iter().zip(pdfs).map(|(alpha, p)| alpha * p).sum::<f64>().recip()
    }

    /// (p_k - p_r) / Σ α_m p_m for every technique, into `out`.
    fn differences(&self, r: usize, out: &mut [f64]) {
        // Exact where the densities are close; their quotients are not.
        let pdfs = || self.rows.iter().step_by(self.stride.max(1));
        let sum: f64 = self.alpha.iter().zip(pdfs()).map(|(alpha, p)| alpha * p).sum();
        let from = pdfs().nth(r).copied().unwrap_or(f64::NAN);
        for (out, p) in out.iter_mut().zip(pdfs()) {
            *out = (p - from) / sum;
        }
    }
}

impl<'a, P, V: Value> Sample<'a, P, V> {
    /// The technique that drew it.
    #[must_use]
    pub fn technique(&self) -> usize {
        self.technique
    }

    /// The replicate that it belongs to; 0 where the samples are independent (see
    /// [`PointSource::replicates`](crate::points::PointSource::replicates)).
    #[must_use]
    pub fn replicate(&self) -> usize {
        self.replicate
    }

    /// Its index, counted within the technique (multi-sample) or over all samples (one-sample).
    #[must_use]
    pub fn index(&self) -> u64 {
        self.index
    }

    /// The point x.
    #[must_use]
    pub fn x(&self) -> &'a P {
        self.x
    }

    /// f(x).
    #[must_use]
    pub fn value(&self) -> &'a V {
        self.value
    }

    /// w_i(x) / (α_i p_i(x)), with α_i = n_i / N (multi-sample) or P_i (one-sample).
    ///
    /// 0 for a sample that counts as 0; it may be infinite where the contribution is not, since
    /// that is formed from logarithms.
    #[must_use]
    pub fn weight(&self) -> f64 {
        self.weight
    }

    /// The contribution y = w_i(x) f(x) / (α_i p_i(x)), the value times the weight; less the
    /// [controls](crate::MultiSample::controls), if there are any. The mean of y over all samples is
    /// the estimate.
    #[must_use]
    pub fn contribution(&self) -> V::Each<f64> {
        V::each(|c| self.contribution_to(c))
    }

    /// p_k / Σ α_m p_m at x for every technique, into `out`; 0 for those without a share. NaN where
    /// the weights are constant: the pdfs of others are not evaluated then.
    pub(crate) fn relative_densities(&self, out: &mut [f64]) {
        self.densities.relative(out);
    }

    /// (p_k - p_r) / Σ α_m p_m at x for every technique, into `out`, as
    /// [`relative_densities`](Self::relative_densities).
    pub(crate) fn differences(&self, r: usize, out: &mut [f64]) {
        self.densities.differences(r, out);
    }

    /// 1 / Σ α_m p_m at x, under the balance heuristic; of a sample at fault too, if its densities are
    /// not.
    pub(crate) fn inverse_mixture(&self) -> f64 {
        if self.weight == 0.0 { self.densities.inverse() } else { self.weight }
    }

    /// NaN for a component that there is not.
    pub(crate) fn contribution_to(&self, c: usize) -> f64 {
        self.y.get(c * self.stride).copied().unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::OnFault;

    #[test]
    fn when_faults_are_hopeless() {
        let zero = OnFault::count_as_zero(0.01).unwrap();
        for (faults, samples, limit, hopeless) in [
            // 100 are expected, and 100 + 5 · 10 + 10 may be.
            (160, 10_000, 1 << 20, false),
            (161, 10_000, 1 << 20, true),
            // None, and 10 may be.
            (10, 0, 1 << 20, false),
            (11, 0, 1 << 20, true),
            // More than all samples to come may have.
            (4, 100, 400, false),
            (5, 100, 400, true),
        ] {
            assert_eq!(zero.is_hopeless(faults, samples, limit), hopeless, "{faults} {samples}");
            assert!(!OnFault::Error.is_hopeless(faults, samples, limit));
        }
    }
}
