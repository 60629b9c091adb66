//! An integral over many dimensions: a product of two functions, and a technique for each.
//!
//! On the box `[0, 10]^D`, with t = x / 10, f is the product of
//!
//! - a pole at the lower faces, `Π t_d^-c_d` with `c_d = 0.8 / d`, and
//! - growth towards the upper corner, `Π e^(-λ_d (1 - t_d))` with `λ_d = 5 / d`,
//!
//! over the volume 10^D. Each function can be sampled, coordinate by coordinate, but neither
//! technique suits the product: the first misses the growth; the second, like uniform points,
//! misses the pole, and its variance is infinite. Combined, they do.
//!
//! D is fixed first (points `[f64; D]`), then given at run time (`Vec<f64>`), then 1000, where
//! every density is 0 in `f64` and the estimators turn to logarithms.
//!
//! `cargo run --release --example product_nd` or `... --example product_nd -- 12` for another D.

use std::error::Error;
use std::fmt::Debug;

use mis::technique::{Exponential, PowerLaw, Product, ProductVec, UniformBox};
use mis::weighting::{Cutoff, Maximum, Power};
use mis::{
    ArgumentError, Estimate, Estimator, Integrand, LnValue, MultiSample, OneSample, Technique,
    Value,
};

/// The side of the box.
const SIDE: f64 = 10.0;

/// The number of dimensions that is fixed.
const D: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let run_time = match std::env::args().nth(1) {
        None => 8,
        Some(text) => text.parse().ok().filter(|d| (1..=100).contains(d)).ok_or_else(|| {
            format!("the number of dimensions is {text}, but it must be from 1 to 100")
        })?,
    };
    println!("Variances are those of one sample, in units of the exact value squared. z is the");
    println!("error in standard errors; where the variance is infinite, neither means anything.");

    let (poles, growths) = (poles(D)?, growths(D)?);
    let pole = Product::<_, D>::new(std::array::from_fn(|d| poles[d]))?;
    let growth = Product::<_, D>::new(std::array::from_fn(|d| growths[d]))?;
    let uniform = UniformBox::uniform([0.0; D], [SIDE; D])?;
    println!("\nD = {D}, fixed when compiling; points are arrays");
    table([&uniform, &pole, &growth], &|x: &[f64; D]| f(x), exact(D), 100_000)?;

    let [uniform, pole, growth] = &at_run_time(run_time)?;
    let techniques = [&**uniform, &**pole, &**growth];
    println!("\nD = {run_time}, known at run time; points are vectors");
    table(techniques, &|x: &Vec<f64>| f(x), exact(run_time), 100_000)?;

    let large = 1000;
    let [uniform, pole, growth] = &at_run_time(large)?;
    let x = growth.sample(&vec![0.5; large]);
    println!("\nD = {large}; at a typical point,");
    println!("{:<16} {:>8} {:>12}", "", "value", "logarithm");
    println!("{:<16} {:>8e} {:>12.3}", "f", f(&x), ln_f(&x));
    println!("{:<16} {:>8e} {:>12.3}", "pdf, pole", pole.pdf(&x), pole.ln_pdf(&x));
    println!("{:<16} {:>8e} {:>12.3}", "pdf, growth", growth.pdf(&x), growth.ln_pdf(&x));
    assert!(f(&x) == 0.0 && pole.pdf(&x) == 0.0 && growth.pdf(&x) == 0.0, "no underflow");
    let ln_f = |x: &Vec<f64>| LnValue::positive(ln_f(x));
    table([&**uniform, &**pole, &**growth], &ln_f, exact(large), 2_000)?;

    println!(
        "\nEvery combination is within 5 standard errors of the exact value, and its variance"
    );
    println!("is below the square of that value.");
    Ok(())
}

/// `c_d` and `λ_d` of coordinate `d`, counted from 0: coordinates matter less and less.
fn parameters(d: usize) -> (f64, f64) {
    let d = (d + 1) as f64;
    (0.8 / d, 5.0 / d)
}

fn f(x: &[f64]) -> f64 {
    let factors = x.iter().enumerate().map(|(d, x)| {
        let ((c, lambda), t) = (parameters(d), x / SIDE);
        t.powf(-c) * (lambda * (t - 1.0)).exp() / SIDE
    });
    factors.product()
}

fn ln_f(x: &[f64]) -> f64 {
    let factors = x.iter().enumerate().map(|(d, x)| {
        let ((c, lambda), t) = (parameters(d), x / SIDE);
        lambda * (t - 1.0) - c * t.ln() - SIDE.ln()
    });
    factors.sum()
}

/// Π ∫ t^-c e^(-λ (1 - t)) dt over the unit interval; each is e^-λ Σ λ^n / (n! (n + 1 - c)).
fn exact(dimensions: usize) -> f64 {
    let integral = |d| {
        let (c, lambda) = parameters(d);
        let (mut power, mut sum) = (1.0, 1.0 / (1.0 - c)); // λ^n / n!
        for n in (1..60).map(f64::from) {
            power *= lambda / n;
            sum += power / (n + 1.0 - c);
        }
        sum * (-lambda).exp()
    };
    (0..dimensions).map(integral).product()
}

fn poles(dimensions: usize) -> Result<Vec<PowerLaw>, ArgumentError> {
    (0..dimensions).map(|d| PowerLaw::new(-parameters(d).0, 0.0, SIDE)).collect()
}

/// A density that grows is an exponential one of negative rate.
fn growths(dimensions: usize) -> Result<Vec<Exponential>, ArgumentError> {
    (0..dimensions).map(|d| Exponential::new(-parameters(d).1 / SIDE, 0.0, SIDE)).collect()
}

/// A technique for points in `P`, of any type.
type Boxed<P> = Box<dyn Technique<Point = P>>;

/// Uniform, pole and growth.
fn at_run_time(dimensions: usize) -> Result<[Boxed<Vec<f64>>; 3], ArgumentError> {
    Ok([
        Box::new(ProductVec::uniform(&vec![0.0; dimensions], &vec![SIDE; dimensions])?),
        Box::new(ProductVec::new(poles(dimensions)?)?),
        Box::new(ProductVec::new(growths(dimensions)?)?),
    ])
}

/// One row for each way to use the three techniques, with `n` samples.
fn table<P: Debug, F: Integrand<P>>(
    [uniform, pole, growth]: [&dyn Technique<Point = P>; 3],
    f: &F,
    exact: f64,
    n: u64,
) -> Result<(), Box<dyn Error>>
where
    F::Value: Value<Each<f64> = f64>,
    F::Value: Value<Each<Option<f64>> = Option<f64>>,
{
    let both = || MultiSample::new(&[(pole, n / 2), (growth, n / 2)]);
    let one_sample = OneSample::new(&[(pole, 0.5), (growth, 0.5)], n)?;
    println!("{n} samples a row; exact value {exact:.12e}\n");
    println!("{:<22} {:>16} {:>10} {:>7} {:>10}", "", "estimate", "error", "z", "variance");

    let infinite = f64::INFINITY;
    let row = |name, bound, estimate| row(name, bound, &estimate, exact);
    row("uniform", infinite, MultiSample::new(&[(uniform, n)])?.estimate(f, 1)?)?;
    row("growth only", infinite, MultiSample::new(&[(growth, n)])?.estimate(f, 2)?)?;
    row("pole only", 100.0, MultiSample::new(&[(pole, n)])?.estimate(f, 3)?)?;
    row("both, balance", 1.0, both()?.estimate(f, 4)?)?;
    row("both, power 2", 1.0, both()?.weighting(Power::squared())?.estimate(f, 5)?)?;
    row("both, cutoff 0.3", 1.0, both()?.weighting(Cutoff::new(0.3)?)?.estimate(f, 6)?)?;
    row("both, maximum", 1.0, both()?.weighting(Maximum)?.estimate(f, 7)?)?;
    row("both, one-sample", 1.0, one_sample.estimate(f, 8)?)
}

/// Prints a row and checks it against a bound of its relative variance.
fn row<V>(name: &str, bound: f64, estimate: &Estimate<V>, exact: f64) -> Result<(), Box<dyn Error>>
where
    V: Value<Each<f64> = f64>,
    V: Value<Each<Option<f64>> = Option<f64>>,
{
    let standard_error = estimate.standard_error().ok_or("every contribution is 0")?;
    let error = estimate.value() / exact - 1.0;
    let z = (estimate.value() - exact) / standard_error;
    let text = estimate.to_string();
    print!("{name:<22} {text:>16} {:>8.3} %", 100.0 * error);
    if bound.is_finite() {
        let variance = (standard_error / exact).powi(2) * estimate.samples() as f64;
        println!(" {z:>7.2} {variance:>10.4}");
        assert!(z.abs() < 5.0, "{name}: {text} for {exact}, z = {z}");
        assert!(variance < bound, "{name}: the relative variance is {variance}, above {bound}");
    } else {
        println!(" {:>7} {:>10}", "-", "infinite");
    }
    Ok(())
}
