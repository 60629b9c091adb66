//! Narrow peaks, and a technique for each: where plain Monte Carlo fails.
//!
//! Two sums of normal peaks: three on the unit interval, drawn as a histogram, and two in five
//! dimensions, where they fill about a millionth of the unit cube. The techniques know where the
//! peaks are, and are a quarter too wide, as a guess would be. The tables show what uniform points
//! make of it, what happens when a peak has no technique, and what each technique contributes to
//! the value and to the variance.
//!
//! `cargo run --release --example peaks`

use std::error::Error;

use mis::technique::{Mixture, Normal, Product, TruncatedNormal, UniformBox};
use mis::weighting::{Constant, Cutoff, Maximum, Power};
use mis::{
    ArgumentError, Estimate, Estimator, Integrand, InverseCdf, MultiSample, OneSample, Technique,
};

/// A peak on the diagonal of the cube, of this mass (were it not cut).
#[derive(Clone, Copy)]
struct Peak {
    mass: f64,
    centre: f64,
    sd: f64,
}

const LINE: [Peak; 3] = [
    Peak { mass: 0.5, centre: 0.2, sd: 0.02 },
    Peak { mass: 0.3, centre: 0.5, sd: 0.005 },
    Peak { mass: 0.2, centre: 0.8, sd: 0.04 },
];

const CAMEL: [Peak; 2] =
    [Peak { mass: 0.5, centre: 0.25, sd: 0.02 }, Peak { mass: 0.5, centre: 0.75, sd: 0.02 }];

fn main() -> Result<(), Box<dyn Error>> {
    println!("z is the error in standard errors; largest is the greatest contribution of a single");
    println!("sample, in per cent of the estimate; value and variance are each technique's share.");

    let f = |x: &[f64; 1]| sum(&LINE, x);
    let techniques = guesses::<1>(&LINE)?;
    println!("\nThree peaks on the unit interval, 600 samples; by the balance heuristic:");
    histogram(&f, &techniques)?;
    table(&f, &techniques, exact::<1>(&LINE)?, 600)?;

    let f = |x: &[f64; 5]| sum(&CAMEL, x);
    let camel = exact::<5>(&CAMEL)?;
    println!("\nTwo peaks in five dimensions, uniform points");
    plain(&f, camel)?;
    println!("\nTwo peaks in five dimensions, 100000 samples");
    table(&f, &guesses::<5>(&CAMEL)?, camel, 100_000)?;
    println!(
        "Peaks that are far apart leave nothing to choose: every weighting gives the weight to"
    );
    println!("the technique of the peak.");
    println!("\nEvery combination is within 5 standard errors of the exact value.");
    Ok(())
}

/// The sum of the peaks at `x`.
fn sum<const D: usize>(peaks: &[Peak], x: &[f64; D]) -> f64 {
    let density = |peak: &Peak| {
        let norm = (2.0 * std::f64::consts::PI).sqrt() * peak.sd;
        let squares: f64 = x.iter().map(|x| ((x - peak.centre) / peak.sd).powi(2)).sum();
        peak.mass * (-0.5 * squares).exp() / norm.powf(D as f64)
    };
    peaks.iter().map(density).sum()
}

/// ∫ f over the unit cube: each peak's mass times the part of it in the cube.
fn exact<const D: usize>(peaks: &[Peak]) -> Result<f64, ArgumentError> {
    let mut value = 0.0;
    for peak in peaks {
        let normal = Normal::new(peak.centre, peak.sd)?;
        value += peak.mass * (1.0 - normal.cdf(0.0) - normal.survival(1.0)).powf(D as f64);
    }
    Ok(value)
}

/// A technique for each peak, 25 % too wide.
fn guesses<const D: usize>(
    peaks: &[Peak],
) -> Result<Vec<Product<TruncatedNormal, D>>, ArgumentError> {
    let guess = |peak: &Peak| {
        Product::new([TruncatedNormal::new(peak.centre, 1.25 * peak.sd, 0.0, 1.0)?; D])
    };
    peaks.iter().map(guess).collect()
}

/// Contributions by place: a bar's length is the part of the integral that its interval holds.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // Finite and positive.
fn histogram<T: Technique<Point = [f64; 1]>>(
    f: &impl Integrand<[f64; 1], Value = f64>,
    techniques: &[T],
) -> Result<(), Box<dyn Error>> {
    let mut bins = [0.0; 25];
    equal(techniques, 600)?.inspect(f, &mis::points::Random::new(1), |sample| {
        let [x] = sample.x();
        let bin = ((x * bins.len() as f64) as usize).min(bins.len() - 1);
        bins[bin] += sample.contribution() / 600.0;
    })?;
    println!("\n  from  part of the integral");
    for (bin, part) in bins.iter().enumerate() {
        let bar = "#".repeat((150.0 * part).round() as usize);
        println!("  {:.2}  {bar}", bin as f64 / bins.len() as f64);
    }
    println!();
    Ok(())
}

/// `n` samples, the same number from every technique.
fn equal<T: Technique>(
    techniques: &[T],
    n: u64,
) -> Result<MultiSample<'_, T::Point>, ArgumentError> {
    let n = n / techniques.len() as u64;
    let counts: Vec<(&dyn Technique<Point = T::Point>, u64)> =
        techniques.iter().map(|t| (t as _, n)).collect();
    MultiSample::new(&counts)
}

/// Uniform points, ever more of them.
fn plain<const D: usize>(
    f: &impl Integrand<[f64; D], Value = f64>,
    exact: f64,
) -> Result<(), Box<dyn Error>> {
    let cube = UniformBox::uniform([0.0; D], [1.0; D])?;
    let uniform = |n| MultiSample::new(&[(&cube, n)]);
    header("samples");
    for n in [100, 1_000, 10_000, 100_000, 1_000_000] {
        let estimate = uniform(n)?.estimate(f, 1)?;
        row(&n.to_string(), &estimate, exact)?;
        let largest = estimate.largest().map_or(0.0, |largest| largest.contribution);
        assert!(largest > 0.1 * estimate.value(), "the largest contribution gives no warning");
    }
    let runs = 1_000;
    let mut close = 0;
    for seed in 0..runs {
        let estimate = uniform(1_000)?.estimate(f, seed)?;
        close += i32::from(estimate.interval(0.95)?.contains(exact));
    }
    println!(
        "Of {runs} runs of 1000 points, {close} have the exact value in their 95 % interval: a"
    );
    println!("run that misses the peaks reports a small error. The largest contribution gives it");
    println!("away: one sample makes up much of the estimate.");
    assert!(close < 100, "uniform points were meant to fail, but {close} intervals are right");
    Ok(())
}

/// One row for each way to use the techniques, with `n` samples.
fn table<T: Technique<Point = [f64; D]> + Clone, const D: usize>(
    f: &impl Integrand<[f64; D], Value = f64>,
    techniques: &[T],
    exact: f64,
    n: u64,
) -> Result<(), Box<dyn Error>> {
    let cube = UniformBox::uniform([0.0; D], [1.0; D])?;
    let all = || equal(techniques, n);
    let probability = 1.0 / techniques.len() as f64;
    let mixture = techniques.iter().map(|t| (t.clone(), probability)).collect();
    let mixture = Mixture::new(mixture)?;
    let selection: Vec<(&dyn Technique<Point = [f64; D]>, f64)> =
        techniques.iter().map(|t| (t as _, probability)).collect();

    header("points");
    row("uniform", &MultiSample::new(&[(&cube, n)])?.estimate(f, 1)?, exact)?;
    let forgotten = [
        ("first technique only", equal(&techniques[..1], n)?.estimate(f, 2)?),
        ("constant weights", all()?.weighting(Constant::equal())?.estimate(f, 3)?),
    ];
    for (name, estimate) in forgotten {
        let z = row(name, &estimate, exact)?;
        assert!(z < -5.0, "{name} was meant to miss peaks, but z = {z}");
    }
    let combined = [
        ("balance", all()?.estimate(f, 4)?),
        ("power 2", all()?.weighting(Power::squared())?.estimate(f, 5)?),
        ("cutoff 0.3", all()?.weighting(Cutoff::new(0.3)?)?.estimate(f, 6)?),
        ("maximum", all()?.weighting(Maximum)?.estimate(f, 7)?),
        ("one-sample", OneSample::new(&selection, n)?.estimate(f, 8)?),
        ("mixture technique", MultiSample::new(&[(&mixture, n)])?.estimate(f, 9)?),
    ];
    for (name, estimate) in combined {
        let z = row(name, &estimate, exact)?;
        assert!(z.abs() < 5.0, "{name}: {estimate} for {exact}, z = {z}");
        // The relative variance of a single sample is below 4.
        let error = estimate.standard_error().ok_or("every contribution is 0")?;
        assert!(error < exact * 2.0 / (n as f64).sqrt(), "{name}: {estimate} for {exact}");
    }
    println!(
        "The first technique, alone or with constant weights, never meets the other peaks, and"
    );
    println!("nothing in its samples tells.");
    Ok(())
}

fn header(first: &str) {
    println!(
        "{first:<21} {:>14} {:>8} {:>9}   {:<14} variance, %",
        "estimate", "z", "largest", "value, %"
    );
}

/// Prints a row; returns z.
fn row(name: &str, estimate: &Estimate, exact: f64) -> Result<f64, Box<dyn Error>> {
    let error = estimate.standard_error().ok_or("every contribution is 0")?;
    let z = (estimate.value() - exact) / error;
    let largest = estimate.largest().map_or(0.0, |l| l.contribution / estimate.value());
    let shares = |of: fn(&mis::TechniqueSummary) -> Option<f64>| {
        let share = |share: Option<f64>| format!("{:.0}", 100.0 * share.unwrap_or(0.0));
        let shares: Vec<String> = estimate.techniques().map(|t| share(of(&t))).collect();
        shares.join(" + ")
    };
    let z_text = if z.abs() < 1e4 { format!("{z:.1}") } else { format!("{z:.0e}") };
    println!(
        "{name:<21} {:>14} {z_text:>8} {:>7.3} %   {:<14} {}",
        estimate.to_string(),
        100.0 * largest,
        shares(|t| t.share_of_value),
        shares(|t| t.share_of_variance)
    );
    Ok(z)
}
