//! Smooth, oscillating and sign-changing integrands on an interval.

use std::f64::consts::{E, FRAC_PI_2, PI};

use mis::Technique;
use mis::technique::{Exponential, FnTechnique, Linear, TruncatedCauchy, TruncatedNormal, Uniform};

use crate::battery::{Battery, Case, Size};

type On<'a, P> = &'a dyn Technique<Point = P>;

pub(crate) fn smooth(size: Size) -> Battery {
    let mut battery = Battery::default();
    let unit = Uniform::unit();
    let up = Linear::new(0.0, 1.0, 1.0, 2.0).unwrap();
    let down = Linear::new(0.0, 1.0, 2.0, 1.0).unwrap();
    let ramp = Linear::new(0.0, 1.0, 0.0, 1.0).unwrap();
    let on_unit: [On<'_, f64>; 3] = [&unit, &up, &down];

    battery.check(
        size,
        &Case {
            name: "exp x",
            f: |x: &f64| x.exp(),
            integral: &[E - 1.0],
            techniques: &on_unit[..2],
            covered: true,
            spread: 2.0,
        },
    );
    let quarter = [0.0, FRAC_PI_2];
    let cosine = FnTechnique::new(quarter, f64::cos, f64::sin, f64::asin).unwrap();
    let cdf = |x: f64| 2.0 * (0.5 * x).sin().powi(2);
    let sine = FnTechnique::new(quarter, f64::sin, cdf, |u| 2.0 * (0.5 * u).sqrt().asin()).unwrap();
    battery.check(
        size,
        &Case {
            name: "sin cos",
            f: |x: &f64| x.sin() * x.cos(),
            integral: &[0.5],
            techniques: &[&cosine, &sine],
            covered: true,
            spread: 1.5,
        },
    );
    battery.check(
        size,
        &Case {
            name: "oscillating",
            f: |x: &f64| 1.0 + (40.0 * x).sin(),
            integral: &[1.0 + (1.0 - 40.0_f64.cos()) / 40.0],
            techniques: &on_unit,
            covered: true,
            spread: 3.0,
        },
    );
    let long = Uniform::new(0.0, 2.0).unwrap();
    let decay = Exponential::new(1.0, 0.0, 2.0).unwrap();
    battery.check(
        size,
        &Case {
            name: "changing sign",
            f: |x: &f64| x.cos(),
            integral: &[2.0_f64.sin()],
            techniques: &[&long, &decay],
            covered: true,
            spread: 2.0,
        },
    );
    let wide = Uniform::new(-1.0, 1.0).unwrap();
    let bell = TruncatedNormal::new(0.0, 0.5, -1.0, 1.0).unwrap();
    let slope = Linear::new(-1.0, 1.0, 1.0, 3.0).unwrap();
    battery.check(
        size,
        &Case {
            name: "integral 0",
            f: |x: &f64| (PI * x).sin(),
            integral: &[0.0],
            techniques: &[&wide, &bell, &slope],
            covered: true,
            spread: 3.0,
        },
    );
    let line = TruncatedCauchy::new(0.0, 0.2, -1.0, 1.0).unwrap();
    battery.check(
        size,
        &Case {
            name: "Runge",
            f: |x: &f64| (1.0 + 25.0 * x * x).recip(),
            integral: &[0.4 * 5.0_f64.atan()],
            techniques: &[&wide, &line],
            covered: true,
            spread: 2.0,
        },
    );
    battery.check(
        size,
        &Case {
            name: "three values",
            f: |x: &f64| [*x, x * x, (PI * x).sin()],
            integral: &[0.5, 1.0 / 3.0, 2.0 / PI],
            techniques: &[&unit, &ramp, &down],
            covered: true,
            spread: 3.0,
        },
    );
    battery
}
