//! Numerical Monte Carlo integration by multiple importance sampling.

pub mod error;
pub mod technique;

pub use error::ArgumentError;
