//! The variance of every estimator on examples with known variances: by quadrature of the formulas
//! with the crate's weights, and by ensembles of estimates.
//!
//! V = Σ (1/n_i) [∫ w_i² f²/p_i − (∫ w_i f)²] for n = (1, …, 1); one sample of the one-sample model
//! has V = Σ ∫ w_i² f²/(P_i p_i) − μ². The printed digits were computed independently, by
//! quadrature at higher precision.
// Counts are far below 2^32; formulas keep their letters.
#![allow(clippy::unwrap_used, clippy::doc_markdown)]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

#[allow(dead_code)] // every test binary uses its own part of it
#[path = "../common/ensemble.rs"]
mod ensemble;
mod example;
mod examples;
mod infinite;
mod tables;
