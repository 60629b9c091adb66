//! Antithetic pairs: exact, independent of each other, and of random access.

use mis::points::{Antithetic, PointSource, Random};
use mis::technique::{Product, Uniform};
use mis::{Estimator, MultiSample, OneSample};

fn points(seed: u64, stream: usize, first: u64, dimension: usize, rows: usize) -> Vec<f64> {
    let mut xi = vec![f64::NAN; rows * dimension];
    Antithetic::new(seed).fill(stream, first, dimension, &mut xi).unwrap();
    xi
}

#[test]
fn pairs_are_mirrored_exactly() {
    let x = points(1, 2, 0, 3, 10_000);
    for pair in x.chunks(6) {
        for (u, v) in pair[..3].iter().zip(&pair[3..]) {
            assert!(1.0 - u == *v && 1.0 - v == *u, "{u:e} {v:e}");
            assert!(0.0 < *u && *u < 1.0 && 0.0 < *v && *v < 1.0);
        }
    }
    // The first of a pair is on either side of 1/2.
    let below = x.chunks(6).filter(|pair| pair[0] < 0.5).count();
    assert!((2300..2700).contains(&below), "{below}");
}

#[test]
fn any_block_has_the_same_points() {
    for dimension in [1, 2, 5] {
        let whole = points(1, 3, 0, dimension, 1200);
        for first in [0_usize, 1, 2, 255, 256, 511, 512, 513, 700] {
            for rows in [0, 1, 2, 3, 64, 257, 488] {
                let block = points(1, 3, first as u64, dimension, rows);
                assert_eq!(block, whole[first * dimension..][..rows * dimension], "{first} {rows}");
            }
        }
    }
}

#[test]
fn the_points_of_a_seed_are_frozen() {
    let bits: Vec<u64> = points(7, 3, 254, 2, 2).iter().map(|u| u.to_bits()).collect();
    let golden = [
        0x3fea_be80_9494_9f5b,
        0x3fee_65c1_6ca7_3b5b,
        0x3fc5_05fd_adad_8294,
        0x3fa9_a3e9_358c_4a50,
    ];
    assert_eq!(bits, golden, "{bits:#x?}");
}

/// A sum of straight lines is exact: each pair is. One sample too many is not part of a pair.
#[test]
fn straight_lines_have_no_error() {
    let square = Product::new([Uniform::unit(), Uniform::new(-1.0, 3.0).unwrap()]).unwrap();
    let line = |x: &[f64; 2]| 3.0 * x[0] - 2.0 * x[1] + 4.0;
    let estimate = |n| {
        let mis = MultiSample::new(&[(&square, n)]).unwrap();
        mis.estimate_from(&line, &Antithetic::new(1)).unwrap()
    };
    let even = estimate(64 * 10);
    let scale = 4.0 * 9.0; // the area times the largest of the line
    assert!((even.value() - 4.0 * 3.5).abs() <= 4.0 * f64::EPSILON * scale, "{even}");
    assert!(even.standard_error().unwrap() <= 4.0 * f64::EPSILON * scale, "{even}");
    let odd = estimate(64 * 10 + 32);
    assert!(odd.standard_error().unwrap() > 1e-3 * scale, "{odd}");
}

/// Streams, seeds and pairs are independent of each other, and of random numbers of the same seed.
#[test]
fn pairs_are_independent() {
    type Pair<'a> = &'a dyn Fn(usize) -> [f64; 2];
    let n = 4096;
    let random = |k: usize| {
        let mut xi = [0.0];
        Random::new(1).fill(0, k as u64, 1, &mut xi).unwrap();
        xi[0]
    };
    let at =
        |seed: usize, stream, sample: usize| points(seed as u64, stream, sample as u64, 1, 1)[0];
    let pairs: [(&str, Pair<'_>); 6] = [
        ("stream", &|k| [at(1, 2 * k, 4), at(1, 2 * k + 1, 4)]),
        ("seed", &|k| [at(2 * k, 0, 4), at(2 * k + 1, 0, 4)]),
        ("pair", &|k| [at(1, 0, 4 * k), at(1, 0, 4 * k + 2)]),
        ("dimension", &|k| <[f64; 2]>::try_from(points(1, k, 4, 2, 1)).unwrap()),
        ("random", &|k| [at(1, 0, 2 * k), random(k)]),
        ("random, the same sample", &|k| [at(1, 0, 2 * k), random(2 * k)]),
    ];
    for (name, pair) in pairs {
        let sum: f64 = (0..n).map(pair).map(|[a, b]| (a - 0.5) * (b - 0.5)).sum();
        // The variance of a term is 1/144.
        let score = 12.0 * sum / (n as f64).sqrt();
        assert!(score.abs() < 5.0, "{name}: {score}");
    }
}

#[test]
fn arguments_and_far_samples() {
    for (replicates, good) in [(0, false), (1, false), (2, true), (4096, true), (4097, false)] {
        assert_eq!(Antithetic::new(1).with_replicates(replicates).is_ok(), good);
    }
    let text = Antithetic::new(1).with_replicates(1).unwrap_err().to_string();
    assert_eq!(text, "Antithetic: `replicates` is 1, but it must be at least 2 and at most 4096");
    let source = Antithetic::new(3).with_replicates(5).unwrap();
    assert_eq!((source.replicates(), Antithetic::new(3).replicates()), (5, 32));
    assert_eq!(format!("{source:?}"), "Antithetic { seed: 3, replicates: 5 }");
    let last = points(1, 0, u64::MAX, 3, 1);
    let before = points(1, 0, u64::MAX - 1, 3, 1);
    assert!(last.iter().zip(&before).all(|(v, u)| *v == 1.0 - u));
    // Numbers that do not fill a row, or none in it.
    Antithetic::new(1).fill(0, 1, 4, &mut [0.0; 3]).unwrap();
    Antithetic::new(1).fill(0, 1, 0, &mut [0.0; 3]).unwrap();
    Antithetic::new(1).fill(0, 1, usize::MAX, &mut []).unwrap();
}

/// The selection of a technique is mirrored as well.
#[test]
fn one_sample_selects_by_mirrored_numbers() {
    let (a, b) = (Uniform::unit(), Uniform::new(0.0, 2.0).unwrap());
    let one = OneSample::new(&[(&a, 0.5), (&b, 0.5)], 640).unwrap();
    let mut selected = [0; 2];
    let points = Antithetic::new(1);
    one.inspect(&|_: &f64| 1.0, &points, |sample| selected[sample.technique()] += 1).unwrap();
    assert_eq!(selected, [320, 320]);
}
