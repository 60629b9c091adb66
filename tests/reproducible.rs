//! The same inputs and seed give the same bits.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use mis::points::Random;
use mis::technique::{Linear, PiecewiseConstant, Product, Uniform};
use mis::weighting::{Constant, Cutoff, Maximum, Power};
use mis::{Estimate, Estimator, InverseCdf, MultiSample, OneSample};

/// Densities and an integrand of additions, multiplications, divisions and square roots only, which
/// IEEE 754 rounds in one way: these bits are the same on every platform.
fn techniques() -> (Uniform, Linear, PiecewiseConstant) {
    (
        Uniform::new(0.0, 2.0).unwrap(),
        Linear::new(0.0, 2.0, 0.0, 1.0).unwrap(),
        PiecewiseConstant::new(&[0.0, 0.5, 2.0], &[1.0, 3.0]).unwrap(),
    )
}

fn f(x: &f64) -> f64 {
    x.sqrt() / (1.0 + x * x)
}

fn bits(estimate: &Estimate) -> [u64; 2] {
    [estimate.value().to_bits(), estimate.standard_error().unwrap().to_bits()]
}

#[test]
fn golden_values() {
    let (a, b, c) = techniques();
    let multi = || MultiSample::new(&[(&a, 1000), (&b, 600), (&c, 77)]).unwrap();
    let one = || OneSample::new(&[(&a, 0.5), (&b, 0.25), (&c, 0.25)], 1500).unwrap();
    let estimates = [
        multi().estimate(&f, 1),
        multi().estimate(&f, u64::MAX),
        multi().weighting(Power::squared()).unwrap().estimate(&f, 1),
        multi().weighting(Cutoff::new(0.25).unwrap()).unwrap().estimate(&f, 1),
        multi().weighting(Maximum).unwrap().estimate(&f, 1),
        multi().weighting(Constant::equal()).unwrap().estimate(&f, 1),
        one().estimate(&f, 1),
        one().weights_without_probabilities().estimate(&f, 1),
    ];
    let golden: [[u64; 2]; 8] = [
        [0x3feb_da75_2ec5_abbf, 0x3f80_01a1_91cc_20ff],
        [0x3feb_d182_dbea_cf06, 0x3f7f_714c_c9dc_26cb],
        [0x3feb_adf4_ab7b_2e5d, 0x3f81_e37b_dd20_7b6b],
        [0x3feb_dc17_a801_86e6, 0x3f82_8d8d_c3ec_3f80],
        [0x3feb_a365_54a7_ae35, 0x3f8c_189c_5901_fa3c],
        [0x3fec_376a_a2b2_75b6, 0x3f8d_0738_7afe_f147],
        [0x3feb_8e12_70e7_1ed1, 0x3f7d_fb63_8394_0183],
        [0x3feb_a2b6_781f_b25e, 0x3f86_2090_47cf_75cc],
    ];
    let found = estimates.map(|estimate| bits(&estimate.unwrap()));
    assert_eq!(found, golden, "{found:#x?}");
}

#[test]
fn golden_values_in_several_dimensions() {
    let unit = Uniform::unit();
    let (_, ramp, _) = techniques();
    let flat = Product::uniform([0.0, 0.0], [1.0, 2.0]).unwrap();
    let coordinates: [Box<dyn InverseCdf>; 2] = [Box::new(unit), Box::new(ramp)];
    let p = Product::new(coordinates).unwrap();
    let mis = MultiSample::new(&[(&flat, 300), (&p, 700)]).unwrap();
    let estimate = mis.estimate(&|x: &[f64; 2]| [x[0] * x[1], x[0] + x[1]], 1).unwrap();
    let found = [
        estimate.value().map(f64::to_bits),
        estimate.standard_error().map(|error| error.unwrap().to_bits()),
    ];
    let golden: [[u64; 2]; 2] = [
        [0x3ff0_011e_5536_2c99, 0x4008_2246_5dd7_8706],
        [0x3f94_2b14_95bf_6fc6, 0x3f95_bdbb_5fb0_2529],
    ];
    assert_eq!(found, golden, "{found:#x?}");
}

#[test]
fn the_same_seed_gives_the_same_estimate_and_another_seed_another() {
    let (a, b, _) = techniques();
    let mis = MultiSample::new(&[(&a, 5000), (&b, 5000)]).unwrap();
    let f = |x: &f64| x.sin().exp();
    let once = mis.estimate(&f, 3).unwrap();
    assert_eq!(mis.estimate(&f, 3).unwrap(), once);
    assert_eq!(mis.estimate_from(&f, &Random::new(3)).unwrap(), once);
    assert_ne!(bits(&mis.estimate(&f, 4).unwrap()), bits(&once));
}

#[test]
fn the_mean_contribution_is_the_estimate() {
    let (a, b, c) = techniques();
    let multi = MultiSample::new(&[(&a, 1000), (&b, 600), (&c, 77)]).unwrap();
    let one = OneSample::new(&[(&a, 0.5), (&b, 0.25), (&c, 0.25)], 1500).unwrap();
    let (mut sum, mut count) = (0.0, 0);
    let estimate = multi.inspect(&f, &Random::new(1), |sample| {
        sum += sample.contribution() / 1677.0;
        count += 1;
    });
    let estimate = estimate.unwrap();
    assert_eq!(count, estimate.samples());
    assert!((sum / estimate.value() - 1.0).abs() < 1e-13);
    let (mut sum, mut indices) = (0.0, Vec::new());
    let estimate = one.inspect(&f, &Random::new(1), |sample| {
        sum += sample.weight() * sample.value() / 1500.0;
        indices.push(sample.index());
    });
    assert!((sum / estimate.unwrap().value() - 1.0).abs() < 1e-13);
    indices.sort_unstable();
    assert!(indices.iter().copied().eq(0..1500));
}
