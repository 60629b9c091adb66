//! Every technique, in every shape, against the laws.
//!
//! `cargo test --test laws` uses 2e4 samples a technique; the battery at 1e6 is
//! `cargo test --release --test laws -- --ignored`.

#![allow(clippy::unwrap_used)] // the helpers of tests fail as tests do

#[path = "../common/mod.rs"]
mod common;

use mis::InverseCdf;
use mis::check::Options;

/// The options of this crate's own techniques: each statistical law at 1e-5.
pub(crate) fn strict() -> Options {
    Options::strict().false_alarms(2e-5)
}

/// Every law of a density on the line, with `n` samples in the statistical ones.
pub(crate) fn check(p: &dyn InverseCdf, n: usize, options: &Options) {
    let report = mis::check::inverse_cdf(p, &options.clone().samples(n));
    assert!(report.passed(), "{report}");
    batch::check(p, n / 10);
}

/// One line a technique: a name, the technique, and the options that differ from the strict ones.
macro_rules! laws {
    ($($name:ident: $technique:expr $(, $option:ident: $value:expr)*;)*) => {$(
        mod $name {
            use super::*;

            fn options() -> mis::check::Options {
                crate::strict()$(.$option($value))*
            }

            #[test]
            fn laws() {
                crate::check(&$technique.unwrap(), 20_000, &options());
            }

            #[test]
            #[ignore = "1e6 samples: run in release"]
            fn battery() {
                crate::check(&$technique.unwrap(), 1_000_000, &options());
            }
        }
    )*};
}

mod antithetic;
mod batch;
mod closed_forms;
mod golden;
mod points;
mod random;
mod sobol;
mod statrs_bounds;
mod stratified;
mod wrappers;
