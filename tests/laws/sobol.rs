//! Sobol' points: nets, their scrambling, and random access.

use mis::points::{PointSource, Sobol};

fn points(seed: u64, stream: usize, first: u64, dimension: usize, rows: usize) -> Vec<f64> {
    let mut xi = vec![f64::NAN; rows * dimension];
    Sobol::new(seed).fill(stream, first, dimension, &mut xi).unwrap();
    xi
}

/// The quality parameters t of the sequence in 1 to 5 dimensions: the degrees of the primitive
/// polynomials, each less one, add up to them.
const T: [u32; 5] = [0, 0, 1, 3, 5];

/// All ways to write `sum` as so many numbers.
fn compositions(sum: u32, parts: usize) -> Vec<Vec<u32>> {
    if parts == 1 {
        return vec![vec![sum]];
    }
    let first = |a: u32| {
        let rest = compositions(sum - a, parts - 1).into_iter();
        rest.map(move |rest| [vec![a], rest].concat())
    };
    (0..=sum).flat_map(first).collect()
}

/// Every box of volume 2^(t-m) with sides that are powers of 1/2 holds 2^t of 2^m points.
fn assert_net(x: &[f64], dimension: usize, m: u32) {
    let t = T[dimension - 1];
    for sides in compositions(m - t, dimension) {
        let mut counts = vec![0_u32; 1 << (m - t)];
        for point in x.chunks_exact(dimension) {
            let mut place = 0;
            for (x, side) in point.iter().zip(&sides) {
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // < 2^m
                let interval = (x * f64::from(1 << side)) as usize;
                place = place << side | interval;
            }
            counts[place] += 1;
        }
        assert!(counts.iter().all(|n| *n == 1 << t), "{sides:?}");
    }
}

#[test]
fn consecutive_points_are_nets() {
    for dimension in 1..=5 {
        for (seed, stream, m) in [(0, 0, 8), (1, 0, 9), (1, 5, 10)] {
            for block in [0, 1, 5] {
                let x = points(seed, stream, block << m, dimension, 1 << m);
                assert_net(&x, dimension, m);
            }
        }
    }
}

/// Also where their index has more than 32 digits.
#[test]
fn points_far_out_are_nets() {
    for first in [1_u64 << 32, (1 << 40) + (1 << 10), 1 << 53, u64::MAX - 1023 - 1024] {
        let first = first >> 10 << 10;
        let x = points(1, 0, first, 3, 1 << 10);
        assert_net(&x, 3, 10);
        assert_ne!(x[..3], points(1, 0, 0, 3, 1)[..]);
    }
}

#[test]
fn any_block_in_any_dimension_has_the_same_points() {
    let whole = points(1, 3, 0, 11, 1000);
    for (first, rows) in [(0, 1), (3, 2), (7, 9), (62, 70), (64, 64), (700, 300), (999, 1)] {
        for dimension in [1, 7, 8, 9, 11] {
            let block = points(1, 3, first, dimension, rows);
            for (own, all) in
                block.chunks(dimension).zip(whole.chunks(11).skip(usize::try_from(first).unwrap()))
            {
                assert_eq!(own, &all[..dimension], "{first} {dimension}");
            }
        }
    }
}

#[test]
fn the_points_of_a_seed_are_frozen() {
    let bits: Vec<u64> = points(7, 3, 255, 2, 2).iter().map(|u| u.to_bits()).collect();
    let golden = [
        0x3fec_1967_aeec_6041,
        0x3fe9_7a20_8230_cf7a,
        0x3fec_0434_8d3e_4009,
        0x3fda_5308_f4fe_206c,
    ];
    assert_eq!(bits, golden, "{bits:#x?}");
}

#[test]
fn numbers_are_multiples_of_2_to_the_minus_53_in_the_unit_interval() {
    let x = points(1, 0, 0, 4, 4096);
    let grid = 2_f64.powi(53);
    assert!(x.iter().all(|x| (0.0..1.0).contains(x) && (x * grid).fract() == 0.0));
    // The last digit is used.
    assert!(x.iter().any(|x| (x * grid / 2.0).fract() != 0.0));
}

/// The mean of x over n scrambled points has one uniform number in each interval of length 1/n:
/// the variance 1/(12 n³), and near normal.
#[test]
fn means_of_x_have_the_variance_of_strata() {
    const STREAMS: usize = 4096;
    for n in [1, 2, 8, 64] {
        for dimension in 0..3 {
            let mean = |stream| {
                let x = points(2, stream, 0, 3, n);
                x.chunks(3).map(|x| x[dimension] - 0.5).sum::<f64>() / n as f64
            };
            let means: Vec<f64> = (0..STREAMS).map(mean).collect();
            let moment = |k| means.iter().map(|m| m.powi(k)).sum::<f64>() / STREAMS as f64;
            let expected = 1.0 / (12.0 * (n as f64).powi(3));
            // The fourth moment of a sum of n uniform numbers: 3 - 6/5 / n times the square.
            let kurtosis = 3.0 - 1.2 / n as f64;
            let deviation = ((kurtosis - 1.0) / STREAMS as f64).sqrt();
            let ratio = moment(2) / expected;
            assert!((ratio - 1.0).abs() < 5.0 * deviation, "{n} {dimension}: {ratio}");
            let found = moment(4) / moment(2).powi(2);
            // Its deviation is √(24 / 4096) = 0.077 for normal numbers.
            assert!((found - kurtosis).abs() < 0.6, "{n} {dimension}: {found}");
            let mean = moment(1) / (expected / STREAMS as f64).sqrt();
            assert!(mean.abs() < 5.0, "{n} {dimension}: {mean}");
        }
    }
}

/// Streams, seeds and dimensions are scrambled independently of each other.
#[test]
fn scramblings_are_independent() {
    type Pair<'a> = &'a dyn Fn(usize) -> [f64; 2];
    let n = 4096;
    let pairs: [(&str, Pair<'_>); 3] = [
        ("stream", &|k| [points(1, 2 * k, 5, 1, 1)[0], points(1, 2 * k + 1, 5, 1, 1)[0]]),
        ("seed", &|k| {
            [points(2 * k as u64, 0, 5, 1, 1)[0], points(2 * k as u64 + 1, 0, 5, 1, 1)[0]]
        }),
        ("dimension", &|k| <[f64; 2]>::try_from(points(1, k, 5, 2, 1)).unwrap()),
    ];
    for (name, pair) in pairs {
        let sum: f64 = (0..n).map(pair).map(|[a, b]| (a - 0.5) * (b - 0.5)).sum();
        // The variance of a term is 1/144.
        let score = 12.0 * sum / (n as f64).sqrt();
        assert!(score.abs() < 5.0, "{name}: {score}");
    }
}

#[test]
fn thousands_of_dimensions() {
    let last = |dimension: usize| points(1, 0, 4, dimension, 1)[dimension - 1];
    assert_ne!(last(1000), last(21_201));
    assert_eq!(points(1, 0, 4, 21_201, 1)[999], last(1000));
    let error = Sobol::new(1).fill(0, 4, 21_202, &mut vec![0.0; 21_202]).unwrap_err();
    assert_eq!((error.dimension, error.available, error.sample), (21_202, 21_201, 4));
    let error = Sobol::new(1).fill(2, u64::MAX, 1, &mut [0.0; 2]).unwrap_err();
    assert_eq!((error.stream, error.sample), (2, u64::MAX));
}

#[test]
fn arguments() {
    for (replicates, good) in [(0, false), (1, false), (2, true), (4096, true), (4097, false)] {
        assert_eq!(Sobol::new(1).with_replicates(replicates).is_ok(), good);
    }
    let text = Sobol::new(1).with_replicates(1).unwrap_err().to_string();
    assert_eq!(text, "Sobol: `replicates` is 1, but it must be at least 2 and at most 4096");
    let points = Sobol::new(3).with_replicates(5).unwrap();
    assert_eq!((points.replicates(), Sobol::new(3).replicates()), (5, 16));
    assert_eq!(format!("{points:?}"), "Sobol { seed: 3, replicates: 5 }");
}

/// In one dimension, the first digits of consecutive indices differ by one digit of the code: the
/// order is that of Antonov and Saleev, in which points 2k and 2k + 1 lie in different halves.
#[test]
fn neighbours_lie_in_different_halves() {
    let x = points(1, 0, 0, 1, 1000);
    for pair in x.chunks(2) {
        assert_ne!(pair[0] < 0.5, pair[1] < 0.5);
    }
}
