//! Estimators at the numerical extremes: coverage, zero variance, scales, heavy tails.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use mis::points::{Random, Replay};
use mis::technique::{Linear, Normal, PowerLaw, Product, ProductVec, Uniform};
use mis::weighting::{Balance, Constant, Cutoff, Maximum, Power, VarianceAware};
use mis::{Estimate, Estimator, LnValue, MultiSample, OneSample, Technique};

fn uniform(a: f64, b: f64) -> Uniform {
    Uniform::new(a, b).unwrap()
}

// Coverage.

#[test]
fn disjoint_supports_combine_exactly() {
    let (left, right) = (uniform(0.0, 1.0), uniform(1.0, 2.0));
    let one = |_: &f64| 1.0;
    for n in [1, 2, 1000] {
        let mis = MultiSample::new(&[(&left, n), (&right, n)]).unwrap();
        let estimate = mis.estimate(&one, 1).unwrap();
        assert_eq!(estimate.value(), 2.0);
        assert_eq!(estimate.standard_error(), if n == 1 { None } else { Some(0.0) });
    }
    // Constant weights need every technique to cover f: half of the integral is lost.
    let constant = MultiSample::new(&[(&left, 10), (&right, 10)]).unwrap();
    let constant = constant.weighting(Constant::equal()).unwrap();
    assert_eq!(constant.estimate(&one, 1).unwrap().value(), 1.0);
}

#[test]
fn what_no_technique_covers_is_left_out() {
    let half = uniform(0.0, 1.0);
    let estimate = MultiSample::new(&[(&half, 100)]).unwrap().estimate(&|_: &f64| 1.0, 1).unwrap();
    assert_eq!(estimate.value(), 1.0); // of 2 on [0, 2]
}

/// Densities of 0.1^1000 and 2 · 0.1^1000, which are 0 in f64.
#[test]
fn densities_that_underflow_are_weighted_through_logarithms() {
    let wide = ProductVec::new(vec![uniform(0.0, 10.0); 1000]).unwrap();
    let mut coordinates = vec![uniform(0.0, 10.0); 1000];
    coordinates[0] = uniform(0.0, 5.0);
    let narrow = ProductVec::new(coordinates).unwrap();
    let f = |x: &Vec<f64>| LnValue::positive(wide.ln_pdf(x));
    let exact = |x: &Vec<f64>| if x[0] <= 5.0 { 2.0 / 3.0 } else { 2.0 };
    assert_eq!(wide.pdf(&vec![1.0; 1000]), 0.0);

    let mis = MultiSample::new(&[(&wide, 300), (&narrow, 300)]).unwrap();
    let mut seen = 0;
    let estimate = mis
        .inspect(&f, &Random::new(1), |sample| {
            let y = sample.contribution();
            assert!((y / exact(sample.x()) - 1.0).abs() < 1e-11, "{y}");
            seen += 1;
        })
        .unwrap();
    assert_eq!((seen, estimate.uncovered(), estimate.zero()), (600, 0, 0));
    let error = estimate.standard_error().unwrap();
    assert!((estimate.value() - 1.0).abs() < 5.0 * error && error < 0.04, "{estimate}");

    // The other weightings and the one-sample model, from the same ratios.
    let squared = mis.weighting(Power::squared()).unwrap();
    let value = squared.estimate(&f, 1).unwrap();
    assert!((value.value() - 1.0).abs() < 5.0 * value.standard_error().unwrap());
    let one = OneSample::new(&[(&wide, 0.5), (&narrow, 0.5)], 600).unwrap();
    let value = one.estimate(&f, 1).unwrap();
    assert!((value.value() - 1.0).abs() < 5.0 * value.standard_error().unwrap());
    let only = MultiSample::new(&[(&wide, 10)]).unwrap().weighting(Constant::equal()).unwrap();
    let value = only.estimate(&f, 1).unwrap();
    assert!((value.value() - 1.0).abs() < 1e-11 && value.standard_error().unwrap() < 1e-11);
}

#[test]
fn a_density_that_overflows_is_weighted_through_logarithms() {
    let p = ProductVec::new(vec![Uniform::new(0.0, 0.1).unwrap(); 1000]).unwrap();
    let f = |x: &Vec<f64>| LnValue::positive(p.ln_pdf(x));
    let e = MultiSample::new(&[(&p, 20)]).unwrap().estimate(&f, 1).unwrap();
    assert!((e.value() - 1.0).abs() < 1e-11);
}

#[test]
fn a_density_that_overflows_with_the_integrand_is_no_harm() {
    // p = 1e300 and f = 1e300 p on a tiny interval; f / p is representable.
    let needle = uniform(0.0, 1e-300);
    let estimate = MultiSample::new(&[(&needle, 4)]).unwrap();
    let estimate = estimate.estimate(&|_: &f64| 1e307, 1).unwrap();
    assert!((estimate.value() / 1e7 - 1.0).abs() < 1e-12, "{estimate}");
}

// Variance.

#[test]
fn zero_variance_is_reported_as_exactly_that() {
    let p = uniform(0.0, 10.0);
    for mis in [MultiSample::new(&[(&p, 10)]).unwrap(), MultiSample::new(&[(&p, 12_345)]).unwrap()]
    {
        let estimate = mis.estimate(&|_: &f64| 0.01, 1).unwrap();
        assert!((estimate.value() - 0.1).abs() < 1e-16);
        assert_eq!(estimate.standard_error(), Some(0.0));
        assert_eq!(estimate.variance(), Some(0.0));
    }
    let ramp = Linear::new(0.0, 1.0, 0.0, 2.0).unwrap();
    let estimate = MultiSample::new(&[(&ramp, 1000)]).unwrap();
    let estimate = estimate.estimate(&|x: &f64| 3.0 * x, 1).unwrap();
    assert!((estimate.value() - 1.5).abs() < 1e-15);
    assert!(estimate.standard_error().unwrap() < 1e-16);
    let one = OneSample::new(&[(&ramp, 0.5), (&ramp, 0.5)], 100).unwrap();
    assert!(one.estimate(&|x: &f64| 3.0 * x, 1).unwrap().standard_error().unwrap() < 1e-15);
}

#[test]
fn a_large_offset_leaves_the_variance() {
    let p = uniform(0.0, 1.0);
    let points = Replay::new([vec![0.04, 0.07, 0.13, 0.16]]).unwrap();
    let f = |x: &f64| 1e9 + (x * 100.0).round();
    let estimate = MultiSample::new(&[(&p, 4)]).unwrap().estimate_from(&f, &points).unwrap();
    assert_eq!(estimate.value(), 1e9 + 10.0);
    assert_eq!(estimate.standard_error(), Some(7.5_f64.sqrt())); // variance 30 of one of four
}

#[test]
fn the_error_survives_scales_whose_squares_do_not() {
    let p = uniform(0.0, 1.0);
    let mis = MultiSample::new(&[(&p, 1000), (&p, 500)]).unwrap();
    let unit = mis.estimate(&|x: &f64| *x, 1).unwrap();
    for scale in [1e200, 1e-200, 1e-300, 1e300] {
        let estimate = mis.estimate(&|x: &f64| scale * x, 1).unwrap();
        let ratio = |a: f64, b: f64| (a / b / scale - 1.0).abs();
        assert!(ratio(estimate.value(), unit.value()) < 1e-13);
        let (error, unit_error) = (estimate.standard_error(), unit.standard_error());
        assert!(ratio(error.unwrap(), unit_error.unwrap()) < 1e-12, "{scale}: {error:?}");
        let shares = |e: &Estimate| -> Vec<f64> {
            e.techniques().map(|t| t.share_of_variance.unwrap()).collect()
        };
        for (a, b) in shares(&estimate).iter().zip(shares(&unit)) {
            assert!((a / b - 1.0).abs() < 1e-10);
        }
    }
    // Where the sum of squares alone would overflow.
    let large = OneSample::new(&[(&p, 1.0)], 100_000).unwrap();
    let large = large.estimate(&|x: &f64| 1e306 * (2.0 * x - 1.0), 1).unwrap();
    let exact = 1e306 / 3e5_f64.sqrt();
    assert!((large.standard_error().unwrap() / exact - 1.0).abs() < 0.02, "{large}");
    let one = OneSample::new(&[(&p, 0.5), (&p, 0.5)], 1000).unwrap();
    let unit = one.estimate(&|x: &f64| *x, 1).unwrap().standard_error().unwrap();
    let large = one.estimate(&|x: &f64| 1e200 * x, 1).unwrap().standard_error().unwrap();
    assert!((large / unit / 1e200 - 1.0).abs() < 1e-12);
}

#[test]
fn one_sample_of_a_technique_leaves_the_error_unknown() {
    let (a, b) = (uniform(0.0, 1.0), uniform(0.0, 2.0));
    let f = |x: &f64| *x;
    for mis in
        [MultiSample::new(&[(&a, 1)]).unwrap(), MultiSample::new(&[(&a, 1000), (&b, 1)]).unwrap()]
    {
        let estimate = mis.estimate(&f, 1).unwrap();
        assert_eq!((estimate.standard_error(), estimate.variance()), (None, None));
        assert!(estimate.interval(0.95).unwrap().contains(-1e300));
        assert!(estimate.to_string().ends_with("(?)"), "{estimate}");
        assert!(estimate.techniques().all(|t| t.share_of_variance.is_none()));
    }
    let single = OneSample::new(&[(&a, 1.0)], 1).unwrap().estimate(&f, 1).unwrap();
    assert_eq!(single.standard_error(), None);
    // One sample may select a technique only once: the pooled error is known all the same.
    let pooled = OneSample::new(&[(&a, 0.5), (&b, 0.5)], 2).unwrap();
    assert!((0..20).all(|seed| pooled.estimate(&f, seed).unwrap().standard_error().is_some()));
}

#[test]
fn nothing_but_zeros_is_no_signal() {
    let p = uniform(0.0, 1.0);
    let mis = MultiSample::new(&[(&p, 100), (&p, 100)]).unwrap();
    let estimate = mis.estimate(&|_: &f64| 0.0, 1).unwrap();
    assert_eq!((estimate.value(), estimate.standard_error()), (0.0, None));
    assert_eq!((estimate.zero(), estimate.largest()), (200, None));
    assert_eq!(estimate.to_string(), "0(?)");
    assert!(estimate.techniques().all(|t| t.share_of_value.is_none()));
    // Component by component.
    let estimate = mis.estimate(&|x: &f64| [0.0, *x], 1).unwrap();
    let [zero, ramp] = estimate.standard_error();
    assert!(zero.is_none() && ramp.is_some() && estimate.zero() == 0);
}

// Heavy tails.

/// f = N(0, 1); p1 = N(0, 1/4) has infinite variance alone, and finite in the balance heuristic.
#[test]
fn a_technique_of_infinite_variance_is_tamed_by_the_balance_heuristic() {
    let (narrow, wide) = (Normal::new(0.0, 0.5).unwrap(), Normal::new(0.0, 2.0).unwrap());
    let f = Normal::new(0.0, 1.0).unwrap();
    let f = |x: &f64| f.pdf(x);
    let n = 200_000;
    let balance = MultiSample::new(&[(&narrow, n), (&wide, n)]).unwrap();
    let estimate = balance.estimate(&f, 1).unwrap();
    let variance = estimate.variance().unwrap() * n as f64;
    assert!((variance / 0.101_608_792_4 - 1.0).abs() < 0.02, "{variance}");
    let largest = estimate.largest().unwrap().contribution / estimate.value();
    assert!(largest < 2.0 / n as f64, "{largest}");
    // With constant weights a single contribution stands out.
    let constant = MultiSample::new(&[(&narrow, n), (&wide, n)]).unwrap();
    let constant = constant.weighting(Constant::equal()).unwrap().estimate(&f, 1).unwrap();
    let share = constant.largest().unwrap().contribution / constant.value();
    assert!(share > 100.0 * largest, "{share}");
    assert_eq!(constant.largest().unwrap().technique, 0);
}

#[test]
fn a_singular_integrand_is_tamed_as_well() {
    let (flat, root) = (uniform(0.0, 1.0), PowerLaw::new(-0.5, 0.0, 1.0).unwrap());
    let mis = MultiSample::new(&[(&flat, 100_000), (&root, 100_000)]).unwrap();
    let estimate = mis.estimate(&|x: &f64| x.powf(-0.5), 1).unwrap();
    let exact = 6.0 * 3f64.ln() - 4.0 - 2.0 * 3f64.ln().powi(2);
    let variance = estimate.variance().unwrap() * 1e5;
    assert!((variance / exact - 1.0).abs() < 0.02, "{variance} {exact}");
    assert!((estimate.value() - 2.0).abs() < 5.0 * estimate.standard_error().unwrap());
}

/// A spike that few samples find: weights that are fixed beforehand leave no bias, however often a
/// technique's sample variance is 0.
#[test]
fn a_rare_spike_does_not_bias_fixed_weights() {
    let (flat, ramp) = (uniform(0.0, 1.0), Linear::new(0.0, 1.0, 0.0, 2.0).unwrap());
    let spike = |x: &f64| if *x < 0.1 { 10.0 } else { 0.0 };
    let mis = MultiSample::new(&[(&flat, 8), (&ramp, 8)]).unwrap();
    let constant = mis.weighting(Constant::new([0.75, 0.25]).unwrap()).unwrap();
    let (mut sum, mut squares, mut silent) = (0.0, 0.0, 0);
    let seeds = 100_000;
    for seed in 0..seeds {
        let estimate = constant.estimate(&spike, seed).unwrap();
        sum += estimate.value();
        squares += estimate.value().powi(2);
        silent += u64::from(estimate.standard_error().is_none());
    }
    let n = seeds as f64;
    let error = ((squares / n - (sum / n).powi(2)) / n).sqrt();
    assert!((sum / n - 1.0).abs() < 5.0 * error && error < 0.02, "{} {error}", sum / n);
    assert!(silent as f64 / n > 0.3, "{silent}"); // no signal, and no error claimed
}

// Numbers of techniques.

#[test]
fn a_single_technique_is_plain_importance_sampling_under_every_weighting() {
    let p = Linear::new(0.0, 1.0, 1.0, 2.0).unwrap();
    let mis = || MultiSample::new(&[(&p, 777)]).unwrap();
    let f = |x: &f64| x.exp();
    let mut plain = 0.0;
    mis().inspect(&f, &Random::new(1), |s| plain += f(s.x()) / p.pdf(s.x()) / 777.0).unwrap();
    let values = [
        mis().estimate(&f, 1).unwrap(),
        mis().weighting(Power::squared()).unwrap().estimate(&f, 1).unwrap(),
        mis().weighting(Power::new(0.0).unwrap()).unwrap().estimate(&f, 1).unwrap(),
        mis().weighting(Cutoff::new(0.5).unwrap()).unwrap().estimate(&f, 1).unwrap(),
        mis().weighting(Maximum).unwrap().estimate(&f, 1).unwrap(),
        mis().weighting(VarianceAware::new([7.0]).unwrap()).unwrap().estimate(&f, 1).unwrap(),
        mis().weighting(Constant::equal()).unwrap().estimate(&f, 1).unwrap(),
    ];
    for estimate in values {
        assert!((estimate.value() / plain - 1.0).abs() < 1e-14, "{estimate} {plain}");
    }
}

#[test]
fn many_techniques_tile_a_domain() {
    let tiles: Vec<Uniform> =
        (0..100_u32).map(|k| uniform(f64::from(k), f64::from(k) + 1.5)).collect();
    let list: Vec<(&dyn Technique<Point = f64>, u64)> =
        tiles.iter().map(|t| (t as _, 20)).collect();
    let f = |x: &f64| if *x < 100.5 { *x } else { 0.0 };
    let exact = 100.5 * 100.5 / 2.0;
    let balance = MultiSample::new(&list).unwrap().weighting(Balance).unwrap();
    let power = MultiSample::new(&list).unwrap().weighting(Power::squared()).unwrap();
    for estimate in [balance.estimate(&f, 1).unwrap(), power.estimate(&f, 1).unwrap()] {
        let error = estimate.standard_error().unwrap();
        assert!((estimate.value() - exact).abs() < 5.0 * error && error < 0.01 * exact);
        assert_eq!(estimate.techniques().len(), 100);
    }
}

#[test]
fn canonical_numbers_at_the_ends_give_points_inside() {
    let ends = [0.0, 1.0 - f64::EPSILON / 2.0, 1.0];
    let (a, b) = (Normal::new(0.0, 1.0).unwrap(), PowerLaw::new(-0.9, 0.0, 1.0).unwrap());
    let mis = MultiSample::new(&[(&a, 3), (&b, 3)]).unwrap();
    let points = Replay::new([ends.to_vec(), ends.to_vec()]).unwrap();
    let estimate = mis.estimate_from(&|x: &f64| (-x * x).exp(), &points).unwrap();
    assert!(estimate.value().is_finite());
    // Selection at the ends, with a probability of 0 first and last.
    let list: [(&dyn Technique<Point = f64>, f64); 4] =
        [(&a, 0.0), (&a, 0.5), (&b, 0.5), (&b, 0.0)];
    let one = OneSample::new(&list, 3).unwrap();
    let points = Replay::new([ends.iter().flat_map(|u| [*u, 0.5]).collect()]).unwrap();
    let mut selected = Vec::new();
    one.inspect(&|_: &f64| 1.0, &points, |s| selected.push(s.technique())).unwrap();
    assert_eq!(selected, [1, 2, 2]);
}

#[test]
fn fixed_and_run_time_dimensions_agree() {
    let box3 = Product::new([uniform(0.0, 1.0), uniform(0.0, 2.0), uniform(0.0, 3.0)]).unwrap();
    let vec3 =
        ProductVec::new(vec![uniform(0.0, 1.0), uniform(0.0, 2.0), uniform(0.0, 3.0)]).unwrap();
    let fixed = MultiSample::new(&[(&box3, 1000)]).unwrap();
    let fixed = fixed.estimate(&|x: &[f64; 3]| x.iter().product::<f64>(), 1).unwrap();
    let run_time = MultiSample::new(&[(&vec3, 1000)]).unwrap();
    let run_time = run_time.estimate(&|x: &Vec<f64>| x.iter().product::<f64>(), 1).unwrap();
    assert_eq!(fixed.value().to_bits(), run_time.value().to_bits());
}
