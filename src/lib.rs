//! Numerical Monte Carlo integration by multiple importance sampling.

mod discrete;
pub mod error;
pub mod technique;

pub use error::ArgumentError;
