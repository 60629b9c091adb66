//! Every technique, in every shape, against the laws.
//!
//! `cargo test --test laws` uses 1e5 samples a technique; the battery at 1e6 is
//! `cargo test --release --test laws -- --ignored`.

mod common;

use common::laws::{LawOptions, check};
use mis::technique::Uniform;

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

laws! {
    uniform: Uniform::new(-1.0, 3.0);
    uniform_unit: Some(Uniform::unit());
    uniform_tiny: Uniform::new(0.0, 1e-300);
    uniform_huge: Uniform::new(-8e307, 8e307);
    uniform_far: Uniform::new(1e9, 1e9 + 1.0);
    uniform_one_ulp: Uniform::new(1.0, 1.0 + f64::EPSILON), resolved: false;
}
