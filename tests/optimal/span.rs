//! Integrands that are combinations of the pdfs.

use mis::technique::{Linear, Normal, Product, ProductVec, Uniform, UniformBox};
use mis::{Fit, LnValue, OptimalMis, Technique};

use crate::ensembles::CROSS_FIT;

fn ramps() -> (Uniform, Linear) {
    (Uniform::unit(), Linear::new(0.0, 1.0, 0.0, 2.0).unwrap())
}

#[test]
fn values_are_exact() {
    let (flat, ramp) = ramps();
    for fit in [Fit::Direct, CROSS_FIT] {
        for n in [50, 51, 1000] {
            let mis = OptimalMis::new(&[(&flat, n), (&ramp, n)]).unwrap().fit(fit).unwrap();
            for (a, b) in [(3.0, 4.0), (-3.0, 10.0), (1.0, -1.5), (0.0, 1.0), (1.0, 0.0)] {
                for scale in [1.0, 1e-200, 1e200, 1e-290, 1e290] {
                    let f = |x: &f64| scale * (a + b * x);
                    let estimate = mis.estimate(&f, n).unwrap();
                    let exact = scale * (a + 0.5 * b);
                    let off = (estimate.value() / exact - 1.0).abs();
                    assert!(off < 1e-12, "{fit:?} {n} {a} {b} {scale}: {off}");
                    let error = estimate.standard_error().unwrap() / exact.abs();
                    assert!(error < 1e-12, "{fit:?} {n} {a} {b} {scale}: {error}");
                    assert_eq!(estimate.uncontrolled(), 0);
                }
            }
        }
    }
}

/// Densities for what is positive and for what is negative of f: no variance is left.
#[test]
fn changing_signs_are_no_obstacle() {
    let (left, right) = (Normal::new(-1.0, 1.0).unwrap(), Normal::new(1.5, 0.7).unwrap());
    let f = |x: &f64| 2.0 * left.pdf(x) - 3.0 * right.pdf(x);
    for fit in [Fit::Direct, CROSS_FIT] {
        let mis = OptimalMis::new(&[(&left, 60), (&right, 60)]).unwrap().fit(fit).unwrap();
        let estimate = mis.estimate(&f, 5).unwrap();
        assert!((estimate.value() + 1.0).abs() < 1e-12, "{fit:?}: {estimate}");
    }
}

#[test]
fn every_component_has_its_own_coefficients() {
    let (flat, ramp) = ramps();
    let f = |x: &f64| [1.0 + x, 1e200 * (2.0 - 3.0 * x), 1e-200 * x, x.exp()];
    for fit in [Fit::Direct, CROSS_FIT, Fit::Progressive] {
        let mis = OptimalMis::new(&[(&flat, 100), (&ramp, 100)]).unwrap().fit(fit).unwrap();
        let all = mis.estimate(&f, 5).unwrap();
        assert_eq!(all.controls().coefficients().len(), 4);
        for c in 0..4 {
            // The blocks of one component are the same, whatever the others.
            let one = mis.estimate(&|x: &f64| f(x)[c], 5).unwrap();
            let (value, error) = (all.value()[c], all.standard_error()[c].unwrap());
            assert!((value / one.value() - 1.0).abs() < 1e-14, "{fit:?} {c}: {value} {one}");
            let other = one.standard_error().unwrap();
            assert!((error - other).abs() <= 1e-9 * other + 1e-15 * value.abs(), "{fit:?} {c}");
            let [beta, expected] =
                [&all.controls().coefficients()[c], &one.controls().coefficients()[0]];
            assert!(
                (beta[1] / expected[1] - 1.0).abs() < 1e-12,
                "{fit:?} {c}: {beta:?} {expected:?}"
            );
            if c < 3 && fit != Fit::Progressive {
                let exact = [1.5, 0.5e200, 0.5e-200][c];
                assert!((value / exact - 1.0).abs() < 1e-12, "{fit:?} {c}: {value}");
            }
        }
    }
}

/// Densities of 1000 coordinates, which are 0 in f64, and a combination of them as a logarithm.
#[test]
fn logarithms_are_as_good() {
    let one = ProductVec::new(vec![Normal::new(0.0, 10.0).unwrap(); 1000]).unwrap();
    let mut means = vec![Normal::new(0.0, 10.0).unwrap(); 1000];
    means[0] = Normal::new(8.0, 10.0).unwrap();
    let other = ProductVec::new(means).unwrap();
    let f = |x: &Vec<f64>| {
        let (a, b) = (one.ln_pdf(x), other.ln_pdf(x));
        let most = a.max(b);
        LnValue::positive(most + (2.0 * (a - most).exp() + 3.0 * (b - most).exp()).ln())
    };
    for fit in [Fit::Direct, CROSS_FIT] {
        let mis = OptimalMis::new(&[(&one, 60), (&other, 60)]).unwrap().fit(fit).unwrap();
        let estimate = mis.estimate(&f, 1).unwrap();
        assert_eq!((estimate.rank(), estimate.uncontrolled()), (1, 0));
        // A logarithm of -3000 has an error of 5e-13, and so have quotients of densities.
        assert!(
            (estimate.value() / 5.0 - 1.0).abs() < 1e-11,
            "{fit:?}: {:e}",
            estimate.value() - 5.0
        );
    }
}

#[test]
fn products_in_five_dimensions() {
    let cube = UniformBox::uniform([0.0; 5], [1.0; 5]).unwrap();
    let sloped = |a, b| Product::new([Linear::new(0.0, 1.0, a, b).unwrap(); 5]).unwrap();
    let (up, down) = (sloped(0.0, 2.0), sloped(2.0, 1.0));
    let f = |x: &[f64; 5]| 2.0 * cube.pdf(x) - up.pdf(x) + 0.5 * down.pdf(x);
    for fit in [Fit::Direct, CROSS_FIT] {
        let list: [(&dyn Technique<Point = [f64; 5]>, u64); 3] =
            [(&cube, 70), (&up, 50), (&down, 60)];
        let estimate = OptimalMis::new(&list).unwrap().fit(fit).unwrap().estimate(&f, 1).unwrap();
        assert!((estimate.value() / 1.5 - 1.0).abs() < 1e-12, "{fit:?}: {estimate}");
    }
}
