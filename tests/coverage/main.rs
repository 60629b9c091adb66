//! Intervals cover at their level; runs say when theirs do not.
#![allow(clippy::unwrap_used)] // also in what the tests share

#[allow(dead_code)] // every test binary uses its own part of it
#[path = "../common/ensemble.rs"]
mod ensemble;

mod dependent;
mod estimates;
mod measure;
mod replicates;
mod runs;
#[allow(dead_code)] // the bench of the same name uses the rest
mod suite;
