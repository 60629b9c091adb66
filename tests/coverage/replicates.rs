//! Sobol' points: how fast their error falls, and whether their intervals hold their level.

use std::f64::consts::{E, FRAC_PI_2};

use mis::points::Sobol;
use mis::technique::{FnTechnique, UniformBox};
use mis::weighting::{Constant, Power, Weighting};
use mis::{Estimate, Estimator, MultiSample, OneSample};

use super::measure::fixed;
use super::suite::suite;

/// From the seeds 0 up to `seeds`: the root of the mean squared error.
fn rms(integral: f64, seeds: u64, estimate: impl Fn(&Sobol) -> Estimate) -> f64 {
    let squares = (0..seeds).map(|seed| (estimate(&Sobol::new(seed)).value() - integral).powi(2));
    (squares.sum::<f64>() / seeds as f64).sqrt()
}

/// The power of n by which an error falls from 2^`few` to 2^`many` samples.
fn rate([few, many]: [u32; 2], rms: impl Fn(u64) -> f64) -> f64 {
    (rms(1 << few) / rms(1 << many)).log2() / f64::from(many - few)
}

/// The slides' example with so many samples in all.
fn sin_cos<W: Weighting>(n: u64, weighting: W, points: &Sobol) -> Estimate {
    let support = [0.0, FRAC_PI_2];
    let cosine = FnTechnique::new(support, f64::cos, f64::sin, f64::asin).unwrap();
    let inverse = |u: f64| 2.0 * (0.5 * u).sqrt().asin();
    let sine = FnTechnique::new(support, f64::sin, |x: f64| 1.0 - x.cos(), inverse).unwrap();
    let mis = MultiSample::new(&[(&cosine, n / 2), (&sine, n / 2)]).unwrap();
    let mis = mis.weighting(weighting).unwrap();
    mis.estimate_from(&|x: &f64| x.sin() * x.cos(), points).unwrap()
}

/// Π (1 + (e^x_d - e + 1) / 2) over the unit cube, which is 1.
fn product<const D: usize>(n: u64, points: &Sobol) -> Estimate {
    let cube = UniformBox::uniform([0.0; D], [1.0; D]).unwrap();
    let f = |x: &[f64; D]| x.iter().map(|x| 1.0 + 0.5 * (x.exp() - E + 1.0)).product::<f64>();
    MultiSample::new(&[(&cube, n)]).unwrap().estimate_from(&f, points).unwrap()
}

/// Of sin·cos under the balance heuristic, whose contributions are not smooth at the ends, and of
/// the others. Rates have a standard deviation of 0.14 / (many - few) with a hundred seeds.
fn assert_rates([few, many]: [u32; 2], seeds: u64, [rough, smooth]: [f64; 2]) {
    let span = [few, many];
    let balance =
        rate(span, |n| rms(0.5, seeds, |points| sin_cos(n, mis::weighting::Balance, points)));
    let power = rate(span, |n| rms(0.5, seeds, |points| sin_cos(n, Power::squared(), points)));
    let constant = rate(span, |n| rms(0.5, seeds, |points| sin_cos(n, Constant::equal(), points)));
    // Sixteen points in five dimensions are no more even than random ones; from 64 on they are.
    let later = [few + 2, many];
    let products = [
        rate(later, |n| rms(1.0, seeds, |points| product::<1>(n, points))),
        rate(later, |n| rms(1.0, seeds, |points| product::<2>(n, points))),
        rate(later, |n| rms(1.0, seeds, |points| product::<5>(n, points))),
    ];
    println!("balance {balance}, power {power}, constant {constant}, products {products:?}");
    assert!(balance >= rough && power >= rough && constant >= rough);
    assert!(products.iter().all(|rate| *rate >= smooth), "{products:?}");
}

#[test]
fn errors_fall_faster_than_those_of_random_points() {
    assert_rates([8, 13], 40, [1.1, 1.1]);
}

#[test]
#[ignore = "half a minute in release"]
fn errors_fall_as_stated() {
    assert_rates([8, 17], 200, [1.35, 1.2]);
}

/// What is 1 in the mean of the replicates is 1 in the estimate: no technique's points are those of
/// another, and the selection of one-sample weights has points of its own.
#[test]
fn one_sample_is_unbiased_and_falls_as_well() {
    let cube = UniformBox::uniform([0.0; 2], [1.0; 2]).unwrap();
    let half = UniformBox::uniform([0.0; 2], [0.5, 1.0]).unwrap();
    let estimate = |n: u64, points: &Sobol| {
        let one = OneSample::new(&[(&cube, 0.5), (&half, 0.5)], n).unwrap();
        one.estimate_from(&|x: &[f64; 2]| 6.0 * x[0] * x[1] * x[1], points).unwrap()
    };
    let rate = rate([8, 12], |n| rms(1.0, 40, |points| estimate(n, points)));
    assert!(rate > 0.8, "{rate}");
    let (mut sum, mut variance) = (0.0, 0.0);
    for seed in 100..200 {
        let e = estimate(512, &Sobol::new(seed));
        sum += e.value() - 1.0;
        variance += e.variance().unwrap();
    }
    assert!((sum / variance.sqrt()).abs() < 5.0, "{}", sum / variance.sqrt());
}

/// Shares between 0.93 and 0.97, with three standard deviations of noise, where the integrand is
/// smooth.
fn assert_coverage(samples: u64, seeds: u64) {
    let smooth = ["e^x", "sin x cos x", "two peaks", "product in 5-D", "vector"];
    let rows = suite().into_iter().filter(|row| row.replicates && smooth.contains(&row.integrand));
    let mut count = 0;
    for row in rows {
        count += 1;
        let cell = fixed(&row, samples, seeds);
        for ((name, _), component) in row.components.iter().zip(&cell.components) {
            let share = component.all[1];
            let text = format!("{} {name}, {samples}: {}", row.integrand, share.value());
            println!("{text}");
            assert!(!share.is_outside([0.93, 0.97]), "{text}");
        }
    }
    assert_eq!(count, smooth.len());
}

#[test]
fn intervals_from_replicates_hold_their_level() {
    assert_coverage(1024, 80);
}

#[test]
#[ignore = "half a minute in release"]
fn intervals_from_replicates_hold_their_level_in_full() {
    for samples in [256, 1000, 4096, 16_384] {
        assert_coverage(samples, 4000);
    }
}
