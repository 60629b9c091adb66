//! The lighting integral: closed forms, laws, extremes, occlusion, and Veach's figure as a table.

#[path = "../common/mod.rs"]
mod common;

mod bsdfs;
mod closed_forms;
mod extremes;
mod interface;
mod laws;
mod occlusion;
mod support;
mod veach;
