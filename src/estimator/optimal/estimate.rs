//! What optimal MIS comes to.

use std::fmt::{self, Display};

use crate::estimate::Estimate;
use crate::estimator::controls::Controls;
use crate::integrand::Value;

/// The result of [`OptimalMis`](crate::OptimalMis).
///
/// `Display` prints the estimate, and how many samples went without controls, if any.
#[derive(Debug, Clone, PartialEq)]
pub struct OptimalEstimate<V: Value = f64> {
    pub(super) estimate: Estimate<V>,
    pub(super) controls: Controls,
    pub(super) variates: Vec<Vec<f64>>,
    pub(super) rank: usize,
    pub(super) uncontrolled: u64,
}

impl<V: Value> OptimalEstimate<V> {
    /// The value with its error. The contributions are those that the controls have left.
    ///
    /// [`Fit::Direct`](crate::Fit::Direct) fits the very samples, which leaves less than there is: what a sample leaves is
    /// divided by 1 - h, with its leverage h, and so is what would be left without it in the fit
    /// (J. G. MacKinnon and H. White, *Some Heteroskedasticity-Consistent Covariance Matrix Estimators
    /// with Improved Finite Sample Properties*, 1985, doi:10.1016/0304-4076(85)90158-7). Degrees of
    /// freedom are less by the [rank](OptimalEstimate::rank). Otherwise each batch, or fold, has an
    /// error of its own, given its coefficients.
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
    /// [`MultiSample::controls`](crate::MultiSample::controls) of other samples, say.
    #[must_use]
    pub fn controls(&self) -> &Controls {
        &self.controls
    }

    /// The coefficients of the [control variates](crate::OptimalMis::control_variates), a row for each component.
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
    /// [`Fit::Progressive`](crate::Fit::Progressive); all, where there are too few; and those for which
    /// there are fewer others with f ≠ 0 than coefficients and a mean.
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
