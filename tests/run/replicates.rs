//! Replicates of which some have more samples than others, or none.

use mis::points::{PointSource, PointsExhausted, Random, Sobol};
use mis::technique::{Linear, Uniform};
use mis::{Doubt, Estimate, Estimator, MultiSample, OneSample, Run, Status, Target, integrand};

/// Random numbers, said to be in so many replicates.
#[derive(Debug)]
struct Divided(usize);

impl PointSource for Divided {
    fn fill(
        &self,
        stream: usize,
        first: u64,
        dimension: usize,
        xi: &mut [f64],
    ) -> Result<(), PointsExhausted> {
        Random::new(1).fill(stream, first, dimension, xi)
    }

    fn replicates(&self) -> usize {
        self.0
    }
}

fn run<'a>() -> Run<'a> {
    Run::new(Target::new()).threads(1).unwrap()
}

fn ramp() -> Linear {
    Linear::new(0.0, 1.0, 0.0, 2.0).unwrap()
}

fn f(x: &f64) -> f64 {
    x.exp()
}

/// Where there are fewer samples than replicates, no error is known, which is said; sums have the
/// value that the estimate has.
#[test]
fn replicates_without_samples_are_doubted() {
    let (flat, ramp) = (Uniform::unit(), ramp());
    let points = Sobol::new(1).with_replicates(4096).unwrap();
    let one = OneSample::new(&[(&flat, 0.5), (&ramp, 0.5)], 1000).unwrap();
    let all = |sample: &mis::Sample<'_, f64, f64>, tally: &mut mis::Tally<'_>| {
        tally.add(0, sample.contribution());
    };
    let report = run().tally(&one, &f, &points, 1, all).unwrap();
    assert!(report.standard_error().is_none());
    let Status::Suspect(doubts) = report.status() else { panic!("{}", report.status()) };
    let empty = |doubt: &Doubt| {
        matches!(doubt, Doubt::EmptyReplicates { samples: 1000, replicates: 4096, .. })
    };
    assert!(doubts.iter().any(empty), "{doubts:?}");
    assert!(report.status().to_string().contains("4096 replicates, but 1000 samples"));
    let [sum] = report.tallied() else { panic!("{:?}", report.tallied()) };
    assert!((sum.value / report.value() - 1.0).abs() < 1e-14 && sum.standard_error.is_none());

    let multi = MultiSample::new(&[(&flat, 12), (&ramp, 600)]).unwrap();
    let report = run().tally(&multi, &f, &Sobol::new(1), 1, all).unwrap();
    assert!(report.status().to_string().contains("technique 0 has drawn 12 samples, fewer"));
    let [sum] = report.tallied() else { panic!("{:?}", report.tallied()) };
    assert!((sum.value / report.value() - 1.0).abs() < 1e-14 && sum.standard_error.is_none());

    // With one sample each, there is an error, and no doubt for want of one.
    let one = OneSample::new(&[(&flat, 0.5), (&ramp, 0.5)], 4096).unwrap();
    let report = run().execute_from(&one, &f, &points).unwrap();
    assert!(report.standard_error().is_some());
    assert!(!report.status().to_string().contains("no error is known"), "{}", report.status());
}

/// The sum of all contributions is the value. Where no sample added, every replicate has 0, which is no
/// sign that the sum is 0.
#[test]
fn sums_from_replicates_of_all_samples_and_of_none() {
    let (flat, ramp) = (Uniform::unit(), ramp());
    let multi = MultiSample::new(&[(&flat, 64), (&ramp, 64)]).unwrap();
    let one = OneSample::new(&[(&flat, 0.5), (&ramp, 0.5)], 128).unwrap();
    let first = |sample: &mis::Sample<'_, f64, f64>, tally: &mut mis::Tally<'_>| {
        tally.add(0, sample.contribution());
    };
    let reports = [
        run().tally(&multi, &f, &Sobol::new(1), 2, first).unwrap(),
        run().tally(&one, &f, &Sobol::new(1), 2, first).unwrap(),
    ];
    for report in reports {
        let [all, none] = report.tallied() else { panic!("{:?}", report.tallied()) };
        assert!((all.value / report.value() - 1.0).abs() < 1e-14);
        let [own, error] = [all.standard_error, report.standard_error()].map(Option::unwrap);
        assert!((own / error - 1.0).abs() < 1e-11, "{own} {error}");
        assert_eq!((none.value, none.standard_error, none.samples), (0.0, None, 0));
    }
}

/// Shares are of the value as it is, and contributions add up to it, although some replicates
/// have a sample more.
#[test]
fn shares_of_replicates_that_differ_in_size() {
    let (flat, ramp) = (Uniform::unit(), ramp());
    let multi = MultiSample::new(&[(&flat, 17), (&ramp, 23)]).unwrap();
    let one = OneSample::new(&[(&flat, 0.5), (&ramp, 0.5)], 41).unwrap();
    let shares = |estimate: Estimate| -> f64 {
        estimate.techniques().map(|technique| technique.share_of_value.unwrap()).sum()
    };
    for seed in 0..10 {
        for estimate in [
            multi.estimate_from(&f, &Sobol::new(seed)).unwrap(),
            one.estimate_from(&f, &Sobol::new(seed)).unwrap(),
        ] {
            assert!((shares(estimate) - 1.0).abs() < 1e-14);
        }
    }
    // One contribution that is not 0 is the value.
    let single = MultiSample::new(&[(&flat, 23)]).unwrap();
    let at = |k: u64| {
        let mut x = f64::NAN;
        let show = |sample: &mis::Sample<'_, f64, f64>| {
            if sample.index() == k {
                x = *sample.x();
            }
        };
        single.inspect(&f, &Sobol::new(3), show).unwrap();
        x
    };
    for k in [0, 6, 7, 15, 16, 22] {
        let x = at(k);
        let peak = move |y: &f64| if *y == x { 1.0 } else { 0.0 };
        let estimate = single.estimate_from(&peak, &Sobol::new(3)).unwrap();
        let largest = estimate.largest().unwrap();
        assert_eq!(largest.sample, k);
        assert!((largest.share_of_value.unwrap() - 1.0).abs() < 1e-15, "{k}: {largest:?}");
    }
}

/// No number of replicates is too many or too few for an estimator.
#[test]
fn numbers_of_replicates_are_kept_within_bounds() {
    let flat = Uniform::unit();
    let multi = MultiSample::new(&[(&flat, 5000)]).unwrap();
    for (stated, taken) in [(0, 1), (1, 1), (4096, 4096), (4097, 4096), (usize::MAX, 4096)] {
        let estimate = multi.estimate_from(&f, &Divided(stated)).unwrap();
        assert_eq!(estimate.replicates(), taken);
        let report = run().execute_from(&multi, &f, &Divided(stated)).unwrap();
        assert_eq!(report.estimate().replicates(), taken);
        assert!((estimate.value() / report.value() - 1.0).abs() < 1e-13);
    }
}

/// What a batch closure leaves out is 0, not what an earlier block of the same thread had there.
#[test]
fn batches_that_leave_out_zeros() {
    let flat = Uniform::unit();
    let multi = MultiSample::new(&[(&flat, 20_000)]).unwrap();
    let sparse = integrand::batch(|xs: &[f64], ys: &mut [f64]| {
        xs.iter().zip(ys).filter(|(x, _)| **x < 0.1).for_each(|(_, y)| *y = 1.0);
    });
    let whole = |x: &f64| if *x < 0.1 { 1.0 } else { 0.0 };
    assert_eq!(multi.estimate(&sparse, 1).unwrap(), multi.estimate(&whole, 1).unwrap());
    for threads in [1, 2] {
        let run = || Run::new(Target::new()).threads(threads).unwrap();
        let [sparse, whole] = [
            run().execute(&multi, &sparse, 1).unwrap().value(),
            run().execute(&multi, &whole, 1).unwrap().value(),
        ];
        assert_eq!(sparse, whole);
    }
}
