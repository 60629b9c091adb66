//! Integrands of known integral, from smooth to hopeless, and the estimators that are run on them.

use std::f64::consts::{E, FRAC_PI_2, PI};
use std::fmt::Debug;
use std::sync::Arc;

use mis::points::Sobol;
use mis::technique::{
    Cauchy, Exponential, FnTechnique, Linear, Normal, Product, Uniform, UniformBox,
};
use mis::weighting::{Constant, Power};
use mis::{MultiSample, OneSample, Report, Run, Target, Technique, Value};

/// An estimator of an integrand.
pub(crate) struct Row {
    pub(crate) integrand: &'static str,
    pub(crate) estimator: &'static str,
    /// Name and integral of each component.
    pub(crate) components: Vec<(&'static str, f64)>,
    /// Whether it has what most samples miss, so that no judgement of samples can warn of it.
    pub(crate) hidden: bool,
    /// Whether it is worth samples beyond 10⁴.
    pub(crate) slow: bool,
    /// Whether its error bar comes from replicates.
    pub(crate) replicates: bool,
    run: Box<dyn Fn(Target, u64) -> Outcome + Sync>,
}

/// What one run came to.
pub(crate) struct Outcome {
    pub(crate) verdict: Verdict,
    pub(crate) samples: u64,
    /// Value, standard error and the intervals at [`LEVELS`] of each component.
    pub(crate) components: Vec<(f64, Option<f64>, [mis::Interval; 3])>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    Converged,
    Spent,
    Suspect,
    NoSignal,
}

pub(crate) const LEVELS: [f64; 3] = [0.6827, 0.95, 0.99];

impl Row {
    pub(crate) fn run(&self, target: Target, seed: u64) -> Outcome {
        (self.run)(target, seed)
    }
}

/// Every integrand with its estimators; constant weights where every technique covers.
pub(crate) fn suite() -> Vec<Row> {
    let mut rows = Vec::new();
    rows.extend(on_the_unit_interval("e^x", E - 1.0, f64::exp).rows(&BOTH));
    rows.extend(on_the_unit_interval("-ln x", 1.0, |x| -x.ln()).rows(&BOTH));
    rows.extend(sin_cos().rows(&ALL));
    for (name, p) in [("1 on a tenth", 0.1), ("1 on a hundredth", 0.01)] {
        rows.extend(on_the_unit_interval(name, p, move |x| f64::from(x < p)).rows(&BOTH));
    }
    let rare = |x| f64::from(x < 1e-3);
    rows.extend(on_the_unit_interval("1 on a thousandth", 1e-3, rare).slow().rows(&ALONE));
    rows.extend(lognormal("lognormal, s = 1", 1.0).slow().rows(&BOTH));
    rows.extend(lognormal("lognormal, s = 2", 2.0).slow().rows(&ALONE));
    rows.extend(narrow_peak("peak of width 0.03", [0.03]).rows(&BOTH));
    rows.extend(narrow_peak("peak of width 0.1 in 3-D", [0.1; 3]).rows(&BOTH));
    rows.extend(pareto("Pareto, a = 1.5", 1.5).slow().rows(&BOTH));
    rows.extend(pareto("Pareto, a = 5", 5.0).slow().rows(&BOTH));
    rows.extend(student_t3().rows(&ALONE));
    rows.extend(two_peaks().rows(&ALL));
    rows.extend(product().rows(&ALL));
    rows.extend(vector().rows(&ALL));
    // Where supports do not overlap, all weightings are the same.
    rows.extend(opposite_skews().rows(&[Kind::Balance, Kind::OneSample, Kind::Sobol]));
    rows.extend(hidden_spike().rows(&ALONE));
    rows
}

/// ∫ of `f` over the unit interval, by uniform samples: the contributions are `f`(ξ).
fn on_the_unit_interval(
    name: &'static str,
    integral: f64,
    f: impl Fn(f64) -> f64 + Send + Sync + 'static,
) -> Problem<f64, f64> {
    Problem::new(name, vec![(Box::new(Uniform::unit()), 1)], integral, move |x: &f64| f(*x))
}

/// ∫ sin x cos x over [0, π/2] = 1/2, with a technique for each factor.
fn sin_cos() -> Problem<f64, f64> {
    let support = [0.0, FRAC_PI_2];
    let cosine = FnTechnique::new(support, f64::cos, f64::sin, f64::asin).unwrap();
    let inverse = |u: f64| 2.0 * (0.5 * u).sqrt().asin();
    let sine = FnTechnique::new(support, f64::sin, |x: f64| 1.0 - x.cos(), inverse).unwrap();
    let techniques: Techniques<f64> = vec![(Box::new(cosine), 1), (Box::new(sine), 1)];
    Problem::new("sin x cos x", techniques, 0.5, |x: &f64| x.sin() * x.cos())
}

/// ∫ e^(s z) φ(z) dz = e^(s²/2), z sampled by φ: the contributions are lognormal.
fn lognormal(name: &'static str, s: f64) -> Problem<f64, f64> {
    let f = move |z: &f64| (s * z - 0.5 * z * z).exp() / (2.0 * PI).sqrt();
    let techniques: Techniques<f64> = vec![(Box::new(Normal::standard()), 1)];
    Problem::new(name, techniques, (0.5 * s * s).exp(), f)
}

/// ∫ Π e^(-(x_d - 1/2)² / (2 w_d²)) over the unit cube = Π √(2π) w_d erf(1 / (√8 w_d)).
fn narrow_peak<const D: usize>(name: &'static str, w: [f64; D]) -> Problem<[f64; D], f64> {
    let side = |w: &f64| (2.0 * PI).sqrt() * w * libm::erf(1.0 / (8_f64.sqrt() * w));
    let integral = w.iter().map(side).product();
    let f = move |x: &[f64; D]| {
        let squares = x.iter().zip(&w).map(|(x, w)| ((x - 0.5) / w).powi(2));
        (-0.5 * squares.sum::<f64>()).exp()
    };
    let cube = UniformBox::uniform([0.0; D], [1.0; D]).unwrap();
    Problem::new(name, vec![(Box::new(cube), 1)], integral, f)
}

/// ∫ x^(-1/a) over the unit interval = a / (a - 1): the contributions have the density
/// a / y^(a+1), and moments of order less than a.
fn pareto(name: &'static str, a: f64) -> Problem<f64, f64> {
    on_the_unit_interval(name, a / (a - 1.0), move |x| x.powf(-1.0 / a))
}

/// The mean of 5 + t, t of Student's distribution with 3 degrees of freedom: a normal number over
/// the root of the mean square of three others.
fn student_t3() -> Problem<[f64; 4], f64> {
    let f = |x: &[f64; 4]| {
        let square = x[1] * x[1] + x[2] * x[2] + x[3] * x[3];
        let density = (-0.5 * (x[0] * x[0] + square)).exp() / (4.0 * PI * PI);
        density * (5.0 + x[0] / (square / 3.0).sqrt())
    };
    let normal = Product::new([Normal::standard(); 4]).unwrap();
    Problem::new("5 + Student t, 3 degrees", vec![(Box::new(normal), 1)], 5.0, f)
}

/// ∫ e^(-x² / (2 · 0.1²)) + e^(-(x - 1)² / (2 · 0.05²)) / 2 over the line
/// = √(2π) (0.1 + 0.05 / 2), a wide technique for each peak.
fn two_peaks() -> Problem<f64, f64> {
    let f = |x: &f64| {
        (-0.5 * (x / 0.1).powi(2)).exp() + 0.5 * (-0.5 * ((x - 1.0) / 0.05).powi(2)).exp()
    };
    let wide: Techniques<f64> = vec![
        (Box::new(Cauchy::new(0.0, 0.1).unwrap()), 1),
        (Box::new(Cauchy::new(1.0, 0.05).unwrap()), 1),
    ];
    Problem::new("two peaks", wide, (2.0 * PI).sqrt() * 0.125, f)
}

/// ∫ Π e^(-3 x_d) (1 + x_d) over the unit cube in five dimensions
/// = ((1 - e⁻³) / 3 + (1 - 4 e⁻³) / 9)⁵, by uniform and by exponential samples.
fn product() -> Problem<[f64; 5], f64> {
    let side = (1.0 - (-3_f64).exp()) / 3.0 + (1.0 - 4.0 * (-3_f64).exp()) / 9.0;
    let f = |x: &[f64; 5]| {
        let sum = x.iter().sum::<f64>();
        (-3.0 * sum).exp() * x.iter().map(|x| 1.0 + x).product::<f64>()
    };
    let cube = UniformBox::uniform([0.0; 5], [1.0; 5]).unwrap();
    let decay = Product::new([Exponential::new(3.0, 0.0, 1.0).unwrap(); 5]).unwrap();
    let techniques: Techniques<[f64; 5]> = vec![(Box::new(cube), 1), (Box::new(decay), 1)];
    Problem::new("product in 5-D", techniques, side.powi(5), f)
}

/// Three integrands at once, over the unit interval.
fn vector() -> Problem<f64, [f64; 3]> {
    let up = Linear::new(0.0, 1.0, 1.0, 2.0).unwrap();
    let techniques: Techniques<f64> = vec![(Box::new(Uniform::unit()), 1), (Box::new(up), 2)];
    let f = |x: &f64| [x.exp(), x.sqrt(), f64::from(*x < 0.3)];
    let integrals = [("e^x", E - 1.0), ("√x", 2.0 / 3.0), ("1 up to 0.3", 0.3)];
    Problem::with_components("vector", techniques, integrals.to_vec(), f)
}

/// ∫ -ln x over [0, 1] + ∫ 2 + ln(x - 1) over [1, 2] = 2, a technique for each part, with 1 and 7
/// samples of every 8; one part's contributions are skewed upwards, the other's downwards.
fn opposite_skews() -> Problem<f64, f64> {
    let right = Uniform::new(1.0, 2.0).unwrap();
    let techniques: Techniques<f64> = vec![(Box::new(Uniform::unit()), 1), (Box::new(right), 7)];
    let f = |x: &f64| if *x < 1.0 { -x.ln() } else { 2.0 + (x - 1.0).ln() };
    Problem::new("opposite skews", techniques, 2.0, f)
}

/// ∫ x + a spike of height 10 on a thousandth, over the unit interval = 1/2 + 1/100.
fn hidden_spike() -> Problem<f64, f64> {
    let f = |x: f64| x + if (0.5..0.501).contains(&x) { 10.0 } else { 0.0 };
    Problem { hidden: true, ..on_the_unit_interval("x and a hidden spike", 0.51, f) }
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Alone,
    Balance,
    Power,
    Constant,
    OneSample,
    /// Balance, or the only technique, with Sobol' points.
    Sobol,
}

const ALONE: [Kind; 1] = [Kind::Alone];
const BOTH: [Kind; 2] = [Kind::Alone, Kind::Sobol];
const ALL: [Kind; 5] = [Kind::Balance, Kind::Power, Kind::Constant, Kind::OneSample, Kind::Sobol];

/// Techniques with their shares of the samples.
type Techniques<P> = Vec<(Box<dyn Technique<Point = P> + Send>, u32)>;

struct Problem<P, V> {
    name: &'static str,
    techniques: Techniques<P>,
    f: Box<dyn Fn(&P) -> V + Send + Sync>,
    components: Vec<(&'static str, f64)>,
    hidden: bool,
    slow: bool,
}

impl<P: Debug + 'static> Problem<P, f64> {
    fn new(
        name: &'static str,
        techniques: Techniques<P>,
        integral: f64,
        f: impl Fn(&P) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self::with_components(name, techniques, vec![("", integral)], f)
    }
}

impl<P: Debug + 'static, V: Components + 'static> Problem<P, V> {
    fn with_components(
        name: &'static str,
        techniques: Techniques<P>,
        components: Vec<(&'static str, f64)>,
        f: impl Fn(&P) -> V + Send + Sync + 'static,
    ) -> Self {
        Self { name, techniques, f: Box::new(f), components, hidden: false, slow: false }
    }

    fn slow(self) -> Self {
        Self { slow: true, ..self }
    }

    fn rows(self, kinds: &[Kind]) -> Vec<Row> {
        let problem = Arc::new(self);
        let row = |kind: &Kind| {
            let (kind, problem) = (*kind, Arc::clone(&problem));
            Row {
                integrand: problem.name,
                estimator: match kind {
                    Kind::Alone => "one technique",
                    Kind::Balance => "balance",
                    Kind::Power => "power 2",
                    Kind::Constant => "constant",
                    Kind::OneSample => "one-sample",
                    Kind::Sobol => "Sobol' points",
                },
                components: problem.components.clone(),
                hidden: problem.hidden,
                slow: problem.slow,
                replicates: matches!(kind, Kind::Sobol),
                run: Box::new(move |target, seed| outcome(&problem.report(kind, target, seed))),
            }
        };
        kinds.iter().map(row).collect()
    }

    fn report(&self, kind: Kind, target: Target, seed: u64) -> Report<V> {
        let techniques = || self.techniques.iter().map(|(technique, n)| (&**technique as _, *n));
        let run = Run::new(target).threads(1).unwrap();
        if let Kind::OneSample = kind {
            let all = f64::from(self.techniques.iter().map(|(_, n)| n).sum::<u32>());
            let list: Vec<(&dyn Technique<Point = P>, f64)> =
                techniques().map(|(technique, n)| (technique, f64::from(n) / all)).collect();
            return run.execute(&OneSample::new(&list, 1).unwrap(), &self.f, seed).unwrap();
        }
        let list: Vec<(&dyn Technique<Point = P>, u64)> =
            techniques().map(|(technique, n)| (technique, u64::from(n))).collect();
        let mis = MultiSample::new(&list).unwrap();
        match kind {
            Kind::Sobol => run.execute_from(&mis, &self.f, &Sobol::new(seed)),
            Kind::Power => run.execute(&mis.weighting(Power::squared()).unwrap(), &self.f, seed),
            Kind::Constant => {
                run.execute(&mis.weighting(Constant::equal()).unwrap(), &self.f, seed)
            }
            _ => run.execute(&mis, &self.f, seed),
        }
        .unwrap()
    }
}

fn outcome<V: Components>(report: &Report<V>) -> Outcome {
    use mis::Status;
    let verdict = match report.status() {
        Status::Converged => Verdict::Converged,
        Status::BudgetSpent => Verdict::Spent,
        Status::Suspect(_) => Verdict::Suspect,
        Status::NoSignal { .. } => Verdict::NoSignal,
        other => unreachable!("{other}"),
    };
    let [a, b, c] = LEVELS.map(|level| V::list(report.estimate().interval(level).unwrap()));
    let intervals = a.into_iter().zip(b).zip(c).map(|((a, b), c)| [a, b, c]);
    let values = V::list(report.value()).into_iter().zip(V::list(report.standard_error()));
    let components = values.zip(intervals).map(|((value, error), i)| (value, error, i)).collect();
    Outcome { verdict, samples: report.samples(), components }
}

/// A value whose components can be listed.
trait Components: Value {
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
