//! Wrong input: every error names the argument, its value, and the rule.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use mis::points::Replay;
use mis::technique::{
    Cauchy, Exponential, Linear, Mixture, Normal, PiecewiseConstant, PowerLaw, ProductVec,
    TruncatedNormal, Uniform,
};
use mis::weighting::{Constant, Cutoff, Power, VarianceAware};
use mis::{ArgumentError, EstimateError, Estimator, MultiSample, OneSample, Technique};

fn unit() -> Uniform {
    Uniform::unit()
}

/// The error's four parts, and that its text has them all.
#[track_caller]
fn assert_names<T>(result: Result<T, ArgumentError>, owner: &str, argument: &str, value: &str) {
    let Err(error) = result else { panic!("accepted") };
    assert_eq!((error.owner(), error.argument(), error.value()), (owner, argument, value));
    let text = error.to_string();
    for part in [owner, argument, value, error.rule()] {
        assert!(!part.is_empty() && text.contains(part), "{text}");
    }
}

#[test]
fn no_techniques() {
    assert_names(MultiSample::<f64>::new(&[]), "MultiSample", "techniques", "[]");
    assert_names(OneSample::<f64>::new(&[], 10), "OneSample", "techniques", "[]");
}

#[test]
fn no_samples() {
    let p = unit();
    assert_names(MultiSample::new(&[(&p, 0)]), "MultiSample", "samples", "[0]");
    assert_names(MultiSample::new(&[(&p, 0), (&p, 0)]), "MultiSample", "samples", "[0, 0]");
    assert_names(OneSample::new(&[(&p, 1.0)], 0), "OneSample", "samples", "0");
    // A single sample is an estimate, whose error is unknown.
    let one = MultiSample::new(&[(&p, 1)]).unwrap().estimate(&|x: &f64| *x, 1).unwrap();
    assert_eq!(one.standard_error(), None);
}

#[test]
fn probabilities_that_are_none() {
    let p = unit();
    let new = |a: f64, b: f64| OneSample::new(&[(&p, a), (&p, b)], 10);
    assert_names(new(0.5, 0.25), "OneSample", "probabilities", "[0.5, 0.25]");
    assert_names(new(0.0, 0.0), "OneSample", "probabilities", "[0.0, 0.0]");
    assert_names(new(1.5, -0.5), "OneSample", "probabilities[1]", "-0.5");
    assert_names(new(1.0, f64::NAN), "OneSample", "probabilities[1]", "NaN");
    assert_names(new(f64::INFINITY, 0.0), "OneSample", "probabilities[0]", "inf");
    // Rounding is no error.
    let thirds: Vec<(&dyn Technique<Point = f64>, f64)> = vec![(&p, 0.1); 10];
    assert!(OneSample::new(&thirds, 1).is_ok());
}

#[test]
fn bounds_that_are_none() {
    assert_names(Uniform::new(1.0, 0.0), "Uniform", "b", "0.0");
    assert_names(Uniform::new(1.0, 1.0), "Uniform", "b", "1.0");
    assert_names(Uniform::new(f64::NAN, 1.0), "Uniform", "a", "NaN");
    assert_names(Uniform::new(0.0, f64::INFINITY), "Uniform", "b", "inf");
    assert_names(Uniform::new(-1e308, 1e308), "Uniform", "b - a", "inf");
    assert_names(Uniform::new(0.0, 1e-310), "Uniform", "b - a", "1e-310");
}

#[test]
fn parameters_that_are_nan() {
    let nan = f64::NAN;
    assert!(Linear::new(0.0, 1.0, nan, 1.0).is_err());
    assert!(Exponential::new(nan, 0.0, 1.0).is_err());
    assert!(PowerLaw::new(nan, 0.0, 1.0).is_err());
    assert!(PowerLaw::new(-1.0, 0.0, 1.0).is_err());
    assert!(Normal::new(nan, 1.0).is_err());
    assert!(Normal::new(0.0, -1.0).is_err());
    assert!(TruncatedNormal::new(0.0, 1.0, 1.0, nan).is_err());
    assert!(Cauchy::new(0.0, nan).is_err());
    assert!(PiecewiseConstant::new(&[0.0, 1.0, nan], &[1.0, 1.0]).is_err());
    assert_names(Power::new(nan), "Power", "beta", "NaN");
    assert_names(Power::new(-1.0), "Power", "beta", "-1.0");
    assert_names(Cutoff::new(nan), "Cutoff", "a", "NaN");
    assert_names(Cutoff::new(1.5), "Cutoff", "a", "1.5");
}

#[test]
fn constant_weights_that_do_not_fit() {
    let p = unit();
    assert_names(Constant::new([0.5, 0.25]), "Constant", "weights", "[0.5, 0.25]");
    assert_names(Constant::new([1.5, -0.5]), "Constant", "weights[1]", "-0.5");
    assert_names(Constant::new([f64::NAN, 1.0]), "Constant", "weights[0]", "NaN");
    let three = Constant::new([0.25, 0.25, 0.5]).unwrap();
    let mis = || MultiSample::new(&[(&p, 1), (&p, 0)]).unwrap();
    assert_names(mis().weighting(three), "Constant", "weights", "[0.25, 0.25, 0.5]");
    let half = Constant::new([0.5, 0.5]).unwrap();
    assert_names(mis().weighting(half), "Constant", "weights[1]", "0.5");
}

#[test]
fn variance_aware_factors_that_do_not_fit() {
    let owner = "VarianceAware";
    for (bad, value) in [(0.0, "0.0"), (-1.0, "-1.0"), (f64::NAN, "NaN"), (f64::INFINITY, "inf")] {
        assert_names(VarianceAware::new([1.0, bad]), owner, "factors[1]", value);
    }
    assert_names(VarianceAware::new([1e-101, 1e100]), owner, "factors[0]", "1e-101");
    assert_names(VarianceAware::new([f64::MAX, 1.0]), owner, "factors[1]", "1.0");
    let p = unit();
    let mis = || MultiSample::new(&[(&p, 1), (&p, 0)]).unwrap();
    for (factors, count) in [(vec![], "0"), (vec![1.0], "1"), (vec![1.0; 3], "3")] {
        let weighting = VarianceAware::new(factors).unwrap();
        assert_names(mis().weighting(weighting), owner, "number of factors", count);
    }
    assert!(mis().weighting(VarianceAware::new([2.0, 1e6]).unwrap()).is_ok());
}

#[test]
fn dimensions_that_do_not_match() {
    let plane = ProductVec::new(vec![unit(); 2]).unwrap();
    let space = ProductVec::new(vec![unit(); 3]).unwrap();
    assert_names(
        MultiSample::new(&[(&plane, 1), (&space, 1)]),
        "MultiSample",
        "techniques[1].point_len()",
        "3",
    );
    assert_names(
        OneSample::new(&[(&space, 0.5), (&plane, 0.5)], 1),
        "OneSample",
        "techniques[1].point_len()",
        "2",
    );
    assert!(ProductVec::<Uniform>::new(vec![]).is_err());
    assert!(ProductVec::uniform(&[0.0, 0.0], &[1.0]).is_err());
    assert!(PiecewiseConstant::new(&[0.0, 1.0], &[1.0, 1.0]).is_err());
}

#[test]
fn a_technique_that_uses_no_numbers_or_too_many() {
    struct Using(usize);
    impl Technique for Using {
        type Point = f64;
        fn dimension(&self) -> usize {
            self.0
        }
        fn sample(&self, _: &[f64]) -> f64 {
            0.0
        }
        fn pdf(&self, _: &f64) -> f64 {
            1.0
        }
    }
    for (numbers, text) in [(0, "0"), (1 << 55, "36028797018963968")] {
        let p = Using(numbers);
        let argument = "techniques[0].dimension()";
        assert_names(MultiSample::new(&[(&p, 1)]), "MultiSample", argument, text);
        assert_names(OneSample::new(&[(&p, 1.0)], 1), "OneSample", argument, text);
    }
    let widest = Mixture::new(vec![(Using(usize::MAX), 1.0)]).unwrap();
    assert!(MultiSample::new(&[(&widest, 1)]).is_err());
}

#[test]
fn a_replay_that_runs_out() {
    let p = unit();
    let f = |x: &f64| *x;
    let points = Replay::new([vec![0.1, 0.2, 0.3], vec![0.4, 0.5]]).unwrap();
    let mis = MultiSample::new(&[(&p, 3), (&p, 3)]).unwrap();
    let error = mis.estimate_from(&f, &points).unwrap_err();
    let EstimateError::Points(exhausted) = &error else { panic!("{error}") };
    assert_eq!((exhausted.stream, exhausted.sample, exhausted.available), (1, 2, 2));
    let text = error.to_string();
    assert!(text.contains("2 canonical numbers in stream 1"), "{text}");
    assert!(text.contains("sample 2 of dimension 1"), "{text}");
    // A technique without a stream.
    let lone = Replay::new([vec![0.1; 3]]).unwrap();
    assert!(mis.estimate_from(&f, &lone).is_err());
    assert!(OneSample::new(&[(&p, 1.0)], 2).unwrap().estimate_from(&f, &lone).is_err());
}

#[test]
fn a_level_that_is_none() {
    let p = unit();
    let estimate = MultiSample::new(&[(&p, 10)]).unwrap().estimate(&|x: &f64| *x, 1).unwrap();
    for (level, value) in
        [(0.0, "0.0"), (1.0, "1.0"), (95.0, "95.0"), (-0.5, "-0.5"), (f64::NAN, "NaN")]
    {
        assert_names(estimate.interval(level), "Estimate::interval", "level", value);
        assert_names(estimate.interval_t(level), "Estimate::interval_t", "level", value);
        let within = estimate.interval_within(level, [-1e9, 1e9]);
        assert_names(within, "Estimate::interval_within", "level", value);
    }
    assert!(estimate.interval(1.0 - 1e-16).is_ok());
    let constant = MultiSample::new(&[(&p, 10)]).unwrap().estimate(&|_: &f64| 2.0, 1).unwrap();
    let interval = constant.interval(1.0 - 1e-16).unwrap();
    assert_eq!((interval.lower, interval.upper), (2.0, 2.0));
}
