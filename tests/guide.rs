//! Figures of the guide that no other test has.

#![allow(clippy::unwrap_used)] // the helpers of tests fail as tests do

use mis::points::{PointSource, Random};
use mis::technique::{Linear, Uniform};
use mis::weighting::Constant;
use mis::{Estimator, MultiSample, Technique};

/// 10 on \[0, 0.1\], 0 elsewhere: the integral is 1.
fn spike(x: &f64) -> f64 {
    if *x < 0.1 { 10.0 } else { 0.0 }
}

/// The mean of the estimates that weights from the inverse of the same samples' variances give.
#[test]
fn weights_from_the_same_samples_are_biased() {
    let (flat, ramp) = (Uniform::unit(), Linear::new(0.0, 1.0, 0.0, 2.0).unwrap());
    let techniques: [&dyn Technique<Point = f64>; 2] = [&flat, &ramp];
    let seeds = 4000;
    let mut sum = 0.0;
    for seed in 0..seeds {
        let parts = techniques.iter().zip([seed, seed + seeds]).map(|(technique, seed)| {
            let alone = MultiSample::new(&[(*technique, 32)]).unwrap();
            let estimate = alone.estimate(&spike, seed).unwrap();
            // Without a sample on the spike, the variance looks like 0.
            (estimate.value(), estimate.variance().unwrap_or(0.0).max(1e-12))
        });
        let (top, bottom) = parts.fold((0.0, 0.0), |(a, b), (f, v)| (a + f / v, b + 1.0 / v));
        sum += top / bottom;
    }
    let mean = sum / seeds as f64;
    assert!((mean - 0.29).abs() < 0.02, "{mean}");
    // Weights that are fixed are not biased.
    let equal = MultiSample::new(&[(&flat, 32_000), (&ramp, 32_000)]).unwrap();
    let estimate = equal.weighting(Constant::equal()).unwrap().estimate(&spike, 1).unwrap();
    assert!((estimate.value() - 1.0).abs() < 5.0 * estimate.standard_error().unwrap());
}

/// How often 1.96 standard errors hold the probability 0.1, if a run ends as soon as they are within
/// `tolerance`, looked at after every sample from the tenth on.
fn covered(tolerance: f64, seeds: u64) -> f64 {
    let mut hits = 0;
    for seed in 0..seeds {
        let mut xi = vec![0.0; 20_000];
        Random::new(seed).fill(0, 0, 1, &mut xi).unwrap();
        let mut inside = 0.0;
        for (n, u) in (1..).zip(&xi) {
            inside += f64::from(u8::from(*u < 0.1));
            let n = f64::from(n);
            let mean = inside / n;
            let error = 1.96 * (mean * (1.0 - mean) / (n - 1.0)).sqrt();
            if n >= 10.0 && error <= tolerance {
                hits += u64::from((mean - 0.1).abs() <= error);
                break;
            }
        }
    }
    hits as f64 / seeds as f64
}

#[test]
fn stopping_at_the_first_small_error_selects_errors_that_are_too_small() {
    let rate = covered(0.02, 2000);
    println!("{rate}");
    assert!((rate - 0.61).abs() < 0.04, "{rate}");
}
