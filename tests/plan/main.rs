//! Plans: what they predict, what they recommend, and that they are what they say.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod adaptive;
mod allocation;
mod coverage;
#[cfg(feature = "lighting")]
mod lit;
mod measure;
mod predictions;
mod problems;
#[path = "../common/quadrature.rs"]
mod quadrature;
mod suite;
mod value;
