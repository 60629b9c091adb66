//! Every technique, in every shape, against the laws.
//!
//! `cargo test --test laws` uses 1e5 samples a technique; the battery at 1e6 is
//! `cargo test --release --test laws -- --ignored`.

#[path = "../common/mod.rs"]
mod common;

/// One line a technique: a name, the technique, and the options that differ from the default.
macro_rules! laws {
    ($($name:ident: $technique:expr $(, $field:ident: $value:expr)*;)*) => {$(
        mod $name {
            use super::*;

            fn options() -> LawOptions {
                LawOptions { $($field: $value,)* ..LawOptions::default() }
            }

            #[test]
            fn laws() {
                check(&$technique.unwrap(), 100_000, &options());
            }

            #[test]
            #[ignore = "1e6 samples: run in release"]
            fn battery() {
                check(&$technique.unwrap(), 1_000_000, &options());
            }
        }
    )*};
}

mod closed_forms;
mod golden;
mod points;
mod random;
mod statrs_bounds;
mod wrappers;
