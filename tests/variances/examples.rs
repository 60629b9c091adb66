//! The examples: integrand, integral, techniques.

use std::f64::consts::{FRAC_PI_2, PI};

use mis::Technique;
use mis::technique::{FnTechnique, Linear, Normal, NumericInverse, PowerLaw, Uniform};

use crate::example::{Example, Technique1};

pub(crate) fn boxed(technique: impl Technique<Point = f64> + 'static) -> Technique1 {
    Box::new(technique)
}

pub(crate) fn sine_cosine() -> Example {
    let quarter = [0.0, FRAC_PI_2];
    let cosine = FnTechnique::new(quarter, f64::cos, f64::sin, f64::asin).unwrap();
    let cdf = |x: f64| 2.0 * (0.5 * x).sin().powi(2);
    let sine = FnTechnique::new(quarter, f64::sin, cdf, |u| 2.0 * (0.5 * u).sqrt().asin()).unwrap();
    Example {
        name: "sin cos",
        f: |x| x.sin() * x.cos(),
        mean: 0.5,
        domain: quarter,
        techniques: vec![boxed(cosine), boxed(sine), boxed(Uniform::new(0.0, FRAC_PI_2).unwrap())],
    }
}

/// x^(-1/2): the variance of uniform samples is infinite, the other technique is exact.
pub(crate) fn root() -> Example {
    Example {
        name: "x^(-1/2)",
        f: |x| x.sqrt().recip(),
        mean: 2.0,
        domain: [0.0, 1.0],
        techniques: vec![boxed(Uniform::unit()), boxed(PowerLaw::new(-0.5, 0.0, 1.0).unwrap())],
    }
}

/// The standard normal density from one half as wide, of infinite variance, and one twice as wide.
pub(crate) fn normal() -> Example {
    Example {
        name: "normal",
        f: |x| (-0.5 * x * x).exp() / (2.0 * PI).sqrt(),
        mean: 1.0,
        domain: [-12.0, 12.0],
        techniques: vec![
            boxed(Normal::new(0.0, 0.5).unwrap()),
            boxed(Normal::new(0.0, 2.0).unwrap()),
        ],
    }
}

/// √x + sin x.
pub(crate) fn example_a() -> Example {
    let [a, b] = [0.01, FRAC_PI_2];
    let mass = |x: f64| 0.5 * x - 0.25 * (2.0 * x).sin();
    let norm = mass(b) - mass(a);
    let squared = NumericInverse::new(
        [a, b],
        move |x| x.sin().powi(2) / norm,
        move |x| (mass(x) - mass(a)) / norm,
    );
    Example {
        name: "A",
        f: |x| x.sqrt() + x.sin(),
        mean: 2.0 / 3.0 * (b.powf(1.5) - a.powf(1.5)) + a.cos() - b.cos(),
        domain: [a, b],
        techniques: vec![
            boxed(Linear::new(a, b, 2.0 - a, 2.0 - b).unwrap()),
            boxed(squared.unwrap()),
        ],
    }
}

/// The ends of examples D and E.
pub(crate) const ENDS: [f64; 2] = [1.5 / PI, PI];

pub(crate) fn three_terms(name: &'static str, f: fn(f64) -> f64, slope: f64) -> Example {
    let [a, b] = ENDS;
    let parabola = |x: f64| x.powi(3) / 3.0 - x * x / (2.0 * PI);
    let norm = parabola(b) - parabola(a);
    let pdf = move |x: f64| x * (x - 1.0 / PI) / norm;
    let parabolic = NumericInverse::new(ENDS, pdf, move |x| (parabola(x) - parabola(a)) / norm);
    // 1 + cos x = 2 cos²(x/2), without cancellation at π.
    let mass = 2.0 * (0.5 * a).cos().powi(2);
    let sine = FnTechnique::new(
        ENDS,
        move |x| x.sin() / mass,
        move |x| 1.0 - 2.0 * (0.5 * x).cos().powi(2) / mass,
        move |u| 2.0 * (0.5 * (1.0 - u) * mass).sqrt().acos(),
    );
    Example {
        name,
        f,
        mean: 0.5 * slope * (b * b - a * a) + norm + mass,
        domain: ENDS,
        techniques: vec![
            boxed(Linear::new(a, b, a, b).unwrap()),
            boxed(parabolic.unwrap()),
            boxed(sine.unwrap()),
        ],
    }
}

pub(crate) fn example_d() -> Example {
    three_terms("D", |x| x + x * (x - 1.0 / PI) + x.sin(), 1.0)
}

/// As D, with one technique that is nearly exact.
pub(crate) fn example_e() -> Example {
    three_terms("E", |x| 30.0 * x + x * (x - 1.0 / PI) + x.sin(), 30.0)
}
