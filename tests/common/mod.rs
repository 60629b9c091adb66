//! What the integration tests share.
#![allow(dead_code)] // every test binary uses its own part of it

pub(crate) mod laws;
pub(crate) mod point_laws;
pub(crate) mod quadrature;
