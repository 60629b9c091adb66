//! Integrands in 2, 3, 8 and 1000 dimensions.

use std::f64::consts::{FRAC_PI_4, PI};

use mis::technique::{
    Exponential, InverseCdf, Linear, Normal, Product, ProductVec, Uniform, UniformBox,
};
use mis::{LnValue, MultiSample, OneSample};

use crate::battery::{Battery, Case, Size};
use crate::ensemble::Any;

pub(crate) fn products(size: Size) -> Battery {
    let mut battery = Battery::default();
    let square = UniformBox::uniform([0.0; 2], [1.0; 2]).unwrap();
    let decay = Product::new([Exponential::new(1.0, 0.0, 1.0).unwrap(); 2]).unwrap();
    battery.check(
        size,
        &Case {
            name: "2D exponential",
            f: |x: &[f64; 2]| (-x[0] - 1.5 * x[1]).exp(),
            integral: &[(1.0 - (-1.0_f64).exp()) * (1.0 - (-1.5_f64).exp()) / 1.5],
            techniques: &[&square, &decay],
            covered: true,
            spread: 2.0,
        },
    );
    let corner = Product::new([Linear::new(0.0, 1.0, 2.0, 1.0).unwrap(); 2]).unwrap();
    battery.check(
        size,
        &Case {
            name: "quarter disc",
            f: |x: &[f64; 2]| f64::from(x[0].hypot(x[1]) < 1.0),
            integral: &[FRAC_PI_4],
            techniques: &[&square, &corner],
            covered: true,
            spread: 2.0,
        },
    );
    let cube = UniformBox::uniform([0.0; 3], [1.0; 3]).unwrap();
    let ramps = Product::new([Linear::new(0.0, 1.0, 0.0, 1.0).unwrap(); 3]).unwrap();
    let mixed: [&dyn InverseCdf; 3] =
        [&Uniform::unit(), &Linear::new(0.0, 1.0, 1.0, 3.0).unwrap(), &Uniform::unit()];
    let mixed = Product::new(mixed).unwrap();
    battery.check(
        size,
        &Case {
            name: "3D product",
            f: |x: &[f64; 3]| 8.0 * x[0] * x[1] * x[2],
            integral: &[1.0],
            techniques: &[&cube, &ramps, &mixed],
            covered: true,
            spread: 4.0,
        },
    );
    let flat = ProductVec::uniform(&[0.0; 8], &[1.0; 8]).unwrap();
    let sloped = ProductVec::new(vec![Linear::new(0.0, 1.0, 1.0, 2.0).unwrap(); 8]).unwrap();
    battery.check(
        Size { samples: size.samples / 2, ..size },
        &Case {
            name: "8D product, run-time length",
            f: |x: &Vec<f64>| x.iter().map(|x| 0.5 + x).product::<f64>(),
            integral: &[1.0],
            techniques: &[&flat, &sloped],
            covered: true,
            spread: 3.0,
        },
    );
    let narrow = Product::new([Normal::standard(); 8]).unwrap();
    let wide = Product::new([Normal::new(0.0, 1.2).unwrap(); 8]).unwrap();
    battery.check(
        Size { samples: size.samples / 2, ..size },
        &Case {
            name: "8D Gaussian",
            f: |x: &[f64; 8]| x[0] * x[0] * (-0.5 * x.iter().map(|x| x * x).sum::<f64>()).exp(),
            integral: &[(2.0 * PI).powi(4)],
            techniques: &[&narrow, &wide],
            covered: true,
            spread: 4.0,
        },
    );
    battery
}

/// f = 10⁻¹⁰⁰⁰ x₁ / 5 on \[0, 10\]¹⁰⁰⁰: neither it nor any pdf is representable.
pub(crate) fn thousand_dimensions(size: Size) -> Battery {
    let mut battery = Battery::default();
    let level = Linear::new(0.0, 10.0, 1.0, 1.0).unwrap();
    let product = |first: Linear| {
        let mut coordinates = vec![level; 1000];
        coordinates[0] = first;
        ProductVec::new(coordinates).unwrap()
    };
    let (flat, up) = (product(level), product(Linear::new(0.0, 10.0, 1.0, 3.0).unwrap()));
    let size = Size { seeds: size.seeds / 2, samples: size.samples / 20 };
    let case = Case {
        name: "1000 dimensions",
        f: |x: &Vec<f64>| LnValue::positive((0.2 * x[0]).ln() - 1000.0 * 10.0_f64.ln()),
        integral: &[1.0],
        techniques: &[&flat, &up],
        covered: true,
        spread: 2.0,
    };
    for weighting in [Any::balance(), Any::power(2.0)] {
        let halves = [(case.techniques[0], 0.7), (case.techniques[1], 0.3)];
        let counts = [
            (case.techniques[0], size.samples / 2),
            (case.techniques[1], size.samples - size.samples / 2),
        ];
        let multi = MultiSample::new(&counts).unwrap().weighting(&weighting).unwrap();
        battery.ensemble(size, &case, &format!("multi-sample, {}", weighting.0), &multi);
        let one = OneSample::new(&halves, size.samples).unwrap().weighting(&weighting).unwrap();
        battery.ensemble(size, &case, &format!("one-sample, {}", weighting.0), &one);
    }
    battery
}
