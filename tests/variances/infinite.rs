//! Infinite variances.

use std::f64::consts::PI;

use mis::points::Replay;
use mis::{Estimator, MultiSample, Technique};

use crate::ensemble::Any;
use crate::example::Example;
use crate::examples::{ENDS, example_d, example_e, normal, root};

/// The variance times n that a run reports on the midpoints of n equal cells of ξ: the integral
/// that is the variance, resolved to 1 / n in ξ.
fn by_midpoints(example: &Example, weighting: &Any, n: u32) -> f64 {
    let xi: Vec<f64> = (0..n).map(|j| (f64::from(j) + 0.5) / f64::from(n)).collect();
    let points = Replay::new(vec![xi; example.techniques.len()]).unwrap();
    let given: Vec<(&dyn Technique<Point = f64>, u64)> =
        example.techniques.iter().map(|t| (&**t, u64::from(n))).collect();
    let mis = MultiSample::new(&given).unwrap().weighting(weighting).unwrap();
    let estimate = mis.estimate_from(&|x: &f64| (example.f)(*x), &points).unwrap();
    f64::from(n) * estimate.variance().unwrap()
}

/// Near its end, ∫ f²/p diverges like a ∫ dξ/ξ: sixteen times the resolution adds a ln 16 to the
/// variance, from any resolution on, so no number bounds it. The balance heuristic has settled.
#[test]
fn constant_weights_of_an_infinite_variance_never_settle() {
    let at_end = |f: fn(f64) -> f64| 0.5 * f(PI).powi(2) * 2.0 * (0.5 * ENDS[0]).cos().powi(2);
    let (root, d, e) = (root(), example_d(), example_e());
    for (example, weights, a) in [
        (&root, vec![0.5, 0.5], 0.25),
        (&root, vec![0.01, 0.99], 1e-4),
        (&d, vec![1.0 / 3.0; 3], at_end(d.f) / 9.0),
        (&e, vec![1.0 / 3.0; 3], at_end(e.f) / 9.0),
        (&e, vec![0.5, 0.4, 0.1], at_end(e.f) / 100.0),
    ] {
        let constant = Any::constant("constant", &weights);
        for n in [1 << 10, 1 << 12] {
            let growth =
                by_midpoints(example, &constant, 16 * n) - by_midpoints(example, &constant, n);
            let ratio = growth / (a * 16_f64.ln());
            // What is regular at the end is resolved to the order of √ξ.
            let rest = 3.0 / f64::from(n).sqrt();
            assert!((ratio - 1.0).abs() < rest, "{}, {weights:?}: {ratio}", example.name);
            let settled = by_midpoints(example, &Any::balance(), 16 * n)
                / by_midpoints(example, &Any::balance(), n);
            assert!((settled - 1.0).abs() < rest, "{}: {settled}", example.name);
        }
    }
}

/// With samples from a normal density half as wide, ∫ f²/p grows with the square root of the
/// resolution, logarithms aside.
#[test]
fn constant_weights_of_too_narrow_a_technique_never_settle() {
    let example = normal();
    let growth = |weighting: &Any, n: u32| {
        by_midpoints(&example, weighting, 16 * n) / by_midpoints(&example, weighting, n)
    };
    for n in [1 << 8, 1 << 12] {
        let constant = growth(&Any::equal(), n);
        assert!(constant > 2.0, "{constant}");
        let balance = growth(&Any::balance(), n);
        assert!((balance - 1.0).abs() < 0.01, "{balance}");
    }
}
