//! The slides' three tables: what they print, and the same rows from the estimators.

use std::error::Error;
use std::f64::consts::FRAC_PI_2;

use mis::points::Replay;
use mis::technique::FnTechnique;
use mis::{ArgumentError, Estimator, InverseCdf, MultiSample, Technique};

/// The slides' six canonical numbers, to the digits that they print.
pub(crate) const XI: [f64; 6] = [0.996, 0.573, 0.587, 0.140, 0.758, 0.525];

/// A table as the slides print it.
pub(crate) struct Printed {
    pub(crate) title: &'static str,
    pub(crate) columns: &'static [&'static str],
    pub(crate) rows: [&'static [f64]; 6],
    pub(crate) estimate: f64,
}

pub(crate) const PRINTED: [Printed; 3] = [
    Printed {
        title: "p(x) = sin x, six samples",
        columns: &["x", "f", "p", "f/p"],
        rows: [
            &[1.566, 0.004, 0.999, 0.004],
            &[1.130, 0.386, 0.904, 0.427],
            &[1.145, 0.376, 0.911, 0.413],
            &[0.535, 0.439, 0.510, 0.860],
            &[1.326, 0.235, 0.970, 0.242],
            &[1.076, 0.418, 0.880, 0.475],
        ],
        estimate: 0.404,
    },
    Printed {
        title: "p(x) = cos x, six samples",
        columns: &["x", "f", "p", "f/p"],
        rows: [
            &[1.478, 0.093, 0.093, 0.996],
            &[0.610, 0.470, 0.819, 0.573],
            &[0.628, 0.475, 0.809, 0.587],
            &[0.140, 0.138, 0.990, 0.140],
            &[0.860, 0.494, 0.652, 0.758],
            &[0.553, 0.447, 0.851, 0.525],
        ],
        estimate: 0.596,
    },
    Printed {
        title: "balance heuristic, three samples of p1 = cos x, three of p2 = sin x",
        columns: &["x", "f", "p1", "p2", "3p1 + 3p2", "f/sum"],
        rows: [
            &[1.481, 0.089, 0.090, 0.996, 3.256, 0.027],
            &[0.610, 0.470, 0.820, 0.573, 4.178, 0.112],
            &[0.627, 0.475, 0.810, 0.587, 4.190, 0.113],
            &[0.535, 0.439, 0.860, 0.510, 4.111, 0.107],
            &[1.326, 0.235, 0.242, 0.970, 3.637, 0.065],
            &[1.076, 0.418, 0.475, 0.880, 4.065, 0.103],
        ],
        estimate: 0.527,
    },
];

/// f(x) = sin x cos x.
pub(crate) fn f(x: &f64) -> f64 {
    x.sin() * x.cos()
}

/// p(x) = cos x on [0, π/2], P(x) = sin x.
pub(crate) fn cosine() -> Result<impl InverseCdf, ArgumentError> {
    FnTechnique::new([0.0, FRAC_PI_2], f64::cos, f64::sin, f64::asin)
}

/// p(x) = sin x on [0, π/2], P(x) = 1 - cos x.
///
/// The slides invert it as acos(1 - ξ), which is the same number but for its rounding: 1 - ξ loses
/// the digits of a small ξ.
pub(crate) fn sine() -> Result<impl InverseCdf, ArgumentError> {
    let cdf = |x: f64| 2.0 * (0.5 * x).sin().powi(2);
    let inverse_cdf = |u: f64| 2.0 * (0.5 * u).sqrt().asin();
    FnTechnique::new([0.0, FRAC_PI_2], f64::sin, cdf, inverse_cdf)
}

/// A table's rows, and the estimate below them.
pub(crate) type Table = (Vec<Vec<f64>>, f64);

/// Table 0, 1 or 2, from these canonical numbers.
pub(crate) fn table(number: usize, xi: &[f64; 6]) -> Result<Table, Box<dyn Error>> {
    let (cosine, sine) = (cosine()?, sine()?);
    let mut rows = Vec::new();
    let estimate = if number == 2 {
        let points = Replay::new([xi[..3].to_vec(), xi[3..].to_vec()])?;
        let mis = MultiSample::new(&[(&cosine, 3), (&sine, 3)])?;
        mis.inspect(&f, &points, |sample| {
            let x = sample.x();
            let (p1, p2) = (cosine.pdf(x), sine.pdf(x));
            let c = 3.0 * p1 + 3.0 * p2;
            rows.push(vec![*x, *sample.value(), p1, p2, c, sample.contribution() / 6.0]);
        })?
    } else {
        let p: &dyn Technique<Point = f64> = if number == 0 { &sine } else { &cosine };
        let points = Replay::new([xi.to_vec()])?;
        MultiSample::new(&[(p, 6)])?.inspect(&f, &points, |sample| {
            let ratio = sample.contribution(); // f / p
            rows.push(vec![*sample.x(), *sample.value(), p.pdf(sample.x()), ratio]);
        })?
    };
    Ok((rows, estimate.value()))
}
