//! Integrands of every kind, with techniques that suit them more or less.

use std::f64::consts::{E, PI};
use std::fmt::Debug;

use mis::technique::{Linear, Normal, PiecewiseConstant, PowerLaw, Product, Uniform, UniformBox};
use mis::{Estimate, Estimator, Fit, MultiSample, OptimalMis, Technique};

use crate::example::Example;
use crate::examples;

/// An integral, and its estimates from any number of samples.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) integral: f64,
    /// K.
    pub(crate) techniques: u64,
    /// Whether its error can be measured: something is left, and not by rare samples only.
    pub(crate) calibrated: bool,
    run: Box<dyn Fn(Option<Fit>, u64, u64) -> Found + Sync>,
}

/// An estimate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    pub(crate) value: f64,
    pub(crate) variance: Option<f64>,
    /// Whether the 95 % interval holds the integral.
    pub(crate) holds: bool,
    pub(crate) kappa: Option<f64>,
    #[allow(dead_code)] // the bench reads it
    pub(crate) uncontrolled: u64,
}

impl Case {
    /// With `samples` of all techniques together; `None` is the balance heuristic.
    pub(crate) fn run(&self, fit: Option<Fit>, samples: u64, seed: u64) -> Found {
        (self.run)(fit, samples, seed)
    }
}

type Boxed<P> = Box<dyn Technique<Point = P>>;

/// `parts` are what the numbers of samples are proportional to.
fn case<P: Debug + 'static>(
    name: &'static str,
    integral: f64,
    techniques: Vec<Boxed<P>>,
    parts: &'static [u64],
    f: impl Fn(&P) -> f64 + Sync + 'static,
) -> Case {
    let all: u64 = parts.iter().sum();
    let k = techniques.len() as u64;
    assert_eq!(parts.len(), techniques.len());
    let found = move |estimate: &Estimate, uncontrolled| Found {
        value: estimate.value(),
        variance: estimate.variance(),
        holds: estimate.interval(0.95).unwrap().contains(integral),
        kappa: estimate.kappa(),
        uncontrolled,
    };
    let run = move |fit: Option<Fit>, samples: u64, seed| {
        let list: Vec<(&dyn Technique<Point = P>, u64)> =
            techniques.iter().zip(parts).map(|(t, part)| (&**t, part * samples / all)).collect();
        if let Some(fit) = fit {
            let mis = OptimalMis::new(&list).unwrap().fit(fit).unwrap();
            let estimate = mis.estimate(&f, seed).unwrap();
            found(estimate.estimate(), estimate.uncontrolled())
        } else {
            found(&MultiSample::new(&list).unwrap().estimate(&f, seed).unwrap(), 0)
        }
    };
    let odd = ["D", "E", "x^(-1/2)", "rare indicator", "heavy tail", "hidden peak"];
    let powers = name.starts_with("powers") && k > 3;
    let calibrated = !(odd.contains(&name) || powers || parts.iter().any(|part| *part != 1));
    Case { name, integral, techniques: k, calibrated, run: Box::new(run) }
}

fn boxed<P>(technique: impl Technique<Point = P> + 'static) -> Boxed<P> {
    Box::new(technique)
}

fn ramp(at_0: f64, at_1: f64) -> Boxed<f64> {
    boxed(Linear::new(0.0, 1.0, at_0, at_1).unwrap())
}

fn uniform(a: f64, b: f64) -> Boxed<f64> {
    boxed(Uniform::new(a, b).unwrap())
}

fn normal(mean: f64, sd: f64) -> Boxed<f64> {
    boxed(Normal::new(mean, sd).unwrap())
}

fn bell(x: f64, mean: f64, sd: f64) -> f64 {
    (-0.5 * ((x - mean) / sd).powi(2)).exp() / (sd * (2.0 * PI).sqrt())
}

const ALIKE: [&[u64]; 9] = [
    &[],
    &[1],
    &[1, 1],
    &[1, 1, 1],
    &[1, 1, 1, 1],
    &[1, 1, 1, 1, 1],
    &[1, 1, 1, 1, 1, 1],
    &[1, 1, 1, 1, 1, 1, 1],
    &[1, 1, 1, 1, 1, 1, 1, 1],
];

fn example(example: Example, parts: &'static [u64]) -> Case {
    let techniques: Vec<_> = example.techniques.into_iter().take(parts.len()).collect();
    let f = example.f;
    case(example.name, example.mean, techniques, parts, move |x: &f64| f(*x))
}

/// A: √x + sin x, from linear and sin².
pub(crate) fn example_a() -> Case {
    example(examples::example_a(), ALIKE[2])
}

/// 1 on a tenth of the interval, where one of two techniques hardly goes.
pub(crate) fn indicator() -> Case {
    let f = |x: &f64| f64::from(u8::from(*x < 0.1));
    case("indicator of a tenth", 0.1, vec![uniform(0.0, 1.0), ramp(0.0, 2.0)], ALIKE[2], f)
}

/// A few samples of a skewed contribution: a peak on which one of the techniques is.
fn skewed() -> Case {
    let peak = PiecewiseConstant::new(&[0.0, 0.05, 1.0], &[1.0, 1.0]).unwrap();
    let integral = 1.0 / 3.0 + 0.02 * (1.0 - (-50.0_f64).exp());
    let f = |x: &f64| x * x + (-50.0 * x).exp();
    case("skewed", integral, vec![uniform(0.0, 1.0), boxed(peak)], ALIKE[2], f)
}

/// Some of every kind, for builds that are not optimised.
pub(crate) fn few() -> Vec<Case> {
    let few = ["sin cos", "A", "lognormal", "sign-changing", "powers, K = 3", "five dimensions"];
    all().into_iter().filter(|case| few.contains(&case.name)).collect()
}

#[allow(clippy::too_many_lines)] // a table
pub(crate) fn all() -> Vec<Case> {
    let mut all = vec![
        example(examples::sine_cosine(), ALIKE[2]),
        example_a(),
        example(examples::example_a(), &[9, 1]),
        example(examples::example_d(), ALIKE[3]),
        example(examples::example_e(), ALIKE[3]),
        example(examples::root(), ALIKE[2]),
        example(examples::normal(), ALIKE[2]),
        skewed(),
        // Indicators: in a tenth and a hundredth of the interval.
        indicator(),
        case(
            "rare indicator",
            0.01,
            vec![uniform(0.0, 1.0), ramp(0.0, 2.0)],
            ALIKE[2],
            |x: &f64| f64::from(u8::from(*x < 0.01)),
        ),
        case(
            "indicator and what suits it",
            0.01,
            vec![uniform(0.0, 1.0), uniform(0.0, 0.02)],
            ALIKE[2],
            |x: &f64| f64::from(u8::from(*x < 0.01)),
        ),
        // A narrow peak that no technique knows of; half of the samples on a ramp.
        case("hidden peak", 1.0, vec![uniform(0.0, 1.0), ramp(2.0, 0.0)], ALIKE[2], |x: &f64| {
            bell(*x, 0.3, 0.01)
        }),
        case(
            "three peaks",
            1.0 + 0.5 + 0.1 + 0.2,
            vec![uniform(0.0, 1.0), normal(0.3, 0.012), normal(0.7, 0.008), normal(0.5, 0.03)],
            ALIKE[4],
            |x: &f64| {
                let inside = f64::from(u8::from((0.0..=1.0).contains(x)));
                bell(*x, 0.3, 0.01)
                    + 0.5 * bell(*x, 0.7, 0.01)
                    + 0.1 * bell(*x, 0.5, 0.02)
                    + 0.2 * inside
            },
        ),
        case(
            "heavy tail",
            1.0 / 0.6,
            vec![uniform(0.0, 1.0), ramp(2.0, 0.0)],
            ALIKE[2],
            |x: &f64| x.powf(-0.4),
        ),
        case(
            "lognormal",
            0.5_f64.exp(),
            vec![normal(0.0, 1.0), normal(0.5, 2.0)],
            ALIKE[2],
            |x: &f64| bell(*x, 0.0, 1.0) * x.exp(),
        ),
        case(
            "sign-changing",
            0.1,
            vec![uniform(0.0, 1.0), ramp(0.0, 2.0), ramp(2.0, 0.0)],
            ALIKE[3],
            |x: &f64| (2.0 * PI * x).sin() + 0.1,
        ),
        case(
            "a hundredth of the samples",
            E - 1.0,
            vec![uniform(0.0, 1.0), ramp(0.0, 2.0)],
            &[99, 1],
            |x: &f64| x.exp(),
        ),
    ];
    for (k, name) in
        [(2, "powers, K = 2"), (3, "powers, K = 3"), (5, "powers, K = 5"), (8, "powers, K = 8")]
    {
        let powers = (0..k).map(|m| boxed(PowerLaw::new(m as f64, 0.0, 1.0).unwrap()));
        all.push(case(name, E - 1.0, powers.collect(), ALIKE[k], |x: &f64| x.exp()));
    }
    let bumps = (0..8).map(|m| normal(f64::from(m), 0.3));
    let far = |x: &f64| (0..8).map(|m| f64::from(m + 1) * bell(*x, f64::from(m), 0.25)).sum();
    all.push(case("eight peaks", 36.0, bumps.collect(), ALIKE[8], far));
    let bumps = (0..8).map(|m| normal(f64::from(m), 0.6));
    let one = |x: &f64| bell(*x, 3.3, 0.5);
    all.push(case("one peak of eight", 1.0, bumps.collect(), ALIKE[8], one));
    let cube = || boxed(UniformBox::uniform([0.0; 5], [1.0; 5]).unwrap());
    let sloped = |a, b| boxed(Product::new([Linear::new(0.0, 1.0, a, b).unwrap(); 5]).unwrap());
    let product = |x: &[f64; 5]| x.iter().map(|x| x.exp()).product::<f64>();
    all.push(case(
        "five dimensions",
        (E - 1.0).powi(5),
        vec![cube(), sloped(0.5, 1.5), sloped(0.0, 2.0)],
        ALIKE[3],
        product,
    ));
    let peak = |x: &[f64; 5]| x.iter().map(|x| bell(*x, 0.5, 0.1)).product::<f64>();
    let around = Product::new([Normal::new(0.5, 0.15).unwrap(); 5]).unwrap();
    all.push(case(
        "peak in five dimensions",
        1.0,
        vec![cube(), boxed(around), sloped(1.0, 2.0)],
        ALIKE[3],
        peak,
    ));
    all
}
