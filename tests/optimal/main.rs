//! Optimal MIS: reference variances, spans, bias, intervals, and the traps of its regression.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a test fails by panicking; counts are far below 2^32"
)]

#[path = "../common/mod.rs"]
mod common;
#[allow(dead_code)] // every test binary uses its own part of it
#[path = "../common/ensemble.rs"]
mod ensemble;
#[allow(dead_code)]
#[path = "../variances/example.rs"]
mod example;
#[allow(dead_code)]
#[path = "../variances/examples.rs"]
mod examples;

mod balance;
mod cases;
mod coverage;
mod ensembles;
mod interface;
mod points;
mod reference;
mod span;
mod traps;
mod variates;
