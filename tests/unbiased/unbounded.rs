//! Integrands on the line and on half-lines.

use std::f64::consts::PI;

use mis::technique::{Affine, Cauchy, Exponential, FnTechnique, Normal};

use crate::battery::{Battery, Case, Size};

pub(crate) fn unbounded(size: Size) -> Battery {
    let mut battery = Battery::default();
    let standard = Normal::standard();
    let shifted = Normal::new(1.0, 2.0).unwrap();
    let cauchy = Cauchy::new(0.0, 1.0).unwrap();
    battery.check(
        size,
        &Case {
            name: "Gaussian on the line",
            f: |x: &f64| (-x * x).exp(),
            integral: &[PI.sqrt()],
            techniques: &[&standard, &shifted, &cauchy],
            covered: true,
            spread: 3.0,
        },
    );
    let fast = Exponential::new(1.0, 0.0, f64::INFINITY).unwrap();
    let slow = Exponential::new(0.5, 0.0, f64::INFINITY).unwrap();
    battery.check(
        size,
        &Case {
            name: "x exp(-x)",
            f: |x: &f64| x * (-x).exp(),
            integral: &[1.0],
            techniques: &[&fast, &slow],
            covered: true,
            spread: 2.0,
        },
    );
    let broad = Cauchy::new(0.5, 2.0).unwrap();
    let bell = Normal::new(0.0, 3.0).unwrap();
    battery.check(
        size,
        &Case {
            name: "resonance",
            f: |x: &f64| (1.0 + x * x).recip(),
            integral: &[PI],
            techniques: &[&broad, &bell],
            covered: false,
            spread: 3.0,
        },
    );
    let tail = FnTechnique::new(
        [0.0, f64::INFINITY],
        |x| 0.5 * (1.0 + x).powf(-1.5),
        |x| 1.0 - (1.0 + x).sqrt().recip(),
        |u| (1.0 - u).powi(-2) - 1.0,
    );
    battery.check(
        size,
        &Case {
            name: "algebraic tail",
            f: |x: &f64| (1.0 + x).powi(-2),
            integral: &[1.0],
            techniques: &[&fast, &tail.unwrap()],
            covered: false,
            spread: 3.0,
        },
    );
    let (mirrored, lazy) =
        (Affine::new(fast, 0.0, -1.0).unwrap(), Affine::new(slow, 0.0, -1.0).unwrap());
    battery.check(
        size,
        &Case {
            name: "lower half-line",
            f: |x: &f64| x.exp() * (1.0 + x.cos()),
            integral: &[1.5],
            techniques: &[&mirrored, &lazy],
            covered: true,
            spread: 2.0,
        },
    );
    battery
}
