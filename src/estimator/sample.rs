//! Samples as an estimator shows them, and what becomes of the unusable ones.

use crate::integrand::Value;

/// What to do with a sample that has no usable contribution: the integrand is not finite, the
/// contribution times N overflows, the technique's own pdf is 0 or infinite, or any pdf is negative
/// or NaN.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum OnFault {
    /// Stop with an [`EstimateError`](crate::EstimateError) that names the sample.
    #[default]
    Error,
    /// Let it contribute 0, and count it. The estimate is then biased by what is missing.
    CountAsZero,
}

/// A sample, as an estimator shows it.
#[derive(Debug, Clone, Copy)]
pub struct Sample<'a, P, V> {
    pub(super) technique: usize,
    pub(super) index: u64,
    pub(super) x: &'a P,
    pub(super) value: &'a V,
    /// One a component, `stride` apart; times the number of samples.
    pub(super) y: &'a [f64],
    pub(super) stride: usize,
    pub(super) total: f64,
}

impl<'a, P, V: Value> Sample<'a, P, V> {
    /// The technique that drew it.
    #[must_use]
    pub fn technique(&self) -> usize {
        self.technique
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

    /// w_i(x) f(x) / (n_i p_i(x)), or w_i(x) f(x) / (N P_i p_i(x)) in the one-sample model. The
    /// sum over all samples is the estimate.
    #[must_use]
    pub fn contribution(&self) -> V::Each<f64> {
        V::each(|c| self.y.get(c * self.stride).map_or(f64::NAN, |y| y / self.total))
    }
}
