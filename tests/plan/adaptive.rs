//! Rounds that learn from those before.

use mis::plan::{Adaptive, Costs};
use mis::points::{PointSource, PointsExhausted, Random, Sobol};
use mis::technique::{Linear, Uniform};
use mis::{OnFault, Technique};

use crate::measure::parallel;
use crate::problems::Problem;
use crate::suite::problems;

fn problem(name: &str) -> Problem {
    problems().into_iter().find(|p| p.name == name).unwrap()
}

fn techniques() -> [&'static dyn Technique<Point = f64>; 2] {
    [
        crate::problems::one(Uniform::unit()),
        crate::problems::one(Linear::new(0.0, 1.0, 0.5, 1.5).unwrap()),
    ]
}

/// Mean error in standard errors of the mean, and N times the variance.
fn ensemble(problem: &Problem, adaptive: &Adaptive, samples: u64, seeds: usize) -> (f64, f64) {
    let truth = problem.integral.as_ref().unwrap()[0];
    let values = parallel(seeds, |seed| problem.adapt(adaptive, seed as u64).values[0] - truth);
    let n = seeds as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean / (variance / n).sqrt(), variance * samples as f64)
}

/// N times the variance of the balance heuristic with equal samples.
const BALANCE: [(&str, f64); 3] = [
    ("family A", 0.138_589_91 * 2.0),
    ("family D", 3.562_557 * 3.0),
    ("family E", 93.366_25 * 3.0),
];

#[test]
fn unbiased_and_better_than_equal_samples() {
    check(&BALANCE[..1], 1024, 24, 0.7);
}

#[test]
#[ignore = "half a minute in release"]
fn unbiased_and_better_than_equal_samples_with_full_ensembles() {
    check(&BALANCE, 1024, 2000, 0.7);
    check(&BALANCE, 16_384, 200, 0.5);
}

fn check(families: &[(&str, f64)], samples: u64, seeds: usize, least: f64) {
    for &(name, balance) in families {
        let problem = problem(name);
        for controls in [true, false] {
            let adaptive = Adaptive::new(samples).unwrap();
            let adaptive = if controls { adaptive } else { adaptive.without_controls() };
            let (z, variance) = ensemble(&problem, &adaptive, samples, seeds);
            println!(
                "{name}, controls {controls}, {samples}: z {z:.2}, variance {:.4}",
                variance / balance
            );
            assert!(z.abs() < 4.42, "{name}: {z}");
            let noise = 1.0 + 4.0 * (2.0 / seeds as f64).sqrt();
            assert!(variance < least * noise * balance, "{name} {controls}: {variance} {balance}");
        }
    }
}

#[test]
fn the_same_bits_on_any_threads() {
    let f = |x: &f64| x.exp();
    for adaptive in [Adaptive::new(8000).unwrap(), Adaptive::new(8000).unwrap().without_controls()]
    {
        let run = |threads| {
            let adapted =
                adaptive.clone().threads(threads).unwrap().execute(&f, &techniques(), 4).unwrap();
            let rounds: Vec<_> = adapted
                .rounds()
                .iter()
                .map(|r| (r.counts().to_vec(), r.controls().cloned()))
                .collect();
            (adapted.value().to_bits(), adapted.standard_error().unwrap().to_bits(), rounds)
        };
        assert_eq!(run(1), run(2));
        assert_eq!(run(1), run(3));
    }
}

#[test]
fn sobol_points() {
    let f = |x: &f64| x.exp() * (1.5 + (9.0 * x).sin());
    let truth = 1.5 * (1_f64.exp() - 1.0) + {
        let at = |x: f64| x.exp() * ((9.0 * x).sin() - 9.0 * (9.0 * x).cos()) / 82.0;
        at(1.0) - at(0.0)
    };
    for adaptive in
        [Adaptive::new(1 << 14).unwrap(), Adaptive::new(1 << 14).unwrap().without_controls()]
    {
        let random = adaptive.execute(&f, &techniques(), 1).unwrap();
        for seed in 0..2 {
            let adapted = adaptive.execute_from(&f, &techniques(), &Sobol::new(seed)).unwrap();
            let error = adapted.standard_error().unwrap();
            let z = (adapted.value() - truth) / error;
            assert!(z.abs() < 6.0 && error > 0.0, "{z}");
            assert!(error < 0.3 * random.standard_error().unwrap(), "{error}");
        }
    }
}

/// Random numbers that are others from some stream on.
#[derive(Debug)]
struct Changed {
    from: usize,
    before: Random,
    after: Random,
}

impl PointSource for Changed {
    fn fill(
        &self,
        stream: usize,
        first: u64,
        dimension: usize,
        xi: &mut [f64],
    ) -> Result<(), PointsExhausted> {
        let own = if stream < self.from { &self.before } else { &self.after };
        own.fill(stream, first, dimension, xi)
    }
}

#[test]
fn counts_depend_on_past_rounds_only() {
    let f = |x: &f64| x.exp() + 3.0 * x.powi(5);
    let adaptive = Adaptive::new(16_384).unwrap();
    let run = |from: usize| {
        let points = Changed { from: from * 2, before: Random::new(1), after: Random::new(2) };
        adaptive.execute_from(&f, &techniques(), &points).unwrap()
    };
    let all = run(usize::MAX / 4);
    assert_eq!(all.rounds().len(), 6);
    for changed in [0, 3, 5] {
        let other = run(changed);
        for (t, (a, b)) in all.rounds().iter().zip(other.rounds()).enumerate() {
            let same_report = a.report().value() == b.report().value();
            assert_eq!(t < changed, same_report, "round {t}, changed from {changed}");
            if t <= changed {
                assert_eq!((a.counts(), a.controls()), (b.counts(), b.controls()));
            }
        }
    }
}

#[test]
fn rounds_add_up() {
    // All but the first technique's samples are at the floor.
    let f = |_: &f64| 1.0;
    for (samples, rounds, expected) in
        [(1024, 6, 3), (1 << 14, 6, 6), (1 << 14, 1, 1), (1 << 14, 40, 7), (10_007, 4, 4)]
    {
        let adaptive = Adaptive::new(samples).unwrap().with_rounds(rounds).unwrap();
        let adapted = adaptive.execute(&f, &techniques(), 1).unwrap();
        assert_eq!(adapted.rounds().len(), expected);
        let all: u64 = adapted.rounds().iter().flat_map(mis::plan::AdaptedRound::counts).sum();
        assert_eq!((all, adapted.estimate().samples()), (samples, samples));
        let sum: f64 = adapted
            .rounds()
            .iter()
            .map(|round| round.report().value() * round.counts().iter().sum::<u64>() as f64)
            .sum();
        assert!((adapted.value() - sum / samples as f64).abs() < 1e-14 * adapted.value());
        for round in adapted.rounds() {
            let n: u64 = round.counts().iter().sum();
            assert!(round.counts().iter().all(|c| *c >= 8 && *c as f64 >= 0.005 * n as f64 - 1.0));
            assert!(round.report().standard_error().is_some());
        }
    }
}

#[test]
fn arguments() {
    assert!(Adaptive::new(1023).is_err() && Adaptive::new((1 << 53) + 1).is_err());
    let adaptive = Adaptive::new(1024).unwrap();
    for bad in [0, 41] {
        let error = adaptive.clone().with_rounds(bad).unwrap_err().to_string();
        assert!(error.contains("rounds") && error.contains(&bad.to_string()), "{error}");
    }
    for bad in [0.0, -1.0, 1.5, f64::NAN] {
        assert!(adaptive.clone().floor(bad).is_err());
    }
    assert!(adaptive.clone().threads(0).is_err());
    let costs = Costs::declared([1.0], [1.0], 1.0, 1.0).unwrap();
    assert!(adaptive.clone().costs(costs).execute(&|x: &f64| *x, &techniques(), 1).is_err());
    let none: [&dyn Technique<Point = f64>; 0] = [];
    assert!(adaptive.execute(&|x: &f64| *x, &none, 1).is_err());
    // Nothing to learn from, and faults.
    let zero = adaptive.execute(&|_: &f64| 0.0, &techniques(), 1).unwrap();
    assert_eq!(zero.value(), 0.0);
    let poles = |x: &f64| if *x < 0.001 { f64::NAN } else { *x };
    assert!(Adaptive::new(1 << 16).unwrap().execute(&poles, &techniques(), 1).is_err());
    let counting = Adaptive::new(1 << 16).unwrap().on_fault(OnFault::count_as_zero(0.1).unwrap());
    let value = counting.execute(&poles, &techniques(), 1).unwrap().value();
    assert!((value - 0.5).abs() < 0.01, "{value}");
}
