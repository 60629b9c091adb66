//! The ways to an estimate: method, shares of the samples, points.

use std::error::Error;
use std::fmt::Debug;

use mis::plan::{Adaptive, Caution, Costs, Method, Planner};
use mis::points::{Antithetic, PointSource, Random, Sobol, Stratified};
use mis::{Estimator, Fit, Integrand, OptimalMis, Plan, Technique};

use crate::problems::Case;

/// Samples of each technique that a pilot draws.
pub(crate) const PILOT: u64 = 4096;

/// One way.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub(crate) name: String,
    pub(crate) way: Way,
    pub(crate) shares: Vec<f64>,
    pub(crate) optimised: bool,
    pub(crate) points: Points,
    /// Of a plan: N times the variance, its relative uncertainty, whether it is flagged.
    pub(crate) predicted: Option<Predicted>,
    /// Whether it is what the plan recommends, with random points or others.
    pub(crate) plan: bool,
}

/// What draws.
#[derive(Debug, Clone)]
pub(crate) enum Way {
    /// A plan's estimator.
    Planned(Method),
    /// Optimal MIS, with coefficients from its own samples.
    Fitted(Fit),
    /// Rounds, with controls or without.
    Adaptive { controls: bool },
}

/// A variance as a pilot predicts it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Predicted {
    pub(crate) variance: f64,
    pub(crate) uncertainty: f64,
    pub(crate) caution: Option<Caution>,
}

/// Where ξ comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Points {
    Random,
    Antithetic,
    Stratified,
    Sobol,
}

impl Points {
    pub(crate) const OTHERS: [Self; 3] = [Self::Antithetic, Self::Stratified, Self::Sobol];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Antithetic => "antithetic",
            Self::Stratified => "strata",
            Self::Sobol => "Sobol’",
        }
    }

    /// The source for estimates with about `each` samples of every technique.
    fn source(self, seed: u64, each: u64) -> Result<Box<dyn PointSource>, Box<dyn Error>> {
        Ok(match self {
            Self::Random => Box::new(Random::new(seed)),
            Self::Antithetic => Box::new(Antithetic::new(seed)),
            // A whole block for each of the 32 replicates.
            Self::Stratified => {
                let strata = usize::try_from(each / 32)?.clamp(2, 1 << 16);
                Box::new(Stratified::new(seed, strata)?)
            }
            Self::Sobol => Box::new(Sobol::new(seed)),
        })
    }
}

/// The techniques of a case, as estimators take them.
pub(crate) fn list<'a, P, F: ?Sized>(case: &Case<'a, P, F>) -> Vec<&'a dyn Technique<Point = P>> {
    case.techniques.iter().map(|named| named.technique).collect()
}

/// Plans with declared costs, or with measured ones.
pub(crate) fn plan<P: Debug, F: Integrand<P, Value = f64>>(
    case: &Case<'_, P, F>,
    clock: bool,
    seed: u64,
) -> Result<Plan, Box<dyn Error>> {
    let mut planner = Planner::new().samples(PILOT)?;
    if !clock {
        let costs = &case.costs;
        planner = planner.costs(Costs::declared(
            costs.sampling,
            costs.pdf,
            costs.integrand,
            costs.combining,
        )?);
    }
    Ok(planner.plan(case.f, &list(case), seed)?)
}

/// Every way that makes sense for a case.
pub(crate) fn all<P, F: ?Sized>(case: &Case<'_, P, F>, plan: &Plan) -> Vec<Entry> {
    let everywhere = case.techniques.iter().all(|named| named.alone);
    let sensible = |method: &Method| match method {
        Method::Single(i) => case.techniques[*i].alone,
        Method::Constant(_) => everywhere,
        _ => true,
    };
    let chosen = plan.prediction();
    let mut entries: Vec<Entry> = plan
        .predictions
        .iter()
        .filter(|p| sensible(&p.method))
        .map(|p| Entry {
            name: format!(
                "{}{}",
                name(&p.method, case),
                if p.optimised { ", opt. shares" } else { "" }
            ),
            way: Way::Planned(p.method.clone()),
            shares: p.shares.clone(),
            optimised: p.optimised,
            points: Points::Random,
            predicted: Some(Predicted {
                variance: p.variance[0] / (case.exact * case.exact),
                uncertainty: p.uncertainty[0],
                caution: p.caution,
            }),
            plan: chosen == Some(p),
        })
        .collect();
    let equal = vec![1.0 / case.techniques.len() as f64; case.techniques.len()];
    let own = |name: &str, way: Way| Entry {
        name: name.into(),
        way,
        shares: equal.clone(),
        optimised: false,
        points: Points::Random,
        predicted: None,
        plan: false,
    };
    entries.push(own("optimal MIS (cross-fit)", Way::Fitted(Fit::default())));
    entries.push(own("optimal MIS (direct)", Way::Fitted(Fit::Direct)));
    entries.push(own("optimal MIS (progressive)", Way::Fitted(Fit::Progressive)));
    entries.push(own("balance, adaptive shares", Way::Adaptive { controls: false }));
    entries.push(own("optimal MIS, adaptive shares", Way::Adaptive { controls: true }));

    let smooth = |entry: &Entry| {
        entry.plan
            || !entry.optimised
                && match &entry.way {
                    Way::Planned(Method::Balance | Method::Maximum) => true,
                    Way::Planned(Method::Constant(_)) => entry.name == EQUAL,
                    Way::Fitted(fit) => *fit == Fit::default(),
                    _ => false,
                }
    };
    let with_other_points: Vec<Entry> = entries
        .iter()
        .filter(|entry| smooth(entry))
        .flat_map(|entry| {
            Points::OTHERS.map(|points| Entry {
                name: format!("{}, {}", entry.name, points.name()),
                points,
                predicted: None,
                ..entry.clone()
            })
        })
        .collect();
    entries.extend(with_other_points);
    entries
}

/// The name of constant weights that are equal.
pub(crate) const EQUAL: &str = "constant, equal";

fn name<P, F: ?Sized>(method: &Method, case: &Case<'_, P, F>) -> String {
    match method {
        Method::Single(i) => format!("{} alone", case.techniques[*i].name),
        Method::Constant(w) if w.windows(2).all(|pair| pair[0] == pair[1]) => EQUAL.into(),
        Method::Constant(_) => "constant, 1/variance".into(),
        Method::Balance => "balance".into(),
        Method::Power(beta) => format!("power {beta}"),
        Method::Cutoff(a) => format!("cutoff {a}"),
        Method::Maximum => "maximum".into(),
        Method::VarianceAware(_) => "variance-aware".into(),
        Method::OneSample => "one-sample".into(),
        Method::Optimal(_) => "optimal MIS (pilot)".into(),
        other => other.to_string(),
    }
}

/// An estimate from `n` samples, and the seconds that it took.
pub(crate) fn estimate<P: Debug, F: Integrand<P, Value = f64> + Sync>(
    case: &Case<'_, P, F>,
    plan: &Plan,
    entry: &Entry,
    n: u64,
    seed: u64,
) -> Result<(f64, f64), Box<dyn Error>> {
    let techniques = list(case);
    let counts = counts(&entry.shares, n);
    let points = entry.points.source(seed, n / techniques.len() as u64)?;
    let start = std::time::Instant::now;
    Ok(match &entry.way {
        Way::Planned(method) => {
            // A plan is a plain value: this one draws these samples.
            let mut plan = plan.clone();
            (plan.method, plan.counts) = (method.clone(), counts);
            let estimator = plan.estimator(&techniques)?;
            let start = start();
            let estimate = match entry.points {
                Points::Random => estimator.estimate(case.f, seed)?,
                _ => estimator.estimate_from(case.f, &*points)?,
            };
            (estimate.value(), start.elapsed().as_secs_f64())
        }
        Way::Fitted(fit) => {
            let list: Vec<_> = techniques.iter().copied().zip(counts).collect();
            let estimator = OptimalMis::new(&list)?.fit(*fit)?;
            let start = start();
            let estimate = estimator.estimate_from(case.f, &*points)?;
            (estimate.value(), start.elapsed().as_secs_f64())
        }
        Way::Adaptive { controls } => {
            let adaptive = Adaptive::new(n)?.threads(1)?;
            let adaptive = if *controls { adaptive } else { adaptive.without_controls() };
            let start = start();
            let adapted = adaptive.execute(case.f, &techniques, seed)?;
            (adapted.value(), start.elapsed().as_secs_f64())
        }
    })
}

/// Whole numbers in proportion to the shares, `n` together; at least 1 where the share is not 0.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // 0 to 2^53.
fn counts(shares: &[f64], n: u64) -> Vec<u64> {
    let mut before = 0.0;
    let mut counts: Vec<u64> = shares
        .iter()
        .map(|share| {
            let from: f64 = before;
            before += share * n as f64;
            (before.round() - from.round()) as u64
        })
        .collect();
    for k in (0..shares.len()).filter(|k| shares[*k] > 0.0) {
        let most = (0..counts.len()).max_by_key(|m| counts[*m]).unwrap_or(k);
        if counts[k] == 0 {
            counts[k] = 1;
            counts[most] -= 1;
        }
    }
    counts
}
