//! Plans: what they predict, what they recommend, and that they are what they say.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

#[cfg(feature = "lighting")]
mod lit;
mod measure;
mod predictions;
mod problems;
