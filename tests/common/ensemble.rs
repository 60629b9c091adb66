//! Ensembles: many estimates from fixed seeds, and what their spread says.

use mis::ArgumentError;
use mis::weighting::{
    Balance, Constant, Cutoff, Densities, Maximum, Power, VarianceAware, Weighting,
};

/// |z| beyond which a figure fails: 1e-5 each, 1e-3 for a family of a hundred.
pub(crate) const Z: f64 = 4.42;

/// Any weighting, as a value. Every method is forwarded, so the weighting's own batch code runs.
pub(crate) struct Any(pub(crate) String, Box<dyn Weighting>);

impl Any {
    pub(crate) fn new(name: impl Into<String>, weighting: impl Weighting + 'static) -> Self {
        Self(name.into(), Box::new(weighting))
    }

    pub(crate) fn balance() -> Self {
        Self::new("balance", Balance)
    }

    pub(crate) fn power(beta: f64) -> Self {
        Self::new(format!("power {beta}"), Power::new(beta).unwrap())
    }

    pub(crate) fn cutoff(alpha: f64) -> Self {
        Self::new(format!("cutoff {alpha}"), Cutoff::new(alpha).unwrap())
    }

    pub(crate) fn maximum() -> Self {
        Self::new("maximum", Maximum)
    }

    pub(crate) fn variance_aware(factors: &[f64]) -> Self {
        Self::new("variance-aware", VarianceAware::new(factors).unwrap())
    }

    pub(crate) fn constant(name: &str, weights: &[f64]) -> Self {
        Self::new(name, Constant::new(weights).unwrap())
    }

    pub(crate) fn equal() -> Self {
        Self::new("constant equal", Constant::equal())
    }
}

impl std::fmt::Debug for Any {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl Weighting for &Any {
    fn weight_over_ratio(&self, i: usize, r: &[f64]) -> f64 {
        self.1.weight_over_ratio(i, r)
    }

    fn ln_weight_over_ratio(&self, i: usize, ln_r: &[f64], r: &[f64]) -> f64 {
        self.1.ln_weight_over_ratio(i, ln_r, r)
    }

    fn weight_over_density_batch(
        &self,
        i: usize,
        q: &Densities<'_>,
        r: &mut [f64],
        out: &mut [f64],
    ) {
        self.1.weight_over_density_batch(i, q, r, out);
    }

    fn constant_weight(&self, i: usize, alpha: &[f64]) -> Option<f64> {
        self.1.constant_weight(i, alpha)
    }

    fn check(&self, alpha: &[f64]) -> Result<(), ArgumentError> {
        self.1.check(alpha)
    }
}

/// Mean, variance and kurtosis of the values of an ensemble.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spread {
    pub(crate) count: f64,
    pub(crate) mean: f64,
    /// Unbiased.
    pub(crate) variance: f64,
    /// 3 for a normal ensemble.
    pub(crate) kurtosis: f64,
}

impl Spread {
    pub(crate) fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        // About the first value: a large offset costs no digits.
        let mean = values[0] + values.iter().map(|v| v - values[0]).sum::<f64>() / count;
        let moment = |k| values.iter().map(|v| (v - mean).powi(k)).sum::<f64>() / count;
        let (m2, m4) = (moment(2), moment(4));
        Self { count, mean, variance: m2 * count / (count - 1.0), kurtosis: m4 / (m2 * m2) }
    }

    /// The standard error of the mean.
    pub(crate) fn error(&self) -> f64 {
        (self.variance / self.count).sqrt()
    }
}
