//! Control variates made of the techniques' pdfs.

use serde::{Deserialize, Serialize};

use crate::error::{ArgumentError, finite};

/// A combination of the techniques' pdfs that is subtracted from the integrand.
///
/// A contribution y = w_i f / (α_i p_i) becomes y - Σ_k β_k (p_k - p_r) / Σ α_m p_m, with a technique r
/// that all others are compared with. What is subtracted has the mean ∫ Σ β_k (p_k - p_r) = 0 over
/// the samples of all techniques, whatever the β_k; those for which f is close to
/// μ Σ α_m p_m + Σ β_k (p_k - p_r) leave little variance.
///
/// With the balance heuristic and the β_k that leave the least, this is optimal MIS (I. Kondapaneni,
/// P. Vévoda, P. Grittmann, T. Skřivan, P. Slusallek and J. Křivánek, *Optimal Multiple Importance
/// Sampling*, 2019, doi:10.1145/3306346.3323009), the same as the regression of A. B. Owen and Y. Zhou,
/// *Safe and Effective Importance Sampling*, 2000, doi:10.1080/01621459.2000.10473909. β must not
/// depend on the samples that it is applied to, or the estimate is biased; [`OptimalMis`] finds it in
/// ways that allow for that.
///
/// Cost: every pdf at every sample, whatever the weighting, and a few operations for each.
///
/// [`OptimalMis`]: crate::OptimalMis
///
/// ```
/// use mis::technique::{Linear, Uniform};
/// use mis::{Controls, Estimator, MultiSample};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // 3 + 4x = 5 · 1 + 2 · (2x - 1): nothing is left to chance.
/// let (flat, ramp) = (Uniform::unit(), Linear::new(0.0, 1.0, 0.0, 2.0)?);
/// let mis = MultiSample::new(&[(&flat, 500), (&ramp, 500)])?;
/// // The coefficient that makes f - β (2x - 1) proportional to the mixture (1 + 2x) / 2.
/// let exact = mis.controls(Controls::new(0, [[0.0, -0.5]])?)?;
/// let estimate = exact.estimate(&|x: &f64| 3.0 + 4.0 * x, 1)?;
/// assert!((estimate.value() - 5.0).abs() < 1e-14);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Controls {
    /// r.
    reference: usize,
    /// β_k for each technique, a row for each component of the value.
    coefficients: Vec<Vec<f64>>,
}

impl Controls {
    /// β_k for each technique, a row for each component of the value; differences are from technique
    /// `reference`, whose own β counts for nothing. A component without a row has no control.
    ///
    /// # Errors
    ///
    /// The coefficients must be finite, rows of one length, and `reference` less than that.
    pub fn new<R: Into<Vec<f64>>>(
        reference: usize,
        coefficients: impl IntoIterator<Item = R>,
    ) -> Result<Self, ArgumentError> {
        let coefficients = coefficients.into_iter().map(Into::into).collect();
        let controls = Self { reference, coefficients };
        let length = controls.coefficients.first().map_or(usize::MAX, Vec::len);
        controls.check(length).map(|()| controls)
    }

    /// Those that a regression has found.
    pub(super) fn fitted(reference: usize, coefficients: Vec<Vec<f64>>) -> Self {
        Self { reference, coefficients }
    }

    /// Whether they fit so many techniques.
    pub(crate) fn check(&self, techniques: usize) -> Result<(), ArgumentError> {
        const OWNER: &str = "Controls";
        if self.reference >= techniques {
            let rule = format!("there are {techniques} techniques");
            return Err(ArgumentError::new(OWNER, "reference", self.reference, rule));
        }
        for row in &self.coefficients {
            if row.len() != techniques {
                let rule = format!("there must be one for each of {techniques} techniques");
                return Err(ArgumentError::new(OWNER, "coefficients", row, rule));
            }
            row.iter().try_for_each(|beta| finite(OWNER, "coefficients", *beta).map(drop))?;
        }
        Ok(())
    }

    /// Whether they leave out the techniques without a share of the samples, whose pdfs have no known
    /// mean over these.
    pub(super) fn check_shares(&self, alpha: &[f64]) -> Result<(), ArgumentError> {
        const OWNER: &str = "MultiSample::controls";
        if alpha.get(self.reference) == Some(&0.0) {
            let rule = "it must have samples";
            return Err(ArgumentError::new(OWNER, "reference", self.reference, rule));
        }
        for row in &self.coefficients {
            let without = row.iter().zip(alpha).position(|(beta, a)| *beta != 0.0 && *a == 0.0);
            if let Some(k) = without {
                let rule = format!("technique {k} has no samples, so its coefficient must be 0");
                return Err(ArgumentError::new(OWNER, "coefficients", row, rule));
            }
        }
        Ok(())
    }

    /// r, the technique that the others are compared with.
    #[must_use]
    pub fn reference(&self) -> usize {
        self.reference
    }

    /// β_k for each technique, a row for each component of the value.
    #[must_use]
    pub fn coefficients(&self) -> &[Vec<f64>] {
        &self.coefficients
    }

    /// Subtracts them from the contributions `y` of a block of `n` samples, a row for each component.
    /// `pdfs` has a row for each technique.
    pub(super) fn subtract<'y>(
        &self,
        alpha: &[f64],
        pdfs: &[f64],
        n: usize,
        y: impl Iterator<Item = &'y mut [f64]>,
    ) {
        const LANES: usize = 64;
        let rows = || pdfs.chunks_exact(n.max(1));
        let Some(reference) = rows().nth(self.reference) else { return };
        for (betas, y) in self.coefficients.iter().zip(y) {
            for (first, y) in (0..n).step_by(LANES).zip(y.chunks_mut(LANES)) {
                let (mut mixture, mut control) = ([0.0; LANES], [0.0; LANES]);
                let from = reference.get(first..n).unwrap_or_default();
                for ((row, alpha), beta) in rows().zip(alpha).zip(betas) {
                    let lanes = mixture.iter_mut().zip(&mut control);
                    for ((mixture, control), (p, r)) in lanes.zip(row.iter().skip(first).zip(from))
                    {
                        *mixture += alpha * p;
                        // The difference first: densities may be close to each other.
                        *control += beta * (p - r);
                    }
                }
                for ((y, control), mixture) in y.iter_mut().zip(control).zip(mixture) {
                    let control = control / mixture;
                    // Where a pdf is at fault, the sample is counted as one that is.
                    *y -= if control.is_finite() { control } else { 0.0 };
                }
            }
        }
    }
}
