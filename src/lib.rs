//! Numerical Monte Carlo integration by multiple importance sampling.

mod discrete;
mod error;
mod estimate;
mod estimator;
mod integrand;
mod lanes;
#[cfg(feature = "lighting")]
pub mod lighting;
mod moments;
pub mod points;
pub mod technique;
pub mod weighting;

pub use error::{ArgumentError, EstimateError};
pub use estimate::{Estimate, Interval, Largest, TechniqueSummary};
pub use estimator::{Estimator, MultiSample, OnFault, OneSample, Sample};
pub use integrand::{Integrand, LnValue, Value};
pub use technique::{InverseCdf, Technique};
