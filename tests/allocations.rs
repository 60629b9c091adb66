//! No allocation per sample, nor per chunk of a run.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use allocation_counter::{AllocationInfo, measure};
use mis::points::{PointSource, Random, Sobol};
use mis::technique::{Linear, Mixture, Product, ProductVec, TruncatedNormal, Uniform};
use mis::weighting::{Constant, Power, Weighting};
use mis::{Estimator, Integrand, MultiSample, OnFault, OneSample, Run, Target, Technique};

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

/// What 50 times the samples may allocate more: the merge tree grows with their logarithm.
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
        allocations(techniques, Power::squared(), f, 50_000),
        allocations(techniques, Constant::equal(), f, 50_000),
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
    assert!(count(50_000) <= count(1_000) + 16);
}

/// Points that own memory are written over, not made anew.
#[test]
fn points_of_run_time_length() {
    let flat = ProductVec::new(vec![Uniform::unit(); 5]).unwrap();
    let ramp = ProductVec::new(vec![Linear::new(0.0, 1.0, 1.0, 3.0).unwrap(); 5]).unwrap();
    let f = |x: &Vec<f64>| x.iter().sum::<f64>();
    let first_block = 512;
    let few = allocations([&flat, &ramp], Power::squared(), &f, first_block);
    let many = allocations([&flat, &ramp], Power::squared(), &f, 50_000);
    // One point for each place in a block (a part of one first, where the selection is random).
    assert!(many[0] <= few[0] + 16, "{few:?} {many:?}");
    assert!(many[1] <= few[1] + 16 + 100, "{few:?} {many:?}");
}

/// A run on one thread: of others, allocations are not counted. `tenths` is whether the parts of the
/// integral on tenths of the unit interval are tallied.
fn run(
    estimator: &impl Estimator<f64>,
    points: &impl PointSource,
    tenths: bool,
    n: u64,
) -> AllocationInfo {
    let run = Run::new(Target::new().samples(n).unwrap()).threads(1).unwrap();
    let f = |x: &f64| x * x;
    measure(|| {
        let report = if tenths {
            run.tally(estimator, &f, points, 10, |sample, tally| {
                let tenth = (1..10).filter(|k| 10.0 * sample.x() >= f64::from(*k)).count();
                tally.add(tenth, sample.contribution());
            })
        } else {
            run.execute_from(estimator, &f, points)
        };
        assert_eq!(report.unwrap().samples(), n);
    })
}

/// The last round has 45 chunks more than the first (18 where they are larger, of replicates), and
/// allocates at most `more` times more often, for two levels of the tree.
#[track_caller]
fn assert_steady(
    estimator: &impl Estimator<f64>,
    points: &impl PointSource,
    tenths: bool,
    more: u64,
) {
    let [few, early, late, most] =
        [125_000, 250_000, 500_000, 1_000_000].map(|n| run(estimator, points, tenths, n));
    let (first, last) = (early.count_total - few.count_total, most.count_total - late.count_total);
    assert!(last <= first + more, "{first}, {last} allocations, with a tally: {tenths}");
    // What a node of the tree holds for its two techniques.
    let node = 2 * points.replicates() * if tenths { 64 + 10 * 24 } else { 64 };
    let bytes_per_level = (most.bytes_max - few.bytes_max) as f64 / 8_f64.log2();
    let at_most = (12_000 + 4 * node) as f64;
    assert!(bytes_per_level <= at_most, "{bytes_per_level} bytes, with a tally: {tenths}");
}

/// Of estimators with and without a tally, each with one kind of points, and the others with the other.
#[track_caller]
fn assert_both_steady(points: &impl PointSource, tenths: [bool; 2], more: u64) {
    let (flat, ramp) = (Uniform::unit(), Linear::new(0.0, 1.0, 1.0, 3.0).unwrap());
    assert_steady(&MultiSample::new(&[(&flat, 1), (&ramp, 1)]).unwrap(), points, tenths[0], more);
    assert_steady(
        &OneSample::new(&[(&flat, 0.5), (&ramp, 0.5)], 1).unwrap(),
        points,
        tenths[1],
        more,
    );
}

#[test]
fn runs_with_random_points() {
    assert_both_steady(&Random::new(1), [false, true], 25);
}

#[test]
fn runs_with_sobol_points() {
    let sobol = Sobol::new(1);
    // The first of all unpacks the direction numbers.
    sobol.fill(0, 0, 2, &mut [0.0; 2]).unwrap();
    assert_both_steady(&sobol, [true, false], 14);
}
