//! Integrands with techniques, whatever points and values they are of, and what is done with them.

use std::any::Any;
use std::f64::consts::PI;
use std::fmt::Debug;

use mis::plan::{Adaptive, Costs, Pilot, Plan, Planner};
use mis::{Report, Run, Status, Target, Technique, Value};

/// An integrand and techniques, whatever points and values they are of.
pub(crate) struct Problem {
    pub(crate) name: &'static str,
    pub(crate) techniques: usize,
    /// The integral of each component, where it is known.
    pub(crate) integral: Option<Vec<f64>>,
    /// On the line, what is smooth lies between these.
    cuts: Vec<f64>,
    inner: Box<dyn Erased>,
}

/// What a run came to.
pub(crate) struct Outcome {
    pub(crate) sound: bool,
    pub(crate) samples: u64,
    pub(crate) values: Vec<f64>,
    pub(crate) errors: Vec<Option<f64>>,
    /// 95 % intervals.
    pub(crate) intervals: Vec<mis::Interval>,
}

trait Erased: Send + Sync {
    fn pilot(&self, planner: &Planner, seed: u64) -> Pilot;
    fn run(&self, plan: &Plan, target: Target, seed: u64) -> Outcome;
    fn integrate(&self, planner: &Planner, seed: u64) -> (Outcome, String);
    fn adapt(&self, adaptive: &Adaptive, seed: u64) -> Outcome;
    /// By quadrature between the cuts: ∫ f²/p_k, for each technique, of one component on the line.
    fn squares(&self, cuts: &[f64]) -> Option<Vec<f64>>;
    fn integral_over(&self, cuts: &[f64], of: &dyn Fn(f64, &[f64]) -> f64) -> Option<f64>;
}

impl Problem {
    pub(crate) fn pilot(&self, planner: &Planner, seed: u64) -> Pilot {
        self.inner.pilot(planner, seed)
    }

    pub(crate) fn between(self, cuts: &[f64]) -> Self {
        Self { cuts: cuts.to_vec(), ..self }
    }

    /// The exact variance of a sample of each technique alone; infinite ones are large.
    pub(crate) fn variances(&self) -> Option<Vec<f64>> {
        let mu = self.integral.as_ref()?.first()?;
        let squares = self.inner.squares(&self.cuts)?;
        Some(squares.into_iter().map(|square| square - mu * mu).collect())
    }

    /// A run of a plan on one thread.
    pub(crate) fn run(&self, plan: &Plan, target: Target, seed: u64) -> Outcome {
        self.inner.run(plan, target, seed)
    }

    /// `integrate`, and what it prints.
    pub(crate) fn integrate(&self, planner: &Planner, seed: u64) -> (Outcome, String) {
        self.inner.integrate(planner, seed)
    }

    pub(crate) fn adapt(&self, adaptive: &Adaptive, seed: u64) -> Outcome {
        self.inner.adapt(adaptive, seed)
    }

    /// Costs of the kind: all parts the same, or one of the three dominates.
    pub(crate) fn costs(&self, kind: Kind) -> Costs {
        let k = self.techniques;
        let each = |cost: f64| vec![cost; k];
        let (sampling, pdf, f) = match kind {
            Kind::Equal => (each(1.0), each(1.0), 1.0),
            Kind::Pdf => (each(1.0), each(10.0), 1.0),
            Kind::Integrand => (each(1.0), each(1.0), 1000.0),
            // From 1 to 100.
            Kind::Ratios => {
                let ratio = |i: usize| 100_f64.powf(i as f64 / (k.max(2) - 1) as f64);
                ((0..k).map(ratio).collect(), each(0.1), 0.1)
            }
        };
        Costs::declared(sampling, pdf, f, 1.0).unwrap()
    }
}

/// What costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Equal,
    Pdf,
    Integrand,
    Ratios,
}

pub(crate) const KINDS: [Kind; 4] = [Kind::Equal, Kind::Pdf, Kind::Integrand, Kind::Ratios];

pub(crate) type Techniques<P> = Vec<&'static dyn Technique<Point = P>>;

struct Case<P: 'static, V> {
    techniques: Techniques<P>,
    f: Box<dyn Fn(&P) -> V + Send + Sync>,
}

impl<P: 'static, V> Case<P, V> {
    fn list(&self) -> Vec<&'static dyn Technique<Point = P>> {
        self.techniques.clone()
    }
}

impl<P: Debug + 'static, V: Components + 'static> Erased for Case<P, V> {
    fn pilot(&self, planner: &Planner, seed: u64) -> Pilot {
        planner.pilot(&self.f, &self.list(), seed).unwrap()
    }

    fn run(&self, plan: &Plan, target: Target, seed: u64) -> Outcome {
        let run = Run::new(target).threads(1).unwrap();
        let list = self.list();
        outcome(&run.execute(&plan.estimator(&list).unwrap(), &self.f, seed).unwrap())
    }

    fn integrate(&self, planner: &Planner, seed: u64) -> (Outcome, String) {
        let integral = planner.integrate(&self.f, &self.list(), seed).unwrap();
        (outcome(integral.report()), integral.to_string())
    }

    fn adapt(&self, adaptive: &Adaptive, seed: u64) -> Outcome {
        let adaptive = adaptive.clone().threads(1).unwrap();
        let adapted = adaptive.execute(&self.f, &self.list(), seed).unwrap();
        let interval = adapted.estimate().interval(0.95).unwrap();
        Outcome {
            sound: matches!(adapted.status(), Some(Status::Converged | Status::BudgetSpent)),
            samples: adapted.estimate().samples(),
            values: V::list(adapted.value()),
            errors: V::list(adapted.standard_error()),
            intervals: V::list(interval),
        }
    }

    fn squares(&self, cuts: &[f64]) -> Option<Vec<f64>> {
        let one = |k: usize| {
            self.integral_over(cuts, &|f, ln| {
                if f == 0.0 { 0.0 } else { (2.0 * f.abs().ln() - ln[k]).exp() }
            })
        };
        (0..self.techniques.len()).map(one).collect()
    }

    fn integral_over(&self, cuts: &[f64], g: &dyn Fn(f64, &[f64]) -> f64) -> Option<f64> {
        let this: &dyn Any = self;
        let case = this.downcast_ref::<Case<f64, f64>>()?;
        if cuts.len() < 2 {
            return None;
        }
        let at = |(x, width): (f64, f64)| {
            let ln: Vec<f64> = case.techniques.iter().map(|t| t.ln_pdf(&x)).collect();
            width * g((case.f)(&x), &ln)
        };
        Some(cuts.windows(2).flat_map(|ends| nodes(ends[0], ends[1])).map(at).sum())
    }
}

/// Nodes and weights of the double-exponential rule on \[a, b\].
fn nodes(a: f64, b: f64) -> impl Iterator<Item = (f64, f64)> {
    const STEP: f64 = 1.0 / 64.0;
    (-230..=230).map(move |k| {
        let t = STEP * f64::from(k);
        let q = (-PI * t.sinh().abs()).exp();
        let distance = (b - a) * q / (1.0 + q);
        let x = if t < 0.0 { a + distance } else { b - distance };
        (x, STEP * (b - a) * PI * t.cosh() * q / ((1.0 + q) * (1.0 + q)))
    })
}

fn outcome<V: Components>(report: &Report<V>) -> Outcome {
    Outcome {
        sound: matches!(report.status(), Status::Converged | Status::BudgetSpent),
        samples: report.samples(),
        values: V::list(report.value()),
        errors: V::list(report.standard_error()),
        intervals: V::list(report.estimate().interval(0.95).unwrap()),
    }
}

/// A value whose components can be listed.
pub(crate) trait Components: Value {
    fn list<U>(each: Self::Each<U>) -> Vec<U>;
}

impl Components for f64 {
    fn list<U>(each: U) -> Vec<U> {
        vec![each]
    }
}

impl<const K: usize> Components for [f64; K] {
    fn list<U>(each: [U; K]) -> Vec<U> {
        each.into()
    }
}

pub(crate) fn problem<P: Debug + 'static, V: Components + 'static>(
    name: &'static str,
    techniques: Techniques<P>,
    integral: Option<Vec<f64>>,
    f: impl Fn(&P) -> V + Send + Sync + 'static,
) -> Problem {
    let count = techniques.len();
    let inner = Box::new(Case { techniques, f: Box::new(f) });
    Problem { name, techniques: count, integral, cuts: Vec::new(), inner }
}

pub(crate) fn one<P>(
    technique: impl Technique<Point = P> + 'static,
) -> &'static dyn Technique<Point = P> {
    // As long as the tests: problems are passed between threads, and a boxed technique may not be.
    Box::leak(Box::new(technique))
}
