//! Variances that are known.

use mis::{Controls, Estimator, Fit, MultiSample, OptimalMis, Technique};

use crate::cases::Found;
use crate::ensemble::Z;
use crate::ensembles::{CROSS_FIT, Mean};
use crate::example::{Example, nodes};
use crate::examples;

fn techniques(example: &Example, used: usize, n: u64) -> Vec<(&dyn Technique<Point = f64>, u64)> {
    example.techniques.iter().take(used).map(|t| (&**t, n)).collect()
}

/// a_k that solve A a = b, for n = (1, …, 1), and ∫ f²/c - b'a: by quadrature.
fn exact(example: &Example, used: usize) -> (Vec<f64>, f64) {
    let [a, b] = example.domain;
    let mut cuts = vec![a, b];
    if a < 0.0 {
        cuts.insert(1, 0.0);
    }
    let (mut matrix, mut right, mut square) = (vec![vec![0.0; used]; used], vec![0.0; used], 0.0);
    for cut in cuts.windows(2) {
        for (x, width) in nodes(cut[0], cut[1]) {
            let p: Vec<f64> = example.techniques[..used].iter().map(|t| t.pdf(&x)).collect();
            let c: f64 = p.iter().sum();
            if c == 0.0 {
                continue;
            }
            let f = (example.f)(x);
            square += width * f * f / c;
            for i in 0..used {
                right[i] += width * f * p[i] / c;
                for k in 0..used {
                    matrix[i][k] += width * p[i] * p[k] / c;
                }
            }
        }
    }
    let solved = solve(matrix, right.clone());
    let explained: f64 = solved.iter().zip(&right).map(|(a, b)| a * b).sum();
    (solved, square - explained)
}

/// Gauss's elimination, with pivots.
fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for i in 0..n {
        let pivot = (i..n).max_by(|j, k| a[*j][i].abs().total_cmp(&a[*k][i].abs())).unwrap();
        a.swap(i, pivot);
        b.swap(i, pivot);
        for j in i + 1..n {
            let factor = a[j][i] / a[i][i];
            let row = a[i].clone();
            a[j].iter_mut().zip(row).for_each(|(x, y)| *x -= factor * y);
            b[j] -= factor * b[i];
        }
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| a[i][k] * b[k]).sum();
        b[i] = (b[i] - known) / a[i][i];
    }
    b
}

/// An example, how many techniques it uses, and the variance of optimal MIS.
type Row = (fn() -> Example, usize, f64);

const ROWS: [Row; 4] = [
    (examples::sine_cosine, 2, 0.019_945_953_403_448_59),
    (examples::normal, 2, 0.101_299_943_0),
    (examples::example_a, 2, 0.030_747_51),
    (examples::root, 2, 0.0),
];

#[test]
fn quadrature_gives_the_reference() {
    for (example, used, variance) in ROWS {
        let example = example();
        let (_, found) = exact(&example, used);
        assert!((found - variance).abs() < 5e-9, "{}: {found} for {variance}", example.name);
    }
}

/// The mean of (value - μ)² and of the reported variance, each times n.
fn measured(example: &Example, used: usize, fit: Fit, n: u64, seeds: u64) -> [Mean; 2] {
    let list = techniques(example, used, n);
    let mis = OptimalMis::new(&list).unwrap().fit(fit).unwrap();
    let f = |x: &f64| (example.f)(*x);
    let found: Vec<Found> = (0..seeds)
        .map(|seed| {
            let estimate = mis.estimate(&f, seed).unwrap();
            assert_eq!(estimate.uncontrolled(), 0);
            let (value, variance) = (estimate.value(), estimate.estimate().variance());
            Found { value, variance, holds: true, kappa: None, uncontrolled: 0 }
        })
        .collect();
    let n = n as f64;
    [
        Mean::of(found.iter().map(|found| n * (found.value - example.mean).powi(2))),
        Mean::of(found.iter().map(|found| n * found.variance.unwrap())),
    ]
}

fn variances_agree(n: u64, seeds: u64) {
    for (example, used, variance) in ROWS {
        let example = example();
        for fit in [Fit::Direct, CROSS_FIT] {
            let figures = measured(&example, used, fit, n, seeds);
            let bound = [1.5 * (2.2 / seeds as f64).sqrt(), 0.5 / (seeds as f64).sqrt()];
            for (figure, bound) in figures.into_iter().zip(bound) {
                let name = format!("{}, {fit:?}: {figure:?} for {variance}", example.name);
                if variance == 0.0 {
                    assert!(figure.mean.abs() < 1e-24 * n as f64, "{name}");
                    continue;
                }
                assert!(figure.error < bound * variance, "{name}");
                // O(K / N) of it is due to the coefficients.
                let allowed = Z * figure.error + 4.0 / n as f64 * variance;
                assert!((figure.mean - variance).abs() < allowed, "{name}");
            }
        }
    }
}

#[test]
fn variances_are_those_of_the_reference() {
    variances_agree(500, 40);
}

#[test]
#[ignore = "takes half a minute in release"]
fn variances_are_those_of_the_reference_in_full_ensembles() {
    variances_agree(2000, 4000);
}

#[test]
fn nothing_is_left_of_combinations() {
    for (example, used) in
        [(examples::example_d(), 3), (examples::example_e(), 3), (examples::root(), 2)]
    {
        for fit in [Fit::Direct, CROSS_FIT] {
            for seed in 0..20 {
                let mis = OptimalMis::new(&techniques(&example, used, 100)).unwrap();
                let f = |x: &f64| (example.f)(*x);
                let estimate = mis.fit(fit).unwrap().estimate(&f, seed).unwrap();
                let off = (estimate.value() / example.mean - 1.0).abs();
                assert!(off < 1e-12, "{} {fit:?}: {off}", example.name);
                let error = estimate.standard_error().unwrap();
                assert!(error < 1e-12 * example.mean, "{} {fit:?}: {error}", example.name);
            }
        }
    }
}

/// β = a - μ α.
fn controls(example: &Example, used: usize) -> Controls {
    let (a, _) = exact(example, used);
    let beta: Vec<f64> = a.iter().map(|a| a - example.mean / used as f64).collect();
    Controls::new(0, [beta]).unwrap()
}

#[test]
fn exact_coefficients_have_the_reference_variance() {
    let exact: [Row; 2] = [(examples::example_d, 3, 0.0), (examples::example_e, 3, 0.0)];
    let rows = ROWS.into_iter().chain(exact);
    for (example, used, variance) in rows {
        let example = example();
        let mis = MultiSample::new(&techniques(&example, used, 1000)).unwrap();
        let mis = mis.controls(controls(&example, used)).unwrap();
        let f = |x: &f64| (example.f)(*x);
        let found: Vec<_> = (0..30).map(|seed| mis.estimate(&f, seed).unwrap()).collect();
        let reported = Mean::of(found.iter().map(|e| 1000.0 * e.variance().unwrap_or(0.0)));
        let value = Mean::of(found.iter().map(mis::Estimate::value));
        let name = format!("{}: {reported:?} for {variance}, {value:?}", example.name);
        if variance == 0.0 {
            assert!(reported.mean < 1e-16 * example.mean.powi(2), "{name}");
            assert!((value.mean / example.mean - 1.0).abs() < 1e-9, "{name}");
        } else {
            assert!(reported.z(variance).abs() < Z && reported.error < 0.02 * variance, "{name}");
            assert!(value.z(example.mean).abs() < Z, "{name}");
        }
    }
}

#[test]
fn coefficients_are_those_of_the_closest_combination() {
    // a_k = μ α_k + β_k, and β of the first is minus the sum of all others.
    for (example, expected, tolerance) in [
        (examples::sine_cosine(), vec![0.25, 0.25], 0.02),
        (examples::normal(), vec![0.525_237, 0.474_763], 0.02),
        (examples::example_d(), exact(&examples::example_d(), 3).0, 1e-9),
    ] {
        let used = expected.len();
        let list = techniques(&example, used, 5000);
        let f = |x: &f64| (example.f)(*x);
        for fit in crate::ensembles::FITS {
            let mis = OptimalMis::new(&list).unwrap().fit(fit).unwrap();
            let estimate = mis.estimate(&f, 3).unwrap();
            let controls = estimate.controls();
            assert_eq!((controls.reference(), estimate.rank()), (0, used - 1));
            let beta = &controls.coefficients()[0];
            for k in 1..used {
                let a = example.mean / used as f64 + beta[k];
                assert!((a - expected[k]).abs() < tolerance, "{} {k}: {a}", example.name);
            }
            let first = example.mean / used as f64 - beta[1..].iter().sum::<f64>();
            assert!((first - expected[0]).abs() < tolerance, "{}: {first}", example.name);
        }
    }
}
