//! Control variates with known integrals.

use std::f64::consts::E;

use mis::technique::{Linear, Uniform};
use mis::{Fit, OptimalEstimate, OptimalMis};

use crate::ensembles::{CROSS_FIT, FITS, Mean};

fn square(x: &f64) -> f64 {
    x * x
}

#[test]
fn variance_falls_to_that_of_the_residual() {
    const N: u64 = 500;
    let flat = Uniform::unit();
    // Var f - Cov(f, h)² / Var h, for f = e^x and h = x².
    let of_f = 0.5 * (E * E - 1.0) - (E - 1.0).powi(2);
    let covariance = E - 2.0 - (E - 1.0) / 3.0;
    let residual = of_f - covariance * covariance / (1.0 / 5.0 - 1.0 / 9.0);
    assert!(residual < 0.05 * of_f);
    for fit in FITS {
        let mis = OptimalMis::new(&[(&flat, N)]).unwrap().fit(fit).unwrap();
        let mis = mis.control_variates([(&square as _, 1.0 / 3.0)]).unwrap();
        let found: Vec<_> =
            (0..100).map(|seed| mis.estimate(&|x: &f64| x.exp(), seed).unwrap()).collect();
        let values = Mean::of(found.iter().map(OptimalEstimate::value));
        assert!(values.z(E - 1.0).abs() < 4.42 && values.error < 2e-3, "{fit:?}: {values:?}");
        if fit == Fit::Progressive {
            continue; // the first batch has no control
        }
        let n = N as f64;
        let reported = Mean::of(found.iter().map(|e| n * e.estimate().variance().unwrap()));
        let realised = Mean::of(found.iter().map(|e| n * (e.value() - (E - 1.0)).powi(2)));
        for v in [reported, realised] {
            let allowed = 4.42 * v.error + 4.0 / n * residual;
            assert!((v.mean - residual).abs() < allowed, "{fit:?}: {v:?} {residual}");
        }
        assert!(reported.error < 0.02 * residual && realised.error < 0.2 * residual);
    }
}

#[test]
fn nothing_is_left_of_combinations() {
    let (flat, ramp) = (Uniform::unit(), Linear::new(0.0, 1.0, 0.0, 2.0).unwrap());
    let h = |x: &f64| (7.0 * x).sin();
    let exact = (1.0 - 7.0_f64.cos()) / 7.0;
    for fit in [Fit::Direct, CROSS_FIT] {
        let mis = OptimalMis::new(&[(&flat, 60), (&ramp, 60)]).unwrap().fit(fit).unwrap();
        let mis = mis.control_variates([(&h as _, exact), (&square as _, 1.0 / 3.0)]).unwrap();
        let f = |x: &f64| 2.0 - 3.0 * x + 4.0 * h(x) + 0.5 * x * x;
        let found = mis.estimate(&f, 3).unwrap();
        let integral = 0.5 + 4.0 * exact + 1.0 / 6.0;
        assert!((found.value() / integral - 1.0).abs() < 1e-12, "{fit:?}: {found}");
        assert_eq!(found.rank(), 3);
        let [a, b] = found.variate_coefficients()[0][..] else { panic!("two") };
        assert!((a - 4.0).abs() < 1e-11 && (b - 0.5).abs() < 1e-11, "{fit:?}: {a} {b}");
    }
}

/// By β for each unit: the coefficients do not know.
#[test]
fn a_wrong_integral_moves_the_value() {
    let flat = Uniform::unit();
    for (fit, off) in FITS.into_iter().flat_map(|fit| [(fit, 0.1), (fit, -2.0)]) {
        let of = |theta: f64| {
            let mis = OptimalMis::new(&[(&flat, 500)]).unwrap().fit(fit).unwrap();
            let mis = mis.control_variates([(&square as _, theta)]).unwrap();
            mis.estimate(&|x: &f64| 3.0 * x * x - 1.0, 3).unwrap()
        };
        let (right, wrong) = (of(1.0 / 3.0), of(1.0 / 3.0 + off));
        // All but the first batch, where the fit is progressive.
        let controlled = 1.0 - right.uncontrolled() as f64 / 500.0;
        let moved = wrong.value() - right.value();
        assert!((moved - 3.0 * off * controlled).abs() < 1e-12, "{fit:?} {off}: {moved}");
    }
}

#[test]
fn what_depends_on_the_pdfs_is_left_out() {
    let (flat, ramp) = (Uniform::unit(), Linear::new(0.0, 1.0, 0.0, 2.0).unwrap());
    let f = |x: &f64| x.exp();
    let plain = OptimalMis::new(&[(&flat, 200), (&ramp, 200)]).unwrap();
    let plain = plain.estimate(&f, 1).unwrap();
    // 5x is in the span of the pdfs, a constant, too.
    let (line, constant) = (|x: &f64| 5.0 * x, |_: &f64| 3.0);
    let mis = OptimalMis::new(&[(&flat, 200), (&ramp, 200)]).unwrap();
    let mis = mis.control_variates([(&line as _, 2.5), (&constant as _, 3.0)]).unwrap();
    let found = mis.estimate(&f, 1).unwrap();
    assert_eq!(found.rank(), 1);
    assert!((found.value() / plain.value() - 1.0).abs() < 1e-13, "{found} {plain}");
}

#[test]
fn a_control_variate_that_is_not_finite_is_an_error() {
    let flat = Uniform::unit();
    let pole = |x: &f64| if *x < 0.5 { f64::INFINITY } else { 1.0 };
    let mis = OptimalMis::new(&[(&flat, 100)]).unwrap();
    let mis = mis.control_variates([(&square as _, 1.0 / 3.0), (&pole as _, 1.0)]).unwrap();
    let message = mis.estimate(&|x: &f64| *x, 1).unwrap_err().to_string();
    assert!(message.starts_with("control variate 1 is inf at sample"), "{message}");
}
