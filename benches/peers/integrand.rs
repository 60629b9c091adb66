//! The suite and its integrands; see the table of kinds in README.md.

use std::f64::consts::{PI, TAU};

/// The largest dimension in the suite.
pub const LARGEST: usize = 8;

/// An integrand of the suite, on the unit cube.
#[derive(Debug, Clone)]
pub struct Integrand {
    pub name: String,
    pub d: usize,
    pub shape: Shape,
}

/// The formula of an integrand. Arrays hold a number for each coordinate.
#[derive(Debug, Clone)]
pub enum Shape {
    /// b sin(b x) cos(b x).
    SinCos { b: f64 },
    /// cos(shift + Σ a x).
    Oscillatory { a: [f64; LARGEST], shift: f64 },
    /// Π 1 / (c + (x - u)²).
    ProductPeak { c: [f64; LARGEST], u: [f64; LARGEST] },
    /// exp(-Σ c (x - u)²).
    Gaussian { c: [f64; LARGEST], u: [f64; LARGEST] },
    /// exp(-Σ a |x - u|).
    C0 { a: [f64; LARGEST], u: [f64; LARGEST] },
    /// Σ factor exp(rate |x - centre (1, ..., 1)|²).
    Peaks(Vec<Peak>),
    /// factor exp(rate |x - centre|²) where |x - disk|² < r2, else 0.
    LobeAndDisk(LobeAndDisk),
}

#[derive(Debug, Clone, Copy)]
pub struct Peak {
    pub centre: f64,
    pub sd: f64,
    pub factor: f64,
    pub rate: f64,
}

#[derive(Debug, Clone, Copy)]
pub struct LobeAndDisk {
    pub sd: f64,
    pub radius: f64,
    pub centre: [f64; 2],
    pub disk: [f64; 2],
    pub factor: f64,
    pub rate: f64,
    pub r2: f64,
}

/// The integrands of a suite: a line each, of name, kind, d, number of parameters, parameters.
///
/// # Errors
///
/// The file cannot be read or does not have that form.
pub fn read(path: &str) -> Result<Vec<Integrand>, Box<dyn std::error::Error>> {
    let text = std::fs::read_to_string(path)?;
    text.lines()
        .map(|line| parse(line).ok_or_else(|| format!("not understood: {line}").into()))
        .collect()
}

fn parse(line: &str) -> Option<Integrand> {
    let mut words = line.split_whitespace();
    let name = words.next()?.to_string();
    let kind: u32 = words.next()?.parse().ok()?;
    let d: usize = words.next()?.parse().ok()?;
    let p: Vec<f64> = words.skip(1).map(str::parse).collect::<Result<_, _>>().ok()?;
    let padded = |from: usize| {
        let mut array = [0.0; LARGEST];
        array.get_mut(..d)?.copy_from_slice(p.get(from..from + d)?);
        Some(array)
    };
    let shape = match (kind, p.as_slice()) {
        (0, &[b]) => Shape::SinCos { b },
        (1, _) => Shape::Oscillatory { a: padded(0)?, shift: TAU * p.get(d)? },
        (2, _) => Shape::ProductPeak { c: padded(0)?.map(|a| (a * a).recip()), u: padded(d)? },
        (4, _) => Shape::Gaussian { c: padded(0)?.map(|a| a * a), u: padded(d)? },
        (5, _) => Shape::C0 { a: padded(0)?, u: padded(d)? },
        (7, [_, peaks @ ..]) => Shape::Peaks(peaks.chunks_exact(3).map(|p| peak(d, p)).collect()),
        (9, &[sd, radius, x1, y1, x2, y2]) => {
            let r2 = radius * radius;
            let factor = 1.0 / (TAU * sd * sd * PI * r2);
            let (centre, disk, rate) = ([x1, y1], [x2, y2], -0.5 / (sd * sd));
            Shape::LobeAndDisk(LobeAndDisk { sd, radius, centre, disk, factor, rate, r2 })
        }
        _ => return None,
    };
    Some(Integrand { name, d, shape })
}

/// The peak of weight, centre and standard deviation `p`.
fn peak(d: usize, p: &[f64]) -> Peak {
    let (weight, centre, sd) = (p[0], p[1], p[2]);
    let norm: f64 = (0..d).map(|_| TAU * sd * sd).product();
    let factor = weight / norm.sqrt();
    Peak { centre, sd, factor, rate: -0.5 / (sd * sd) }
}

impl Integrand {
    /// f(x).
    #[inline]
    pub fn eval(&self, x: &[f64]) -> f64 {
        match &self.shape {
            Shape::SinCos { b } => b * (b * x[0]).sin() * (b * x[0]).cos(),
            Shape::Oscillatory { a, shift } => {
                (shift + x.iter().zip(a).map(|(x, a)| a * x).sum::<f64>()).cos()
            }
            Shape::ProductPeak { c, u } => {
                let factors = x.iter().zip(c).zip(u).map(|((x, c), u)| c + (x - u) * (x - u));
                factors.product::<f64>().recip()
            }
            Shape::Gaussian { c, u } => {
                let terms = x.iter().zip(c).zip(u).map(|((x, c), u)| c * (x - u) * (x - u));
                (-terms.sum::<f64>()).exp()
            }
            Shape::C0 { a, u } => {
                let terms = x.iter().zip(a).zip(u).map(|((x, a), u)| a * (x - u).abs());
                (-terms.sum::<f64>()).exp()
            }
            Shape::Peaks(peaks) => {
                let term = |peak: &Peak| {
                    let squares = x.iter().map(|x| (x - peak.centre) * (x - peak.centre));
                    peak.factor * (peak.rate * squares.sum::<f64>()).exp()
                };
                peaks.iter().map(term).sum()
            }
            Shape::LobeAndDisk(LobeAndDisk { centre, disk, factor, rate, r2, .. }) => {
                let distance2 = |c: &[f64; 2]| (x[0] - c[0]).powi(2) + (x[1] - c[1]).powi(2);
                if distance2(disk) < *r2 { factor * (rate * distance2(centre)).exp() } else { 0.0 }
            }
        }
    }
}

/// Prints a line of results.
pub fn print(
    name: &str,
    method: &str,
    seed: u64,
    (value, error): (f64, f64),
    n: u64,
    seconds: f64,
) {
    println!("{name},{method},{seed},{value:e},{error:e},{n},{seconds:.9}");
}
