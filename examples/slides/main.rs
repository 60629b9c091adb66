//! The slides' example, ∫ sin x cos x over [0, π/2] = 1/2: their three tables, row by row, and the
//! exact against the measured variance of every estimator.
//!
//! `cargo run --release --example slides`

mod tables;

use std::error::Error;
use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};

use mis::technique::Uniform;
use mis::weighting::{Constant, Cutoff, Maximum, Power};
use mis::{Estimator, MultiSample, OneSample};

use tables::{PRINTED, XI, cosine, f, sine, table};

/// ∫ sin x cos x over [0, π/2].
const INTEGRAL: f64 = 0.5;

fn main() -> Result<(), Box<dyn Error>> {
    println!("∫ sin x cos x dx over [0, π/2] = {INTEGRAL}\n");
    for (number, printed) in PRINTED.iter().enumerate() {
        let (rows, estimate) = table(number, &XI)?;
        println!("{}; in brackets, what the slides print\n", printed.title);
        let columns: Vec<String> =
            printed.columns.iter().map(|name| format!("{name:^16}")).collect();
        println!("    ξ   {}", columns.join(" ").trim_end());
        for ((xi, row), printed_row) in XI.iter().zip(&rows).zip(printed.rows) {
            print!("  {xi:.3}");
            for (ours, theirs) in row.iter().zip(printed_row) {
                print!("  {ours:.6} ({theirs:.3})");
            }
            println!();
        }
        println!("\n  estimate {estimate:.6} ({:.3})\n", printed.estimate);
        assert!((estimate - printed.estimate).abs() < 0.000_5 + 1e-12, "another estimate");
    }
    println!("{SLIPS}");
    variances()
}

const SLIPS: &str = "\
Slips of the slides
- The second table's mean is 3.579 / 6 = 0.5965. The slides print 0.596; rounded half away from
  zero it is 0.597.
- The variance of the constant-weight combination is printed as Σ w_i V[F_i]. Independent
  estimators give Σ w_i² V[F_i]: with weights 1/2 and V[F_i] = 1/12 that is 1/24, not 1/12. The
  measured variance below agrees with 1/24.
- Not slips: single entries differ in the third decimal because the slides computed them from more
  digits of ξ than they print; and one, p = 0.99999, is cut off to 0.999.
";

/// How many estimates each row's variance comes from, and samples of each technique in each.
const ESTIMATES: u64 = 20_000;
const PER_TECHNIQUE: u64 = 8;

fn variances() -> Result<(), Box<dyn Error>> {
    let (p1, p2) = (cosine()?, sine()?);
    let uniform = Uniform::new(0.0, FRAC_PI_2)?;
    let n = PER_TECHNIQUE;
    let both = || MultiSample::new(&[(&p1, n), (&p2, n)]);
    let one = || OneSample::new(&[(&p1, 0.5), (&p2, 0.5)], n);
    let balance = SQRT_2 * (1.0 + SQRT_2).ln() / 4.0 - 7.0 / 24.0;

    println!(
        "Variance for one sample of each technique; in the one-sample model, for one sample\n"
    );
    println!(
        "  {:24} {:>12} {:>12} {:>6} {:>12} {:>8}",
        "estimator", "exact", "measured", "z", "reported", "mean, z"
    );
    row("p = cos x", 1.0 / 12.0, &MultiSample::new(&[(&p1, n)])?)?;
    row("p = sin x", 1.0 / 12.0, &MultiSample::new(&[(&p2, n)])?)?;
    row("p uniform", PI * PI / 32.0 - 0.25, &MultiSample::new(&[(&uniform, n)])?)?;
    row("constant 1/2", 1.0 / 24.0, &both()?.weighting(Constant::equal())?)?;
    row("balance", balance, &both()?)?;
    row("power 1.5", 0.022_359_154_8, &both()?.weighting(Power::new(1.5)?)?)?;
    row("power 2", 23.0 / 840.0, &both()?.weighting(Power::squared())?)?;
    row("power 3", 0.038_776_626_2, &both()?.weighting(Power::new(3.0)?)?)?;
    row("power 4", 0.048_805_872_7, &both()?.weighting(Power::new(4.0)?)?)?;
    row("cutoff 0.1", 0.019_991_502_7, &both()?.weighting(Cutoff::new(0.1)?)?)?;
    row("cutoff 0.3", 0.022_784_909_9, &both()?.weighting(Cutoff::new(0.3)?)?)?;
    row("cutoff 0.5", 0.035_492_470_4, &both()?.weighting(Cutoff::new(0.5)?)?)?;
    row("cutoff 0.75", 0.068_004_058_0, &both()?.weighting(Cutoff::new(0.75)?)?)?;
    row("maximum", SQRT_2 / 6.0 - 0.125, &both()?.weighting(Maximum)?)?;
    row("one-sample balance", 2.0 * balance, &one()?)?;
    row("one-sample p_i / Σ p_k", 2.0 * balance, &one()?.weights_without_probabilities())?;
    row("one-sample power 2", 23.0 / 420.0, &one()?.weighting(Power::squared())?)?;
    println!(
        "\n  measured: from {ESTIMATES} estimates with {n} samples of each technique ({n} in all in the one-sample\n  \
         model), their variance times {n}; reported: the mean of the variances that they report, times {n};\n  \
         z: distance in standard errors. The rows of cos and sin are mirror images from the same seeds;\n  \
         with equal probabilities the two one-sample weights are the same. Sample for sample, either pdf\n  \
         alone (0.083) is worse than the uniform one (0.058), and both, balanced (2 x 0.020), are better."
    );
    Ok(())
}

/// Prints a row of the table of variances, and checks it.
fn row(name: &str, exact: f64, mis: &impl Estimator<f64>) -> Result<(), Box<dyn Error>> {
    let (mut values, mut reported) = (Vec::new(), 0.0);
    for seed in 0..ESTIMATES {
        let estimate = mis.estimate(&f, seed)?;
        values.push(estimate.value());
        reported += estimate.variance().ok_or("no variance")?;
    }
    let count = ESTIMATES as f64;
    let mean = values.iter().sum::<f64>() / count;
    let moment = |k| values.iter().map(|v| (v - mean).powi(k)).sum::<f64>() / count;
    let (variance, fourth) = (moment(2), moment(4));
    // The standard errors of a mean and of a variance.
    let z_mean = (mean - INTEGRAL) / (variance / count).sqrt();
    let spread = ((fourth - variance * variance) / count).sqrt();
    let scale = PER_TECHNIQUE as f64;
    let z = (variance * scale - exact) / (spread * scale);
    println!(
        "  {name:24} {exact:12.8} {:12.8} {z:6.2} {:12.8} {z_mean:8.2}",
        variance * scale,
        reported / count * scale
    );
    assert!(z.abs() < 5.0 && z_mean.abs() < 5.0, "{name}: not what theory says");
    assert!((reported / count * scale / exact - 1.0).abs() < 0.05, "{name}: reported variance");
    Ok(())
}
