//! Runs: the same bits however they are driven, and what becomes of faults.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod bits;
mod checkpoints;
mod common;
mod damage;
mod faults;
mod identity;
mod interruption;
mod judgement;
mod kill;
#[cfg(feature = "parallel")]
mod pools;
mod printed;
mod progress;
mod replicates;
mod schedules;
mod shards;
