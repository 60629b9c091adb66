//! Contributions, their numbering and their shares, one by one.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use mis::points::{Random, Replay};
use mis::technique::{Technique, Uniform};
use mis::weighting::{Balance, Constant, Cutoff, Maximum, Power, Weighting};
use mis::{EstimateError, Estimator, MultiSample, OnFault, OneSample, Value};

/// Draws its own number; its density at point k is `q[k]`.
struct At {
    number: usize,
    q: [f64; 2],
}

impl Technique for At {
    type Point = usize;
    fn dimension(&self) -> usize {
        1
    }
    fn sample(&self, _: &[f64]) -> usize {
        self.number
    }
    fn pdf(&self, x: &usize) -> f64 {
        self.q[*x]
    }
}

/// Two samples: one of each technique, P = (1/4, 3/4).
fn both() -> Replay {
    Replay::new([vec![0.1, 0.5, 0.9, 0.5]]).unwrap()
}

#[test]
fn weights_without_probabilities_divide_by_the_probability_once() {
    // Constant weights ignore the densities of others, so the factors do not matter to them.
    let (a, b) = (At { number: 0, q: [0.5; 2] }, At { number: 1, q: [2.0; 2] });
    let one = || OneSample::new(&[(&a, 0.25), (&b, 0.75)], 2).unwrap();
    let constant = |one: OneSample<'_, usize>| {
        let one = one.weighting(Constant::new([0.5, 0.5]).unwrap()).unwrap();
        one.estimate_from(&|_: &usize| 1.0, &both()).unwrap().value()
    };
    let exact = 0.5 * (0.5 / (0.25 * 0.5) + 0.5 / (0.75 * 2.0));
    assert!((constant(one()) - exact).abs() < 1e-15);
    assert!((constant(one().weights_without_probabilities()) - exact).abs() < 1e-15);
}

#[test]
fn weights_without_probabilities_in_logarithms() {
    // Densities far below the range in which quotients are exact.
    let (a, b) = (At { number: 0, q: [1e-300; 2] }, At { number: 1, q: [3e-300; 2] });
    let one = || OneSample::new(&[(&a, 0.25), (&b, 0.75)], 2).unwrap();
    let value = |one: OneSample<'_, usize>| {
        one.estimate_from(&|_: &usize| 1e-300, &both()).unwrap().value()
    };
    let balance = 1.0 / (0.25 + 0.75 * 3.0);
    assert!((value(one()) - balance).abs() < 1e-12);
    let equal = 0.5 * (0.25 / 0.25 + 0.25 / 0.75);
    assert!((value(one().weights_without_probabilities()) - equal).abs() < 1e-12);
    let constant = one().weights_without_probabilities().weighting(Constant::equal()).unwrap();
    let constant = constant.estimate_from(&|_: &usize| 1e-300, &both()).unwrap().value();
    let exact = 0.5 * (0.5 / 0.25 + 0.5 / (0.75 * 3.0));
    assert!((constant - exact).abs() < 1e-12, "{constant}");
}

/// A value that asks for more components than it says it has gets NaN, not a panic.
#[test]
fn a_component_that_there_is_not_is_nan() {
    #[derive(Debug, Clone)]
    struct Greedy(f64);

    impl Value for Greedy {
        const COMPONENTS: usize = 1;
        type Each<U> = [U; 3];
        fn each<U>(of: impl FnMut(usize) -> U) -> [U; 3] {
            std::array::from_fn(of)
        }
        fn zero() -> Self {
            Self(0.0)
        }
        fn is_finite(&self) -> bool {
            self.0.is_finite()
        }
        fn times(&self, _: usize, factor: f64) -> f64 {
            self.0 * factor
        }
        fn times_exp(&self, _: usize, ln_factor: f64) -> f64 {
            self.0 * ln_factor.exp()
        }
    }

    let p = Uniform::unit();
    let mis = MultiSample::new(&[(&p, 10)]).unwrap();
    let mut contributions = 0.0;
    let estimate = mis
        .inspect(&|_: &f64| Greedy(2.0), &Random::new(1), |s| {
            contributions += s.contribution()[0] / 10.0;
        })
        .unwrap();
    assert!((contributions - 2.0).abs() < 1e-14);
    assert_eq!(estimate.value()[0], 2.0);
    assert!(estimate.value()[2].is_nan() && estimate.standard_error()[2].is_none());
    assert!(estimate.largest()[2].is_none());
    let _ = estimate.interval(0.95).unwrap();
    assert_eq!(estimate.techniques().count(), 1);
}

/// Fails if its density is asked for at a point of another's.
struct OwnOnly(usize);

impl Technique for OwnOnly {
    type Point = usize;
    fn dimension(&self) -> usize {
        1
    }
    fn sample(&self, _: &[f64]) -> usize {
        self.0
    }
    fn pdf(&self, x: &usize) -> f64 {
        assert_eq!(*x, self.0, "a foreign point");
        1e-300
    }
}

#[test]
fn what_is_not_evaluated_is_not_evaluated_in_logarithms_either() {
    let f = |_: &usize| 1e-300;
    let mis = MultiSample::new(&[(&OwnOnly(0), 3), (&OwnOnly(1), 3)]).unwrap();
    let mis = mis.weighting(Constant::equal()).unwrap();
    assert!((mis.estimate(&f, 1).unwrap().value() - 1.0).abs() < 1e-12);
    // A technique without samples.
    let mis = MultiSample::new(&[(&OwnOnly(0), 3), (&OwnOnly(1), 0)]).unwrap();
    assert!((mis.estimate(&f, 1).unwrap().value() - 1.0).abs() < 1e-12);
    let one = OneSample::new(&[(&OwnOnly(0), 1.0), (&OwnOnly(1), 0.0)], 3).unwrap();
    assert!((one.estimate(&f, 1).unwrap().value() - 1.0).abs() < 1e-12);
}

#[test]
fn every_component_of_a_contribution_is_checked() {
    let p = At { number: 0, q: [1e-200; 2] };
    let mis = MultiSample::new(&[(&p, 3)]).unwrap();
    let error = mis.estimate(&|_: &usize| [1.0, 1e200], 1).unwrap_err();
    assert!(matches!(error, EstimateError::Contribution { .. }), "{error}");
    let counted =
        mis.on_fault(OnFault::count_as_zero(1.0).unwrap()).estimate(&|_: &usize| [1.0, 1e200], 1);
    let counted = counted.unwrap();
    assert_eq!((counted.value(), counted.non_finite(), counted.zero()), ([0.0, 0.0], 3, 3));
}

#[test]
fn a_fault_in_one_component_leaves_out_the_whole_sample() {
    let p = Uniform::unit();
    let mis =
        MultiSample::new(&[(&p, 1000)]).unwrap().on_fault(OnFault::count_as_zero(1.0).unwrap());
    let f = |x: &f64| [1.0, if *x < 0.5 { f64::NAN } else { 2.0 }];
    let estimate = mis.estimate(&f, 1).unwrap();
    let kept = 1.0 - estimate.non_finite() as f64 / 1000.0;
    let [a, b] = estimate.value();
    assert!((a - kept).abs() < 1e-14 && (b - 2.0 * kept).abs() < 1e-14, "{a} {b} {kept}");
}

#[test]
fn a_contribution_is_zero_if_all_its_components_are() {
    let p = Uniform::unit();
    let mis = MultiSample::new(&[(&p, 1000)]).unwrap();
    assert_eq!(mis.estimate(&|x: &f64| [*x, 0.0], 1).unwrap().zero(), 0);
    assert_eq!(mis.estimate(&|_: &f64| [0.0, 0.0], 1).unwrap().zero(), 1000);
}

#[test]
fn an_infinite_foreign_density_takes_the_weight() {
    fn value(w: impl Weighting) -> f64 {
        let a = At { number: 0, q: [1.0, 1.0] };
        let b = At { number: 1, q: [f64::INFINITY, 1.0] };
        let mis = MultiSample::new(&[(&a, 2), (&b, 2)]).unwrap().weighting(w).unwrap();
        mis.estimate(&|_: &usize| 1.0, 1).unwrap().value()
    }
    assert_eq!(value(Balance), 0.5);
    assert_eq!(value(Maximum), 0.5);
    assert_eq!(value(Cutoff::new(0.5).unwrap()), 0.5);
    assert_eq!(value(Power::squared()), 0.5);
}
#[test]
fn an_infinite_foreign_density_takes_the_weight_below_1() {
    for beta in [0.0, 0.5] {
        let a = At { number: 0, q: [1.0, 1.0] };
        let b = At { number: 1, q: [f64::INFINITY, 1.0] };
        let mis = MultiSample::new(&[(&a, 2), (&b, 2)]).unwrap();
        let mis = mis.weighting(Power::new(beta).unwrap()).unwrap();
        assert_eq!(mis.estimate(&|_: &usize| 1.0, 1).unwrap().value(), 0.5);
    }
}

#[test]
fn samples_are_numbered_through_all_blocks() {
    let p = Uniform::unit();
    let mis = MultiSample::new(&[(&p, 1500), (&p, 700)]).unwrap();
    let mut seen: [Vec<u64>; 2] = [vec![], vec![]];
    mis.inspect(&|x: &f64| *x, &Random::new(1), |s| seen[s.technique()].push(s.index())).unwrap();
    assert!(seen[0].iter().copied().eq(0..1500) && seen[1].iter().copied().eq(0..700));
    // An error and the largest contribution name the same numbers.
    let mut xi = vec![0.5; 1500];
    xi[1300] = 0.75;
    let points = Replay::new([xi.clone(), vec![0.25; 700]]).unwrap();
    let spike = |x: &f64| if *x == 0.75 { 9.0 } else { 1.0 };
    let largest = mis.estimate_from(&spike, &points).unwrap().largest().unwrap();
    assert_eq!((largest.technique, largest.sample), (0, 1300));
    let bad = |x: &f64| if *x == 0.75 { f64::NAN } else { 1.0 };
    let error = mis.estimate_from(&bad, &points).unwrap_err();
    assert!(matches!(error, EstimateError::Value { technique: 0, sample: 1300, .. }), "{error}");
    let one = OneSample::new(&[(&p, 0.5), (&p, 0.5)], 1500).unwrap();
    let rows = Replay::new([xi.iter().flat_map(|u| [0.7, *u]).collect::<Vec<_>>()]).unwrap();
    let error = one.estimate_from(&bad, &rows).unwrap_err();
    assert!(matches!(error, EstimateError::Value { technique: 1, sample: 1300, .. }), "{error}");
    let largest = one.estimate_from(&spike, &rows).unwrap().largest().unwrap();
    assert_eq!((largest.technique, largest.sample), (1, 1300));
}

#[test]
fn a_technique_gets_the_numbers_after_the_selecting_one() {
    struct Last(usize);
    impl Technique for Last {
        type Point = f64;
        fn dimension(&self) -> usize {
            self.0
        }
        fn sample(&self, xi: &[f64]) -> f64 {
            assert_eq!(xi.len(), self.0);
            xi[self.0 - 1]
        }
        fn pdf(&self, _: &f64) -> f64 {
            1.0
        }
    }
    let one = OneSample::new(&[(&Last(1), 0.5), (&Last(2), 0.5)], 2).unwrap();
    let points = Replay::new([vec![0.1, 0.2, 0.3, 0.9, 0.4, 0.6]]).unwrap();
    let mut seen = vec![];
    one.inspect(&|x: &f64| *x, &points, |s| seen.push((s.technique(), *s.x()))).unwrap();
    assert_eq!(seen, [(0, 0.2), (1, 0.6)]);
}

#[test]
fn too_many_samples_are_refused() {
    let p = Uniform::unit();
    for n in [(1 << 53) + 1, u64::MAX] {
        let error = OneSample::new(&[(&p, 1.0)], n).unwrap_err();
        assert_eq!((error.owner(), error.argument()), ("OneSample", "samples"));
    }
    assert!(OneSample::new(&[(&p, 1.0)], 1 << 53).is_ok());
}

#[test]
fn shares_and_degrees_of_freedom_by_hand() {
    let (a, b) = (Uniform::unit(), Uniform::new(0.0, 2.0).unwrap());
    let mis = MultiSample::new(&[(&a, 2), (&b, 3)]).unwrap();
    let mis = mis.weighting(Constant::new([0.5, 0.5]).unwrap()).unwrap();
    let points = Replay::new([vec![0.2, 0.4], vec![0.1, 0.2, 0.6]]).unwrap();
    let estimate = mis.estimate_from(&|x: &f64| *x, &points).unwrap();
    // w f / p: (0.1, 0.2), mean 0.15, and (0.2, 0.4, 1.2), mean 0.6; V = 0.005 / 2 + 0.28 / 3.
    let close = |x: f64, y: f64| assert!((x / y - 1.0).abs() < 1e-9, "{x} {y}");
    close(estimate.value(), 0.75);
    let v = 0.0025 + 0.28 / 3.0;
    close(estimate.variance().unwrap(), v);
    let shares: Vec<_> = estimate.techniques().collect();
    close(shares[0].share_of_value.unwrap(), 0.2);
    close(shares[1].share_of_value.unwrap(), 0.8);
    close(shares[0].share_of_variance.unwrap(), 0.0025 / v);
    close(shares[1].share_of_variance.unwrap(), 0.28 / 3.0 / v);
    assert_eq!((shares[0].samples, shares[1].samples), (2, 3));
    // Welch and Satterthwaite: V² / (0.0025² / 1 + (0.28 / 3)² / 2) = 2.105565...
    let half = |level| {
        let interval = estimate.interval(level).unwrap();
        (interval.upper - interval.lower) / 2.0
    };
    close(half(0.95), 4.102_416_053_389_73 * v.sqrt());
    // Pooled: five contributions of one-sample, N - 1 = 4 degrees of freedom.
    let one = OneSample::new(&[(&a, 0.5), (&b, 0.5)], 5).unwrap();
    let one = one.weighting(Constant::new([0.5, 0.5]).unwrap()).unwrap();
    let rows = [0.2, 0.2, 0.2, 0.4, 0.7, 0.1, 0.7, 0.2, 0.7, 0.6];
    let points = Replay::new([rows.to_vec()]).unwrap();
    let estimate = one.estimate_from(&|x: &f64| *x, &points).unwrap();
    // w f / (P p): 0.2, 0.4, 0.4, 0.8, 2.4, mean 0.84; squared deviations from it.
    let ys = [0.2, 0.4, 0.4, 0.8, 2.4_f64];
    let squares = ys.map(|y| (y - 0.84) * (y - 0.84));
    let sum: f64 = squares.iter().sum();
    close(estimate.value(), 0.84);
    close(estimate.variance().unwrap(), sum / 20.0);
    let shares: Vec<_> = estimate.techniques().collect();
    close(shares[0].share_of_value.unwrap(), 0.6 / 4.2);
    close(shares[0].share_of_variance.unwrap(), (squares[0] + squares[1]) / sum);
    let interval = estimate.interval(0.95).unwrap();
    close((interval.upper - interval.lower) / 2.0, 2.776_445_105_197_79 * (sum / 20.0).sqrt());
}

#[test]
fn the_largest_contribution_of_each_component_has_its_sign() {
    let p = Uniform::unit();
    let mis = MultiSample::new(&[(&p, 2), (&p, 2)]).unwrap();
    let points = Replay::new([vec![0.25, 0.5], vec![0.75, 0.125]]).unwrap();
    let f = |x: &f64| [if *x == 0.75 { -5.0 } else { 1.0 }, if *x == 0.5 { 9.0 } else { -1.0 }];
    let [first, second] = mis.estimate_from(&f, &points).unwrap().largest().map(Option::unwrap);
    assert_eq!((first.technique, first.sample, first.contribution), (1, 0, -1.25));
    assert_eq!((second.technique, second.sample, second.contribution), (0, 1, 2.25));
}

#[test]
fn an_own_density_of_0_is_an_error_where_another_covers_the_point() {
    fn error<W: Weighting>(w: W, n: u64, bad: f64) -> EstimateError {
        let (a, b) = (At { number: 0, q: [bad, 1.0] }, At { number: 1, q: [1.0, 1.0] });
        let mis = MultiSample::new(&[(&a, n), (&b, n)]).unwrap().weighting(w).unwrap();
        mis.estimate(&|_: &usize| 1.0, 1).map(|e| e.value()).unwrap_err()
    }
    for n in [3, 100] {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            for e in
                [error(Balance, n, bad), error(Maximum, n, bad), error(Power::squared(), n, bad)]
            {
                assert!(
                    matches!(e, EstimateError::Density { technique: 0, sampled_by: 0, .. }),
                    "{e}"
                );
            }
        }
    }
}

#[test]
fn products_of_shares_and_subnormal_densities_keep_their_digits() {
    let tiny = f64::from_bits(3);
    let (a, b) = (At { number: 0, q: [1e-305; 2] }, At { number: 1, q: [tiny; 2] });
    let mis = MultiSample::new(&[(&a, 1), (&b, 1)]).unwrap().weighting(Power::squared()).unwrap();
    let mut w = [0.0; 2];
    let f = |i: &usize| [1e-305, tiny][*i] * 5e299; // then contributions are w_i 1e300
    mis.inspect(&f, &mis::points::Random::new(1), |s| w[s.technique()] = s.contribution()).unwrap();
    let exact = (tiny * 1e300 / 1e-5).powi(2);
    assert!((w[1] / 1e300 / exact - 1.0).abs() < 1e-11, "{w:?} {exact}");
}
