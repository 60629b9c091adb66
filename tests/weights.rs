//! Weights at the numerical extremes, as the public function gives them and as the estimators
//! apply them.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use mis::points::Replay;
use mis::weighting::{
    Balance, Constant, Cutoff, Maximum, Power, VarianceAware, Weighting, weights,
};
use mis::{EstimateError, Estimator, MultiSample, OnFault, OneSample, Technique};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Dxsm;

/// A technique that draws its own number and states the density `q` everywhere.
struct Stated {
    number: usize,
    q: f64,
}

impl Technique for Stated {
    type Point = usize;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, _: &[f64]) -> usize {
        self.number
    }

    fn pdf(&self, _: &usize) -> f64 {
        self.q
    }
}

fn stated(q: &[f64]) -> Vec<Stated> {
    q.iter().enumerate().map(|(number, q)| Stated { number, q: *q }).collect()
}

/// The weights that the multi-sample estimator applies: with f = q_i at technique i's sample, the
/// contribution is w_i.
fn applied(weighting: impl Weighting, q: &[f64]) -> Result<Vec<f64>, EstimateError> {
    let techniques = stated(q);
    let list: Vec<(&dyn Technique<Point = usize>, u64)> =
        techniques.iter().map(|t| (t as _, 1)).collect();
    let mis = MultiSample::new(&list).unwrap().weighting(weighting).unwrap();
    let mut w = vec![f64::NAN; q.len()];
    mis.on_fault(OnFault::Error).inspect(
        &|i: &usize| q[*i],
        &mis::points::Random::new(1),
        |s| {
            w[s.technique()] = s.contribution() / q.len() as f64;
        },
    )?;
    Ok(w)
}

/// Factors of 1 to 10⁶, as many as there are densities.
fn aware(q: &[f64]) -> VarianceAware {
    let factors: Vec<f64> = [1.0, 1e6, 30.0].into_iter().cycle().take(q.len()).collect();
    VarianceAware::new(factors).unwrap()
}

#[track_caller]
fn assert_weights(weighting: impl Weighting + Clone, q: &[f64], expected: &[f64]) {
    let tolerance = 1e-12;
    let stated = weights(&weighting, q).unwrap();
    let applied = applied(weighting, q).unwrap();
    for (name, w) in [("stated", &stated), ("applied", &applied)] {
        for (w, expected) in w.iter().zip(expected) {
            let close = (w - expected).abs() <= tolerance * expected.max(f64::MIN_POSITIVE);
            assert!(close, "{name}: {w:?}, expected {expected:?} of {q:?}");
        }
    }
}

#[test]
fn powers_of_densities_neither_over_nor_underflow() {
    let squared = Power::squared();
    assert_weights(squared, &[1e-170, 3e-170], &[0.1, 0.9]);
    assert_weights(squared, &[1e155, 1e155], &[0.5, 0.5]);
    assert_weights(squared, &[1e200, 1e155], &[1.0, 1e-90]);
    assert_weights(squared, &[1e300, 1e-300], &[1.0, 0.0]);
    assert_weights(Power::new(0.5).unwrap(), &[1e300, 1e-300], &[1.0, 1e-300]);
}

#[test]
fn subnormal_densities_are_densities() {
    for weighting in [Power::new(1.0).unwrap(), Power::squared(), Power::new(0.0).unwrap()] {
        assert_weights(weighting, &[5e-324, 5e-324], &[0.5, 0.5]);
        assert_eq!(weights(&weighting, &[5e-324, 0.0]), Some(vec![1.0, 0.0]));
    }
    assert_weights(Balance, &[5e-324, 5e-324], &[0.5, 0.5]);
    assert_weights(Maximum, &[5e-324, 5e-324], &[0.5, 0.5]);
    let least = VarianceAware::new([1e-200, 1.0]).unwrap();
    assert_weights(least.clone(), &[5e-324, 5e-324], &[1e-200, 1.0]);
    assert_weights(least, &[1e300, 1e100], &[0.5, 0.5]);
    assert_weights(Power::new(f64::INFINITY).unwrap(), &[5e-324, 5e-324], &[0.5, 0.5]);
    // A ratio that is subnormal has lost digits, and its root would show it.
    let w = 3e-308_f64.sqrt() / 1e15_f64.sqrt();
    assert_weights(Power::new(0.5).unwrap(), &[1e15, 3e-308], &[1.0, w]);
    assert_weights(Constant::equal(), &[5e-324, 5e-324], &[0.5, 0.5]);
}

#[test]
fn a_point_that_nothing_covers_has_no_weights() {
    assert_eq!(weights(&Balance, &[0.0, 0.0]), None);
    assert_eq!(weights(&Power::squared(), &[0.0]), None);
    assert_eq!(weights(&Maximum, &[]), None);
}

#[test]
fn an_infinite_density_takes_all_the_weight_and_several_share_it() {
    let inf = f64::INFINITY;
    for q in [[inf, 1.0], [inf, 0.0], [inf, 1e300]] {
        assert_eq!(weights(&Balance, &q), Some(vec![1.0, 0.0]));
        assert_eq!(weights(&Power::squared(), &q), Some(vec![1.0, 0.0]));
        assert_eq!(weights(&Maximum, &q), Some(vec![1.0, 0.0]));
        assert_eq!(weights(&aware(&q), &q), Some(vec![1.0, 0.0]));
    }
    assert_eq!(weights(&Balance, &[inf, 1.0, inf]), Some(vec![0.5, 0.0, 0.5]));
    assert_eq!(weights(&Power::new(0.5).unwrap(), &[inf, 1.0]), Some(vec![1.0, 0.0]));

    // At its own sample an infinite density is a breach; at another technique's it takes the
    // weight.
    let techniques = stated(&[inf, 1.0]);
    let (infinite, one) = (&techniques[0], &techniques[1]);
    let mis = MultiSample::new(&[(infinite, 1), (one, 1)]).unwrap();
    let error = mis.estimate(&|_: &usize| 1.0, 1).unwrap_err();
    assert!(matches!(error, EstimateError::Density { technique: 0, sampled_by: 0, .. }), "{error}");
    let counted =
        mis.on_fault(OnFault::count_as_zero(1.0).unwrap()).estimate(&|_: &usize| 1.0, 1).unwrap();
    assert_eq!((counted.value(), counted.uncovered()), (0.0, 1));
}

#[test]
fn a_density_that_is_nan_or_negative_is_never_silently_0() {
    for bad in [f64::NAN, -1.0] {
        for k in 0..2 {
            let mut q = [1.0, 1.0];
            q[k] = bad;
            assert_eq!(weights(&Balance, &q), None);
            assert_eq!(weights(&Maximum, &q), None);
            let techniques = stated(&q);
            let mis = || MultiSample::new(&[(&techniques[0], 1), (&techniques[1], 1)]).unwrap();
            let f = |_: &usize| 1.0;
            for error in [
                mis().estimate(&f, 1).unwrap_err(),
                mis().weighting(Power::squared()).unwrap().estimate(&f, 1).unwrap_err(),
                mis().weighting(Maximum).unwrap().estimate(&f, 1).unwrap_err(),
                mis().weighting(Cutoff::new(0.5).unwrap()).unwrap().estimate(&f, 1).unwrap_err(),
            ] {
                let EstimateError::Density { technique, sampled_by: 0, sample: 0, .. } = error
                else {
                    panic!("{error}")
                };
                assert_eq!(technique, k);
            }
        }
    }
}

#[test]
fn ties_share_and_the_weights_sum_to_1() {
    for k in 1..20_u32 {
        for ties in 1..=k {
            let q: Vec<f64> = (0..k).map(|i| if i < ties { 0.7 } else { 0.1 }).collect();
            let expected: Vec<f64> =
                (0..k).map(|i| if i < ties { 1.0 / f64::from(ties) } else { 0.0 }).collect();
            assert_weights(Maximum, &q, &expected);
            assert_weights(Cutoff::new(1.0).unwrap(), &q, &expected);
            assert_weights(Power::new(f64::INFINITY).unwrap(), &q, &expected);
        }
    }
}

#[test]
fn the_ends_of_cutoff_are_balance_and_maximum() {
    let q = [0.2, 0.0, 3.0, 1.0, 3.0];
    let same = |a: Option<Vec<f64>>, b: Option<Vec<f64>>| assert_eq!(a, b);
    same(weights(&Cutoff::new(0.0).unwrap(), &q), weights(&Balance, &q));
    same(weights(&Cutoff::new(1.0).unwrap(), &q), weights(&Maximum, &q));
}

#[test]
fn the_ends_of_power() {
    let q = [0.2, 0.0, 3.0, 1e-300];
    // β = 0: equal among those that cover the point, however little.
    assert_eq!(weights(&Power::new(0.0).unwrap(), &q).unwrap()[1], 0.0);
    assert_weights(Power::new(0.0).unwrap(), &[0.2, 3.0, 1e-300], &[1.0 / 3.0; 3]);
    assert_weights(Power::new(0.0).unwrap(), &[1e300, 1e-300], &[0.5, 0.5]);
    assert_weights(Power::new(0.0).unwrap(), &[1e200, 1e-200], &[0.5, 0.5]);
    let w = 10f64.powf(-0.4);
    assert_weights(Power::new(1e-3).unwrap(), &[1e200, 1e-200], &[1.0 / (1.0 + w), w / (1.0 + w)]);
    assert_weights(Power::new(1.0).unwrap(), &[1.0, 3.0], &[0.25, 0.75]);
    assert_weights(Power::new(1e3).unwrap(), &[1.0, 0.4], &[1.0, 0.0]);
    assert_weights(Power::new(f64::INFINITY).unwrap(), &[1.0, 0.999], &[1.0, 0.0]);
}

/// n = (2^40, 1) and pdfs of 1e300, whose product with n would overflow.
#[test]
fn counts_and_densities_do_not_overflow_together() {
    let n = 2f64.powi(40);
    let few = 2f64.powi(-40);
    let techniques = stated(&[1e300, 1e300]);
    let total = n + 1.0;
    let (p0, p1) = (n / total, 1.0 / total);
    let one = OneSample::new(&[(&techniques[0], p0), (&techniques[1], p1)], 2).unwrap();
    // The second number selects the last technique.
    let points = Replay::new([vec![0.5, 0.5, 1.0 - f64::EPSILON / 2.0, 0.5]]).unwrap();
    let mut w = Vec::new();
    one.inspect(&|_: &usize| 1e300, &points, |s| {
        w.push(s.contribution() * [p0, p1][s.technique()]);
    })
    .unwrap();
    assert!((w[0] - (1.0 - few)).abs() <= f64::EPSILON, "{w:?}");
    assert!((w[1] * total - 1.0).abs() <= 4.0 * f64::EPSILON, "{w:?}");
    // As counts: exact up to 2^53, refused beyond.
    assert!(MultiSample::new(&[(&techniques[0], 1 << 40), (&techniques[1], 1)]).is_ok());
    assert!(MultiSample::new(&[(&techniques[0], (1 << 53) + 1)]).is_err());
    assert!(MultiSample::new(&[(&techniques[0], u64::MAX), (&techniques[1], 1)]).is_err());
}

/// A technique that must not be asked.
struct Invisible;

impl Technique for Invisible {
    type Point = usize;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, _: &[f64]) -> usize {
        panic!("sampled")
    }

    fn pdf(&self, _: &usize) -> f64 {
        panic!("evaluated")
    }
}

#[test]
fn a_technique_without_samples_is_invisible() {
    let visible = Stated { number: 0, q: 0.5 };
    let f = |_: &usize| 1.0;
    let mis = MultiSample::new(&[(&Invisible, 0), (&visible, 3)]).unwrap();
    let estimate = mis.estimate(&f, 1).unwrap();
    assert_eq!((estimate.value(), estimate.standard_error()), (2.0, Some(0.0)));
    let equal = MultiSample::new(&[(&visible, 3), (&Invisible, 0)]).unwrap();
    let equal = equal.weighting(Constant::equal()).unwrap();
    assert_eq!(equal.estimate(&f, 1).unwrap().value(), 2.0);
    let one = OneSample::new(&[(&visible, 1.0), (&Invisible, 0.0)], 5).unwrap();
    assert_eq!(one.estimate(&f, 1).unwrap().value(), 2.0);
    assert_eq!(one.weights_without_probabilities().estimate(&f, 1).unwrap().value(), 2.0);
}

/// Constant weights need no other pdf: the other technique's panics if asked at a foreign point.
#[test]
fn constant_weights_evaluate_only_the_own_pdf() {
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
            0.5
        }
    }
    let mis = MultiSample::new(&[(&OwnOnly(0), 600), (&OwnOnly(1), 10)]).unwrap();
    let mis = mis.weighting(Constant::new([0.25, 0.75]).unwrap()).unwrap();
    assert_eq!(mis.estimate(&|_: &usize| 1.0, 1).unwrap().value(), 2.0);
}

#[test]
fn the_weights_sum_to_1_over_all_exponents() {
    let mut generator = Pcg64Dxsm::seed_from_u64(1);
    let mut uniform = || generator.next_u64() as f64 / 2f64.powi(64);
    for k in (1..=6).cycle().take(100_000) {
        let q: Vec<f64> = (0..k).map(|_| 10f64.powf(uniform() * 615.0 - 307.0)).collect();
        let sums = [
            weights(&Balance, &q),
            weights(&Power::squared(), &q),
            weights(&Power::new(0.5).unwrap(), &q),
            weights(&Power::new(7.5).unwrap(), &q),
            weights(&Cutoff::new(0.3).unwrap(), &q),
            weights(&Maximum, &q),
            weights(&aware(&q), &q),
            weights(&Constant::equal(), &q),
        ];
        for (name, w) in sums.into_iter().enumerate() {
            let w = w.unwrap();
            let sum: f64 = w.iter().sum();
            assert!((sum - 1.0).abs() <= 3.0 * f64::from(k) * f64::EPSILON, "{name}: {q:?} {w:?}");
            assert!(w.iter().all(|w| (0.0..=1.0 + f64::EPSILON).contains(w)), "{name}: {w:?}");
        }
    }
}

/// Weightings behind pointers, so that a list can hold several.
#[test]
fn a_boxed_weighting_is_the_weighting() {
    let (a, b) = (Stated { number: 0, q: 0.5 }, Stated { number: 1, q: 2.0 });
    let f = |i: &usize| [3.0, 5.0][*i];
    let value = |weighting: &dyn Weighting| {
        let mis = MultiSample::new(&[(&a, 2), (&b, 1)]).unwrap().weighting(weighting).unwrap();
        mis.estimate(&f, 1).unwrap().value()
    };
    let direct = |weighting: &dyn Weighting| {
        let w = |i| {
            let q = [2.0 * 0.5, 2.0];
            weighting.constant_weight(i, &[0.5; 2]).unwrap_or(weights(weighting, &q).unwrap()[i])
        };
        w(0) * 3.0 / 0.5 + w(1) * 5.0 / 2.0
    };
    let list: [Box<dyn Weighting>; 6] = [
        Box::new(Balance),
        Box::new(Power::new(0.5).unwrap()),
        Box::new(Cutoff::new(0.6).unwrap()),
        Box::new(Maximum),
        Box::new(VarianceAware::new([3.0, 1.0]).unwrap()),
        Box::new(Constant::new([0.25, 0.75]).unwrap()),
    ];
    for weighting in &list {
        assert!(
            (value(&weighting) / direct(&weighting) - 1.0).abs() < 1e-14,
            "{}",
            value(weighting)
        );
    }
    let wrong: Box<dyn Weighting> = Box::new(Constant::new([1.0]).unwrap());
    assert!(MultiSample::new(&[(&a, 2), (&b, 1)]).unwrap().weighting(wrong).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 2000,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// What the estimators apply is what the function states.
    #[test]
    fn applied_weights_are_the_stated_ones(
        exponents in prop::collection::vec(-300.0..300.0_f64, 1..6),
        beta in 0.0..8.0_f64,
        a in 0.0..1.0_f64,
    ) {
        let q: Vec<f64> = exponents.iter().map(|e| 10f64.powf(*e)).collect();
        let (power, cutoff) = (Power::new(beta).unwrap(), Cutoff::new(a).unwrap());
        for (stated, applied) in [
            (weights(&Balance, &q), applied(Balance, &q)),
            (weights(&power, &q), applied(power, &q)),
            (weights(&cutoff, &q), applied(cutoff, &q)),
            (weights(&Maximum, &q), applied(Maximum, &q)),
            (weights(&aware(&q), &q), applied(aware(&q), &q)),
            (weights(&Constant::equal(), &q), applied(Constant::equal(), &q)),
        ] {
            for (stated, applied) in stated.unwrap().iter().zip(applied.unwrap()) {
                // Logarithms near 700 cost three digits.
                let tolerance = 1e-11 * stated + 1e-30;
                prop_assert!((stated - applied).abs() <= tolerance, "{stated} {applied} {q:?}");
            }
        }
    }

    /// Weights do not depend on the scale of the densities.
    #[test]
    fn weights_are_scale_free(
        q in prop::collection::vec(1e-3..1e3_f64, 1..6),
        exponent in -900..900_i32,
        beta in 0.0..8.0_f64,
    ) {
        let scaled: Vec<f64> = q.iter().map(|q| q * 2f64.powi(exponent)).collect();
        prop_assert_eq!(weights(&Balance, &q), weights(&Balance, &scaled));
        let power = Power::new(beta).unwrap();
        prop_assert_eq!(weights(&power, &q), weights(&power, &scaled));
        prop_assert_eq!(weights(&Maximum, &q), weights(&Maximum, &scaled));
        prop_assert_eq!(weights(&aware(&q), &q), weights(&aware(&q), &scaled));
    }
}
