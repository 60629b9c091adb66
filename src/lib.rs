//! Numerical Monte Carlo integration by multiple importance sampling.
//!
//! An integrand f has several factors or peaks, and there is a density p_i that suits each of
//! them; none suits f. Draw n_i samples from each p_i and weight them,
//!
//! F = Σ_i 1/n_i Σ_j w_i(x_ij) f(x_ij) / p_i(x_ij), with Σ_i w_i(x) = 1,
//!
//! and F is an unbiased estimate of ∫ f, whose variance is small wherever any of the densities is
//! good. E. Veach and L. J. Guibas, *Optimally Combining Sampling Techniques for Monte Carlo
//! Rendering*, SIGGRAPH 1995, doi:10.1145/218380.218498.
//!
//! ```
//! use mis::technique::{Exponential, Uniform};
//! use mis::{Estimator, MultiSample};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // ∫ e^(-5x) / (1 + x) over [0, 2] is 0.170 42.
//! let decay = Exponential::new(5.0, 0.0, 2.0)?;
//! let flat = Uniform::new(0.0, 2.0)?;
//! let mis = MultiSample::new(&[(&decay, 3000), (&flat, 1000)])?;
//! let estimate = mis.estimate(&|x: &f64| (-5.0 * x).exp() / (1.0 + x), 1)?;
//! assert!(estimate.interval(0.999)?.contains(0.170_419));
//! println!("{estimate}");
//! # Ok(())
//! # }
//! ```
//!
//! # The way of a sample
//!
//! ```text
//! points ξ → technique → weighting → estimator → moments → estimate
//!               integrand f(x) ─────────┘
//! ```
//!
//! - [`points`]: canonical numbers ξ in the unit interval: [`Random`](points::Random) from a seed,
//!   in pairs that are [`Antithetic`](points::Antithetic), [`Stratified`](points::Stratified),
//!   [`Sobol`](points::Sobol), whose error falls faster, or [`Replay`](points::Replay) of given ones.
//! - [`technique`]: a [`Technique`] maps ξ to a point x and knows the density of x.
//! - [`Integrand`]: a closure `|x: &P| value`, of `f64`, `[f64; K]` or [`LnValue`]; or, for whole
//!   batches, [`integrand::batch`].
//! - [`weighting`]: how the techniques share f at x; [`Balance`](weighting::Balance) by default.
//! - [`MultiSample`] and [`OneSample`], both an [`Estimator`], collect the contributions.
//! - [`Estimate`]: value, standard error, interval, and what each technique did.
//! - [`run`]: a [`Run`] drives an estimator to a [`Target`], on all threads, and judges the result.
//! - [`plan`]: which estimator, and how many samples of each technique? [`integrate`] finds out, and
//!   does it.
//! - [`check`]: does a technique keep its promises? A report on every law.
//! - `lighting`: an application, the radiance that leaves a surface.
//!
//! How to choose among all this, and when not to trust it, is in `guide`; what it costs and buys in
//! `measured`. Both are documentation only.
//!
//! # Features
//!
//! - `lighting` (default): the module `lighting`; brings in `glam`.
//! - `parallel` (default): runs on several threads; brings in `rayon`. The bits are the same
//!   without.

#![forbid(unsafe_code)]

pub mod check;
mod discrete;
mod error;
mod estimate;
mod estimator;
#[cfg(doc)]
pub mod guide;
pub mod integrand;
mod lanes;
#[cfg(feature = "lighting")]
pub mod lighting;
#[cfg(doc)]
pub mod measured;
mod moments;
mod part;
pub mod plan;
pub mod points;
pub mod run;
mod tail;
pub mod technique;
mod vectors;
pub mod weighting;

pub use error::{ArgumentError, EstimateError};
pub use estimate::{Estimate, Interval, Largest, TechniqueSummary};
pub use estimator::{
    Controls, Estimator, Fit, MultiSample, OnFault, OneSample, OptimalEstimate, OptimalMis, Sample,
};
pub use integrand::{Integrand, LnValue, Value};
pub use plan::{Integral, Plan, integrate};
pub use run::{
    Cancel, CheckpointError, Doubt, Norm, Progress, Report, RoundSummary, Run, RunError, RunFault,
    Status, Stop, Tallied, Tally, Target,
};
pub use technique::{InverseCdf, Technique};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
