//! Estimates are unbiased and their error bars calibrated: integrands of known integral, each
//! weighting, both estimators, from ensembles of fixed seeds.
//!
//! Of R estimates of n samples each: the mean is within 4.42 of its standard errors of the
//! integral, and that standard error is small; the mean of the reported variances over the variance
//! of the estimates is 1 to within 4.42 √((κ − 1)/R), κ being the kurtosis of the estimates, 3 if
//! they are normal, at least.
#![allow(clippy::unwrap_used)] // also in what the tests share

mod battery;
#[allow(dead_code)] // every test binary uses its own part of it
#[path = "../common/ensemble.rs"]
mod ensemble;
mod own_points;
mod products;
mod rough;
mod smooth;
mod unbounded;

use battery::{FULL, QUICK};

/// A test of each group of integrands, and one of its full ensembles.
macro_rules! batteries {
    ($($module:ident::$group:ident $full:ident),*) => {$(
        #[test]
        fn $group() {
            $module::$group(QUICK).report(stringify!($group));
        }

        #[test]
        #[ignore = "two minutes in all, in release"]
        fn $full() {
            $module::$group(FULL).report(stringify!($group));
        }
    )*};
}

batteries! {
    smooth::smooth smooth_full,
    rough::rough rough_full,
    unbounded::unbounded unbounded_full,
    products::products products_full,
    products::thousand_dimensions thousand_dimensions_full,
    own_points::own_points own_points_full
}
