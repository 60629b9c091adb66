//! The printed variances.

use std::f64::consts::SQRT_2;

use mis::weighting::VarianceAware;

use crate::ensemble::Any;
use crate::example::{Example, FULL, Limits, Model, QUICK};
use crate::examples::{ENDS, example_a, example_d, example_e, normal, root, sine_cosine};

/// An estimator and its variance as printed.
struct Row(Model, Any, &'static str);

/// That of a multi-sample estimator with all techniques.
fn all(techniques: usize, weighting: Any, printed: &'static str) -> Row {
    Row(Model::Multi((0..techniques).collect()), weighting, printed)
}

fn single(technique: usize, printed: &'static str) -> Row {
    Row(Model::Multi(vec![technique]), Any::balance(), printed)
}

fn one(probabilities: &[f64], weighting: Any, printed: &'static str) -> Row {
    Row(Model::One(probabilities.to_vec()), weighting, printed)
}

fn weights_without_probabilities(
    probabilities: &[f64],
    weighting: Any,
    printed: &'static str,
) -> Row {
    Row(Model::WithoutProbabilities(probabilities.to_vec()), weighting, printed)
}

/// Asserts that `value` rounds to the printed digits.
fn assert_printed(value: f64, printed: &str, name: &str) {
    let decimals = printed.split_once('.').map_or(0, |(_, digits)| digits.len());
    let half = 0.5 * 10_f64.powi(-i32::try_from(decimals).unwrap());
    let expected: f64 = printed.parse().unwrap();
    assert!((value - expected).abs() <= 1.001 * half, "{name}: {value:.14}, not {printed}");
}

fn check(example: &Example, rows: &[Row], limits: Limits) {
    let mut zs = Vec::new();
    for Row(model, weighting, printed) in rows {
        let exact = example.exact(model, weighting);
        let name = format!("{}, {}, {}", example.name, model.name(), weighting.0);
        assert!((exact.mean / example.mean - 1.0).abs() < 1e-8, "{name}: {}", exact.mean);
        assert_printed(exact.variance, printed, &name);
        zs.extend(example.ensemble(model, weighting, exact, limits));
    }
    let largest = zs.iter().fold(0.0, |m: f64, z| m.max(z.abs()));
    println!("{}: {} figures, largest |z| {largest:.2}", example.name, zs.len());
}

fn sine_cosine_rows(example: &Example) -> Vec<Row> {
    let both = |weighting, printed| all(2, weighting, printed);
    let half = [0.5, 0.5, 0.0];
    let uneven = [0.25, 0.75, 0.0];
    vec![
        single(0, "0.0833333333"),
        single(1, "0.0833333333"),
        single(2, "0.0584251375"),
        both(Any::constant("constant 1/2", &half), "0.0416666667"),
        both(Any::balance(), "0.0199459534"),
        both(Any::power(1.5), "0.0223591548"),
        both(Any::power(2.0), "0.0273809524"),
        both(Any::power(3.0), "0.0387766262"),
        both(Any::power(4.0), "0.0488058727"),
        both(Any::maximum(), "0.1107022604"),
        both(Any::cutoff(0.1), "0.0199915027"),
        both(Any::cutoff(0.3), "0.0227849099"),
        both(Any::cutoff(0.5), "0.0354924704"),
        both(Any::cutoff(0.75), "0.0680040580"),
        all(3, Any::balance(), "0.0151800872"),
        all(3, variance_aware(example, &[true; 3]), "0.0159280712"),
        one(&half, Any::balance(), "0.0398919068"),
        one(&half, Any::power(2.0), "0.0547619048"),
        // Unequal probabilities cost less if the weights know them.
        one(&uneven, Any::balance(), "0.0476264861"),
        one(&uneven, Any::power(2.0), "0.0731206399"),
        weights_without_probabilities(&half, Any::balance(), "0.0398919068"),
        weights_without_probabilities(&uneven, Any::balance(), "0.1365225424"),
        weights_without_probabilities(&uneven, Any::power(2.0), "0.1563492063"),
    ]
}

/// The closed forms behind some of the digits.
#[test]
fn sine_cosine_has_closed_forms() {
    let example = sine_cosine();
    let variance = |Row(model, weighting, _): Row| example.exact(&model, &weighting).variance;
    let asinh = (1.0 + SQRT_2).ln();
    for (row, closed) in [
        (all(2, Any::balance(), ""), SQRT_2 * asinh / 4.0 - 7.0 / 24.0),
        (all(2, Any::power(2.0), ""), 23.0 / 840.0),
        (all(2, Any::maximum(), ""), SQRT_2 / 6.0 - 0.125),
        (one(&[0.5, 0.5, 0.0], Any::power(2.0), ""), 23.0 / 420.0),
    ] {
        let name = row.1.0.clone();
        let v = variance(row);
        assert!((v / closed - 1.0).abs() < 1e-12, "{name}: {v} {closed}");
    }
}

fn root_rows() -> Vec<Row> {
    vec![
        all(2, Any::balance(), "0.1777758104"),
        all(2, Any::power(2.0), "0.2936249348"),
        all(2, Any::maximum(), "1.3862943611"),
        // Half of it, with two samples, is 2 ln 3 - 2.
        one(&[0.5, 0.5], Any::balance(), "0.3944491547"),
    ]
}

fn normal_rows(example: &Example) -> Vec<Row> {
    vec![
        all(2, variance_aware(example, &[false, true]), "0.1617690661"),
        single(1, "0.5118578920"),
        all(2, Any::balance(), "0.1016087924"),
        all(2, Any::power(2.0), "0.1400846266"),
    ]
}

/// Selection probabilities or constant weights in proportion to 1 / V_i; 0 for `None`.
fn inverse_variance(example: &Example, finite: &[bool]) -> Vec<f64> {
    let inverse = |(i, finite): (usize, &bool)| {
        let row = single(i, "");
        if *finite { example.exact(&row.0, &row.1).variance.recip() } else { 0.0 }
    };
    let inverses: Vec<f64> = finite.iter().enumerate().map(inverse).collect();
    let sum: f64 = inverses.iter().sum();
    inverses.iter().map(|v| v / sum).collect()
}

/// The factors 1 + μ² / V_i; 1 where a technique's variance is infinite.
fn variance_aware(example: &Example, finite: &[bool]) -> Any {
    let factor = |(i, finite): (usize, &bool)| {
        let row = single(i, "");
        let variance = if *finite { example.exact(&row.0, &row.1).variance } else { f64::INFINITY };
        VarianceAware::factor(example.mean, variance)
    };
    let factors: Vec<f64> = finite.iter().enumerate().map(factor).collect();
    Any::variance_aware(&factors)
}

/// The selection probability of the first of two techniques with the least variance, by golden
/// section.
fn optimum(example: &Example) -> Vec<f64> {
    let variance = |p: f64| example.exact(&Model::One(vec![p, 1.0 - p]), &Any::balance()).variance;
    let ratio = 0.5 * (5_f64.sqrt() - 1.0);
    let (mut a, mut b) = (0.2, 0.4);
    while b - a > 1e-6 {
        let (left, right) = (b - ratio * (b - a), a + ratio * (b - a));
        if variance(left) < variance(right) {
            b = right;
        } else {
            a = left;
        }
    }
    vec![0.5 * (a + b), 1.0 - 0.5 * (a + b)]
}

fn example_a_rows(example: &Example) -> Vec<Row> {
    let inverse = inverse_variance(example, &[true, true]);
    let best = optimum(example);
    assert!((best[0] - 0.2756).abs() < 1e-4, "{best:?}");
    vec![
        single(0, "3.99352148"),
        single(1, "4.29439279"),
        all(2, Any::equal(), "2.07197857"),
        all(2, Any::constant("inverse variance", &inverse), "2.06924798"),
        all(2, Any::balance(), "0.13858991"),
        all(2, Any::power(2.0), "0.27593205"),
        all(2, variance_aware(example, &[true, true]), "0.14977016"),
        all(2, Any::maximum(), "1.14364637"),
        one(&[0.5, 0.5], Any::balance(), "0.36912818"),
        one(&inverse, Any::balance(), "0.41394084"),
        one(&best, Any::balance(), "0.09100620"),
    ]
}

/// Constant weights with a positive third one have an infinite variance, see below.
fn three_term_rows(example: &Example, printed: [&'static str; 9]) -> Vec<Row> {
    let inverse = inverse_variance(example, &[true, true, false]);
    let [first, second, constant, balance, power, aware, maximum, equal, alpha] = printed;
    let third = [1.0, 1.0, 1.0].map(|w: f64| w / 3.0);
    vec![
        single(0, first),
        single(1, second),
        all(3, Any::constant("inverse variance", &inverse), constant),
        all(3, Any::balance(), balance),
        all(3, Any::power(2.0), power),
        all(3, variance_aware(example, &[true, true, false]), aware),
        all(3, Any::maximum(), maximum),
        one(&third, Any::balance(), equal),
        one(&inverse, Any::balance(), alpha),
    ]
}

fn example_d_rows(example: &Example) -> Vec<Row> {
    let printed = [
        "4.09963",
        "35.32784",
        "3.67335504",
        "3.562557",
        "8.425688",
        "1.82443247",
        "54.91406",
        "13.35398",
        "2.03733542",
    ];
    three_term_rows(example, printed)
}

fn example_e_rows(example: &Example) -> Vec<Row> {
    let printed = [
        "4.09963",
        "7857.943",
        "4.09749292",
        "93.36625",
        "615.6835",
        "4.00279635",
        "5176.414",
        "349.6339",
        "3.97554919",
    ];
    three_term_rows(example, printed)
}

fn check_all(limits: Limits) {
    check(&root(), &root_rows(), limits);
    let (slides, normal) = (sine_cosine(), normal());
    check(&slides, &sine_cosine_rows(&slides), limits);
    check(&normal, &normal_rows(&normal), limits);
    let (a, d, e) = (example_a(), example_d(), example_e());
    check(&a, &example_a_rows(&a), limits);
    check(&d, &example_d_rows(&d), limits);
    check(&e, &example_e_rows(&e), limits);
}

#[test]
fn variances_are_as_printed() {
    check_all(QUICK);
}

#[test]
#[ignore = "half a minute in release: heavy tails need 10^8 samples"]
fn variances_are_as_printed_with_full_ensembles() {
    check_all(FULL);
}

#[test]
fn variances_of_zero_are_zero() {
    let (root, d, e) = (root(), example_d(), example_e());
    // Of D and E, each term's integral over the sum.
    let shares = |example: &Example, slope: f64| {
        let [a, b] = ENDS;
        let first = 0.5 * slope * (b * b - a * a) / example.mean;
        let last = 2.0 * (0.5 * a).cos().powi(2) / example.mean;
        Model::One(vec![first, 1.0 - first - last, last])
    };
    for (example, model) in
        [(&root, Model::Multi(vec![1])), (&d, shares(&d, 1.0)), (&e, shares(&e, 30.0))]
    {
        let exact = example.exact(&model, &Any::balance());
        let square = example.mean.powi(2);
        assert!(exact.variance.abs() < 1e-12 * square, "{}: {exact:?}", example.name);
        let estimate = example.run(&model, &Any::balance(), 10_000, 1, |_| ()).unwrap();
        assert!((estimate.value() / example.mean - 1.0).abs() < 1e-14, "{estimate:?}");
        let variance = 10_000.0 * estimate.variance().unwrap();
        assert!(variance < 1e-30 * square, "{}: {variance:e}", example.name);
    }
}

/// The schemes of V. Elvira, L. Martino, D. Luengo and M. F. Bugallo, *Generalized Multiple
/// Importance Sampling*, 2019, doi:10.1214/18-STS668, on example A with two samples: N1 and R1
/// weight with a sample's own density, N3 and R3 with the whole mixture; N takes each technique
/// once, R selects at random.
#[test]
fn schemes_of_generalized_mis() {
    let example = example_a();
    let half = [0.5, 0.5];
    let both = Model::Multi(vec![0, 1]);
    let [n1, n3] = [Any::equal(), Any::balance()].map(|w| example.exact(&both, &w).variance);
    // Per sample; the estimate is the mean of two.
    let [r1, r3] = [Any::equal(), Any::balance()]
        .map(|w| 0.5 * example.exact(&Model::One(half.to_vec()), &w).variance);
    // The mixture of the selected techniques: in half of the draws both, else one of them twice.
    let r2 = 0.5 * n3 + 0.5 * n1;
    // The first sample with the mixture of both, the second with the one that is left.
    let n2 = 0.5 * (n1 + r3);
    for (name, variance, printed) in [
        ("N1", n1, "2.07198"),
        ("R1", r1, "2.07198"),
        ("N2", n2, "1.12827"),
        ("R2", r2, "1.10528"),
        ("R3", r3, "0.184564"),
        ("N3", n3, "0.138590"),
    ] {
        assert_printed(variance, printed, name);
    }
    // The others are among the rows of example A.
    let (model, weighting) = (Model::One(half.to_vec()), Any::equal());
    let exact = example.exact(&model, &weighting);
    example.ensemble(&model, &weighting, exact, QUICK);
}
