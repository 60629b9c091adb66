//! What the user's own code can do wrong, and what becomes of it.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use mis::points::Replay;
use mis::technique::{Normal, ProductVec, Uniform, canonical};
use mis::weighting::{Constant, Maximum};
use mis::{
    EstimateError, Estimator, Integrand, LnValue, MultiSample, OnFault, OneSample, Technique,
};

fn uniform(a: f64, b: f64) -> Uniform {
    Uniform::new(a, b).unwrap()
}

/// A technique of given functions, right or wrong.
struct Raw<S, P> {
    sample: S,
    pdf: P,
}

impl<S: Fn(f64) -> f64 + Sync, P: Fn(f64) -> f64 + Sync> Technique for Raw<S, P> {
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        (self.sample)(canonical(xi, 0))
    }

    fn pdf(&self, x: &f64) -> f64 {
        (self.pdf)(*x)
    }
}

fn fault<F: Integrand<f64>>(p: &impl Technique<Point = f64>, f: &F) -> EstimateError {
    MultiSample::new(&[(p, 3)]).unwrap().estimate(f, 1).map(|_| ()).unwrap_err()
}

#[test]
fn a_value_that_is_not_finite_is_an_error_that_names_it() {
    let p = uniform(0.0, 1.0);
    let points = Replay::new([vec![0.25, 0.5, 0.75]]).unwrap();
    let mis = MultiSample::new(&[(&p, 3)]).unwrap();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let f = |x: &f64| if *x == 0.5 { bad } else { 1.0 };
        let error = mis.estimate_from(&f, &points).unwrap_err();
        let EstimateError::Value { technique: 0, sample: 1, point, value } = &error else {
            panic!("{error}")
        };
        assert_eq!((point.as_str(), value), ("0.5", &format!("{bad:?}")));
        let text = error.to_string();
        assert!(text.contains("sample 1") && text.contains("x = 0.5"), "{text}");
        // A component of a vector, and a logarithm.
        assert!(mis.estimate_from(&|x: &f64| [1.0, f(x)], &points).is_err());
        if bad != f64::NEG_INFINITY {
            assert!(mis.estimate_from(&|x: &f64| LnValue::positive(f(x)), &points).is_err());
        }
        // A weight of 0 does not hide it.
        let dense = uniform(0.0, 0.6);
        let never = MultiSample::new(&[(&p, 3), (&dense, 9)]).unwrap();
        assert!(never.weighting(Maximum).unwrap().estimate(&|_: &f64| bad, 1).is_err());
    }
}

#[test]
fn counted_faults_contribute_nothing_and_show() {
    let p = uniform(0.0, 1.0);
    let mis =
        MultiSample::new(&[(&p, 1000)]).unwrap().on_fault(OnFault::count_as_zero(1.0).unwrap());
    let f = |x: &f64| if *x < 0.5 { f64::NAN } else { 1.0 };
    let estimate = mis.estimate(&f, 1).unwrap();
    assert_eq!(estimate.non_finite(), estimate.zero());
    assert_eq!(estimate.value(), 1.0 - estimate.non_finite() as f64 / 1000.0);
    assert!((400..600).contains(&estimate.non_finite()));

    let gap = Raw { sample: |u| u, pdf: |x| if x < 0.5 { 0.0 } else { 1.0 } };
    let mis =
        MultiSample::new(&[(&gap, 1000)]).unwrap().on_fault(OnFault::count_as_zero(1.0).unwrap());
    let estimate = mis.estimate(&|_: &f64| 1.0, 1).unwrap();
    assert!((400..600).contains(&estimate.uncovered()));
    assert_eq!(estimate.value(), 1.0 - estimate.uncovered() as f64 / 1000.0);
    assert_eq!(estimate.non_finite(), 0);
}

#[test]
fn a_pdf_that_breaks_its_contract_at_its_own_sample_is_an_error() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let p = Raw { sample: |u| u, pdf: |_| bad };
        // Neither a zero integrand nor any weighting excuses it.
        for f in [0.0, 1.0] {
            let error = fault(&p, &|_: &f64| f);
            let EstimateError::Density { technique: 0, sampled_by: 0, sample: 0, pdf, .. } = error
            else {
                panic!("{error}")
            };
            assert!(pdf == bad || pdf.is_nan() && bad.is_nan());
        }
        let constant = MultiSample::new(&[(&p, 3)]).unwrap();
        let constant = constant.weighting(Constant::equal()).unwrap();
        assert!(constant.estimate(&|_: &f64| 1.0, 1).is_err());
        let one = OneSample::new(&[(&p, 1.0)], 3).unwrap().weighting(Maximum).unwrap();
        assert!(one.estimate(&|_: &f64| 1.0, 1).is_err());
    }
}

#[test]
fn a_contribution_beyond_the_range_is_an_error_not_an_infinity() {
    let error = fault(&Raw { sample: |u| u, pdf: |_| 1e-200 }, &|_: &f64| 1e200);
    assert!(matches!(error, EstimateError::Contribution { .. }), "{error}");
}

#[test]
fn a_sampler_that_disagrees_with_its_pdf_shows_in_the_densities() {
    // Under balance weights every pdf integrates to 1; one whose samples are 10 % too wide does
    // not.
    let wrong = |width: f64| Raw {
        sample: move |u: f64| if u < 0.5 { (2.0 * u).ln() } else { -(2.0 * (1.0 - u)).ln() },
        pdf: move |x: f64| 0.5 / width * (-x.abs() / width).exp(),
    };
    let other = Normal::new(0.0, 3.0).unwrap();
    let z = |width: f64| {
        let p = wrong(width);
        let mis = MultiSample::new(&[(&p, 25_000), (&other, 25_000)]).unwrap();
        let estimate = mis.estimate(&|x: &f64| p.pdf(x), 1).unwrap();
        (estimate.value() - 1.0) / estimate.standard_error().unwrap()
    };
    assert!(z(1.0).abs() < 4.0, "{}", z(1.0));
    assert!(z(0.9).abs() > 5.0 && z(1.1).abs() > 5.0, "{} {}", z(0.9), z(1.1));
}

/// A uniform technique with a batch method of its own.
struct Batch(fn(&[f64], &mut Vec<f64>));

impl Technique for Batch {
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        canonical(xi, 0)
    }

    fn pdf(&self, _: &f64) -> f64 {
        1.0
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<f64>) {
        (self.0)(xi, xs);
    }
}

/// A batch method that makes too few points is found out, not averaged over.
#[test]
fn a_short_batch_is_an_error() {
    let short = Batch(|xi, xs| {
        xs.clear();
        xs.extend(&xi[1..]);
    });
    let error = fault(&short, &|x: &f64| *x);
    assert_eq!(error, EstimateError::Batch { technique: 0, asked: 3, sampled: 2 });
    assert!(error.to_string().contains("made 2 points from numbers for 3"), "{error}");
}

/// One that appends would use the points of the first block for ever.
#[test]
fn a_batch_that_is_appended_is_an_error() {
    let appended = Batch(|xi, xs| xs.extend_from_slice(xi));
    let mis = MultiSample::new(&[(&appended, 5000)]).unwrap();
    let error = mis.estimate(&|x: &f64| *x, 1).unwrap_err();
    assert!(matches!(error, EstimateError::Batch { technique: 0, .. }), "{error}");
}

/// A pdf of 0 whose logarithm is NaN: a fault of the density, not of the contribution.
#[test]
fn a_logarithm_that_is_nan_is_a_fault_of_the_density() {
    struct NoLogarithm;
    impl Technique for NoLogarithm {
        type Point = f64;
        fn dimension(&self) -> usize {
            1
        }
        fn sample(&self, xi: &[f64]) -> f64 {
            canonical(xi, 0)
        }
        fn pdf(&self, _: &f64) -> f64 {
            0.0
        }
        fn ln_pdf(&self, _: &f64) -> f64 {
            f64::NAN
        }
    }
    let error = fault(&NoLogarithm, &|_: &f64| 1.0);
    assert!(matches!(error, EstimateError::Density { technique: 0, .. }), "{error}");
}

#[test]
fn a_long_point_is_cut_in_the_message() {
    let p = ProductVec::new(vec![uniform(0.0, 1.0); 1000]).unwrap();
    let mis = MultiSample::new(&[(&p, 1)]).unwrap();
    let error = mis.estimate(&|_: &Vec<f64>| f64::NAN, 1).unwrap_err();
    assert!(error.to_string().len() < 500, "{error}");
}
