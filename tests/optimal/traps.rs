//! Where least squares go wrong: zeros, near collinearity, duplicates, few samples.

use mis::points::{Random, Replay};
use mis::technique::{FnTechnique, Linear, PowerLaw, Uniform};
use mis::{Estimator, Fit, MultiSample, OptimalEstimate, OptimalMis, Technique};

use crate::cases::{self, Case};
use crate::common::canonical_numbers;
use crate::ensembles::{CROSS_FIT, FITS, Mean, ensemble, ratio};

fn ramp() -> Linear {
    Linear::new(0.0, 1.0, 0.0, 2.0).unwrap()
}

fn estimate(list: &[(&dyn Technique<Point = f64>, u64)], fit: Fit, seed: u64) -> OptimalEstimate {
    let mis = OptimalMis::new(list).unwrap().fit(fit).unwrap();
    mis.estimate(&|x: &f64| x.exp(), seed).unwrap()
}

/// The coefficients of what leaves out samples with f = 0 would give 0.56767.
#[test]
fn samples_where_the_integrand_is_0_count() {
    let (flat, ramp) = (Uniform::unit(), ramp());
    let below = |x: &f64| f64::from(u8::from(*x < 0.5));
    for fit in FITS {
        let mis = OptimalMis::new(&[(&flat, 400), (&ramp, 400)]).unwrap().fit(fit).unwrap();
        let found: Vec<_> = (0..80).map(|seed| mis.estimate(&below, seed).unwrap()).collect();
        let values = Mean::of(found.iter().map(OptimalEstimate::value));
        assert!(values.z(0.5).abs() < 4.42 && values.error < 0.004, "{fit:?}: {values:?}");
        for e in found.iter().map(OptimalEstimate::estimate) {
            assert_eq!(e.samples(), 800);
            // Half of those of the one, and three quarters of those of the other.
            assert!((350..650).contains(&e.zero()), "{}", e.zero());
        }
    }
}

/// z and y of a sample.
type Row = ([f64; 2], f64);

/// The least squares themselves, of a basis that is far from collinear.
fn least_squares(rows: &[Row]) -> f64 {
    let n = rows.len() as f64;
    let mean = |of: fn(&Row) -> f64| rows.iter().map(of).sum::<f64>() / n;
    let (z0, z1, y) = (mean(|r| r.0[0]), mean(|r| r.0[1]), mean(|r| r.1));
    let [mut s00, mut s01, mut s11, mut t0, mut t1] = [0.0; 5];
    for ([a, b], of) in rows {
        let (d0, d1, dy) = (a - z0, b - z1, of - y);
        s00 += d0 * d0;
        s01 += d0 * d1;
        s11 += d1 * d1;
        t0 += d0 * dy;
        t1 += d1 * dy;
    }
    let det = s00 * s11 - s01 * s01;
    y - z0 * (s11 * t0 - s01 * t1) / det - z1 * (s00 * t1 - s01 * t0) / det
}

#[test]
fn near_collinear_techniques_do_no_harm() {
    let (flat, square) = (Uniform::unit(), PowerLaw::new(2.0, 0.0, 1.0).unwrap());
    for e in [1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13] {
        // What the rounding of densities makes of their differences.
        let bound = f64::min(1e-16 / e, 2e-5);
        let cdf = |x: f64| x + e * (x * x - x);
        let inverse = |u: f64| 2.0 * u / (1.0 - e + ((1.0 - e) * (1.0 - e) + 4.0 * e * u).sqrt());
        let pdf = |x: f64| 1.0 + e * (2.0 * x - 1.0);
        let tilted = FnTechnique::new([0.0, 1.0], pdf, cdf, inverse).unwrap();
        let mut worst = 0.0;
        let list: [(&dyn Technique<Point = f64>, u64); 3] =
            [(&flat, 400), (&tilted, 400), (&square, 400)];
        for seed in 0..5 {
            let mut rows = Vec::new();
            let add = |sample: &mis::Sample<'_, f64, f64>| {
                let x = *sample.x();
                let mixture = (2.0 + e * (2.0 * x - 1.0) + 3.0 * x * x) / 3.0;
                let z = [(2.0 * x - 1.0) / mixture, (3.0 * x * x - 1.0) / mixture];
                rows.push((z, x.exp() / mixture));
            };
            let mis = MultiSample::new(&list).unwrap();
            mis.inspect(&|x: &f64| x.exp(), &Random::new(seed), add).unwrap();
            let exact = least_squares(&rows);
            let found = estimate(&list, Fit::Direct, seed);
            let off = (found.value() - exact).abs();
            worst = f64::max(worst, off);
            assert!(off < bound, "{e:e}: {off:e}");
            // Far below the standard error, about 1e-4, which is not hidden.
            let error = found.standard_error().unwrap();
            assert!((3e-5..3e-4).contains(&error), "{e:e}: {error:e}");
            for fit in [CROSS_FIT, Fit::Progressive] {
                let z = (estimate(&list, fit, seed).value() - exact) / error;
                assert!(z.abs() < if fit == CROSS_FIT { 2.0 } else { 200.0 }, "{e:e} {fit:?} {z}");
            }
        }
        println!("{e:e}: {worst:e}");
    }
}

#[test]
fn duplicates_count_for_nothing() {
    let (flat, ramp) = (Uniform::unit(), ramp());
    let (a, b) = (canonical_numbers(1, 300), canonical_numbers(2, 300));
    let replay = |streams: &[&[f64]]| Replay::new(streams.iter().map(|s| s.to_vec())).unwrap();
    let f = |x: &f64| x.exp();
    let of = |list: &[(&dyn Technique<Point = f64>, u64)], streams: &[&[f64]]| {
        let mis = OptimalMis::new(list).unwrap().fit(Fit::Direct).unwrap();
        mis.estimate_from(&f, &replay(streams)).unwrap()
    };
    let once = of(&[(&flat, 300), (&ramp, 300)], &[&a, &b]);
    assert_eq!(once.rank(), 1);
    // Of the reference; of another one; both.
    let twice = [
        of(&[(&flat, 150), (&flat, 150), (&ramp, 300)], &[&a[..150], &a[150..], &b]),
        of(&[(&flat, 300), (&ramp, 100), (&ramp, 200)], &[&a, &b[..100], &b[100..]]),
        of(
            &[(&flat, 100), (&ramp, 100), (&flat, 200), (&ramp, 200)],
            &[&a[..100], &b[..100], &a[100..], &b[100..]],
        ),
    ];
    for (twice, zeros) in twice.iter().zip([2, 2, 3]) {
        assert_eq!((twice.rank(), twice.uncontrolled()), (1, 0));
        assert!((twice.value() / once.value() - 1.0).abs() < 1e-14, "{twice} {once}");
        let [error, expected] = [twice, &once].map(|e| e.standard_error().unwrap());
        // The variances within fewer samples each.
        assert!((error / expected - 1.0).abs() < 0.02, "{twice} {once}");
        // The reference has the coefficient 0, too.
        let beta = &twice.controls().coefficients()[0];
        assert_eq!(beta.iter().filter(|beta| **beta == 0.0).count(), zeros, "{beta:?}");
        assert!(beta.iter().all(|beta| beta.is_finite()));
    }
    for fit in [Fit::Direct, CROSS_FIT] {
        let list: [(&dyn Technique<Point = f64>, u64); 2] = [(&flat, 200), (&flat, 200)];
        let same = estimate(&list, fit, 1);
        let plain = MultiSample::new(&list).unwrap().estimate(&f, 1).unwrap();
        assert_eq!(same.rank(), 0);
        assert!((same.value() / plain.value() - 1.0).abs() < 1e-14, "{same} {plain}");
    }
}

#[test]
fn too_few_samples_fall_back_to_the_balance_heuristic() {
    let powers: Vec<PowerLaw> =
        (0..5).map(|m| PowerLaw::new(f64::from(m), 0.0, 1.0).unwrap()).collect();
    let f = |x: &f64| x.exp();
    for k in 1..=5 {
        for n in 1..=6 {
            let list: Vec<(&dyn Technique<Point = f64>, u64)> =
                powers[..k].iter().map(|p| (p as _, n)).collect();
            for (fit, seed) in FITS.into_iter().flat_map(|fit| [(fit, 1), (fit, 2)]) {
                let found = estimate(&list, fit, seed);
                let what = format!("{k} {n} {fit:?}: {found}");
                let all = n * k as u64;
                assert_eq!(found.estimate().samples(), all);
                assert!(found.value().is_finite() && found.uncontrolled() <= all, "{what}");
                assert_eq!(found.standard_error().is_some(), n > 1, "{what}");
                if found.uncontrolled() == all {
                    let plain = MultiSample::new(&list).unwrap().estimate(&f, seed).unwrap();
                    let off = (found.value() / plain.value() - 1.0).abs();
                    assert!(off < 1e-14, "{what} {plain}");
                    assert!(found.to_string().ends_with(": too few samples"), "{what}");
                    let [error, expected] = [found.standard_error(), plain.standard_error()];
                    if let (Some(error), Some(expected)) = (error, expected) {
                        assert!((error / expected - 1.0).abs() < 1e-9, "{what} {plain}");
                    }
                }
                // N ≤ K: as many coefficients as samples would make any residual 0.
                if k > 1 && n == 1 {
                    assert_eq!(found.uncontrolled(), all, "{what}");
                }
            }
        }
    }
}

/// Of a few samples where f is not 0, coefficients would be noise.
#[test]
fn too_few_contributions_make_no_coefficients() {
    let (flat, ramp) = (Uniform::unit(), ramp());
    let rare = |x: &f64| f64::from(u8::from(*x < 0.006));
    for fit in [CROSS_FIT, Fit::Progressive] {
        let mis = OptimalMis::new(&[(&flat, 500), (&ramp, 500)]).unwrap().fit(fit).unwrap();
        let mut without = 0;
        for seed in 0..50 {
            let found = mis.estimate(&rare, seed).unwrap();
            let hits = found.estimate().samples() - found.estimate().zero();
            if hits <= 1 {
                assert_eq!((found.uncontrolled(), found.rank()), (1000, 0), "{fit:?} {hits}");
                without += 1;
            }
            if hits > 6 && fit == CROSS_FIT {
                assert!(found.uncontrolled() < 1000, "{hits}");
            }
        }
        assert!((2..25).contains(&without), "{without}");
    }
}

/// One sample more than coefficients: something is left, but its size is unknown.
#[test]
fn errors_are_unknown_where_nothing_is_left_to_tell_them() {
    let p = [0, 1, 2].map(|m| PowerLaw::new(f64::from(m), 0.0, 1.0).unwrap());
    let list: [(&dyn Technique<Point = f64>, u64); 3] = [(&p[0], 2), (&p[1], 2), (&p[2], 1)];
    let found = estimate(&list, Fit::Direct, 1);
    assert_eq!((found.uncontrolled(), found.rank(), found.standard_error()), (0, 2, None));
    assert_eq!(found.estimate().interval(0.95).unwrap().upper, f64::INFINITY);
}

#[test]
fn values_may_be_negative() {
    let (flat, ramp) = (Uniform::unit(), ramp());
    let f = |x: &f64| (x - 0.5).powi(2);
    let mis = OptimalMis::new(&[(&flat, 3), (&ramp, 3)]).unwrap().fit(Fit::Direct).unwrap();
    let negative = (0..500).filter(|seed| mis.estimate(&f, *seed).unwrap().value() < 0.0).count();
    assert!((1..50).contains(&negative), "{negative}");
}

/// Standard errors of the direct fit: never too small, and right as soon as there are samples.
fn direct_errors_are_calibrated(cases: Vec<Case>, seeds: u64) {
    for case in cases.into_iter().filter(|case| case.calibrated) {
        for (of_each, [low, high]) in [(8, [0.45, 1.05]), (16, [0.55, 1.05]), (50, [0.8, 1.08])] {
            let found = ensemble(&case, Some(Fit::Direct), of_each * case.techniques, seeds);
            let pair =
                |f: &cases::Found| ((f.value - case.integral).powi(2), f.variance.unwrap_or(0.0));
            let ratio = ratio(&found.iter().map(pair).collect::<Vec<_>>());
            let what = format!("{}, {of_each} of each: {ratio:?}", case.name);
            println!("{what}");
            assert!(ratio.mean + 4.42 * ratio.error > low, "{what}");
            assert!(ratio.mean - 4.42 * ratio.error < high, "{what}");
        }
    }
}

#[test]
fn errors_of_direct_fits_are_not_optimistic() {
    direct_errors_are_calibrated(cases::few(), 100);
}

#[test]
#[ignore = "takes half a minute in release"]
fn errors_of_direct_fits_are_not_optimistic_in_full_ensembles() {
    direct_errors_are_calibrated(cases::all(), 10_000);
}
