//! A histogram with error bars from a run, and a mean with its error.
//!
//! The mass spectrum of muon pairs near the ω and φ mesons: two Breit-Wigner lines on a falling
//! continuum, seen by a detector that adds a normal error of 10 MeV. A point is the pair (true mass,
//! error of the detector), the integral is the cross-section in the range of true masses, and the
//! histogram is of what the detector shows, their sum. Each line has a technique, 25 % too wide, as
//! a guess would be; the continuum has one that is flat.
//!
//! The content of a bin is an integral of its own, of f over the points that fall into it. All of
//! them come from one run, with standard errors, and their sum is the estimate. The exact contents
//! are known here, from a quadrature over the true mass.
//!
//! `cargo run --release --example histogram` prints it, and draws it in
//! `target/histogram.svg` (or in another file, if one is named).

use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;

use mis::points::Random;
use mis::technique::{Normal, Product, TruncatedCauchy, Uniform};
use mis::{InverseCdf, MultiSample, Report, Run, Tallied, Target};

/// A resonance, in MeV and nb.
struct Line {
    name: &'static str,
    mass: f64,
    width: f64,
    cross_section: f64,
}

const LINES: [Line; 2] = [
    Line { name: "ω", mass: 782.66, width: 8.68, cross_section: 3.0 },
    Line { name: "φ", mass: 1019.46, width: 4.25, cross_section: 2.0 },
];

/// Of the continuum at 900 MeV, in nb / MeV, and the mass in which it falls by e.
const CONTINUUM: (f64, f64) = (0.012, 200.0);

/// The range of true masses, in MeV.
const TRUE: [f64; 2] = [600.0, 1200.0];

/// The standard deviation of the detector's error, in MeV.
const RESOLUTION: f64 = 10.0;

/// The range of the histogram, in MeV.
const SHOWN: [f64; 2] = [700.0, 1100.0];

/// How many bins; what falls below and above goes into two more.
const BINS: usize = 40;

const WIDTH: f64 = (SHOWN[1] - SHOWN[0]) / BINS as f64;

/// Few, so that the error bars can be seen.
const SAMPLES: u64 = 10_000;

// Behind the bins: below, above, and three sums for the mean.
const BELOW: usize = BINS;
const ABOVE: usize = BINS + 1;
const MASS: usize = BINS + 2;
const MASS_AND_ALL: usize = BINS + 3;
const SUMS: usize = BINS + 4;

/// Where masses are counted from, for the mean: near it, so that nothing cancels.
const ORIGIN: f64 = 900.0;

/// The spectrum of true masses, in nb / MeV.
fn spectrum(mass: f64) -> f64 {
    let line = |line: &Line| {
        let half = 0.5 * line.width;
        let lorentz = half / ((mass - line.mass).powi(2) + half * half);
        line.cross_section * lorentz / std::f64::consts::PI
    };
    let (height, decay) = CONTINUUM;
    height * ((900.0 - mass) / decay).exp() + LINES.iter().map(line).sum::<f64>()
}

/// The spectrum times the density of the detector's error.
fn f(&[mass, error]: &[f64; 2]) -> f64 {
    let z = error / RESOLUTION;
    let normal = (-0.5 * z * z).exp() / (RESOLUTION * (2.0 * std::f64::consts::PI).sqrt());
    spectrum(mass) * normal
}

fn main() -> Result<(), Box<dyn Error>> {
    let detector = Normal::new(0.0, RESOLUTION)?;
    let line = |line: &Line| {
        let mass = TruncatedCauchy::new(line.mass, 1.25 * 0.5 * line.width, TRUE[0], TRUE[1])?;
        Product::new([Box::new(mass) as Box<dyn InverseCdf>, Box::new(detector)])
    };
    let (omega, phi) = (line(&LINES[0])?, line(&LINES[1])?);
    let flat: Box<dyn InverseCdf> = Box::new(Uniform::new(TRUE[0], TRUE[1])?);
    let continuum = Product::new([flat, Box::new(detector)])?;
    let mis = MultiSample::new(&[(&omega, 1), (&phi, 1), (&continuum, 2)])?;

    let target = Target::new().samples(SAMPLES)?;
    let report = Run::new(target).tally(&mis, &f, &Random::new(1), SUMS, |sample, tally| {
        let y = sample.contribution();
        let [mass, error] = sample.x();
        let seen = mass + error;
        tally.add(bin(seen), y);
        tally.add(MASS, (seen - ORIGIN) * y);
        tally.add(MASS_AND_ALL, (seen - ORIGIN) * y + y);
    })?;

    let exact = exact(&detector);
    let bins = &report.tallied()[..BINS];
    text(bins, &exact);
    println!();
    check_bins(&report, &exact)?;
    mean(&report)?;
    let file = std::env::args_os().nth(1).map_or_else(default_file, PathBuf::from);
    std::fs::write(&file, svg(bins, &exact)).map_err(|e| format!("{}: {e}", file.display()))?;
    println!("\nThe picture is in {}.", file.display());
    Ok(())
}

/// The sum that a mass belongs to.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // It is in the range.
fn bin(seen: f64) -> usize {
    if seen < SHOWN[0] {
        BELOW
    } else if seen >= SHOWN[1] {
        ABOVE
    } else {
        (((seen - SHOWN[0]) / WIDTH) as usize).min(BINS - 1)
    }
}

/// The lower end of a bin, in MeV.
fn edge(bin: usize) -> f64 {
    SHOWN[0] + bin as f64 * WIDTH
}

/// Simpson's rule over the true mass, in steps of 0.1 MeV.
fn integral(of: impl Fn(f64) -> f64) -> f64 {
    let steps = 6_000_u32;
    let h = (TRUE[1] - TRUE[0]) / f64::from(steps);
    let term = |k: u32| {
        let weight = match k {
            0 => 1.0,
            k if k == steps => 1.0,
            k if k % 2 == 1 => 4.0,
            _ => 2.0,
        };
        weight * of(TRUE[0] + f64::from(k) * h)
    };
    (0..=steps).map(term).sum::<f64>() * h / 3.0
}

/// The exact contents of the bins, and of what is below and above.
fn exact(detector: &Normal) -> Vec<f64> {
    let below = |x: f64| move |mass: f64| spectrum(mass) * detector.cdf(x - mass);
    let cumulative: Vec<f64> = (0..=BINS).map(|k| integral(below(edge(k)))).collect();
    let mut contents: Vec<f64> = cumulative.windows(2).map(|ends| ends[1] - ends[0]).collect();
    contents.push(cumulative[0]);
    contents.push(integral(spectrum) - cumulative[BINS]);
    contents
}

/// A bar for each bin, with a mark where the exact content is.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // Columns.
fn text(bins: &[Tallied], exact: &[f64]) {
    println!("Cross-section by reconstructed mass, {SAMPLES} samples; | marks the exact content\n");
    println!("  MeV         nb");
    let most = exact[..BINS].iter().fold(0.0, |a: f64, b| a.max(*b));
    for (k, (tallied, exact)) in bins.iter().zip(exact).enumerate() {
        let column = |content: f64| (50.0 * content / most).round() as usize;
        let mut bar: Vec<char> = vec!['#'; column(tallied.value)];
        bar.resize(bar.len().max(column(*exact) + 1), ' ');
        bar[column(*exact)] = '|';
        println!(
            "{:>5}  {:.4} ± {:.4}  {}",
            edge(k),
            tallied.value,
            tallied.standard_error.unwrap_or(f64::NAN),
            bar.iter().collect::<String>()
        );
    }
}

fn check_bins(report: &Report, exact: &[f64]) -> Result<(), Box<dyn Error>> {
    let contents = &report.tallied()[..=ABOVE];
    let sum: f64 = contents.iter().map(|bin| bin.value).sum();
    println!("below {:.4} nb, above {:.4} nb", contents[BELOW].value, contents[ABOVE].value);
    println!(
        "all bins {sum:.15} nb\nestimate {:.15} nb, {} of exactly {:.4}",
        report.value(),
        report.estimate(),
        exact.iter().sum::<f64>()
    );
    // Both are sums of the same 10 000 numbers, in another order.
    if (sum / report.value() - 1.0).abs() > 1e-13 {
        return Err("the bins do not add up to the estimate".into());
    }
    let mut chi_squared = 0.0;
    for (k, (bin, exact)) in contents.iter().zip(exact).enumerate() {
        let error = bin.standard_error.ok_or("a bin without an error")?;
        let z = (bin.value - exact) / error;
        if z.abs() > 5.0 || error > 0.2 * exact {
            return Err(format!("sum {k} is {} ± {error}, but {exact}", bin.value).into());
        }
        chi_squared += z * z;
    }
    let count = contents.len() as f64;
    println!("chi2 of the bins {chi_squared:.1}, for {count} bins");
    // Its mean is the number of bins. The bins share their samples, which correlates them a
    // little; that is no matter for a bound of about five standard deviations.
    let spread = (2.0 * count).sqrt();
    if (chi_squared - count).abs() > 5.0 * spread {
        return Err("the bins do not agree with their error bars".into());
    }
    let z = (report.value() - exact.iter().sum::<f64>())
        / report.standard_error().ok_or("no standard error")?;
    if z.abs() > 5.0 {
        return Err(format!("the estimate is off by {z} standard errors").into());
    }
    Ok(())
}

/// The mean of the mass, ∫ m f / ∫ f, a ratio R = A / B of two sums of the same samples.
///
/// To first order, the variance of A / B is (V[A] - 2 R C[A, B] + R² V[B]) / B². The covariance
/// comes from a third sum: 2 C[A, B] = V[A + B] - V[A] - V[B].
fn mean(report: &Report) -> Result<(), Box<dyn Error>> {
    let sum = |k: usize| -> Result<(f64, f64), Box<dyn Error>> {
        let tallied = report.tallied().get(k).ok_or("no such sum")?;
        Ok((tallied.value, tallied.standard_error.ok_or("no error")?.powi(2)))
    };
    let (a, var_a) = sum(MASS)?;
    let (_, var_ab) = sum(MASS_AND_ALL)?;
    let (b, var_b) = (report.value(), report.standard_error().ok_or("no error")?.powi(2));
    let ratio = a / b;
    let covariance = 0.5 * (var_ab - var_a - var_b);
    let error = (var_a - 2.0 * ratio * covariance + ratio * ratio * var_b).sqrt() / b;
    // The detector's error is 0 on average.
    let exact = integral(|mass| mass * spectrum(mass)) / integral(spectrum);
    let z = (ORIGIN + ratio - exact) / error;
    println!("mean mass {:.2} ± {error:.2} MeV, exactly {exact:.2}, z {z:.2}", ORIGIN + ratio);
    if z.is_nan() || z.abs() > 5.0 || error > 5.0 {
        return Err("the mean is wrong".into());
    }
    Ok(())
}

/// In the target folder of this crate.
fn default_file() -> PathBuf {
    let target = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target");
    if target.is_dir() { target.join("histogram.svg") } else { "histogram.svg".into() }
}

/// The histogram as a picture: estimate with error bars, exact contents as steps, and below it the
/// differences in standard errors.
fn svg(bins: &[Tallied], exact: &[f64]) -> String {
    let exact = &exact[..BINS];
    let most = exact.iter().fold(0.0, |a: f64, b| a.max(*b)) / WIDTH;
    // 0.05 nb / MeV and the like above the highest bin.
    let top = (most * 1.15 / 0.05).ceil() * 0.05;
    let x = |mass: f64| 80.0 + 600.0 * (mass - SHOWN[0]) / (SHOWN[1] - SHOWN[0]);
    let y = |content: f64| 360.0 - 320.0 * content / top;
    let pull = |z: f64| 430.0 - 10.0 * z.clamp(-4.0, 4.0);
    let mut out = String::from(HEAD);
    let mut draw = |text: String| out.push_str(&text);

    for k in (0..=BINS).step_by(5) {
        let (at, mass) = (x(edge(k)), edge(k));
        draw(format!("<path class='axis' d='M{at:.1} 360v5M{at:.1} 470v5'/>\n"));
        draw(format!("<text x='{at:.1}' y='490' text-anchor='middle'>{mass}</text>\n"));
    }
    let mut tick = 0.0;
    while tick <= top + 1e-9 {
        let at = y(tick);
        draw(format!("<path class='grid' d='M80 {at:.1}h600'/>\n"));
        draw(format!("<text x='72' y='{:.1}' text-anchor='end'>{tick:.2}</text>\n", at + 4.0));
        tick += 0.05;
    }
    for (z, label) in [(-3.0, "−3"), (0.0, "0"), (3.0, "3")] {
        let at = pull(z);
        draw(format!("<path class='grid' d='M80 {at:.1}h600'/>\n"));
        draw(format!("<text x='72' y='{:.1}' text-anchor='end'>{label}</text>\n", at + 4.0));
    }

    let mut steps = format!("M80 {:.1}", y(exact[0] / WIDTH));
    for (k, content) in exact.iter().enumerate() {
        let _ = write!(steps, "V{:.2}H{:.2}", y(content / WIDTH), x(edge(k + 1)));
    }
    draw(format!("<path class='exact' d='{steps}'/>\n"));
    for (k, (bin, exact)) in bins.iter().zip(exact).enumerate() {
        let at = x(edge(k) + 0.5 * WIDTH);
        let error = bin.standard_error.unwrap_or(0.0);
        let (low, high) = ((bin.value - error) / WIDTH, (bin.value + error) / WIDTH);
        draw(format!(
            "<path class='bar' d='M{at:.1} {:.2}V{:.2}'/><circle cx='{at:.1}' cy='{:.2}' r='2.4'/>\n",
            y(low),
            y(high),
            y(bin.value / WIDTH)
        ));
        let z = (bin.value - exact) / error;
        draw(format!("<circle cx='{at:.1}' cy='{:.2}' r='2.4'/>\n", pull(z)));
    }
    for line in &LINES {
        let at = x(line.mass);
        let content = exact[bin(line.mass)] / WIDTH;
        draw(format!(
            "<text x='{at:.1}' y='{:.1}' text-anchor='middle' font-size='16'>{}</text>\n",
            y(content) - 14.0,
            line.name
        ));
    }
    out.push_str(TAIL);
    out
}

const HEAD: &str = "\
<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 710 535' width='710' height='535' \
font-family='sans-serif' font-size='13'>
<style>
.axis, .bar, .exact, .grid { fill: none; stroke: #222 }
.grid { stroke: #ddd }
.exact { stroke: #c50; stroke-width: 1.4 }
.bar { stroke: #057; stroke-width: 1.4 }
circle { fill: #057 }
text { fill: #222 }
</style>
<rect width='710' height='535' fill='white'/>
<text x='380' y='24' text-anchor='middle' font-size='15'>Muon pairs near the ω and φ, detector \
resolution 10 MeV</text>
";

const TAIL: &str = "\
<path class='axis' d='M80 40V360H680V40ZM80 390V470H680V390Z'/>
<text x='380' y='518' text-anchor='middle'>reconstructed mass m / MeV</text>
<text transform='translate(22 200) rotate(-90)' text-anchor='middle'>dσ/dm / (nb/MeV)</text>
<text transform='translate(22 430) rotate(-90)' text-anchor='middle'>pull</text>
<path class='bar' d='M450 58v18'/><circle cx='450' cy='67' r='2.4'/>
<text x='472' y='71'>estimate ± standard error</text>
<path class='exact' d='M438 89h24'/>
<text x='472' y='93'>exact</text>
</svg>
";
