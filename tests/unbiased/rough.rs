//! Integrands with singularities, jumps and peaks.

use mis::Technique;
use mis::technique::{
    Affine, Cauchy, InverseCdf, Linear, Mixture, Normal, PiecewiseConstant, PowerLaw, Uniform,
};

use crate::battery::{Battery, Case, Size};

pub(crate) fn rough(size: Size) -> Battery {
    let mut battery = Battery::default();
    let unit = Uniform::unit();
    let down = Linear::new(0.0, 1.0, 2.0, 1.0).unwrap();
    let singular = PowerLaw::new(-0.5, 0.0, 1.0).unwrap();
    battery.check(
        size,
        &Case {
            name: "x^(-1/2)",
            f: |x: &f64| x.sqrt().recip(),
            integral: &[2.0],
            techniques: &[&unit, &singular, &down],
            covered: false,
            spread: 2.0,
        },
    );
    let weaker = PowerLaw::new(-0.3, 0.0, 1.0).unwrap();
    battery.check(
        size,
        &Case {
            name: "logarithm",
            f: |x: &f64| -x.ln(),
            integral: &[1.0],
            techniques: &[&unit, &weaker],
            covered: true,
            spread: 2.0,
        },
    );
    compensated(size, &mut battery);
    let halves = PiecewiseConstant::new(&[0.0, 0.5, 1.0], &[1.0, 2.0]).unwrap();
    let part = Uniform::new(0.4, 0.7).unwrap();
    battery.check(
        size,
        &Case {
            name: "steps",
            f: |x: &f64| match x {
                0.2..0.5 => 1.0,
                0.5..0.6 => 3.0,
                _ => 0.0,
            },
            integral: &[0.6],
            techniques: &[&unit, &halves, &part],
            covered: false,
            spread: 3.0,
        },
    );
    let (left, right) = (Uniform::unit(), Uniform::new(1.0, 2.0).unwrap());
    let middle = Uniform::new(0.5, 1.5).unwrap();
    battery.check(
        size,
        &Case {
            name: "supports that share x",
            f: |x: &f64| *x,
            integral: &[2.0],
            techniques: &[&left, &right, &middle],
            covered: false,
            spread: 3.0,
        },
    );
    let around = Uniform::new(-1.0, 8.0).unwrap();
    let negative = Affine::new(PowerLaw::new(0.5, 0.0, 1.0).unwrap(), 0.0, -1.0).unwrap();
    let positive = Affine::new(PowerLaw::new(0.5, 0.0, 8.0).unwrap(), 0.0, 1.0).unwrap();
    let boxed: [(Box<dyn InverseCdf>, f64); 2] =
        [(Box::new(negative), 0.25), (Box::new(positive), 0.75)];
    let sides = Mixture::new(Vec::from(boxed)).unwrap();
    let edges: Vec<f64> = (-4..=32).map(|k| 0.25 * f64::from(k)).collect();
    let table: Vec<f64> = edges.windows(2).map(|e| (0.5 * (e[0] + e[1])).abs().cbrt()).collect();
    let tabulated = PiecewiseConstant::new(&edges, &table).unwrap();
    battery.check(
        size,
        &Case {
            name: "cube root",
            f: |x: &f64| x.abs().cbrt(),
            integral: &[0.75 * 17.0],
            techniques: &[&around, &sides, &tabulated],
            covered: true,
            spread: 3.0,
        },
    );
    let peak = |at: f64, width: f64| Normal::new(at, width).unwrap();
    let peaks = [(0.2, 0.01, 1.0), (0.5, 0.02, 2.0), (0.9, 0.005, 0.5)];
    let [p, q, r] = peaks.map(|(at, width, _)| peak(at, 1.2 * width));
    let between = Cauchy::new(0.5, 0.5).unwrap();
    battery.check(
        size,
        &Case {
            name: "three peaks",
            f: move |x: &f64| {
                peaks.map(|(at, width, mass)| mass * peak(at, width).pdf(x)).iter().sum::<f64>()
            },
            integral: &[3.5],
            techniques: &[&p, &q, &r, &between],
            covered: false,
            spread: 4.0,
        },
    );
    battery
}

/// A table that alone would miss most of the integral, beside one that covers it.
fn compensated(size: Size, battery: &mut Battery) {
    let unit = Uniform::unit();
    let above = |x: f64| 0.2 + (-200.0 * (x - 0.7).powi(2)).exp();
    let table = PiecewiseConstant::tabulate(0.0, 1.0, 32, above).unwrap();
    let compensated = table.compensated(1.0).unwrap();
    assert!(compensated.pdf(&0.1) == 0.0 && compensated.pdf(&0.7) > 2.0);
    battery.check(
        size,
        &Case {
            name: "compensated table",
            f: |x: &f64| if *x < 0.75 { 1.0 - x } else { 3.0 },
            integral: &[0.75 - 0.5 * 0.75 * 0.75 + 0.75],
            techniques: &[&compensated, &unit],
            covered: false,
            spread: 2.2,
        },
    );
}
