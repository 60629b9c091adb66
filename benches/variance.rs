//! Time and variance of every estimator and weighting, and what they buy together.
//!
//! `cargo bench --bench variance` times each by criterion, then prints a table for each integrand,
//! which it also writes to `target/mis-variance.md`. It takes about a minute and a half.
//!
//! Time and variance are of one run: the table's time is the first decile of all estimates that
//! criterion asked for, each timed alone, since other processes only add to it; its variance is the
//! mean of the variances that the same estimates report.

#![allow(clippy::unwrap_used, missing_docs)]

use std::cell::RefCell;
use std::f64::consts::FRAC_PI_2;
use std::fmt::{Debug, Write};
use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, Throughput};
use mis::lighting::{
    Bsdf, DVec3, Direction, Lambert, Light, ModifiedPhong, Rectangle, ReflectedRadiance, Scene,
    Sphere, Surface,
};
use mis::technique::{Exponential, FnTechnique, Mixture, PowerLaw, Product, Uniform, UniformBox};
use mis::weighting::{Balance, Constant, Cutoff, Maximum, Power, Weighting};
use mis::{Estimate, EstimateError, Estimator, Integrand, MultiSample, OneSample, Technique};

/// Samples of one estimate.
const SAMPLES: u64 = 1 << 13;

type Dyn<'a, P> = &'a dyn Technique<Point = P>;

fn main() {
    let mut criterion = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(1_500))
        .nresamples(2_000)
        .without_plots()
        .configure_from_args();
    let mut report = String::from(
        "Time: first decile of criterion's runs. Variance: of one sample, in units of the exact \
         value squared;\nthe mean of what the timed estimates report. Efficiency: \
         1 / (variance x time), per second. Error after 1 s:\nrelative, extrapolated as \
         1 / sqrt(efficiency). z: error of the mean of all estimates, in standard errors.\n",
    );
    sin_cos(&mut criterion, &mut report);
    product(&mut criterion, &mut report);
    lighting(&mut criterion, &mut report);
    criterion.final_summary();
    println!("\n{report}");
    // With --test, every benchmark runs once: the table is then of no use.
    if !std::env::args().any(|argument| argument == "--test") {
        let target = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap();
        let path = target.join("mis-variance.md");
        std::fs::write(&path, report).unwrap();
        println!("written to {}", path.display());
    }
}

/// The integrand sin x cos x on [0, π/2].
fn sin_cos(criterion: &mut Criterion, report: &mut String) {
    let support = [0.0, FRAC_PI_2];
    let cosine = FnTechnique::new(support, f64::cos, f64::sin, f64::asin).unwrap();
    let sine = |u: f64| 2.0 * (0.5 * u).sqrt().asin();
    let sine = FnTechnique::new(support, f64::sin, |x: f64| 1.0 - x.cos(), sine).unwrap();
    let uniform = Uniform::new(0.0, FRAC_PI_2).unwrap();
    let f = |x: &f64| x.sin() * x.cos();
    let mut case = Case::new(criterion, "sin cos", 0.5, &f);
    case.alone("uniform", &uniform, Variance::Finite);
    case.alone("cosine", &cosine, Variance::Finite);
    case.alone("sine", &sine, Variance::Finite);
    case.every_weighting(&cosine, &sine, Variance::Finite);
    case.finish(report);
}

/// The product of a pole and a growth in five dimensions, as in the example `product_nd`.
fn product(criterion: &mut Criterion, report: &mut String) {
    const D: usize = 5;
    let parameters: [_; D] = std::array::from_fn(|d| (0.8 / (d + 1) as f64, 5.0 / (d + 1) as f64));
    let pole = parameters.map(|(c, _)| PowerLaw::new(-c, 0.0, 1.0).unwrap());
    let growth = parameters.map(|(_, lambda)| Exponential::new(-lambda, 0.0, 1.0).unwrap());
    let (pole, growth) = (Product::new(pole).unwrap(), Product::new(growth).unwrap());
    let uniform = UniformBox::uniform([0.0; D], [1.0; D]).unwrap();
    let f = |x: &[f64; D]| {
        let factors = x.iter().zip(&parameters);
        factors.map(|(x, (c, lambda))| x.powf(-c) * (lambda * x).exp()).product::<f64>()
    };
    // ∫ x^-c e^(λ x) = Σ λ^n / (n! (n + 1 - c)).
    let exact = parameters.map(|(c, lambda)| {
        let mut power = 1.0; // λ^n / n!
        let term = |n: f64| {
            power *= if n > 0.0 { lambda / n } else { 1.0 };
            power / (n + 1.0 - c)
        };
        (0..60).map(f64::from).map(term).sum::<f64>()
    });
    let exact = exact.iter().product();
    let mut case = Case::new(criterion, "product in 5 dimensions", exact, &f);
    case.alone("uniform", &uniform, Variance::Infinite);
    case.alone("pole", &pole, Variance::Finite);
    case.alone("growth", &growth, Variance::Infinite);
    case.every_weighting(&pole, &growth, Variance::Infinite);
    case.finish(report);
}

/// The radiance of a matte and glossy point under two lights; the point of the example `lighting`.
fn lighting(criterion: &mut Criterion, report: &mut String) {
    let sphere = Sphere::new(DVec3::new(1.5, -0.2, 2.0), 0.5).unwrap();
    let (x, y) = (DVec3::new(1.5, 0.0, 0.0), DVec3::new(0.0, 1.2, 0.0));
    let rectangle = Rectangle::from_corner(DVec3::new(-2.0, 0.3, 1.5), x, y).unwrap();
    let scene = Scene::new()
        .light(Light::new(sphere, 4.0).unwrap())
        .light(Light::new(rectangle, 1.0).unwrap());
    let normal = Direction::new(DVec3::Z).unwrap();
    let eye = Direction::new(DVec3::new(-1.3, -0.1, 2.0)).unwrap();
    let surface = Surface::new(DVec3::ZERO, normal, eye).unwrap();
    let incident = scene.seen_from(surface.position()).unwrap();
    let bsdf = (Lambert::new(0.5).unwrap(), ModifiedPhong::new(0.5, 300.0).unwrap());

    // Constant weights need techniques that cover the integrand: all lights, or all lobes.
    let lights = incident.lights().iter().map(|light| (light, 0.5)).collect();
    let lobes = bsdf.techniques(&surface).into_iter().map(|lobe| (lobe, 0.5)).collect();
    let (lights, lobes) = (Mixture::new(lights).unwrap(), Mixture::new(lobes).unwrap());
    let f = ReflectedRadiance::new(&incident, surface, &bsdf);
    let mut case = Case::new(criterion, "lighting", LIGHTING_EXACT, &f);
    case.alone("lights", &lights, Variance::Finite);
    case.alone("BSDF", &lobes, Variance::Finite);
    case.every_weighting(&lights, &lobes, Variance::Finite);
    case.finish(report);
}

/// The exact radiance, by the quadrature of the example `lighting`.
const LIGHTING_EXACT: f64 = 1.456_094_685_861;

/// Whether the variance of an estimator is known to be infinite.
#[derive(Clone, Copy, PartialEq)]
enum Variance {
    Finite,
    Infinite,
}

/// The estimators of one integrand.
struct Case<'a, P, F> {
    criterion: &'a mut Criterion,
    name: &'static str,
    exact: f64,
    f: &'a F,
    rows: Vec<Row>,
    point: std::marker::PhantomData<P>,
}

impl<'a, P: Debug, F: Integrand<P, Value = f64>> Case<'a, P, F> {
    fn new(criterion: &'a mut Criterion, name: &'static str, exact: f64, f: &'a F) -> Self {
        Self { criterion, name, exact, f, rows: Vec::new(), point: std::marker::PhantomData }
    }

    /// One technique.
    fn alone(&mut self, name: &str, technique: Dyn<'_, P>, variance: Variance) {
        let mis = MultiSample::new(&[(technique, SAMPLES)]).unwrap();
        let f = self.f;
        self.measure(name, "alone", variance, |seed| mis.estimate(f, seed));
    }

    /// Both estimators with every weighting of two techniques. With constant weights, the
    /// variance is infinite if that of one technique is.
    fn every_weighting(&mut self, a: Dyn<'_, P>, b: Dyn<'_, P>, constant: Variance) {
        self.weighting("balance", Balance, a, b, Variance::Finite);
        self.weighting("power 2", Power::squared(), a, b, Variance::Finite);
        self.weighting("cutoff 0.3", Cutoff::new(0.3).unwrap(), a, b, Variance::Finite);
        self.weighting("maximum", Maximum, a, b, Variance::Finite);
        self.weighting("constant", Constant::equal(), a, b, constant);
    }

    fn weighting(
        &mut self,
        name: &str,
        weighting: impl Weighting + Clone,
        a: Dyn<'_, P>,
        b: Dyn<'_, P>,
        variance: Variance,
    ) {
        let f = self.f;
        let multi = MultiSample::new(&[(a, SAMPLES / 2), (b, SAMPLES / 2)]).unwrap();
        let multi = multi.weighting(weighting.clone()).unwrap();
        self.measure("multi-sample", name, variance, |seed| multi.estimate(f, seed));
        let one = OneSample::new(&[(a, 0.5), (b, 0.5)], SAMPLES).unwrap();
        let one = one.weighting(weighting).unwrap();
        self.measure("one-sample", name, variance, |seed| one.estimate(f, seed));
    }

    /// Times `estimate` for seed after seed.
    fn measure(
        &mut self,
        estimator: &str,
        weighting: &str,
        variance: Variance,
        estimate: impl Fn(u64) -> Result<Estimate, EstimateError>,
    ) {
        let runs = RefCell::new(Runs::default());
        let mut group = self.criterion.benchmark_group(self.name);
        group.throughput(Throughput::Elements(SAMPLES));
        group.bench_function(BenchmarkId::new(estimator, weighting), |bencher| {
            bencher.iter_custom(|iterations| {
                let mut runs = runs.borrow_mut();
                let mut total = Duration::ZERO;
                for _ in 0..iterations {
                    let start = Instant::now();
                    let estimate = black_box(estimate(black_box(runs.count))).unwrap();
                    let elapsed = start.elapsed();
                    total += elapsed;
                    runs.add(&estimate, elapsed);
                }
                total
            });
        });
        group.finish();
        let runs = runs.into_inner();
        if runs.count > 0 {
            let estimator = estimator.to_string();
            let weighting = weighting.to_string();
            self.rows.push(Row { estimator, weighting, variance, runs });
        }
    }

    /// Appends the table to `report`.
    fn finish(self, report: &mut String) {
        let Some(first) = self.rows.first().map(|row| row.runs.nanoseconds()) else {
            return;
        };
        writeln!(report, "\n## {}: {}\n", self.name, self.exact).unwrap();
        writeln!(
            report,
            "| {:<12} | {:<10} | ns/sample | time ratio | variance   | efficiency | error after 1 s |     z |",
            "estimator", "weighting"
        )
        .unwrap();
        writeln!(report, "|{:-<14}|{:-<12}|----------:|-----------:|-----------:|-----------:|----------------:|------:|", "", "").unwrap();
        for row in &self.rows {
            let ns = row.runs.nanoseconds();
            let start = format!(
                "| {:<12} | {:<10} | {ns:>9.1} | {:>10.2} |",
                row.estimator,
                row.weighting,
                ns / first
            );
            if row.variance == Variance::Infinite {
                writeln!(
                    report,
                    "{start} {:>10} | {:>10} | {:>15} | {:>5} |",
                    "infinite", "-", "-", "-"
                )
                .unwrap();
                continue;
            }
            let count = row.runs.count as f64;
            let variance = row.runs.variances / count * SAMPLES as f64 / self.exact.powi(2);
            let efficiency = 1e9 / (variance * ns);
            let z = (row.runs.values / count - self.exact) / (row.runs.variances.sqrt() / count);
            writeln!(
                report,
                "{start} {variance:>10.6} | {efficiency:>10.3e} | {:>13.5} % | {z:>5.2} |",
                100.0 / efficiency.sqrt()
            )
            .unwrap();
            assert!(z.abs() < 5.0, "{} {}: z = {z}", row.estimator, row.weighting);
        }
    }
}

/// What the table tells of an estimator.
struct Row {
    estimator: String,
    weighting: String,
    variance: Variance,
    runs: Runs,
}

/// Sums over the estimates of all seeds.
#[derive(Default)]
struct Runs {
    count: u64,
    values: f64,
    variances: f64,
    times: Vec<Duration>,
}

impl Runs {
    fn add(&mut self, estimate: &Estimate, time: Duration) {
        self.times.push(time);
        self.count += 1;
        self.values += estimate.value();
        self.variances += estimate.variance().unwrap_or(f64::NAN);
    }

    /// The time of a sample.
    fn nanoseconds(&self) -> f64 {
        let mut times = self.times.clone();
        times.sort();
        let decile = times.get(times.len() / 10).copied().unwrap_or_default();
        1e9 * decile.as_secs_f64() / SAMPLES as f64
    }
}
