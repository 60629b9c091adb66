//! Integrands with techniques, from easy to hopeless, of which plans are made.

use std::f64::consts::{E, FRAC_PI_2, PI};

use mis::technique::{
    Cauchy, Exponential, FnTechnique, Linear, Mixture, Normal, NumericInverse, PowerLaw, Product,
    TruncatedNormal, Uniform, UniformBox,
};
use mis::{InverseCdf, Technique};

use crate::problems::{Problem, Techniques, one, problem};

fn uniform(a: f64, b: f64) -> &'static dyn Technique<Point = f64> {
    one(Uniform::new(a, b).unwrap())
}

pub(crate) fn quarter() -> Techniques<f64> {
    let quarter = [0.0, FRAC_PI_2];
    let cosine = FnTechnique::new(quarter, f64::cos, f64::sin, f64::asin).unwrap();
    let cdf = |x: f64| 2.0 * (0.5 * x).sin().powi(2);
    let sine = FnTechnique::new(quarter, f64::sin, cdf, |u| 2.0 * (0.5 * u).sqrt().asin()).unwrap();
    vec![one(cosine), one(sine)]
}

/// The techniques of family A: 2 - x and sin² x on [0.01, π/2].
pub(crate) fn family_a() -> Techniques<f64> {
    let [a, b] = [0.01, FRAC_PI_2];
    let mass = |x: f64| 0.5 * x - 0.25 * (2.0 * x).sin();
    let norm = mass(b) - mass(a);
    let squared = NumericInverse::new(
        [a, b],
        move |x| x.sin().powi(2) / norm,
        move |x| (mass(x) - mass(a)) / norm,
    );
    vec![one(Linear::new(a, b, 2.0 - a, 2.0 - b).unwrap()), one(squared.unwrap())]
}

/// Those of D and E: x, x² - x/π and sin x on [3/(2π), π].
pub(crate) fn family_d() -> Techniques<f64> {
    let [a, b] = DOMAIN_D;
    let mass = |x: f64| x.powi(3) / 3.0 - x * x / (2.0 * PI);
    let norm = mass(b) - mass(a);
    let parabola = NumericInverse::new(
        [a, b],
        move |x| (x * x - x / PI) / norm,
        move |x| (mass(x) - mass(a)) / norm,
    );
    // 1 + cos x = 2 cos²(x/2), without cancellation at π.
    let whole = 2.0 * (0.5 * a).cos().powi(2);
    let sine = FnTechnique::new(
        DOMAIN_D,
        move |x| x.sin() / whole,
        move |x| 1.0 - 2.0 * (0.5 * x).cos().powi(2) / whole,
        move |u| 2.0 * (0.5 * (1.0 - u) * whole).sqrt().acos(),
    );
    vec![one(Linear::new(a, b, a, b).unwrap()), one(parabola.unwrap()), one(sine.unwrap())]
}

pub(crate) const DOMAIN_D: [f64; 2] = [1.5 / PI, PI];

pub(crate) fn f_a(x: f64) -> f64 {
    x.sqrt() + x.sin()
}

/// D with 1, E with 30.
pub(crate) fn f_d(x: f64, first: f64) -> f64 {
    first * x + (x * x - x / PI) + x.sin()
}

fn bell(x: f64, at: f64, width: f64) -> f64 {
    (-0.5 * ((x - at) / width).powi(2)).exp() / (width * (2.0 * PI).sqrt())
}

/// Peaks of a unit mass on the line, each with a technique of another width.
fn peaks(name: &'static str, off: f64, peaks: &'static [(f64, f64)]) -> Problem {
    let techniques = peaks.iter().map(|(at, w)| one(Normal::new(*at, off * w).unwrap())).collect();
    let f = |x: &f64| peaks.iter().map(|(at, w)| bell(*x, *at, *w)).sum::<f64>();
    problem(name, techniques, Some(vec![peaks.len() as f64]), f)
}

/// Π e^(-3 x_d) (1 + x_d) over the unit cube, uniform and exponential.
fn product<const D: usize>(name: &'static str) -> Problem {
    let side = (1.0 - (-3_f64).exp()) / 3.0 + (1.0 - 4.0 * (-3_f64).exp()) / 9.0;
    let f = |x: &[f64; D]| {
        (-3.0 * x.iter().sum::<f64>()).exp() * x.iter().map(|x| 1.0 + x).product::<f64>()
    };
    let cube = one(UniformBox::uniform([0.0; D], [1.0; D]).unwrap());
    let decay = one(Product::new([Exponential::new(3.0, 0.0, 1.0).unwrap(); D]).unwrap());
    problem(name, vec![cube, decay], Some(vec![side.powi(D.try_into().unwrap())]), f)
}

/// A normal peak in the middle of the unit cube, uniform and a product of wider peaks.
fn cube_peak<const D: usize>(name: &'static str, width: f64) -> Problem {
    let side = |w: f64| libm::erf(0.5 / (w * 2_f64.sqrt()));
    let f = move |x: &[f64; D]| x.iter().map(|x| bell(*x, 0.5, width)).product::<f64>();
    let cube = one(UniformBox::uniform([0.0; D], [1.0; D]).unwrap());
    let wide = TruncatedNormal::new(0.5, 1.3 * width, 0.0, 1.0).unwrap();
    let wide = one(Product::new([wide; D]).unwrap());
    problem(name, vec![cube, wide], Some(vec![side(width).powi(D.try_into().unwrap())]), f)
}

fn many(name: &'static str, k: usize) -> Problem {
    // A ripple on a slope, and a technique for each part of the interval.
    let width = 1.0 / k as f64;
    let technique =
        |i: usize| one(TruncatedNormal::new((i as f64 + 0.5) * width, width, 0.0, 1.0).unwrap());
    let f = |x: &f64| (2.0 * x).exp() * (1.2 + (11.0 * x).sin());
    let i = |w: f64, a: f64| {
        // ∫ e^(2x) sin(ax)
        let at = |x: f64| (2.0 * x).exp() * (2.0 * (a * x).sin() - a * (a * x).cos());
        w * (at(1.0) - at(0.0)) / (4.0 + a * a)
    };
    let integral = 0.6 * (E * E - 1.0) + i(1.0, 11.0);
    problem(name, (0..k).map(technique).collect(), Some(vec![integral]), f)
}

fn on_unit(
    name: &'static str,
    techniques: Techniques<f64>,
    integral: f64,
    f: impl Fn(f64) -> f64 + Send + Sync + 'static,
) -> Problem {
    problem(name, techniques, Some(vec![integral]), move |x: &f64| f(*x))
}

fn linear(a: f64, b: f64) -> &'static dyn Technique<Point = f64> {
    one(Linear::new(0.0, 1.0, a, b).unwrap())
}

/// Where what is smooth begins and ends.
const CUTS: &[(&str, &[f64])] = &[
    ("sin·cos", &[0.0, FRAC_PI_2]),
    ("sin·cos and uniform", &[0.0, FRAC_PI_2]),
    ("family A", &[0.01, FRAC_PI_2]),
    ("family D", &DOMAIN_D),
    ("family E", &DOMAIN_D),
    ("normal, too narrow and wide", &[-30.0, 0.0, 30.0]),
    ("two peaks, wide", &[-5.0, 0.0, 0.5, 1.0, 5.0]),
    ("three peaks, narrow", &[-25.0, 0.0, 3.0, 5.0, 25.0]),
    ("four peaks, wide", &[-10.0, 0.0, 0.5, 1.0, 1.2, 2.0, 3.0, 15.0]),
    ("indicator", &[0.0, 0.3]),
    ("rare indicator", &[0.0, 0.02]),
    ("defensive mixture", &[-20.0, 0.0, 0.3, 20.0]),
    ("eight", &[0.0, 0.5, 1.0]),
    ("sixteen", &[0.0, 0.5, 1.0]),
    ("changes sign", &[0.0, 0.5, 1.0]),
    ("nearly nothing", &[0.0, 1.0]),
    ("nearly duplicate", &[0.0, 1.0]),
    ("duplicates", &[0.0, 1.0]),
    ("e^(-5x)/(1+x)", &[0.0, 2.0]),
    ("-ln x", &[0.0, 1.0]),
    ("Cauchy tails", &[-1e3, -5.0, 0.0, 5.0, 1e3]),
    ("in the span", &[0.0, 1.0]),
    ("one technique", &[0.0, 1.0]),
];

/// All of them.
#[allow(clippy::too_many_lines)] // a table
pub(crate) fn problems() -> Vec<Problem> {
    let sin_cos = |x: f64| x.sin() * x.cos();
    let with_third = || {
        let mut list = quarter();
        list.push(uniform(0.0, FRAC_PI_2));
        list
    };
    let defensive = || {
        let narrow: Box<dyn InverseCdf + Send> = Box::new(Normal::new(0.0, 0.7).unwrap());
        let wide: Box<dyn InverseCdf + Send> = Box::new(Normal::new(0.0, 3.0).unwrap());
        one(Mixture::new(vec![(narrow, 0.8), (wide, 0.2)]).unwrap())
    };
    let all = vec![
        on_unit("sin·cos", quarter(), 0.5, sin_cos),
        on_unit("sin·cos and uniform", with_third(), 0.5, sin_cos),
        on_unit("family A", family_a(), 2.311_750_83, f_a),
        on_unit("family D", family_d(), 15.473_607_86, |x| f_d(x, 1.0)),
        on_unit("family E", family_d(), 155.277_268_06, |x| f_d(x, 30.0)),
        on_unit(
            "1/√x",
            vec![uniform(0.0, 1.0), one(PowerLaw::new(-0.5, 0.0, 1.0).unwrap())],
            2.0,
            |x| x.sqrt().recip(),
        ),
        on_unit(
            "normal, too narrow and wide",
            vec![one(Normal::new(0.0, 0.5).unwrap()), one(Normal::new(0.0, 2.0).unwrap())],
            1.0,
            |x| bell(x, 0.0, 1.0),
        ),
        peaks("two peaks, wide", 1.4, &[(0.0, 0.1), (1.0, 0.05)]),
        peaks("three peaks, narrow", 0.8, &[(0.0, 1.0), (3.0, 1.0), (5.0, 0.5)]),
        peaks("four peaks, wide", 2.0, &[(0.0, 0.1), (1.0, 0.05), (1.2, 0.2), (3.0, 0.5)]),
        product::<2>("product in 2-D"),
        product::<5>("product in 5-D"),
        product::<8>("product in 8-D"),
        cube_peak::<3>("peak in 3-D", 0.15),
        cube_peak::<8>("peak in 8-D", 0.3),
        on_unit("indicator", vec![uniform(0.0, 1.0), linear(2.0, 0.0)], 0.3, |x| {
            f64::from(x < 0.3)
        }),
        on_unit(
            "rare indicator",
            vec![uniform(0.0, 1.0), linear(2.0, 0.0), linear(1.0, 1.5)],
            0.02,
            |x| f64::from(x < 0.02),
        ),
        on_unit(
            "disjoint supports",
            vec![uniform(0.0, 1.0), uniform(1.0, 2.0)],
            E * E - 1.0,
            f64::exp,
        ),
        on_unit(
            "alone in a region",
            vec![uniform(0.0, 1.0), linear(2.0, 0.0), uniform(0.9, 1.2)],
            1.2,
            |_| 1.0,
        ),
        on_unit("rarely alone", vec![uniform(0.0, 1.0), uniform(0.0, 1.01)], 1.01 * 0.505, |x| x),
        on_unit(
            "defensive mixture",
            vec![defensive(), one(Normal::new(0.5, 1.0).unwrap())],
            1.0,
            |x| bell(x, 0.3, 0.9),
        ),
        many("eight", 8),
        many("sixteen", 16),
        on_unit(
            "changes sign",
            vec![uniform(0.0, 1.0), linear(0.5, 1.5)],
            (1.0 - (7_f64).cos()) / 7.0,
            |x| (7.0 * x).sin(),
        ),
        on_unit("nearly nothing", vec![uniform(0.0, 1.0), linear(0.0, 2.0)], 0.01, |x| x - 0.49),
        problem(
            "vector",
            vec![uniform(0.0, 1.0), linear(1.0, 2.0)],
            Some(vec![E - 1.0, 2.0 / 3.0, 0.3]),
            |x: &f64| [x.exp(), x.sqrt(), f64::from(*x < 0.3)],
        ),
        on_unit(
            "nearly duplicate",
            vec![linear(1.0, 2.0), linear(1.0, 2.0 + 1e-7), linear(1.0, 3.0)],
            E - 1.0,
            f64::exp,
        ),
        on_unit("duplicates", vec![linear(1.0, 2.0), linear(1.0, 2.0)], E - 1.0, f64::exp),
        on_unit(
            "e^(-5x)/(1+x)",
            vec![one(Exponential::new(5.0, 0.0, 2.0).unwrap()), uniform(0.0, 2.0)],
            0.170_419_067_5,
            |x| (-5.0 * x).exp() / (1.0 + x),
        ),
        on_unit(
            "-ln x",
            vec![uniform(0.0, 1.0), one(PowerLaw::new(-0.3, 0.0, 1.0).unwrap())],
            1.0,
            |x| -x.ln(),
        ),
        on_unit(
            "Cauchy tails",
            vec![one(Cauchy::new(0.0, 1.0).unwrap()), one(Normal::new(0.0, 1.0).unwrap())],
            FRAC_PI_2,
            |x| (1.0 + x * x).powi(-2),
        ),
        on_unit("rare spike", vec![uniform(0.0, 1.0), linear(0.0, 2.0)], 1.0, |x| {
            if x < 0.1 { 10.0 } else { 0.0 }
        }),
        on_unit(
            "in the span",
            vec![uniform(0.0, 1.0), linear(0.0, 2.0), linear(2.0, 1.0)],
            2.5,
            |x| 1.0 + 3.0 * x,
        ),
        on_unit("one technique", vec![linear(1.0, 2.0)], E - 1.0, f64::exp),
    ];
    let all: Vec<Problem> = all
        .into_iter()
        .map(|p| match CUTS.iter().find(|(name, _)| *name == p.name) {
            Some((_, cuts)) => p.between(cuts),
            None => p,
        })
        .collect();
    #[cfg(feature = "lighting")]
    let all = all.into_iter().chain(crate::lit::problems()).collect();
    all
}
