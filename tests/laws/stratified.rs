//! Strata: each is hit once in every block and coordinate; their variances; random access.

use mis::points::{PointSource, Random, Stratified};

fn points(strata: usize, stream: usize, first: u64, dimension: usize, rows: usize) -> Vec<f64> {
    let mut xi = vec![f64::NAN; rows * dimension];
    let source = Stratified::new(1, strata).unwrap();
    source.fill(stream, first, dimension, &mut xi).unwrap();
    xi
}

#[test]
fn every_stratum_is_hit_once_in_every_block_and_coordinate() {
    for strata in [2_usize, 3, 7, 64, 1000, 1 << 16] {
        for block in [0, 1, 5, (1 << 40) + 3] {
            let dimension = 3;
            let x = points(strata, 2, block * strata as u64, dimension, strata);
            for c in 0..dimension {
                let mut hit = vec![false; strata];
                let mut moved = 0;
                for (j, u) in x.iter().skip(c).step_by(dimension).enumerate() {
                    assert!(0.0 < *u && *u < 1.0);
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
                    let k = (u * strata as f64) as usize;
                    assert!(!hit[k], "{strata} {block} {c}: {k}");
                    hit[k] = true;
                    moved += usize::from(k != j);
                }
                assert!(strata < 64 || moved > strata / 2, "in order");
            }
        }
    }
}

#[test]
fn any_block_has_the_same_points() {
    for strata in [2, 7, 64, 300] {
        for dimension in [1, 2, 5] {
            let whole = points(strata, 3, 0, dimension, 1200);
            for first in [0_usize, 1, 6, 63, 255, 256, 300, 511, 700] {
                for rows in [0, 1, 2, 64, 257, 488] {
                    let block = points(strata, 3, first as u64, dimension, rows);
                    assert_eq!(block, whole[first * dimension..][..rows * dimension], "{first}");
                }
            }
        }
    }
}

#[test]
fn the_points_of_a_seed_are_frozen() {
    let bits: Vec<u64> = points(5, 3, 253, 2, 2).iter().map(|u| u.to_bits()).collect();
    let golden = [
        0x3fe4_80c5_fad6_97d6,
        0x3fe1_c823_f019_7226,
        0x3fea_94bc_0f97_be42,
        0x3fe3_57b1_df57_83cf,
    ];
    assert_eq!(bits, golden, "{bits:#x?}");
}

/// The sum over terms, in standard deviations of the sum.
fn score(n: usize, deviation: f64, term: impl Fn(usize) -> f64) -> f64 {
    (0..n).map(term).sum::<f64>() / (deviation * (n as f64).sqrt())
}

/// Each sample of a block alone is uniform: by Legendre's polynomials, whose mean is 0.
#[test]
fn marginals_are_uniform() {
    const STREAMS: usize = 4096;
    for (strata, sample) in [(2, 0), (2, 1), (3, 1), (16, 0), (16, 15), (16, 21)] {
        let at = |stream| 2.0 * points(strata, stream, sample, 2, 1)[1] - 1.0;
        let first = score(STREAMS, (1_f64 / 3.0).sqrt(), at);
        let second =
            score(STREAMS, (1_f64 / 5.0).sqrt(), |stream| 0.5 * (3.0 * at(stream).powi(2) - 1.0));
        let third = score(STREAMS, (1_f64 / 7.0).sqrt(), |stream| {
            let x = at(stream);
            0.5 * (5.0 * x.powi(3) - 3.0 * x)
        });
        for score in [first, second, third] {
            assert!(score.abs() < 5.0, "{strata} {sample}: {score}");
        }
    }
}

/// Streams, seeds, blocks and coordinates are independent, and of random numbers of the same seed.
#[test]
fn streams_seeds_blocks_and_coordinates_are_independent() {
    type Pair<'a> = &'a dyn Fn(usize) -> [f64; 2];
    let of_seed = |k: usize| {
        let mut xi = [0.0];
        Stratified::new(k as u64, 4).unwrap().fill(0, 5, 1, &mut xi).unwrap();
        xi[0]
    };
    let random = |k: usize| {
        let mut xi = [0.0];
        Random::new(1).fill(0, k as u64, 1, &mut xi).unwrap();
        xi[0]
    };
    let at = |stream, sample: usize| points(4, stream, sample as u64, 1, 1)[0];
    let pairs: [(&str, Pair<'_>); 6] = [
        ("stream", &|k| [at(2 * k, 5), at(2 * k + 1, 5)]),
        ("seed", &|k| [of_seed(2 * k), of_seed(2 * k + 1)]),
        ("block", &|k| [at(0, 8 * k + 1), at(0, 8 * k + 5)]),
        ("coordinate", &|k| <[f64; 2]>::try_from(points(4, k, 5, 2, 1)).unwrap()),
        ("coordinates of two samples", &|k| {
            let x = points(4, k, 5, 2, 2);
            [x[0], x[3]]
        }),
        ("random", &|k| [at(0, 4 * k), random(4 * k)]),
    ];
    for (name, pair) in pairs {
        // The variance of a term is 1/144.
        let score = score(4096, 1.0 / 12.0, |k| {
            let [a, b] = pair(k);
            (a - 0.5) * (b - 0.5)
        });
        assert!(score.abs() < 5.0, "{name}: {score}");
    }
}

/// Of means over a block. Of x: a uniform number in each stratum, 1 / (12 S³). Of centred products
/// x y, each with the covariance -(1 - 1/S²) / (12 (S - 1)) within a block: a little above that of
/// random numbers, (1/12)² / S, and nothing is gained.
#[test]
fn variances_of_block_means() {
    type Of = fn(&[f64]) -> f64;
    const STREAMS: usize = 8192;
    for strata in [2_usize, 3, 8, 50] {
        let s = strata as f64;
        let mean = |f: Of| -> Vec<f64> {
            let of = |stream| {
                points(strata, stream, 5 * strata as u64, 2, strata).chunks(2).map(f).sum::<f64>()
                    / s
            };
            (0..STREAMS).map(of).collect()
        };
        let covariance = (1.0 - 1.0 / (s * s)) / (12.0 * (s - 1.0));
        let product = (1.0 / 144.0 + (s - 1.0) * covariance * covariance) / s;
        let sum = 1.0 / (12.0 * s.powi(3));
        let cases: [(&str, Of, f64); 3] = [
            ("x", |x| x[0] - 0.5, sum),
            ("x - 2 y", |x| x[0] - 2.0 * x[1] + 0.5, 5.0 * sum),
            ("x y", |x| (x[0] - 0.5) * (x[1] - 0.5), product),
        ];
        for (name, f, expected) in cases {
            let means = mean(f);
            let moment = |k| means.iter().map(|m| m.powi(k)).sum::<f64>() / STREAMS as f64;
            let centre = moment(1) / (expected / STREAMS as f64).sqrt();
            assert!(centre.abs() < 5.0, "{strata} {name}: {centre}");
            let deviation = ((moment(4) / moment(2).powi(2) - 1.0) / STREAMS as f64).sqrt();
            let ratio = moment(2) / expected;
            assert!(deviation < 0.03 && (ratio - 1.0).abs() < 5.0 * deviation, "{name}: {ratio}");
        }
    }
}

#[test]
fn arguments_and_far_samples() {
    for (strata, good) in [(0, false), (1, false), (2, true), (65_536, true), (65_537, false)] {
        assert_eq!(Stratified::new(1, strata).is_ok(), good);
    }
    let text = Stratified::new(1, 1).unwrap_err().to_string();
    assert_eq!(text, "Stratified: `strata` is 1, but it must be at least 2 and at most 65536");
    let source = Stratified::new(3, 8).unwrap();
    for (replicates, good) in [(0, false), (1, false), (2, true), (4096, true), (4097, false)] {
        assert_eq!(source.with_replicates(replicates).is_ok(), good);
    }
    let text = source.with_replicates(1).unwrap_err().to_string();
    assert_eq!(text, "Stratified: `replicates` is 1, but it must be at least 2 and at most 4096");
    let fewer = source.with_replicates(5).unwrap();
    assert_eq!((fewer.replicates(), source.replicates()), (5, 32));
    assert_eq!(format!("{fewer:?}"), "Stratified { seed: 3, strata: 8, replicates: 5 }");
    assert!(points(7, 0, u64::MAX, 3, 5).iter().all(|u| 0.0 < *u && *u < 1.0));
    // Numbers that do not fill a row, or none in it.
    source.fill(0, 1, 4, &mut [0.0; 3]).unwrap();
    source.fill(0, 1, 0, &mut [0.0; 30]).unwrap();
    source.fill(0, 1, usize::MAX, &mut []).unwrap();
}
