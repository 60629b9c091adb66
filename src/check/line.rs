//! The laws of an [`InverseCdf`] that hold at single numbers.

use super::calls::Calls;
use super::options::Options;
use super::report::{Finding, Law, Tally};
use crate::technique::{InverseCdf, canonical};

/// A technique on the line, whose panics are caught.
pub(super) struct Line<'a> {
    pub(super) p: &'a dyn InverseCdf,
    pub(super) calls: &'a Calls,
    pub(super) options: &'a Options,
    /// The ends of the support.
    pub(super) a: f64,
    pub(super) b: f64,
}

/// Samples and the numbers that they are made of.
pub(super) struct Samples {
    pub(super) us: Vec<f64>,
    pub(super) xs: Vec<f64>,
}

/// The distance to the next larger number of the magnitude of `x`.
pub(super) fn ulp(x: f64) -> f64 {
    let x = x.abs().min(f64::MAX.next_down());
    x.next_up() - x
}

/// 2⁻⁵² max(1, |ln p|), finite.
pub(super) fn unit_of(ln_pdf: f64) -> f64 {
    f64::EPSILON * if ln_pdf.is_finite() { ln_pdf.abs().max(1.0) } else { 1.0 }
}

impl<'a> Line<'a> {
    pub(super) fn new(p: &'a dyn InverseCdf, calls: &'a Calls, options: &'a Options) -> Self {
        let ends = calls.try_call(|| "support()".into(), || p.support());
        let (a, b) = ends.unwrap_or((f64::NAN, f64::NAN));
        Self { p, calls, options, a, b }
    }

    pub(super) fn pdf(&self, x: f64) -> f64 {
        self.calls.number("pdf", x, |x| self.p.pdf(&x))
    }

    pub(super) fn ln_pdf(&self, x: f64) -> f64 {
        self.calls.number("ln_pdf", x, |x| self.p.ln_pdf(&x))
    }

    pub(super) fn cdf(&self, x: f64) -> f64 {
        self.calls.number("cdf", x, |x| self.p.cdf(x))
    }

    pub(super) fn survival(&self, x: f64) -> f64 {
        self.calls.number("survival", x, |x| self.p.survival(x))
    }

    pub(super) fn inverse_cdf(&self, u: f64) -> f64 {
        self.calls.number("inverse_cdf", u, |u| self.p.inverse_cdf(u))
    }

    pub(super) fn inverse_survival(&self, v: f64) -> f64 {
        self.calls.number("inverse_survival", v, |v| self.p.inverse_survival(v))
    }

    pub(super) fn sample(&self, u: f64) -> f64 {
        self.calls.number("sample", u, |u| self.p.sample(&[u]))
    }

    pub(super) fn sample_all(&self, us: Vec<f64>) -> Samples {
        let xs = self.calls.numbers("sample", &us, |u| self.p.sample(&[u]));
        Samples { us, xs }
    }

    fn inside(&self, x: f64) -> bool {
        self.a <= x && x <= self.b
    }

    /// The change of the CDF over the spacing of f64 at `x`: no inverse can do better.
    pub(super) fn grain(&self, x: f64) -> f64 {
        let pdf = |x: f64| self.pdf(x.max(self.a).min(self.b));
        ulp(x) * pdf(x).max(pdf(x.next_up())).max(pdf(x.next_down()))
    }

    /// All laws that need no integral; `us` are random numbers in the unit interval, and
    /// of `many` samples only support and density are looked at.
    pub(super) fn laws(&self, us: &[f64], many: &Samples) -> Vec<Finding> {
        let mut findings = vec![self.ends()];
        findings.extend(self.round_trip(us));
        findings.push(self.tails());
        findings.push(self.monotone(us));
        findings.extend(self.samples(us, many));
        findings.push(self.batches(us));
        findings
    }

    fn ends(&self) -> Finding {
        let (a, b) = (self.a, self.b);
        let mut tally = Tally::new(Law::Ends);
        tally.holds(a < b, || format!("support() = ({a:?}, {b:?})"));
        let mut equal = |name: &str, x: f64, value: f64, expected: f64| {
            tally.holds(value == expected, || {
                format!("{name}({x:?}) = {value:?}, not {expected:?}")
            });
        };
        for (u, end, other) in [(0.0, a, b), (1.0, b, a)] {
            equal("inverse_cdf", u, self.inverse_cdf(u), end);
            equal("inverse_survival", u, self.inverse_survival(u), other);
        }
        for (x, mass) in [
            (a, 0.0),
            (b, 1.0),
            (a.next_down(), 0.0),
            (f64::NEG_INFINITY, 0.0),
            (b.next_up(), 1.0),
            (f64::INFINITY, 1.0),
        ] {
            equal("cdf", x, self.cdf(x), mass);
            equal("survival", x, self.survival(x), 1.0 - mass);
        }
        for x in [a.next_down(), f64::NEG_INFINITY, b.next_up(), f64::INFINITY] {
            equal("pdf", x, self.pdf(x), 0.0);
            equal("ln_pdf", x, self.ln_pdf(x), f64::NEG_INFINITY);
        }
        for u in [-5e-324, -1.0, 1.0 + f64::EPSILON, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            let (x, y) = (self.inverse_cdf(u), self.inverse_survival(u));
            tally.holds(x.is_nan(), || format!("inverse_cdf({u:?}) = {x:?}, not NaN"));
            tally.holds(y.is_nan(), || format!("inverse_survival({u:?}) = {y:?}, not NaN"));
        }
        // No panic, and not a density.
        let (pdf, ln_pdf) = (self.pdf(f64::NAN), self.ln_pdf(f64::NAN));
        tally.holds(pdf.is_nan() || pdf == 0.0, || format!("pdf(NaN) = {pdf:?}"));
        tally.holds(ln_pdf.is_nan() || ln_pdf == f64::NEG_INFINITY, || {
            format!("ln_pdf(NaN) = {ln_pdf:?}")
        });
        let _ = (self.cdf(f64::NAN), self.survival(f64::NAN), self.sample(f64::NAN));
        let _ = self.calls.try_call(|| "sample of no number".into(), || self.p.sample(&[]));
        tally.finding()
    }

    fn round_trip(&self, us: &[f64]) -> [Finding; 2] {
        let options = self.options;
        let mut trip = Tally::new(Law::RoundTrip);
        let mut sum = Tally::new(Law::Survival);
        let grid = (1..1024).map(|k| f64::from(k) / 1024.0);
        for u in grid.chain(us.iter().copied()) {
            if u < options.tail_from || 1.0 - u < options.tail_from {
                continue;
            }
            let bound = options.round_trip * ulp(u.max(1.0 - u));
            let x = self.inverse_cdf(u);
            let (below, above) = (self.cdf(x), self.survival(x));
            let miss = if self.inside(x) { (below - u).abs() } else { f64::NAN };
            trip.limit(miss, bound + self.grain(x), || {
                format!("cdf(inverse_cdf({u:?})) = {below:?}, x = {x:?}")
            });
            let miss = (below + above - 1.0).abs();
            sum.limit(miss, options.round_trip * f64::EPSILON, || {
                format!("cdf({x:?}) + survival({x:?}) = {:?}", below + above)
            });
            let x = self.inverse_survival(u);
            let above = self.survival(x);
            let miss = if self.inside(x) { (above - u).abs() } else { f64::NAN };
            trip.limit(miss, bound + self.grain(x), || {
                format!("survival(inverse_survival({u:?})) = {above:?}, x = {x:?}")
            });
        }
        [trip.finding(), sum.finding()]
    }

    fn tails(&self) -> Finding {
        let options = self.options;
        let mut tally = Tally::new(Law::Tails);
        let exponents = [3.0, 3.7, 5.0, 8.3, 12.0, 17.1, 25.0, 40.0, 80.0, 150.0, 230.5, 300.0];
        for v in exponents.map(|e: f64| 10f64.powf(-e)) {
            if v < options.tail_from {
                continue;
            }
            let x = self.inverse_cdf(v);
            let mass = self.cdf(x);
            tally.limit((mass - v).abs() / v, options.tail + self.grain(x) / v, || {
                format!("cdf(inverse_cdf({v:e})) = {mass:e}, x = {x:?}")
            });
            let x = self.inverse_survival(v);
            let mass = self.survival(x);
            tally.limit((mass - v).abs() / v, options.tail + self.grain(x) / v, || {
                format!("survival(inverse_survival({v:e})) = {mass:e}, x = {x:?}")
            });
        }
        tally.finding()
    }

    /// To rounding: neighbouring numbers may swap by the error of the round trip.
    fn monotone(&self, us: &[f64]) -> Finding {
        let mut tally = Tally::new(Law::Monotone);
        let mut sorted = us.to_vec();
        sorted.extend((1..=53).map(|k| 2f64.powi(-k)));
        sorted.extend((1..=53).map(|k| 1.0 - 2f64.powi(-k)));
        sorted.sort_by(f64::total_cmp);
        let at = |u: f64| {
            let x = self.inverse_cdf(u);
            (u, x, self.cdf(x), self.survival(x))
        };
        let points: Vec<_> = sorted.into_iter().map(at).collect();
        for pair in points.windows(2) {
            let [(u, x, below_x, above_x), (v, y, below_y, above_y)] = [pair[0], pair[1]];
            let step = if x <= y { 0.0 } else { f64::INFINITY };
            tally.limit(step, 0.0, || {
                format!("inverse_cdf({u:?}) = {x:?}, inverse_cdf({v:?}) = {y:?}")
            });
            let slack = self.options.round_trip * ulp(below_x);
            tally.limit(below_x - below_y, slack, || {
                format!("cdf({x:?}) = {below_x:?}, cdf({y:?}) = {below_y:?}")
            });
            let slack = self.options.round_trip * ulp(above_x);
            tally.limit(above_y - above_x, slack, || {
                format!("survival({x:?}) = {above_x:?}, survival({y:?}) = {above_y:?}")
            });
        }
        // Steps in the right direction are no violation of negative size.
        let mut finding = tally.finding();
        finding.measured = finding.measured.max(0.0);
        finding
    }

    fn samples(&self, us: &[f64], many: &Samples) -> [Finding; 4] {
        let mut inverse = Tally::new(Law::SampleIsInverse);
        let mut support = Tally::new(Law::SampleSupport);
        let mut density = Tally::new(Law::SampleDensity);
        let mut logarithm = Tally::new(Law::LnPdf);
        let edges = [0.0, 2f64.powi(-54), 0.5, 1.0 - 2f64.powi(-53), 1.0];
        let mut look = |u: f64, x: f64, pdf: f64| {
            support.holds(x.is_finite() && self.inside(x), || {
                format!("sample({u:?}) = {x:?} outside [{:?}, {:?}]", self.a, self.b)
            });
            density.holds(pdf.is_finite() && pdf > 0.0, || {
                format!("pdf(sample({u:?})) = {pdf:?}, x = {x:?}")
            });
        };
        for &u in edges.iter().chain(us) {
            let x = self.sample(u);
            let pdf = self.pdf(x);
            look(u, x, pdf);
            let exact = self.inverse_cdf(canonical(&[u], 0));
            let miss = if x == exact { 0.0 } else { (x - exact).abs() };
            inverse
                .limit(miss, 0.0, || format!("sample({u:?}) = {x:?}, inverse_cdf of it {exact:?}"));
            let ln_pdf = self.ln_pdf(x);
            let bound = self.options.ln_pdf * unit_of(ln_pdf);
            let miss = (ln_pdf - pdf.ln()).abs();
            let miss = if pdf.is_subnormal() && ln_pdf.is_finite() { 0.0 } else { miss };
            logarithm.limit(miss, bound, || {
                format!("ln_pdf({x:?}) = {ln_pdf:?}, ln of the pdf {:?}", pdf.ln())
            });
        }
        let pdfs = self.calls.numbers("pdf", &many.xs, |x| self.p.pdf(&x));
        for ((&u, &x), pdf) in many.us.iter().zip(&many.xs).zip(pdfs) {
            look(u, x, pdf);
        }
        [inverse.finding(), support.finding(), density.finding(), logarithm.finding()]
    }

    fn batches(&self, us: &[f64]) -> Finding {
        let mut tally = Tally::new(Law::Batch);
        for held in [0, us.len() / 2, us.len() + 3] {
            let mut xs = vec![7.0; held];
            let what = || format!("sample_batch of {} into {held} points", us.len());
            let Some(()) = self.calls.try_call(what, || self.p.sample_batch(us, &mut xs)) else {
                continue;
            };
            tally.holds(xs.len() >= us.len(), || {
                format!("sample_batch made {} points of {}", xs.len(), us.len())
            });
            xs.truncate(us.len());
            let mut pdfs = vec![f64::NAN; xs.len()];
            let what = || format!("pdf_batch of {} points", xs.len());
            if self.calls.try_call(what, || self.p.pdf_batch(&xs, &mut pdfs)).is_none() {
                continue;
            }
            for ((&u, &x), pdf) in us.iter().zip(&xs).zip(&pdfs) {
                let (one, pdf_one) = (self.sample(u), self.pdf(x));
                tally.holds(x.to_bits() == one.to_bits(), || {
                    format!("sample_batch gives {x:?} at ξ = {u:?}, sample {one:?}")
                });
                tally.holds(pdf.to_bits() == pdf_one.to_bits(), || {
                    format!("pdf_batch gives {pdf:?} at {x:?}, pdf {pdf_one:?}")
                });
            }
        }
        tally.finding()
    }
}
