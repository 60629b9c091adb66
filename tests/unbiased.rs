//! Estimates are unbiased and their error bars calibrated: integrands of known integral, each
//! weighting, both estimators, from ensembles of fixed seeds.
//!
//! Of R estimates of n samples each: the mean is within 4.42 of its standard errors of the integral,
//! and that standard error is small; the mean of the reported variances over the variance of the
//! estimates is 1 to within 4.42 √((κ − 1)/R), κ being the kurtosis of the estimates, 3 if they are
//! normal, at least.

#[allow(dead_code)] // every test binary uses its own part of it
#[path = "common/ensemble.rs"]
mod ensemble;

use std::f64::consts::{E, FRAC_PI_2, FRAC_PI_4, PI};
use std::fmt::Debug;

use ensemble::{Any, Spread, Z};
use mis::technique::{
    Affine, Cauchy, Exponential, FnTechnique, InverseCdf, Linear, Mixture, Normal,
    PiecewiseConstant, PowerLaw, Product, ProductVec, TruncatedCauchy, TruncatedNormal, Uniform,
    UniformBox, canonical,
};
use mis::{Estimate, Estimator, Integrand, LnValue, MultiSample, OneSample, Technique, Value};

/// How large an ensemble is.
#[derive(Clone, Copy)]
struct Size {
    seeds: u64,
    samples: u64,
}

const QUICK: Size = Size { seeds: 300, samples: 100 };
const FULL: Size = Size { seeds: 2000, samples: 1000 };

/// Values whose components can be listed.
trait Listed: Value {
    fn list<U>(each: Self::Each<U>) -> Vec<U>;
}

impl Listed for f64 {
    fn list<U>(each: U) -> Vec<U> {
        vec![each]
    }
}

impl Listed for LnValue {
    fn list<U>(each: U) -> Vec<U> {
        vec![each]
    }
}

impl<const K: usize> Listed for [f64; K] {
    fn list<U>(each: [U; K]) -> Vec<U> {
        each.into()
    }
}

/// An integrand, its integral and the techniques for it.
struct Case<'a, P, F> {
    name: &'static str,
    f: F,
    integral: &'a [f64],
    techniques: &'a [&'a dyn Technique<Point = P>],
    /// Whether every technique alone has a finite variance, so that constant weights do.
    covered: bool,
    /// The largest standard deviation of a sample's contribution over the integral (over 1 for an
    /// integral of 0) that any estimator may have.
    spread: f64,
}

/// The extremes of all that was checked.
#[derive(Default)]
struct Battery {
    figures: usize,
    largest_z: f64,
    calibration: Option<[f64; 2]>,
    /// The largest deviation of a calibration ratio from 1, in units of its standard error.
    largest_calibration_z: f64,
}

impl Battery {
    fn report(&self, group: &str) {
        println!(
            "{group}: {} ensembles, largest |z| {:.2}, calibration {:.3?} (largest |z| {:.2})",
            self.figures,
            self.largest_z,
            self.calibration.unwrap_or_default(),
            self.largest_calibration_z,
        );
    }

    /// Every weighting with both estimators.
    fn check<P, F>(&mut self, size: Size, case: &Case<'_, P, F>)
    where
        P: Debug,
        F: Integrand<P>,
        F::Value: Listed,
    {
        let mut weightings = vec![
            Any::balance(),
            Any::power(2.0),
            Any::power(1.5),
            Any::cutoff(0.3),
            Any::maximum(),
        ];
        if case.covered {
            weightings.push(Any::equal());
        }
        // Unequal: 1 : 2 : ... for counts, ... : 2 : 1 for probabilities.
        let techniques = case.techniques;
        let parts = techniques.len() * (techniques.len() + 1) / 2;
        let counts: Vec<_> =
            (1..).map(|k| (k * size.samples).div_ceil(parts as u64)).collect_for(techniques);
        let shares: Vec<_> = (0..techniques.len())
            .map(|k| (techniques.len() - k) as f64 / parts as f64)
            .collect_for(techniques);
        for weighting in &weightings {
            let multi = MultiSample::new(&counts).unwrap().weighting(weighting).unwrap();
            self.ensemble(size, case, &format!("multi-sample, {}", weighting.0), &multi);
            let one =
                || OneSample::new(&shares, size.samples).unwrap().weighting(weighting).unwrap();
            self.ensemble(size, case, &format!("one-sample, {}", weighting.0), &one());
            let equal = one().equal_factors();
            self.ensemble(size, case, &format!("equal factors, {}", weighting.0), &equal);
        }
    }

    fn ensemble<P, F, M>(&mut self, size: Size, case: &Case<'_, P, F>, how: &str, mis: &M)
    where
        P: Debug,
        F: Integrand<P>,
        F::Value: Listed,
        M: Estimator<P>,
    {
        // Every ensemble has seeds of its own.
        let first = case
            .name
            .bytes()
            .chain(how.bytes())
            .fold(0, |h: u64, byte| (h ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
        let estimates: Vec<Estimate<F::Value>> = (0..size.seeds)
            .map(|seed| mis.estimate(&case.f, first.wrapping_add(seed)).unwrap())
            .collect();
        for (c, integral) in case.integral.iter().enumerate() {
            let values = |e: &Estimate<F::Value>| F::Value::list(e.value())[c];
            let variances = |e: &Estimate<F::Value>| F::Value::list(e.variance())[c].unwrap();
            let values: Vec<f64> = estimates.iter().map(values).collect();
            let variances: Vec<f64> = estimates.iter().map(variances).collect();
            let name = format!("{}, component {c}, {how}", case.name);
            self.figures(size, &name, *integral, case.spread, &values, &variances);
        }
    }

    fn figures(
        &mut self,
        size: Size,
        name: &str,
        integral: f64,
        spread: f64,
        values: &[f64],
        variances: &[f64],
    ) {
        let (values, variances) = (Spread::of(values), Spread::of(variances));
        let scale = if integral == 0.0 { 1.0 } else { integral.abs() };
        let relative = values.error() / scale;
        let bound = spread / ((size.seeds * size.samples) as f64).sqrt();
        assert!(relative <= bound, "{name}: relative standard error {relative}, not {bound}");
        self.figures += 1;
        // Where a weighting makes the estimate exact, there is no spread to compare with.
        if relative < 1e-15 {
            assert!((values.mean / scale - integral / scale).abs() < 1e-13, "{name}: {values:?}");
            assert!(variances.mean.sqrt() < 1e-13 * scale, "{name}: {variances:?}");
            return;
        }
        let z = (values.mean - integral) / values.error();
        assert!(z.abs() <= Z, "{name}: {}, not {integral}, z = {z:.2}", values.mean);

        let ratio = variances.mean / values.variance;
        let of_reports = variances.error() / variances.mean;
        let error = ((values.kurtosis.max(3.0) - 1.0) / values.count).sqrt().hypot(of_reports);
        let deviation = (ratio - 1.0) / error;
        assert!(deviation.abs() <= Z, "{name}: reported over actual variance {ratio} ± {error}");
        self.largest_z = self.largest_z.max(z.abs());
        self.largest_calibration_z = self.largest_calibration_z.max(deviation.abs());
        let [low, high] = self.calibration.unwrap_or([ratio; 2]);
        self.calibration = Some([low.min(ratio), high.max(ratio)]);
    }
}

/// Numbers, one a technique.
trait CollectFor<U>: Iterator<Item = U> + Sized {
    fn collect_for<'a, P>(
        self,
        techniques: &[&'a dyn Technique<Point = P>],
    ) -> Vec<(&'a dyn Technique<Point = P>, U)> {
        techniques.iter().copied().zip(self).collect()
    }
}

impl<U, I: Iterator<Item = U>> CollectFor<U> for I {}

type On<'a, P> = &'a dyn Technique<Point = P>;

fn smooth(size: Size) -> Battery {
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

fn rough(size: Size) -> Battery {
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

fn unbounded(size: Size) -> Battery {
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

fn products(size: Size) -> Battery {
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
fn thousand_dimensions(size: Size) -> Battery {
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

/// A direction, as a user's own type.
#[derive(Debug, Clone, Copy)]
struct Unit {
    z: f64,
    azimuth: f64,
}

/// Directions about the pole, per steradian: 1 / 4π, (1 + z) / 4π, or z / π above the horizon.
enum Polar {
    Sphere,
    Leaning,
    Lambert,
}

impl Technique for Polar {
    type Point = Unit;

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> Unit {
        let u = canonical(xi, 0);
        let z = match self {
            Self::Sphere => 2.0 * u - 1.0,
            Self::Leaning => 2.0 * u.sqrt() - 1.0,
            Self::Lambert => u.sqrt(),
        };
        Unit { z, azimuth: 2.0 * PI * canonical(xi, 1) }
    }

    fn pdf(&self, w: &Unit) -> f64 {
        match self {
            Self::Sphere => 0.25 / PI,
            Self::Leaning => 0.25 * (1.0 + w.z) / PI,
            Self::Lambert => w.z.max(0.0) / PI,
        }
    }
}

/// A number in one of three boxes; the measure counts boxes and is length within one.
#[derive(Debug, Clone, Copy)]
struct Boxed {
    which: usize,
    x: f64,
}

/// A box with these probabilities, then x by a density on the unit interval.
struct Boxes<T>([f64; 3], T);

impl<T: InverseCdf> Technique for Boxes<T> {
    type Point = Boxed;

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> Boxed {
        let u = canonical(xi, 0);
        let which = usize::from(u >= self.0[0]) + usize::from(u >= self.0[0] + self.0[1]);
        Boxed { which, x: self.1.sample(&[canonical(xi, 1)]) }
    }

    fn pdf(&self, at: &Boxed) -> f64 {
        self.0.get(at.which).map_or(0.0, |p| p * self.1.pdf(&at.x))
    }
}

fn own_points(size: Size) -> Battery {
    let mut battery = Battery::default();
    battery.check(
        size,
        &Case {
            name: "directions",
            f: |w: &Unit| w.z.max(0.0) * (1.0 + w.z * (1.0 + w.azimuth.cos())),
            integral: &[PI + 2.0 * PI / 3.0],
            techniques: &[&Polar::Sphere, &Polar::Leaning, &Polar::Lambert],
            covered: true,
            spread: 3.0,
        },
    );
    let even = Boxes([1.0 / 3.0; 3], Uniform::unit());
    let uneven = Boxes([0.2, 0.3, 0.5], Linear::new(0.0, 1.0, 1.0, 3.0).unwrap());
    battery.check(
        size,
        &Case {
            name: "numbers in boxes",
            f: |at: &Boxed| [1.0, 2.0 * at.x, 3.0 * at.x * at.x][at.which],
            integral: &[3.0],
            techniques: &[&even, &uneven],
            covered: true,
            spread: 2.0,
        },
    );
    battery
}

/// A test of every group, and one of its full ensembles.
macro_rules! batteries {
    ($($group:ident $full:ident),*) => {$(
        #[test]
        fn $group() {
            crate::$group(QUICK).report(stringify!($group));
        }

        #[test]
        #[ignore = "minutes in all: run it in release"]
        fn $full() {
            crate::$group(FULL).report(stringify!($group));
        }
    )*};
}

mod integrands {
    use super::{FULL, QUICK};

    batteries! {
        smooth smooth_full,
        rough rough_full,
        unbounded unbounded_full,
        products products_full,
        thousand_dimensions thousand_dimensions_full,
        own_points own_points_full
    }
}
