//! Whether the judgement on a run is right.

use mis::points::Random;
use mis::technique::{Cauchy, Normal, Uniform};
use mis::weighting::Constant;
use mis::{
    Doubt, Estimator, MultiSample, Norm, OneSample, Report, Run, Status, Stop, Target, Technique,
};

use crate::common::{Raw, f};

fn run<'a>(samples: u64) -> Run<'a> {
    Run::new(Target::new().samples(samples).unwrap()).threads(1).unwrap()
}

fn doubts<V: mis::Value>(report: &Report<V>) -> Vec<Doubt> {
    match report.status() {
        Status::Suspect(doubts) => doubts.clone(),
        _ => Vec::new(),
    }
}

fn doubts_densities<V: mis::Value>(report: &Report<V>) -> bool {
    doubts(report).iter().any(|doubt| matches!(doubt, Doubt::Density { .. }))
}

fn bell(x: &f64) -> f64 {
    (-x * x).exp() * (1.0 + x)
}

/// A normal density whose samples spread `wide` times as far, and whose pdf is `scaled`.
fn wrong(wide: f64, scaled: f64) -> impl Technique<Point = f64> {
    let normal = Normal::new(0.0, 1.0).unwrap();
    Raw { sample: move |u| wide * normal.sample(&[u]), pdf: move |x| scaled * normal.pdf(&x) }
}

/// How many of the seeds are doubted for densities, with two and with three techniques.
fn doubted(technique: &dyn Technique<Point = f64>, samples: u64, seeds: u64) -> [u64; 3] {
    let (wide, cauchy) = (Normal::new(0.5, 2.0).unwrap(), Cauchy::new(0.0, 1.0).unwrap());
    let two = MultiSample::new(&[(technique, 1), (&wide, 1)]).unwrap();
    let three = MultiSample::new(&[(&wide, 1), (technique, 2), (&cauchy, 1)]).unwrap();
    let one = OneSample::new(&[(technique, 0.5), (&wide, 0.5)], 1).unwrap();
    let count = |doubted: &dyn Fn(u64) -> bool| (0..seeds).filter(|seed| doubted(*seed)).count();
    [
        count(&|seed| doubts_densities(&run(samples).execute(&two, &bell, seed).unwrap())),
        count(&|seed| doubts_densities(&run(samples).execute(&three, &bell, seed).unwrap())),
        count(&|seed| doubts_densities(&run(samples).execute(&one, &bell, seed).unwrap())),
    ]
    .map(|count| count as u64)
}

fn check_densities(seeds: u64, faults: &[(f64, f64, u64)]) {
    for &(wide, scaled, samples) in faults {
        for count in doubted(&wrong(wide, scaled), samples, seeds) {
            assert!(100 * count >= 95 * seeds, "{wide} {scaled}: {count} of {seeds}");
        }
    }
}

#[test]
fn samplers_and_pdfs_that_differ_are_suspect() {
    // Of long runs, a part of the samples is looked at.
    check_densities(1, &[(1.1, 1.0, 400_000)]);
    check_densities(2, &[(1.0, 1.05, 45_000)]);
}

#[test]
#[ignore = "a minute in a release build"]
fn samplers_and_pdfs_that_differ_are_suspect_by_nearly_every_seed() {
    let wide = 1_500_000;
    check_densities(40, &[(1.05, 1.0, wide), (1.0, 1.05, 45_000), (0.95, 1.0, wide)]);
}

#[test]
fn sound_techniques_are_not_doubted() {
    // By 3 estimators. Of so skewed densities, a thousand samples would not be enough.
    assert_eq!(doubted(&wrong(1.0, 1.0), 5000, 80), [0; 3]);
}

#[test]
#[ignore = "half a minute in a release build"]
fn sound_techniques_are_not_doubted_by_any_seed() {
    assert_eq!(doubted(&wrong(1.0, 1.0), 20_000, 1000), [0; 3]);
}

/// Their ratio does not vary: there is no spread to compare a deviation with.
#[test]
fn densities_that_are_proportional() {
    for (a, b) in [(0.0, 3.0), (0.1, 0.8), (-1.0, 1e-3)] {
        let flat = Uniform::new(a, b).unwrap();
        let steps = mis::technique::PiecewiseConstant::new(&[a, 0.3 * b, b], &[1.0, 1.0]);
        let steps =
            steps.map(|_| Raw { sample: |u| a + u * (b - a), pdf: |_| 1.0 / (b - a) }).unwrap();
        let taller = Raw { sample: |u| a + u * (b - a), pdf: |_| 1.05 / (b - a) };
        for n in [1, 2, 3, 7, 12] {
            let mis = MultiSample::new(&[(&flat, n), (&steps, 3), (&flat, 1)]).unwrap();
            let one = OneSample::new(&[(&flat, 0.3), (&steps, 0.7)], 1).unwrap();
            for samples in [1000, 1203, 5000] {
                let g = |x: &f64| 2.0 + x;
                let report = run(samples).execute(&mis, &g, 1).unwrap();
                assert!(!doubts_densities(&report), "{report}");
                let report = run(samples).execute(&one, &g, 1).unwrap();
                assert!(!doubts_densities(&report), "{report}");
            }
            let mis = MultiSample::new(&[(&flat, n), (&taller, 3)]).unwrap();
            let report = run(5000).execute(&mis, &|x: &f64| 2.0 + x, 1).unwrap();
            assert!(doubts_densities(&report), "{report}");
        }
    }
}

#[test]
fn density_scores_are_none_where_nothing_can_be_said() {
    let (a, b) = (Normal::new(0.0, 1.0).unwrap(), Normal::new(0.0, 2.0).unwrap());
    let single = MultiSample::new(&[(&a, 2000)]).unwrap();
    let report = Run::new(Target::new()).execute(&single, &bell, 1).unwrap();
    assert_eq!(report.density_scores(), [None]);
    let constant = MultiSample::new(&[(&a, 2000), (&b, 1000)]).unwrap();
    let constant = constant.weighting(Constant::equal()).unwrap();
    let report = Run::new(Target::new()).execute(&constant, &bell, 1).unwrap();
    assert_eq!(report.density_scores(), [None, None]);
}

/// No sample can tell that a region is missing.
#[test]
fn a_hole_in_the_coverage_is_not_seen() {
    let (left, right) = (Uniform::new(0.0, 0.5).unwrap(), Uniform::new(0.2, 1.0).unwrap());
    let mis = MultiSample::new(&[(&left, 1), (&right, 1)]).unwrap();
    let report = run(20_000).execute(&mis, &|x: &f64| x.sqrt(), 1).unwrap();
    assert_eq!(*report.status(), Status::BudgetSpent);
    assert!(report.estimate().interval(0.9999).unwrap().contains(2.0 / 3.0));
    // With 1 to 2 left out, the answer is the integral over 0 to 1.
    let report = run(20_000).execute(&mis, &|x: &f64| if *x <= 2.0 { x.sqrt() } else { 0.0 }, 1);
    let report = report.unwrap();
    assert_eq!(*report.status(), Status::BudgetSpent);
    assert!(report.estimate().interval(0.9999).unwrap().contains(2.0 / 3.0));
}

#[test]
fn no_signal() {
    let flat = Uniform::unit();
    let mis = MultiSample::new(&[(&flat, 1)]).unwrap();
    for samples in [1, 2, 3, 6, 5000] {
        let report = run(samples).execute(&mis, &|_: &f64| 0.0, 1).unwrap();
        let at_most = (3.0 / samples as f64).min(1.0);
        let Status::NoSignal { at_most: found, .. } = report.status() else { panic!("{report}") };
        assert_eq!(*found, at_most);
        assert_eq!((report.value(), report.standard_error()), (0.0, None));
        assert!(report.to_string().contains("NO SIGNAL"), "{report}");
    }
    let target = Target::new().absolute(1.0).unwrap().samples(5000).unwrap();
    let report = Run::new(target).execute(&mis, &|_: &f64| 0.0, 1).unwrap();
    assert_eq!((report.stop(), report.samples()), (Stop::Samples, 5000));
    // A component alone.
    let f = |x: &f64| [*x, 0.0];
    let of = |norm| Run::new(target.norm(norm)).execute(&mis, &f, 1).unwrap();
    let report = of(Norm::Component(1));
    assert!(matches!(report.status(), Status::NoSignal { .. }), "{report}");
    assert_eq!(report.stop(), Stop::Samples);
    for norm in [Norm::Each, Norm::Component(0), Norm::Largest, Norm::Euclidean, Norm::Sum] {
        let report = of(norm);
        assert_eq!((report.stop(), report.status()), (Stop::Tolerance, &Status::Converged));
        assert_eq!(report.standard_error()[1], None);
    }
}

#[test]
fn few_contributions() {
    let flat = Uniform::unit();
    let mis = MultiSample::new(&[(&flat, 1)]).unwrap();
    let indicator = |x: &f64| f64::from(*x < 0.01);
    let report = run(1000).execute(&mis, &indicator, 1).unwrap();
    let hits = 1000 - report.estimate().zero();
    assert!((1..30).contains(&hits));
    let contributions = |doubt: &Doubt| match doubt {
        Doubt::FewContributions { technique, contributions, .. } => {
            Some((*technique, *contributions))
        }
        _ => None,
    };
    let found: Vec<_> = doubts(&report).iter().filter_map(contributions).collect();
    assert_eq!(found, [(Some(0), hits), (None, hits)]);
    assert!(report.to_string().contains(&format!("only {hits} contributions are not 0")));
    // One of two techniques that matter.
    let half = Uniform::new(0.0, 0.5).unwrap();
    let other = Uniform::new(0.5, 1.0).unwrap();
    let mis = MultiSample::new(&[(&half, 200), (&other, 20)]).unwrap();
    let report = run(220).execute(&mis, &|x: &f64| 1.0 + x, 1).unwrap();
    let found: Vec<_> = doubts(&report).iter().filter_map(contributions).collect();
    assert_eq!(found, [(Some(1), 20)]);
    // Of a millionth of the variance, as few are enough.
    let small = |x: &f64| (1.0 + x) * if *x < 0.5 { 1.0 } else { 1e-3 };
    let report = run(220).execute(&mis, &small, 1).unwrap();
    assert_eq!(doubts(&report).iter().find_map(contributions), None, "{report}");
}

/// 29 are too few, 30 are not: of a technique, and of all.
#[test]
fn how_many_contributions_are_few() {
    let flat = Uniform::unit();
    let few = |doubt: &Doubt| matches!(doubt, Doubt::FewContributions { .. });
    let multi = MultiSample::new(&[(&flat, 1)]).unwrap();
    let one = OneSample::new(&[(&flat, 1.0)], 1).unwrap();
    for (samples, expected) in [(29, [2, 1]), (30, [0, 0])] {
        let f = |x: &f64| 1.0 + x;
        let reports = [run(samples).execute(&multi, &f, 1), run(samples).execute(&one, &f, 1)];
        let found = reports.map(|report| doubts(&report.unwrap()).into_iter().filter(few).count());
        assert_eq!(found, expected, "{samples}");
    }
}

#[test]
fn an_infinite_variance_does_not_converge() {
    let flat = Uniform::unit();
    let mis = MultiSample::new(&[(&flat, 1)]).unwrap();
    let (mut suspect, mut named) = (0, 0);
    for seed in 0..20 {
        let target = Target::new().relative(0.05).unwrap().samples(1 << 15).unwrap();
        // Pareto, a = 1.5.
        let report = Run::new(target).execute(&mis, &|u: &f64| u.powf(-1.0 / 1.5), seed).unwrap();
        suspect += u32::from(matches!(report.status(), Status::Suspect(_)));
        named += u32::from(doubts(&report).iter().any(|doubt| {
            matches!(doubt, Doubt::HeavyTail { technique: 0, component: 0, k_hat, .. } if *k_hat > 0.5)
        }));
    }
    assert_eq!(suspect, 20);
    assert!(named >= 19, "{named}");
}

#[test]
fn a_constant_has_no_error_ends_at_once_and_is_doubted() {
    let flat = Uniform::new(0.0, 3.0).unwrap();
    let mis = MultiSample::new(&[(&flat, 1)]).unwrap();
    let target = Target::new().relative(1e-12).unwrap();
    let report = Run::new(target).execute(&mis, &|_: &f64| 0.7, 1).unwrap();
    assert_eq!(report.stop(), Stop::Tolerance);
    let Status::Suspect(doubts) = report.status() else { panic!("{}", report.status()) };
    let [Doubt::Constant { component: 0, at_most, .. }] = doubts[..] else { panic!("{doubts:?}") };
    assert_eq!(at_most, 3.0 / 1024.0);
    assert_eq!((report.samples(), report.estimate().samples()), (2048, 1024));
    assert!((report.value() / 2.1 - 1.0).abs() < 1e-15);
    assert_eq!(report.standard_error(), Some(0.0));
    assert_eq!(report.rounds().len(), 2);
}

/// What is reported meets the tolerance in the norm that was asked for.
#[test]
fn norms() {
    let flat = Uniform::new(0.0, 2.0).unwrap();
    let mis = MultiSample::new(&[(&flat, 1)]).unwrap();
    let three = |x: &f64| [f(x), 5.0 * x, -0.1 * x * x];
    let (relative, level) = (0.02, 0.9);
    let samples = |norm: Norm| {
        let target = Target::new().relative(relative).unwrap().confidence(level).unwrap();
        let report = Run::new(target.norm(norm)).execute(&mis, &three, 3).unwrap();
        assert_eq!(*report.status(), Status::Converged);
        let intervals = report.estimate().interval(level).unwrap();
        let e = intervals.map(|interval| (interval.upper - interval.lower) / 2.0);
        let v = report.value().map(f64::abs);
        let sum = |xs: [f64; 3]| xs.iter().sum::<f64>();
        let (over, of) = match norm {
            Norm::Each => ((0..3).map(|c| e[c] / v[c]).fold(0.0, f64::max), 1.0),
            Norm::Component(c) => (e[c], v[c]),
            Norm::Largest => (e[1], v[1]),
            Norm::Euclidean => (sum(e.map(|e| e * e)).sqrt(), sum(v.map(|v| v * v)).sqrt()),
            Norm::Sum => (sum(e), sum(v)),
            _ => panic!("{norm:?}"),
        };
        assert!(over <= 1.001 * relative * of, "{norm:?}");
        report.samples()
    };
    let each = samples(Norm::Each);
    for norm in [0, 1, 2].map(Norm::Component) {
        assert!(samples(norm) <= each);
    }
    assert_eq!(samples(Norm::Component(2)), each);
    assert!(samples(Norm::Largest) < each && samples(Norm::Sum) < each);
    assert!(samples(Norm::Euclidean) < each);
    let target = Target::new().relative(relative).unwrap().norm(Norm::Component(3));
    let error = Run::new(target).execute(&mis, &three, 1).unwrap_err().to_string();
    assert!(error.contains("the integrand has 3 components"), "{error}");
}

#[test]
fn a_technique_that_has_drawn_nothing() {
    let (flat, rare) = (Uniform::new(0.0, 1.0).unwrap(), Uniform::new(0.0, 2.0).unwrap());
    let mis = MultiSample::new(&[(&flat, 1_000_000), (&rare, 1)]).unwrap();
    let tally = |samples| {
        run(samples).tally(&mis, &f, &Random::new(1), 1, |sample, tally| {
            tally.add(0, sample.contribution());
        })
    };
    let report = tally(5000).unwrap();
    assert!(report.value().is_nan() && report.standard_error().is_none());
    // The sum is that of all contributions, so it is as unknown as the value.
    assert!(report.tallied()[0].value.is_nan() && report.tallied()[0].standard_error.is_none());
    assert!(report.to_string().contains("its part is missing"), "{report}");
    let samples = |doubt: &Doubt| match doubt {
        Doubt::Samples { technique, samples, .. } => Some((*technique, *samples)),
        _ => None,
    };
    assert_eq!(doubts(&report).iter().find_map(samples), Some((1, 0)));
    // None converges as long as it is so.
    let target = Target::new().absolute(1e9).unwrap().samples(20_000).unwrap();
    let report = Run::new(target).execute(&mis, &f, 1).unwrap();
    assert_eq!(report.stop(), Stop::Samples);
    assert_eq!(doubts(&report).iter().find_map(samples), Some((1, 0)));
    // One sample is a value, but no error.
    let mis = MultiSample::new(&[(&flat, 1999), (&rare, 1)]).unwrap();
    let report = run(2000).execute(&mis, &f, 1).unwrap();
    assert!(report.value().is_finite() && report.standard_error().is_none());
    assert_eq!(doubts(&report).iter().find_map(samples), Some((1, 1)));
}

#[test]
fn values_without_components_are_refused() {
    let flat = Uniform::unit();
    let mis = MultiSample::new(&[(&flat, 1)]).unwrap();
    let nothing = |_: &f64| -> [f64; 0] { [] };
    let error = run(3000).execute(&mis, &nothing, 1).unwrap_err();
    let text =
        "Run: `Value::COMPONENTS` is 0, but the values of an integrand must have at least one";
    assert!(error.report().is_none() && error.to_string().starts_with(text), "{error}");
}

/// One number, three ways: the estimator alone, the run, and its sums.
#[test]
fn a_run_agrees_with_the_estimator_alone() {
    let (a, b) = (Normal::new(0.0, 1.0).unwrap(), Normal::new(1.0, 2.0).unwrap());
    let mis = MultiSample::new(&[(&a, 3001), (&b, 1999)]).unwrap();
    let alone = mis.estimate(&bell, 5).unwrap();
    let report = Run::new(Target::new())
        .tally(&mis, &bell, &Random::new(5), 1, |sample, tally| tally.add(0, sample.contribution()))
        .unwrap();
    assert_eq!(report.estimate().samples(), 5000);
    let sum = report.tallied()[0];
    let (error, of) = (alone.standard_error().unwrap(), report.standard_error().unwrap());
    for (value, error_again) in [(report.value(), of), (sum.value, sum.standard_error.unwrap())] {
        assert!((value / alone.value() - 1.0).abs() < 1e-13);
        assert!((error_again / error - 1.0).abs() < 1e-12);
    }
    let [largest, own] = [report.estimate(), &alone].map(|e| e.largest().unwrap());
    assert_eq!((largest.technique, largest.sample), (own.technique, own.sample));
    assert_eq!(largest.contribution, own.contribution);
    assert!((report.estimate().kappa().unwrap() / alone.kappa().unwrap() - 1.0).abs() < 1e-9);
}
