//! Batches: the bits of single points, wherever a batch is cut and whatever it holds.

use crate::common::canonical_numbers;
use mis::technique::{
    Affine, Cauchy, Exponential, InverseCdf, Mixture, Normal, PiecewiseConstant, PowerLaw, Product,
    ProductVec, Technique, TruncatedCauchy, TruncatedNormal, Uniform, UniformBox,
};
use proptest::prelude::*;
use std::f64::consts::{FRAC_1_PI, FRAC_1_SQRT_2, FRAC_PI_4, PI, SQRT_2, TAU};
use std::fmt::Debug;

/// Numbers at and beyond the ends of the unit interval, and where formulas change.
fn special_numbers() -> Vec<f64> {
    let mut xi = vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 2.0, -0.0, 0.0, 1.0];
    for u in [5e-324_f64, 1e-300, 0.25, 0.5, 0.75, 1.0] {
        xi.extend([u, u.next_up(), u.next_down(), 1.0 - u]);
    }
    for k in 0..60 {
        let u = 0.5_f64.powi(k);
        xi.extend([u, 1.0 - u, 0.5 + u, 0.5 - u]);
    }
    xi
}

/// Numbers of all magnitudes, and around `xs`.
fn special_points(xs: &[f64], (a, b): (f64, f64)) -> Vec<f64> {
    let mut points = vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN, -0.0];
    for end in [a, b] {
        points.extend([end, end.next_up(), end.next_down(), 2.0 * end, 0.5 * end]);
    }
    let (low, high) = (xs[0].min(xs[1]), xs[0].max(xs[1]));
    points.extend((-50..50).map(|k| low + (high - low) * f64::from(k)));
    points.extend((-323..308).flat_map(|k| [10_f64.powi(k), -10_f64.powi(k)]));
    points
}

/// Equal bits, or two NaN.
fn same(x: f64, y: f64) -> bool {
    x.to_bits() == y.to_bits() || (x.is_nan() && y.is_nan())
}

/// Samples and densities of `p` in a batch are those of single points, at `n` numbers and at
/// special ones.
pub(crate) fn check(p: &dyn InverseCdf, n: usize) {
    let mut xi = canonical_numbers(3, n);
    xi.extend(special_numbers());
    let mut slice = vec![7.0; xi.len()];
    p.sample_slice(&xi, &mut slice);
    let xs = sampled(p, &xi);
    for ((u, x), y) in xi.iter().zip(&xs).zip(&slice) {
        let one = p.sample(&[*u]);
        assert!(same(*x, one) && same(*y, one), "at {u:e}: {x:e} and {y:e} in batches, {one:e}");
    }
    let points = [xs.clone(), special_points(&xs, p.support())].concat();
    let mut pdfs = vec![7.0; points.len()];
    p.pdf_batch(&points, &mut pdfs);
    for (x, pdf) in points.iter().zip(&pdfs) {
        assert!(same(*pdf, p.pdf(x)), "at {x:e}: {pdf:e} in a batch, {:e}", p.pdf(x));
    }
    let finite = |(x, pdf): (&f64, &f64)| x.is_nan() || (*pdf > 0.0 && *pdf < f64::INFINITY);
    assert!(xs.iter().zip(&pdfs).all(finite));
}

/// The points of `xi`, written over `xi.len() / 2` others and with some left behind them.
fn sampled(p: &dyn InverseCdf, xi: &[f64]) -> Vec<f64> {
    let mut xs = vec![7.0; xi.len() / 2];
    p.sample_batch(xi, &mut xs);
    assert_eq!(xs.len(), xi.len());
    let memory = xs.as_ptr();
    p.sample_batch(&xi[..xi.len() / 3], &mut xs);
    assert!(xs.len() >= xi.len() / 3 && xs.as_ptr() == memory, "points are kept in place");
    p.sample_batch(xi, &mut xs);
    xs
}

/// A batch that is cut into others keeps its bits.
fn cut<P: Debug + Clone + PartialEq>(p: &dyn Technique<Point = P>, xi: &[f64], cuts: &[usize]) {
    let dimension = p.dimension();
    let rows = xi.len() / dimension;
    let mut whole = Vec::new();
    p.sample_batch(xi, &mut whole);
    let mut densities = vec![0.0; rows];
    p.pdf_batch(&whole, &mut densities);
    let mut ends: Vec<usize> = cuts.iter().map(|cut| cut % (rows + 1)).collect();
    ends.push(rows);
    ends.sort_unstable();
    let (mut start, mut part) = (0, Vec::new());
    for end in ends {
        p.sample_batch(&xi[start * dimension..end * dimension], &mut part);
        assert_eq!(part[..end - start], whole[start..end]);
        let mut pdfs = vec![0.0; end - start];
        p.pdf_batch(&whole[start..end], &mut pdfs);
        assert_eq!(pdfs, densities[start..end]);
        start = end;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn a_batch_may_be_cut_anywhere(
        seed in any::<u64>(),
        rows in 1..300_usize,
        cuts in prop::collection::vec(any::<usize>(), 0..5),
    ) {
        let numbers = canonical_numbers(seed, 4 * rows);
        let (normal, line) = (Normal::new(1.0, 0.5).unwrap(), Normal::standard());
        let peak = TruncatedNormal::new(0.3, 0.1, 0.0, 1.0).unwrap();
        let cauchy = Cauchy::new(0.0, 1.0).unwrap();
        let steps = PiecewiseConstant::new(&[0.0, 0.5, 2.0, 3.0], &[1.0, 0.0, 3.0]).unwrap();
        let image = Affine::new(line, 3.0, 0.1).unwrap();
        let techniques: [&dyn Technique<Point = f64>; 5] = [&normal, &peak, &cauchy, &steps, &image];
        for p in techniques {
            cut(p, &numbers[..rows], &cuts);
        }
        let mixture = Mixture::new(vec![(normal, 0.5), (line, 0.5)]).unwrap();
        cut(&mixture, &numbers[..2 * rows], &cuts);
        let coordinates: [&dyn InverseCdf; 4] = [&normal, &peak, &steps, &image];
        cut(&Product::new(coordinates).unwrap(), &numbers, &cuts);
        cut(&ProductVec::new(coordinates.to_vec()).unwrap(), &numbers, &cuts);
    }
}

/// Samples and densities of a product in a batch are those of single points.
fn product<P: Debug + PartialEq + Clone>(p: &dyn Technique<Point = P>, make: impl Fn(&[f64]) -> P) {
    let dimension = p.dimension();
    let mut xi = canonical_numbers(5, 1000 * dimension);
    xi[..dimension].fill(0.0);
    xi[dimension..2 * dimension].fill(1.0);
    let mut xs = Vec::new();
    p.sample_batch(&xi, &mut xs);
    assert_eq!(xs.len(), 1000);
    for (x, xi) in xs.iter().zip(xi.chunks_exact(dimension)) {
        assert_eq!(*x, p.sample(xi));
    }
    // Coordinates outside, in a tail, and none.
    for x in [1e300, -1e300, 12.0, -30.0, f64::NAN, f64::INFINITY, 5e-324] {
        xs.push(make(&vec![x; dimension]));
    }
    let mut pdfs = vec![7.0; xs.len()];
    p.pdf_batch(&xs, &mut pdfs);
    for (x, pdf) in xs.iter().zip(&pdfs) {
        assert!(same(*pdf, p.pdf(x)), "{pdf:e} at {x:?}, {:e}", p.pdf(x));
    }
}

#[test]
fn products() {
    let (normal, small) = (Normal::standard(), Normal::new(0.0, 1e-200).unwrap());
    let sides: [&dyn InverseCdf; 3] = [&normal, &small, &small];
    product(&Product::new(sides).unwrap(), |x| [x[0], x[1], x[2]]);
    product(&ProductVec::new(sides.to_vec()).unwrap(), <[f64]>::to_vec);
    product(&UniformBox::uniform([-1.0; 5], [20.0; 5]).unwrap(), |x| [x[0]; 5]);
    // The density underflows on the way.
    product(&ProductVec::new(vec![Uniform::new(0.0, 1e9).unwrap(); 100]).unwrap(), <[f64]>::to_vec);
    let p = ProductVec::new(vec![normal; 2]).unwrap();
    let mut pdfs = [7.0; 3];
    p.pdf_batch(&[vec![0.0; 2], vec![0.0; 3], vec![]], &mut pdfs);
    assert!(pdfs[0] > 0.0 && pdfs[1].is_nan() && pdfs[2].is_nan());
}

/// The largest difference of samples at 1e5 numbers, and of densities there, from the same formulas
/// by `libm`: samples in units of 2⁻⁵² max(|x|, `unit`), densities in units of 2⁻⁵² p.
fn off(
    p: &dyn InverseCdf,
    unit: f64,
    inverse: impl Fn(f64) -> f64,
    pdf: impl Fn(f64) -> f64,
) -> [f64; 2] {
    let mut xi = canonical_numbers(11, 100_000);
    xi.extend((0..54).flat_map(|k| [0.5_f64.powi(k + 1), 1.0 - 0.5_f64.powi(k)]));
    xi.retain(|u| 0.0 < *u && *u < 1.0);
    let xs = sampled(p, &xi);
    let mut pdfs = vec![7.0; xs.len()];
    p.pdf_batch(&xs, &mut pdfs);
    let mut worst = [0.0_f64; 2];
    for ((u, x), density) in xi.iter().zip(&xs).zip(&pdfs) {
        let (y, q) = (inverse(*u), pdf(*x));
        worst[0] = worst[0].max((x - y).abs() / y.abs().max(unit) / f64::EPSILON);
        worst[1] = worst[1].max((density - q).abs() / q / f64::EPSILON);
    }
    worst
}

#[track_caller]
fn within([sample, density]: [f64; 2], samples: f64, densities: f64) {
    assert!(sample <= samples && density <= densities, "{sample} {density}");
}

#[test]
fn the_stated_roundings() {
    let bell = |z: f64| (-0.5 * z * z).exp() / TAU.sqrt();
    let quantile = |u: f64| -SQRT_2 * statrs::function::erf::erfc_inv(2.0 * u);
    within(off(&Normal::standard(), 0.0, quantile, bell), 5.0, 3.0);
    let p = Normal::new(-3.0, 0.2).unwrap();
    let z = |x: f64| (x + 3.0) / 0.2;
    within(off(&p, 3.0, |u| -3.0 + 0.2 * quantile(u), |x| bell(z(x)) / 0.2), 2.0, 4.0);

    let p = Exponential::new(2.0, 0.0, f64::INFINITY).unwrap();
    within(off(&p, 0.0, |u| -(-u).ln_1p() / 2.0, |x| 2.0 * (-2.0 * x).exp()), 2.0, 2.0);
    let p = Exponential::new(-1.5, 1.0, 3.0).unwrap();
    let m = -(-3.0_f64).exp_m1();
    let inverse = |u: f64| 3.0 + (u + (1.0 - u) * (-3.0_f64).exp()).ln() / 1.5;
    within(off(&p, 0.0, inverse, |x| 1.5 * (1.5 * (x - 3.0)).exp() / m), 3.0, 4.0);

    let tangent = |u: f64| {
        let outer = 1.0 / (PI * u.min(1.0 - u)).tan();
        let outer = if u < 0.5 { -outer } else { outer };
        if (u - 0.5).abs() > 0.25 { outer } else { (PI * (u - 0.5)).tan() }
    };
    let lorentzian = |z: f64| FRAC_1_PI / (1.0 + z * z);
    within(off(&Cauchy::new(0.0, 1.0).unwrap(), 0.0, tangent, lorentzian), 4.0, 4.0);
    let p = TruncatedCauchy::new(0.0, 1.0, -1.0, f64::INFINITY).unwrap();
    let cut = |u: f64| {
        if u < 0.5 {
            (0.75 * PI * u - FRAC_PI_4).tan()
        } else {
            1.0 / (0.75 * PI * (1.0 - u)).tan()
        }
    };
    within(off(&p, 1.0, cut, |z| lorentzian(z) / 0.75), 6.0, 5.0);

    // Each factor e of a distance costs an ulp more.
    let p = PowerLaw::new(-0.5, 0.0, 1.0).unwrap();
    within(off(&p, 1e-4, |u| u * u, |x| 0.5 / x.sqrt()), 16.0, 64.0);
    let p = PowerLaw::new(2.0, 1.0, 2.0).unwrap();
    within(off(&p, 0.0, |u| (1.0 + 7.0 * u).cbrt(), |x| 3.0 / 7.0 * x * x), 5.0, 8.0);

    let p = TruncatedNormal::new(0.0, 1.0, -1.0, 2.0).unwrap();
    let tail = |z: f64| 0.5 * libm::erfc(z * FRAC_1_SQRT_2);
    let mass = 1.0 - tail(1.0) - tail(2.0);
    let inverse = |u: f64| {
        let (below, above) = (tail(1.0) + u * mass, tail(2.0) + (1.0 - u) * mass);
        if below < above { quantile(below) } else { -quantile(above) }
    };
    within(off(&p, 1.0, inverse, |x| bell(x) / mass), 6.0, 4.0);
}
