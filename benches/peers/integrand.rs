//! The suite, and its integrands for one point and for four at once; see the table of kinds in
//! README.md.

use std::f64::consts::{PI, TAU};
use std::ops::{Add, Mul, Sub};
use wide::f64x4;

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
    factor: f64,
    rate: f64,
}

#[derive(Debug, Clone, Copy)]
pub struct LobeAndDisk {
    pub sd: f64,
    pub radius: f64,
    pub centre: [f64; 2],
    pub disk: [f64; 2],
    factor: f64,
    rate: f64,
    r2: f64,
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
    let factor = weight * (TAU * sd * sd).powf(-0.5 * d as f64);
    Peak { centre, sd, factor, rate: -0.5 / (sd * sd) }
}

impl Integrand {
    /// f(x).
    #[inline]
    pub fn eval(&self, x: &[f64]) -> f64 {
        match &self.shape {
            Shape::SinCos { b } => b * (b * x[0]).sin() * (b * x[0]).cos(),
            Shape::Oscillatory { a, shift } => phase(x, a, *shift).cos(),
            Shape::ProductPeak { c, u } => denominator(x, c, u, 1.0).recip(),
            Shape::Gaussian { c, u } => (-weighted_square(x, c, u, 0.0)).exp(),
            Shape::C0 { a, u } => {
                let terms = x.iter().zip(a).zip(u).map(|((x, a), u)| a * (x - u).abs());
                (-terms.sum::<f64>()).exp()
            }
            Shape::Peaks(peaks) => {
                let term =
                    |peak: &Peak| peak.factor * (square(x, peak.centre, 0.0) * peak.rate).exp();
                peaks.iter().map(term).sum()
            }
            Shape::LobeAndDisk(LobeAndDisk { centre, disk, factor, rate, r2, .. }) => {
                let distance2 = |c: &[f64; 2]| (x[0] - c[0]).powi(2) + (x[1] - c[1]).powi(2);
                if distance2(disk) < *r2 { factor * (rate * distance2(centre)).exp() } else { 0.0 }
            }
        }
    }

    /// f of four points; a row of `x` is a coordinate.
    #[inline]
    pub fn eval4(&self, x: &[f64x4]) -> f64x4 {
        let zero = f64x4::splat(0.0);
        match &self.shape {
            Shape::SinCos { b } => {
                let (sin, cos) = (x[0] * *b).sin_cos();
                sin * cos * *b
            }
            Shape::Oscillatory { a, shift } => phase(x, a, f64x4::splat(*shift)).cos(),
            Shape::ProductPeak { c, u } => {
                f64x4::splat(1.0) / denominator(x, c, u, f64x4::splat(1.0))
            }
            Shape::Gaussian { c, u } => (zero - weighted_square(x, c, u, zero)).exp(),
            Shape::C0 { a, u } => {
                let terms = x.iter().zip(a).zip(u).map(|((x, a), u)| (*x - *u).abs() * *a);
                (zero - terms.fold(zero, |sum, term| sum + term)).exp()
            }
            Shape::Peaks(peaks) => peaks.iter().fold(zero, |sum, peak| {
                sum + (square(x, peak.centre, zero) * peak.rate).exp() * peak.factor
            }),
            Shape::LobeAndDisk(LobeAndDisk { centre, disk, factor, rate, r2, .. }) => {
                let distance2 = |c: &[f64; 2]| {
                    let (dx, dy) = (x[0] - c[0], x[1] - c[1]);
                    dx * dx + dy * dy
                };
                let factors =
                    distance2(disk).to_array().map(|d| if d < *r2 { *factor } else { 0.0 });
                if factors == [0.0; 4] {
                    return zero;
                }
                (distance2(centre) * *rate).exp() * f64x4::new(factors)
            }
        }
    }
}

/// A number or four of them.
trait Lanes:
    Copy
    + Add<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
{
}
impl Lanes for f64 {}
impl Lanes for f64x4 {}

/// `from` + Σ a x.
#[inline]
fn phase<T: Lanes>(x: &[T], a: &[f64], from: T) -> T {
    x.iter().zip(a).fold(from, |sum, (x, a)| sum + *x * *a)
}

/// Π (c + (x - u)²), times `from`.
#[inline]
fn denominator<T: Lanes>(x: &[T], c: &[f64], u: &[f64], from: T) -> T {
    x.iter().zip(c).zip(u).fold(from, |product, ((x, c), u)| {
        let dx = *x - *u;
        product * (dx * dx + *c)
    })
}

/// `from` + Σ c (x - u)².
#[inline]
fn weighted_square<T: Lanes>(x: &[T], c: &[f64], u: &[f64], from: T) -> T {
    x.iter().zip(c).zip(u).fold(from, |sum, ((x, c), u)| {
        let dx = *x - *u;
        sum + dx * dx * *c
    })
}

/// `from` + Σ (x - centre)².
#[inline]
fn square<T: Lanes>(x: &[T], centre: f64, from: T) -> T {
    x.iter().fold(from, |sum, x| {
        let dx = *x - centre;
        sum + dx * dx
    })
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
