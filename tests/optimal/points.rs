//! Points that depend on each other: the error comes from replicates.

use std::f64::consts::E;

use mis::points::{Antithetic, PointSource, Sobol, Stratified};
use mis::technique::{Linear, Uniform};
use mis::{OptimalMis, Technique};

use crate::ensembles::{FITS, Mean, ratio};

fn replicates_tell_the_error<S: PointSource>(points: impl Fn(u64) -> S, seeds: u64, most: f64) {
    let (flat, ramp) = (Uniform::unit(), Linear::new(0.0, 1.0, 0.0, 2.0).unwrap());
    let list: [(&dyn Technique<Point = f64>, u64); 2] = [(&flat, 1024), (&ramp, 1024)];
    for fit in FITS {
        let mis = OptimalMis::new(&list).unwrap().fit(fit).unwrap();
        let found: Vec<_> = (0..seeds)
            .map(|seed| mis.estimate_from(&|x: &f64| x.exp(), &points(seed)).unwrap())
            .collect();
        let replicates = points(0).replicates();
        for e in found.iter().map(mis::OptimalEstimate::estimate) {
            assert_eq!((e.replicates(), e.samples()), (replicates, 2048));
            let shares: f64 = e.techniques().map(|t| t.share_of_value.unwrap()).sum();
            assert!((shares - 1.0).abs() < 1e-12, "{shares}");
            assert!(e.techniques().all(|t| t.samples == 1024));
        }
        let values = Mean::of(found.iter().map(mis::OptimalEstimate::value));
        let what = format!("{:?} {fit:?}: {values:?}", points(0));
        assert!(values.z(E - 1.0).abs() < 4.42, "{what}");
        let pair = |e: &mis::OptimalEstimate| {
            ((e.value() - (E - 1.0)).powi(2), e.estimate().variance().unwrap())
        };
        let pairs: Vec<_> = found.iter().map(pair).collect();
        let ratio = ratio(&pairs);
        assert!(
            (ratio.mean - 1.0).abs() < 4.42 * ratio.error && ratio.error < 0.4,
            "{what} {ratio:?}"
        );
        // The balance heuristic with random numbers has 2.6e-5, optimal MIS 1.4e-6.
        let variance = Mean::of(pairs.iter().map(|p| p.0)).mean;
        assert!(variance < most, "{what}: {variance:e}");
    }
}

#[test]
fn sobol_points() {
    replicates_tell_the_error(Sobol::new, 40, 3e-8);
}

#[test]
fn stratified_points() {
    replicates_tell_the_error(|seed| Stratified::new(seed, 4).unwrap(), 40, 1e-5);
}

#[test]
fn antithetic_points() {
    replicates_tell_the_error(Antithetic::new, 40, 1e-5);
}

/// With so few replicates, folds are fewer, and each is of whole ones.
#[test]
fn few_replicates() {
    let (flat, ramp) = (Uniform::unit(), Linear::new(0.0, 1.0, 0.0, 2.0).unwrap());
    for replicates in [2, 3, 7] {
        let points = Sobol::new(1).with_replicates(replicates).unwrap();
        for fit in FITS {
            let mis = OptimalMis::new(&[(&flat, 500), (&ramp, 300)]).unwrap().fit(fit).unwrap();
            let found = mis.estimate_from(&|x: &f64| 1.0 + 3.0 * x, &points).unwrap();
            assert_eq!(found.estimate().replicates(), replicates);
            let bound = if found.uncontrolled() == 0 { 1e-13 } else { 1e-3 };
            assert!((found.value() / 2.5 - 1.0).abs() < bound, "{replicates} {fit:?}: {found}");
            assert!(found.standard_error().is_some());
        }
    }
}
