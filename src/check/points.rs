//! The laws of any [`Technique`] that hold at single points.

use std::fmt::Debug;
use std::panic::{AssertUnwindSafe, catch_unwind};

use super::calls::Calls;
use super::line::unit_of;
use super::options::Options;
use super::report::{Finding, Law, Tally};
use crate::points::{PointSource, Random};
use crate::technique::Technique;

/// More numbers for one sample are taken for a mistake.
const MOST: usize = 1 << 24;

/// How many rows of random numbers are held at a time.
const BLOCK: usize = 256;

/// How many samples the laws at single points look at.
const ROWS: usize = 2000;

/// There are fewer of them where they would use more numbers than this.
const NUMBERS: usize = 500_000;

/// How many of them are compared as text, too.
const WORDY: usize = 64;

/// How many coordinates are moved to the edges of the unit interval one by one.
const EDGED: usize = 16;

/// Streams of random numbers, one for each purpose.
#[derive(Debug, Clone, Copy)]
pub(super) enum Stream {
    Laws,
    Pilot,
    ReferencePilot,
    Samples,
    Reference,
}

/// A technique with a reference and coordinates of its points; panics are caught.
pub(super) struct Points<'a, P> {
    pub(super) p: &'a dyn Technique<Point = P>,
    pub(super) reference: &'a dyn Technique<Point = P>,
    /// Appends the coordinates of a point.
    pub(super) map: &'a dyn Fn(&P, &mut Vec<f64>),
    pub(super) calls: &'a Calls,
    pub(super) options: &'a Options,
}

/// The first violations of what samples have to keep, collected on the way.
pub(super) struct Tallies {
    pub(super) dimension: Tally,
    pub(super) density: Tally,
    pub(super) anywhere: Tally,
    pub(super) reference: Tally,
}

impl<'a, P: Debug> Points<'a, P> {
    /// The number of canonical numbers that a sample uses, if there is a sensible one.
    pub(super) fn dimension(
        &self,
        technique: &'a dyn Technique<Point = P>,
        tally: &mut Tally,
    ) -> Option<usize> {
        let dimension = self.calls.try_call(|| "dimension()".into(), || technique.dimension())?;
        let sensible = (1..=MOST).contains(&dimension);
        tally.holds(sensible, || format!("dimension() = {dimension}"));
        sensible.then_some(dimension)
    }

    /// Calls `visit` with `n` rows of random numbers.
    pub(super) fn rows(
        &self,
        stream: Stream,
        n: usize,
        dimension: usize,
        mut visit: impl FnMut(&[f64]),
    ) {
        let random = Random::new(self.options.seed);
        let mut first = 0;
        while first < n && !self.calls.given_up() {
            let mut xi = vec![0.5; dimension * BLOCK.min(n - first)];
            // Random numbers do not run out.
            let _ = random.fill(stream as usize, first as u64, dimension, &mut xi);
            xi.chunks_exact(dimension).for_each(&mut visit);
            first += BLOCK;
        }
    }

    /// What `f` returns, which calls the methods below for the row `xi`; nothing if one panics.
    pub(super) fn row<T>(&self, xi: &[f64], f: impl FnOnce() -> T) -> Option<T> {
        self.calls.try_call(|| format!("{} at ξ = {}", self.calls.name(), few(xi)), f)
    }

    pub(super) fn sample(&self, technique: &dyn Technique<Point = P>, xi: &[f64]) -> P {
        self.calls.enter("sample");
        technique.sample(xi)
    }

    /// A density and its logarithm; the latter only if the former left the range of `f64`.
    pub(super) fn density(&self, technique: &dyn Technique<Point = P>, x: &P) -> (f64, f64) {
        self.calls.enter("pdf");
        let pdf = technique.pdf(x);
        let ln = if pdf.is_normal() { f64::NAN } else { self.ln_pdf(technique, x) };
        (pdf, ln)
    }

    pub(super) fn ln_pdf(&self, technique: &dyn Technique<Point = P>, x: &P) -> f64 {
        self.calls.enter("ln_pdf");
        technique.ln_pdf(x)
    }

    /// Makes `to` the coordinates of `x`.
    pub(super) fn coordinates(&self, x: &P, to: &mut Vec<f64>) {
        self.calls.enter("coordinates");
        to.clear();
        (self.map)(x, to);
    }

    /// Whether two points are the same: coordinates to the bit, and what is printed.
    fn same(&self, x: &P, y: &P, wordy: bool) -> bool {
        let (mut c, mut d) = (Vec::new(), Vec::new());
        self.coordinates(x, &mut c);
        self.coordinates(y, &mut d);
        let bits = |v: &[f64]| v.iter().map(|c| c.to_bits()).collect::<Vec<u64>>();
        bits(&c) == bits(&d) && (!wordy || text(x) == text(y))
    }

    /// All laws that need no integral.
    pub(super) fn laws(&self, dimension: usize, tallies: &mut Tallies) -> [Finding; 3] {
        let mut xis = Vec::new();
        let rows = (NUMBERS / dimension).clamp(ROWS / 20, ROWS);
        self.rows(Stream::Laws, rows, dimension, |xi| xis.extend_from_slice(xi));
        let edges = [0.0, 2f64.powi(-54), 0.5, 1.0 - 2f64.powi(-53), 1.0];
        for edge in edges {
            xis.extend(std::iter::repeat_n(edge, dimension));
            for d in 0..dimension.min(EDGED) {
                xis.extend((0..dimension).map(|e| if d == e { edge } else { 0.375 }));
            }
        }
        let mut pure = Tally::new(Law::Pure);
        let mut logarithm = Tally::new(Law::LnPdf);
        let beginning = vec![0.625; dimension];
        let mut over = self.row(&beginning, || self.sample(self.p, &beginning));
        let mut c = Vec::new();
        for (k, xi) in xis.chunks_exact(dimension).enumerate() {
            self.row(xi, || {
                let x = self.sample(self.p, xi);
                self.coordinates(&x, &mut c);
                tallies.dimension.holds(!c.is_empty() && c.iter().all(|c| c.is_finite()), || {
                    format!("sample({}) = {} has coordinates {c:?}", few(xi), text(&x))
                });
                let pdf = self.density(self.p, &x).0;
                let ln_pdf = self.ln_pdf(self.p, &x);
                // A density below the range of f64 is known by its logarithm.
                let positive = pdf > 0.0 || (pdf == 0.0 && ln_pdf.is_finite() && ln_pdf < -700.0);
                tallies.density.holds(pdf.is_finite() && positive, || {
                    format!("pdf(sample({})) = {pdf:?}, x = {}", few(xi), text(&x))
                });
                let units = self.options.ln_pdf * c.len().max(1) as f64;
                let miss = (ln_pdf - pdf.ln()).abs();
                let known = !pdf.is_normal() && pdf >= 0.0 && ln_pdf.is_finite();
                logarithm.limit(if known { 0.0 } else { miss }, units * unit_of(ln_pdf), || {
                    format!("ln_pdf = {ln_pdf:?}, ln of the pdf {:?} at {}", pdf.ln(), text(&x))
                });
                let again = self.sample(self.p, xi);
                pure.holds(self.same(&again, &x, k < WORDY), || {
                    format!("sample({}) = {} and then {}", few(xi), text(&x), text(&again))
                });
                if let Some(over) = &mut over {
                    self.calls.enter("sample_into");
                    self.p.sample_into(xi, over);
                    pure.holds(self.same(over, &x, k < WORDY), || {
                        format!("sample({}) = {}, sample_into {}", few(xi), text(&x), text(over))
                    });
                }
            });
        }
        [pure.finding(), logarithm.finding(), self.batches(&xis, dimension)]
    }

    fn batches(&self, xis: &[f64], dimension: usize) -> Finding {
        let mut tally = Tally::new(Law::Batch);
        let rows = xis.len() / dimension;
        for held in [0, rows / 2, rows + 3] {
            let made = self.row(xis, || {
                // Points of other rows, to be written over.
                let others = xis.chunks_exact(dimension).rev().cycle().take(held);
                let mut xs: Vec<P> = others.map(|xi| self.sample(self.p, xi)).collect();
                self.calls.enter("sample_batch");
                self.p.sample_batch(xis, &mut xs);
                tally.holds(xs.len() >= rows, || {
                    format!("sample_batch made {} points of {rows}", xs.len())
                });
                xs.truncate(rows);
                let mut pdfs = vec![f64::NAN; xs.len()];
                self.calls.enter("pdf_batch");
                self.p.pdf_batch(&xs, &mut pdfs);
                (xs, pdfs)
            });
            let Some((xs, pdfs)) = made else { continue };
            for (k, ((xi, x), pdf)) in xis.chunks_exact(dimension).zip(&xs).zip(&pdfs).enumerate() {
                self.row(xi, || {
                    let one = self.sample(self.p, xi);
                    tally.holds(self.same(x, &one, k < WORDY), || {
                        format!("sample_batch gives {}, sample {}", text(x), text(&one))
                    });
                    let pdf_one = self.density(self.p, x).0;
                    tally.holds(pdf.to_bits() == pdf_one.to_bits(), || {
                        format!("pdf_batch gives {pdf:?} at {}, pdf {pdf_one:?}", text(x))
                    });
                });
            }
        }
        tally.finding()
    }
}

/// A point as `Debug` prints it, cut after 100 characters.
pub(super) fn text(x: &impl Debug) -> String {
    let print = AssertUnwindSafe(|| format!("{x:?}"));
    let mut text = catch_unwind(print).unwrap_or_else(|_| "(Debug panics)".into());
    if let Some((end, _)) = text.char_indices().nth(100) {
        text.truncate(end);
        text.push('…');
    }
    text
}

/// The first of some numbers.
fn few(xi: &[f64]) -> String {
    text(&xi.get(..xi.len().min(4)).unwrap_or_default())
}
