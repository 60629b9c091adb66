//! The lighting integral: closed forms, laws, extremes, occlusion, and Veach's figure as a table.
#![allow(clippy::unwrap_used, clippy::expect_used)] // the helpers of tests fail as tests do
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // numbers of cells

#[path = "../common/mod.rs"]
mod common;

#[allow(dead_code)] // every test binary uses its own part of it
#[path = "../common/ensemble.rs"]
mod ensemble;

mod bsdfs;
mod closed_forms;
mod extremes;
mod ggx;
mod interface;
mod laws;
mod occlusion;
mod point_lights;
mod render;
mod support;
mod veach;
