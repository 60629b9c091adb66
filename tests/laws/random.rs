//! The laws at parameters drawn at random, from a fixed seed.
//!
//! A few draws and few samples by default; 1e6 samples in the ignored battery.

use crate::common::canonical_numbers;
use crate::{check, strict};
use mis::check::Options;
use mis::technique::{
    Affine, Cauchy, Exponential, InverseCdf, Linear, Normal, PowerLaw, Technique, TruncatedCauchy,
    TruncatedNormal, Uniform,
};

/// Random parameters.
struct Draw(std::vec::IntoIter<f64>);

impl Draw {
    fn new(seed: u64) -> Self {
        Self(canonical_numbers(seed, 1000).into_iter())
    }

    fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.0.next().unwrap_or(0.5)
    }

    /// A number of random magnitude.
    fn size(&mut self) -> f64 {
        10_f64.powf(self.between(-3.0, 3.0))
    }

    /// A number of random magnitude and sign.
    fn place(&mut self) -> f64 {
        let sign = self.between(-1.0, 1.0).signum();
        sign * self.size()
    }
}

/// Every technique with a closed form, at the parameters of one seed.
fn techniques(seed: u64) -> Vec<(String, Box<dyn InverseCdf>)> {
    let mut draw = Draw::new(seed);
    let mut all: Vec<(String, Box<dyn InverseCdf>)> = Vec::new();
    macro_rules! add {
        ($technique:expr) => {{
            let p = $technique.unwrap();
            all.push((format!("{p:?}"), Box::new(p)));
        }};
    }
    let (a, scale) = (draw.place(), draw.size());
    let b = a + draw.size();
    add!(Uniform::new(a, b));
    add!(Linear::new(a, b, draw.size(), draw.size()));
    add!(Linear::new(a, b, 0.0, draw.size()));
    add!(Exponential::new(draw.place(), a, b));
    add!(Exponential::new(draw.size(), a, f64::INFINITY));
    let lo = draw.size();
    add!(PowerLaw::new(draw.between(-4.0, 4.0), lo, lo + draw.size()));
    add!(PowerLaw::new(-1.0 + 1e-3 * draw.place(), lo, lo + draw.size()));
    add!(Normal::new(a, scale));
    add!(Cauchy::new(a, scale));
    let z = draw.between(-9.0, 9.0);
    let (low, high) = (a + scale * z, a + scale * (z + draw.between(0.5, 5.0)));
    add!(TruncatedNormal::new(a, scale, low, high));
    add!(TruncatedNormal::new(a, scale, f64::NEG_INFINITY, high));
    add!(TruncatedCauchy::new(a, scale, low, high));
    add!(TruncatedCauchy::new(a, scale, low, f64::INFINITY));
    all
}

fn options() -> Options {
    // Quadrature cannot tell neighbouring numbers apart in a window far from 0.
    strict().integral(1e-9)
}

fn laws_of(seeds: std::ops::Range<u64>, n: usize) {
    for seed in seeds {
        for (name, p) in techniques(seed) {
            println!("{name}");
            check(&p, n, &options());
        }
    }
}

#[test]
fn laws() {
    laws_of(0..5, 2000);
}

#[test]
#[ignore = "1e6 samples: run in release"]
fn battery() {
    laws_of(5..12, 2000);
    laws_of(100..103, 1_000_000);
}

/// An image keeps the laws to the rounding of its argument: the ends, and every sample.
#[test]
fn images() {
    for seed in 0..200 {
        let mut draw = Draw::new(seed);
        let inner = Linear::new(0.0, draw.size(), draw.size(), draw.size()).unwrap();
        let p = Affine::new(inner, draw.place(), draw.place()).unwrap();
        let (a, b) = p.support();
        assert_eq!((p.cdf(a), p.cdf(b), p.survival(a), p.survival(b)), (0.0, 1.0, 1.0, 0.0));
        for xi in [0.0, 0.3, 0.7, 1.0] {
            let x = p.sample(&[xi]);
            assert!(a <= x && x <= b && p.pdf(&x) > 0.0, "{p:?}: {x}");
        }
    }
}
