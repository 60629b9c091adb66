//! Runs: the same bits however they are driven, and what becomes of faults.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod bits;
mod common;
mod interruption;
mod kill;
mod schedules;
mod shards;
