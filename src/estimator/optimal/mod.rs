//! Optimal multiple importance sampling.

mod estimate;
mod left_out;
mod work;

pub use estimate::OptimalEstimate;

use std::fmt::{self, Debug};

use super::{MultiSample, OnFault};
use crate::error::{ArgumentError, EstimateError, finite};
use crate::integrand::Integrand;
use crate::points::{PointSource, Random};
use crate::technique::Technique;
use work::Work;

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
/// bad ones spoil what the good ones would give. Where there is nothing to gain, coefficients made of
/// samples are noise: with 50 K samples, that made the variance up to 4 % larger than by the balance
/// heuristic, with 200 K up to 1 %, over 25 integrands. Samples with f = 0 count like any other. The
/// value may be negative though f is not. With fewer samples than make sense, it is the balance
/// heuristic, and [`uncontrolled`](OptimalEstimate::uncontrolled) says so.
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
///
#[doc = include_str!("../bias.md")]
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
        let work = Work::new(self, f, points);
        match self.fit {
            // Nothing to fit.
            _ if work.regressors() == 0 => work.direct(),
            Fit::Direct => work.direct(),
            Fit::CrossFit { folds } => work.cross_fit(folds),
            Fit::Progressive => work.progressive(),
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
