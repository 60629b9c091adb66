//! No allocation per sample.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use allocation_counter::measure;
use mis::technique::{Linear, Mixture, Product, ProductVec, TruncatedNormal, Uniform};
use mis::weighting::{Constant, Power, Weighting};
use mis::{Estimator, Integrand, MultiSample, OnFault, OneSample, Technique};

/// Allocations of an estimate from `n` samples of each technique.
fn allocations<P, W, F>(
    techniques: [&dyn Technique<Point = P>; 2],
    weighting: W,
    f: &F,
    n: u64,
) -> [u64; 2]
where
    P: std::fmt::Debug,
    W: Weighting + Clone,
    F: Integrand<P>,
{
    let [a, b] = techniques;
    let multi = MultiSample::new(&[(a, n), (b, n)]).unwrap().weighting(weighting.clone()).unwrap();
    let one = OneSample::new(&[(a, 0.5), (b, 0.5)], 2 * n).unwrap().weighting(weighting).unwrap();
    [
        measure(|| drop(multi.estimate(f, 1).unwrap())).count_total,
        measure(|| drop(one.estimate(f, 1).unwrap())).count_total,
    ]
}

/// What 500 times the samples may allocate more: the merge tree grows with their logarithm.
#[track_caller]
fn assert_constant<P: std::fmt::Debug>(
    techniques: [&dyn Technique<Point = P>; 2],
    f: &impl Integrand<P>,
) {
    let few = [
        allocations(techniques, Power::squared(), f, 1_000),
        allocations(techniques, Constant::equal(), f, 1_000),
    ];
    let many = [
        allocations(techniques, Power::squared(), f, 500_000),
        allocations(techniques, Constant::equal(), f, 500_000),
    ];
    for (few, many) in few.as_flattened().iter().zip(many.as_flattened()) {
        assert!(*few > 0 && *many <= few + 16, "{few} {many}");
    }
}

#[test]
fn numbers() {
    let (flat, ramp) = (Uniform::unit(), Linear::new(0.0, 1.0, 1.0, 3.0).unwrap());
    assert_constant([&flat, &ramp], &|x: &f64| *x);
    let mixture = Mixture::new(vec![(flat, 0.25), (flat, 0.75)]).unwrap();
    assert_constant([&flat, &mixture], &|x: &f64| [*x, 1.0]);
}

/// Coordinates go through blocks on the stack.
#[test]
fn arrays() {
    let peak = TruncatedNormal::new(0.3, 0.1, 0.0, 1.0).unwrap();
    let (flat, peaks) = (Product::uniform([0.0; 3], [1.0; 3]).unwrap(), [peak; 3]);
    let peaks = Product::new(peaks).unwrap();
    assert_constant([&flat, &peaks], &|x: &[f64; 3]| x[0] + x[1] * x[2]);
}

/// A fault that is only counted is not described.
#[test]
fn counted_faults() {
    let flat = Uniform::unit();
    let f = |x: &f64| if *x < 0.9 { f64::NAN } else { 1.0 };
    let count = |n| {
        let mis =
            MultiSample::new(&[(&flat, n)]).unwrap().on_fault(OnFault::count_as_zero(1.0).unwrap());
        measure(|| drop(mis.estimate(&f, 1).unwrap())).count_total
    };
    assert!(count(500_000) <= count(1_000) + 16);
}

/// Points that own memory are written over, not made anew.
#[test]
fn points_of_run_time_length() {
    let flat = ProductVec::new(vec![Uniform::unit(); 5]).unwrap();
    let ramp = ProductVec::new(vec![Linear::new(0.0, 1.0, 1.0, 3.0).unwrap(); 5]).unwrap();
    let f = |x: &Vec<f64>| x.iter().sum::<f64>();
    let first_block = 512;
    let few = allocations([&flat, &ramp], Power::squared(), &f, first_block);
    let many = allocations([&flat, &ramp], Power::squared(), &f, 200_000);
    // One point for each place in a block (a part of one first, where the selection is random).
    assert!(many[0] <= few[0] + 16, "{few:?} {many:?}");
    assert!(many[1] <= few[1] + 16 + 100, "{few:?} {many:?}");
}
