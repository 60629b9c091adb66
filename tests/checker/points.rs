//! Faults of techniques in several dimensions, and of references.

use std::f64::consts::TAU;

use mis::check::{self, Law, Options, Report, Verdict};
use mis::technique::{Normal, Technique, Uniform, canonical};

use crate::{Square, assert_broken, assert_size, square};

/// By quadrature, and by the reference's samples.
fn both(p: &Square, samples: usize) -> [Report; 2] {
    let options = Options::default().samples(samples);
    [true, false].map(|quadrature| {
        check::technique(p, &square(), |x| *x, &options.clone().quadrature(quadrature))
    })
}

#[test]
fn correlation_that_the_pdf_ignores() {
    // Both marginals are uniform; y follows x a little.
    let map = |[u, v]: [f64; 2]| [u, (v + 0.05 * (TAU * u).sin()).rem_euclid(1.0)];
    let right = Square { map, pdf: |_| 1.0 };
    for report in both(&right, 20_000) {
        assert!(report.passed(), "{report}");
    }
    // y is x in one of 20 samples.
    let map = |[u, v]: [f64; 2]| [u, if v < 0.05 { u } else { (v - 0.05) / 0.95 }];
    for report in both(&Square { map, pdf: |_| 1.0 }, 100_000) {
        assert_broken(&report, &[Law::JointChiSquared(0, 1)]);
        // χ² grows by n (0.05)² 9.
        assert_size(&report, Law::JointChiSquared(0, 1), 40.0, 0.5, " samples, ");
    }
}

#[test]
fn points_whose_pdf_is_scaled_or_of_another_shape() {
    for report in both(&Square { map: |x| x, pdf: |_| 1.05 }, 20_000) {
        assert_broken(&report, &[Law::Integral]);
        assert_size(&report, Law::Integral, 0.05, 1e-9, "integrates to 1.0500, 5.00 % too much");
    }
    for report in both(&Square { map: |x| x, pdf: |x| 1.0 + 0.2 * (x[0] - 0.5) }, 25_000) {
        assert!(!report.get(Law::ChiSquared(0)).unwrap().passed(), "{report}");
        assert!(!report.get(Law::Kolmogorov(0)).unwrap().passed(), "{report}");
        assert!(report.get(Law::ChiSquared(1)).unwrap().passed(), "{report}");
        assert!(report.get(Law::Integral).unwrap().passed(), "{report}");
    }
}

/// Quadrature must not be taken at its word where the density jumps.
#[test]
fn a_comb_is_right() {
    let map = |[u, v]: [f64; 2]| [((32.0 * u).floor() + 0.499 * (32.0 * u).fract()) / 32.0, v];
    let pdf = |x: &[f64; 2]| if (32.0 * x[0]).fract() < 0.499 { 1.0 / 0.499 } else { 0.0 };
    for report in both(&Square { map, pdf }, 20_000) {
        assert!(report.passed(), "{report}");
        assert!(report.get(Law::Integral).unwrap().allowed() > 1e-3, "{report}");
    }
}

#[test]
fn a_hole_in_two_dimensions() {
    // Where both are below a half, only those with x < y: samples move, the pdf does not.
    let map = |[u, v]: [f64; 2]| if u < 0.1 && v < 0.1 { [u + 0.1, v] } else { [u, v] };
    for report in both(&Square { map, pdf: |_| 1.0 }, 50_000) {
        assert!(!report.get(Law::JointChiSquared(0, 1)).unwrap().passed(), "{report}");
        assert!(!report.get(Law::ChiSquared(0)).unwrap().passed(), "{report}");
        assert!(report.get(Law::ChiSquared(1)).unwrap().passed(), "{report}");
    }
}

#[test]
fn dimensions_that_are_none() {
    struct Flat(usize);
    impl Technique for Flat {
        type Point = Vec<f64>;
        fn dimension(&self) -> usize {
            self.0
        }
        fn sample(&self, xi: &[f64]) -> Vec<f64> {
            xi.iter().copied().filter(|u| *u > 0.1).collect()
        }
        fn pdf(&self, _: &Vec<f64>) -> f64 {
            1.0
        }
    }
    for dimension in [0, usize::MAX] {
        let p = Flat(dimension);
        let report = check::technique(&p, &p, Vec::clone, &Options::default());
        assert_size(&report, Law::Dimension, 1.0, 0.0, &format!("dimension() = {dimension}"));
    }
    // As many coordinates as it likes.
    let report = check::technique(&Flat(2), &Flat(2), Vec::clone, &Options::default());
    assert!(!report.get(Law::Dimension).unwrap().passed(), "{report}");
    let nothing = |_: &Vec<f64>| -> [f64; 0] { [] };
    assert!(!check::technique(&Flat(2), &Flat(2), nothing, &Options::default()).passed());
}

#[test]
fn samples_that_change_from_call_to_call() {
    use std::sync::atomic::{AtomicU64, Ordering};
    struct Restless(AtomicU64);
    impl Technique for Restless {
        type Point = f64;
        fn dimension(&self) -> usize {
            1
        }
        fn sample(&self, xi: &[f64]) -> f64 {
            let k = self.0.fetch_add(1, Ordering::Relaxed);
            (canonical(xi, 0) + k as f64 * 1e-3).fract()
        }
        fn pdf(&self, _: &f64) -> f64 {
            1.0
        }
    }
    let p = Restless(AtomicU64::new(0));
    let report = check::technique(&p, &Uniform::unit(), |x| [*x], &Options::default());
    assert!(!report.get(Law::Pure).unwrap().passed(), "{report}");
    assert!(!report.get(Law::Batch).unwrap().passed(), "{report}");
}

#[test]
fn a_reference_that_does_not_suffice() {
    let narrow = Normal::new(0.5, 1e-5).unwrap();
    let wide = Uniform::new(-1.0, 2.0).unwrap();
    let options = Options::default();
    let report = check::technique(&narrow, &wide, |x| [*x], &options);
    assert_eq!(report.get(Law::Reference).unwrap().verdict(), Verdict::Unresolved, "{report}");
    assert!(report.failures().all(|f| f.verdict() == Verdict::Unresolved), "{report}");
    assert_eq!(report.get(Law::Integral).unwrap().verdict(), Verdict::Unresolved, "{report}");
    assert!(!report.passed());
    // Half of the samples are where the reference has no density.
    let half = Uniform::new(0.5, 1.0).unwrap();
    let report = check::technique(&Uniform::unit(), &half, |x| [*x], &options);
    // Of 1e5 samples and a pilot's 1e4.
    assert_size(&report, Law::Reference, 55_000.0, 0.02, "the reference has the density 0.0");
    // Few samples say little, and nothing panics.
    for samples in [0, 1, 7, 50] {
        let report = check::technique(&half, &wide, |x| [*x], &options.clone().samples(samples));
        assert!(!report.passed(), "{report}");
        let _ = check::inverse_cdf(&half, &options.clone().samples(samples)).to_string();
    }
}
