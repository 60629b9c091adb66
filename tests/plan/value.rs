//! Plans as values: equal, saved, edited, printed, executed.

use std::sync::OnceLock;

use mis::plan::{Costs, Method, Plan, Planner};
use mis::technique::{Linear, Uniform};
use mis::{Controls, Run, Target, Technique, integrate};

use crate::problems::Kind;
use crate::suite::problems;

fn techniques() -> [&'static dyn Technique<Point = f64>; 2] {
    [
        crate::problems::one(Uniform::unit()),
        crate::problems::one(Linear::new(0.0, 1.0, 0.5, 1.5).unwrap()),
    ]
}

fn f(x: &f64) -> f64 {
    x.exp() + (20.0 * x).sin()
}

fn planner() -> Planner {
    let costs = Costs::declared([1.0, 2.0], [0.5, 0.5], 3.0, 1.0).unwrap();
    Planner::new().costs(costs).samples(512).unwrap()
}

fn made() -> Plan {
    planner().plan(&f, &techniques(), 7).unwrap()
}

/// The same, made once.
fn plan() -> Plan {
    static PLAN: OnceLock<Plan> = OnceLock::new();
    PLAN.get_or_init(made).clone()
}

#[test]
fn declared_costs_make_the_same_plan_every_time() {
    assert_eq!(made(), plan());
    assert_ne!(plan(), planner().plan(&f, &techniques(), 8).unwrap());
    for problem in problems().iter().filter(|p| ["family D", "vector"].contains(&p.name)) {
        let planner = Planner::new().costs(problem.costs(Kind::Pdf)).samples(128).unwrap();
        let again = || problem.pilot(&planner, 3).plan().unwrap();
        assert_eq!(again(), again());
    }
}

#[test]
fn a_run_of_a_plan_has_the_same_bits_on_any_threads() {
    let mut plan = plan();
    for number in 0..plan.predictions.len() {
        plan.choose(number).unwrap();
        let estimator = plan.estimator(&techniques()).unwrap();
        let run = |threads| {
            let run = Run::new(Target::new().samples(5000).unwrap()).threads(threads).unwrap();
            let report = run.execute(&estimator, &f, 3).unwrap();
            (report.value().to_bits(), report.standard_error().map(f64::to_bits), report.samples())
        };
        assert_eq!(run(1), run(2), "{}", plan.method);
        assert_eq!(run(1), run(3), "{}", plan.method);
    }
    let whole = || {
        let planner = planner().target(Target::new().relative(0.01).unwrap());
        planner.integrate(&f, &techniques(), 5).unwrap().report().value().to_bits()
    };
    assert_eq!(whole(), whole());
}

#[test]
fn plans_are_saved_and_read() {
    for problem in
        problems().iter().filter(|p| ["family E", "vector", "alone in a region"].contains(&p.name))
    {
        let planner = Planner::new().costs(problem.costs(Kind::Ratios)).samples(256).unwrap();
        let mut plan = problem.pilot(&planner, 3).plan().unwrap();
        for number in 0..plan.predictions.len() {
            plan.choose(number).unwrap();
            let bytes = postcard::to_stdvec(&plan).unwrap();
            assert_eq!(postcard::from_bytes::<Plan>(&bytes).unwrap(), plan);
            let own = plan.prediction().unwrap();
            assert_eq!(
                (&own.method, &own.shares),
                (&plan.method, &plan.predictions[number].shares)
            );
        }
    }
}

#[test]
fn choosing() {
    let mut plan = plan();
    assert_eq!(plan.prediction(), Some(&plan.predictions[0]));
    let before = plan.clone();
    let error = plan.choose(1000).unwrap_err().to_string();
    assert!(error.contains("1000") && error.contains("predictions"), "{error}");
    assert_eq!(plan, before);
    let last = plan.predictions.len() - 1;
    plan.choose(last).unwrap();
    assert_eq!(plan.method, plan.predictions[last].method);
    plan.counts = vec![3, 7];
    assert!(plan.prediction().is_none());
    assert!(plan.to_string().contains("not one of those that were predicted"), "{plan}");
}

/// Whatever is done to a plan: an error that names it, or an estimator, and it can be printed.
#[test]
fn mutilated_plans() {
    fn refused(what: &str, edit: impl Fn(&mut Plan)) {
        let mut plan = plan();
        edit(&mut plan);
        let _ = plan.to_string();
        let _ = plan.prediction();
        match plan.estimator(&techniques()) {
            Ok(estimator) => panic!("{what}: {estimator:?}"),
            Err(error) => assert!(error.to_string().contains(what), "{what}: {error}"),
        }
    }
    refused("counts", |plan| plan.counts = vec![1]);
    refused("counts", |plan| plan.counts = Vec::new());
    refused("counts", |plan| plan.counts = vec![1, 2, 3]);
    refused("counts", |plan| plan.counts = vec![0, 0]);
    refused("counts", |plan| plan.counts = vec![u64::MAX, u64::MAX]);
    refused("counts", |plan| {
        plan.method = Method::Single(0);
        plan.counts = vec![1, 1];
    });
    refused("Single", |plan| {
        plan.method = Method::Single(9);
        plan.counts = vec![1, 0];
    });
    refused("weights", |plan| plan.method = Method::Constant(vec![f64::NAN, 1.0]));
    refused("weights", |plan| plan.method = Method::Constant(vec![1.0]));
    refused("weights", |plan| plan.method = Method::Constant(Vec::new()));
    refused("beta", |plan| plan.method = Method::Power(f64::NAN));
    refused("Cutoff", |plan| plan.method = Method::Cutoff(2.0));
    refused("factors", |plan| plan.method = Method::VarianceAware(vec![1.0]));
    refused("factors", |plan| plan.method = Method::VarianceAware(vec![f64::NAN, 1.0]));
    refused("coefficients", |plan| {
        plan.method = Method::Optimal(Controls::new(0, [[0.0]]).unwrap());
    });
    refused("at_most", |plan| plan.faults_at_most = Some(f64::NAN));
    // Nothing of these matters to an estimator, and all can be printed.
    let mut plan = plan();
    plan.predictions[0].shares.clear();
    plan.predictions[0].variance.clear();
    plan.predictions[0].uncertainty.clear();
    plan.predictions[1].efficiency = f64::NAN;
    plan.predictions[1].shares = vec![f64::NAN, f64::INFINITY];
    plan.predictions[2].shares = vec![-1.0, 1e300];
    plan.pilot_value.clear();
    let _ = (plan.to_string(), plan.prediction());
    for number in 0..3 {
        plan.choose(number).unwrap();
        let _ = plan.estimator(&techniques()).map(|estimator| format!("{estimator:?}"));
    }
    plan.predictions.clear();
    assert!(plan.choose(0).is_err());
    let _ = plan.to_string();
    // Of other techniques.
    assert!(plan.estimator(&techniques()[..1]).is_err());
    assert!(plan.estimator::<f64>(&[]).is_err());
}

#[test]
fn predictions_of_what_does_not_fit_are_refused() {
    let pilot = planner().pilot(&f, &techniques(), 7).unwrap();
    for shares in
        [&[1.0][..], &[], &[0.0, 0.0], &[-1.0, 2.0], &[f64::NAN, 1.0], &[f64::INFINITY, 1.0]]
    {
        let error = pilot.predict(&Method::Balance, shares).unwrap_err().to_string();
        assert!(error.contains("shares"), "{error}");
    }
    assert!(pilot.predict(&Method::Single(5), &[1.0, 0.0]).is_err());
    assert!(pilot.predict(&Method::Single(0), &[0.5, 0.5]).is_err());
    assert!(pilot.allocate(&Method::Single(5)).is_err());
    assert!(pilot.predict(&Method::Constant(vec![1.0]), &[0.5, 0.5]).is_err());
    assert!(
        pilot.predict(&Method::Optimal(Controls::new(0, [[0.0]]).unwrap()), &[0.5, 0.5]).is_ok()
    );
    // Shares are taken in proportion.
    let twice = pilot.predict(&Method::Balance, &[2.0, 2.0]).unwrap();
    assert_eq!(twice, pilot.predict(&Method::Balance, &[0.5, 0.5]).unwrap());
}

#[test]
fn a_target_is_needed() {
    let error = integrate(&f, &techniques(), Target::new(), 1).unwrap_err().to_string();
    assert!(error.contains("target"), "{error}");
    let none: [&dyn Technique<Point = f64>; 0] = [];
    assert!(integrate(&f, &none, Target::new().samples(100).unwrap(), 1).is_err());
}

/// Columns are aligned, and what is cautioned against is explained.
#[test]
fn printed() {
    let problem = problems().into_iter().find(|p| p.name == "family D").unwrap();
    let planner = Planner::new().costs(problem.costs(Kind::Ratios)).samples(512).unwrap();
    let plan = problem.pilot(&planner, 3).plan().unwrap();
    let text = plan.to_string();
    let lines: Vec<&str> = text.lines().collect();
    let head = lines.iter().position(|line| line.starts_with("method")).unwrap();
    let column = |line: &str, word: &str| {
        line.find(word).map_or_else(|| panic!("{line}"), |at| line[..at].chars().count())
    };
    let shares = column(lines[head], "shares");
    for (line, row) in lines[head + 1..].iter().zip(&plan.predictions) {
        assert!(line.starts_with(&row.method.to_string()), "{line}");
        let first = format!("{:.3}, ", row.shares[0]);
        let tail: String = line.chars().skip(shares).collect();
        assert!(tail.starts_with(&first), "{line}");
        let flagged = line.contains("heavy tail") || line.contains("uncertain");
        assert_eq!(row.caution.is_some(), flagged, "{line}");
    }
    assert!(text.contains("heavy tail: few samples make up the variance"), "{text}");
    for word in ["plan: ", "times the efficiency", "±: ", "cost: ", "1536 samples of a pilot"] {
        assert!(text.contains(word), "{word}: {text}");
    }
}

/// How the tables look: `cargo test --test plan print -- --ignored --nocapture`.
#[test]
#[ignore = "for the eye"]
fn print() {
    for name in ["family D", "eight", "three peaks, narrow", "one technique", "alone in a region"] {
        let problem = problems().into_iter().find(|p| p.name == name).unwrap();
        let planner = Planner::new().costs(problem.costs(Kind::Ratios));
        println!("{}\n", problem.pilot(&planner, 3).plan().unwrap());
        let planner =
            Planner::new().target(Target::new().relative(1e-3).unwrap().samples(1 << 20).unwrap());
        println!("{}\n", problem.integrate(&planner, 3).1);
    }
}

/// What a pilot and its plan take: `cargo test --release --test plan seconds -- --ignored --nocapture`.
#[test]
#[ignore = "for the eye"]
fn seconds() {
    for name in [
        "sin·cos",
        "sin·cos and uniform",
        "four peaks, wide",
        "eight",
        "sixteen",
        "product in 8-D",
        "vector",
    ] {
        let problem = problems().into_iter().find(|p| p.name == name).unwrap();
        for (what, planner) in [
            ("declared", Planner::new().costs(problem.costs(Kind::Equal))),
            ("measured", Planner::new()),
        ] {
            let (mut pilots, mut plans) = (f64::INFINITY, f64::INFINITY);
            for seed in 0..5 {
                let start = std::time::Instant::now();
                let pilot = problem.pilot(&planner, seed);
                pilots = pilots.min(start.elapsed().as_secs_f64());
                let start = std::time::Instant::now();
                let _ = pilot.plan().unwrap();
                plans = plans.min(start.elapsed().as_secs_f64());
            }
            println!("{name:<22} {what}: pilot {:.1} ms, plan {:.1} ms", 1e3 * pilots, 1e3 * plans);
        }
    }
}
