//! The checker finds every fault, names it and says how large it is; and it lets right techniques
//! pass.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod directions;
mod line;
mod points;
mod rates;

use mis::check::{self, Finding, Law, Options, Report, Verdict};
use mis::technique::{InverseCdf, Normal, Technique, Uniform, UniformBox, canonical};

/// A technique on the line, to be spoilt one function at a time.
#[derive(Clone, Copy)]
struct Faulty<T> {
    right: T,
    sample: fn(&T, f64) -> f64,
    inverse: fn(&T, f64) -> f64,
    pdf: fn(&T, f64) -> f64,
    ln_pdf: fn(&T, f64) -> f64,
    cdf: fn(&T, f64) -> f64,
    sample_batch: fn(&T, &[f64], &mut Vec<f64>),
    pdf_batch: fn(&T, &[f64], &mut [f64]),
}

impl<T: InverseCdf> Faulty<T> {
    fn of(right: T) -> Self {
        Self {
            right,
            sample: |p, u| p.sample(&[u]),
            inverse: T::inverse_cdf,
            pdf: |p, x| p.pdf(&x),
            ln_pdf: |p, x| p.ln_pdf(&x),
            cdf: T::cdf,
            sample_batch: T::sample_batch,
            pdf_batch: T::pdf_batch,
        }
    }

    fn report(&self) -> Report {
        check::inverse_cdf(self, &Options::default())
    }
}

impl<T: InverseCdf> Technique for Faulty<T> {
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        (self.sample)(&self.right, canonical(xi, 0))
    }

    fn pdf(&self, x: &f64) -> f64 {
        (self.pdf)(&self.right, *x)
    }

    fn ln_pdf(&self, x: &f64) -> f64 {
        (self.ln_pdf)(&self.right, *x)
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<f64>) {
        (self.sample_batch)(&self.right, xi, xs);
    }

    fn pdf_batch(&self, xs: &[f64], out: &mut [f64]) {
        (self.pdf_batch)(&self.right, xs, out);
    }
}

impl<T: InverseCdf> InverseCdf for Faulty<T> {
    fn cdf(&self, x: f64) -> f64 {
        (self.cdf)(&self.right, x)
    }

    fn inverse_cdf(&self, u: f64) -> f64 {
        (self.inverse)(&self.right, u)
    }
}

fn normal() -> Faulty<Normal> {
    Faulty::of(Normal::standard())
}

fn unit() -> Faulty<Uniform> {
    Faulty::of(Uniform::unit())
}

/// The laws that do not hold, and no other.
fn assert_broken(report: &Report, laws: &[Law]) {
    let broken: Vec<Law> = report.failures().map(Finding::law).collect();
    assert_eq!(broken, laws, "{report}");
    assert!(!report.passed());
    for law in laws {
        assert_eq!(report.get(*law).unwrap().verdict(), Verdict::Broken);
    }
}

/// The law is broken by about this much, and the detail says so.
fn assert_size(report: &Report, law: Law, size: f64, relative: f64, words: &str) {
    let finding = report.get(law).unwrap();
    assert!(!finding.passed(), "{report}");
    let miss = (finding.measured() / size - 1.0).abs();
    assert!(
        miss <= relative || finding.measured() == size,
        "{} for {size}\n{report}",
        finding.measured()
    );
    assert!(finding.detail().contains(words), "{words:?} is not in\n{report}");
}

/// The relative width that a detail reports, in per cent.
fn width(report: &Report, law: Law) -> f64 {
    let detail = report.get(law).unwrap().detail();
    let words = "the middle half of the samples is ";
    let number = detail.split(words).nth(1).and_then(|rest| rest.split(' ').next());
    number.unwrap_or_else(|| panic!("{report}")).parse().unwrap()
}

/// A point in the unit square, by a map of the unit square and a density.
struct Square {
    map: fn([f64; 2]) -> [f64; 2],
    pdf: fn(&[f64; 2]) -> f64,
}

impl Technique for Square {
    type Point = [f64; 2];

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> [f64; 2] {
        (self.map)([canonical(xi, 0), canonical(xi, 1)])
    }

    fn pdf(&self, x: &[f64; 2]) -> f64 {
        if x.iter().all(|x| (0.0..=1.0).contains(x)) { (self.pdf)(x) } else { 0.0 }
    }
}

fn square() -> UniformBox<2> {
    UniformBox::uniform([0.0, 0.0], [1.0, 1.0]).unwrap()
}
