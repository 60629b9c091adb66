//! The laws of any [`Technique`](crate::Technique) about integrals of its pdf.

use std::fmt::Debug;

use super::bins::{Binned, COARSE, Edges, Total, coarse, pairs};
use super::exact::Exact;
use super::histogram::{describe, interval, shape, unresolved};
use super::line_masses::too_much;
use super::points::{Points, Stream, Tallies, text};
use super::report::{Finding, Law, Tally, Verdict};
use super::statistics::{
    Fit, Weighted, estimated_masses, known_masses, kolmogorov_factor, largest_score,
};

/// How many samples of the reference there are for one of the technique.
const REFERENCE: usize = 4;
/// The reference's samples must be worth so many, and none may have a larger share.
const WORTH: f64 = 400.0;
const SHARE: f64 = 0.02;

impl<P: Debug> Points<'_, P> {
    /// ∫ p = 1, and the samples in bins and cells against it.
    pub(super) fn masses(&self, dimensions: [usize; 2], tallies: &mut Tallies) -> Vec<Finding> {
        let [dimension, inner] = dimensions;
        let n = self.options.samples;
        let pilot = (n / 10).clamp(1280, 20_000);
        let (mut values, mut weighted) = (Vec::new(), Vec::new());
        self.rows(Stream::Pilot, pilot, dimension, |xi| {
            let mut c = Vec::new();
            self.own(xi, &mut c, tallies);
            values.push((c, 0.5 / pilot as f64));
        });
        let Some(coordinates) = values.iter().map(|(c, _)| c.len()).find(|len| *len > 0) else {
            return vec![unresolved(Law::Integral, "no samples")];
        };
        self.rows(Stream::ReferencePilot, pilot, inner, |xi| {
            let mut c = Vec::new();
            let weight = self.other(xi, &mut c, tallies);
            weighted.push((c, weight));
        });
        let total: f64 = weighted.iter().map(|(_, w)| w).sum();
        values.extend(weighted.into_iter().map(|(c, w)| (c, 0.5 * w / total)));
        let edges: Vec<Edges> = (0..coordinates)
            .map(|d| {
                Edges::new(values.iter().filter_map(|(c, w)| Some((*c.get(d)?, *w))).collect())
            })
            .collect();

        let pairs = pairs(coordinates);
        let mut fill = |stream, n, dimension, own: bool| {
            let mut binned = Binned::new(&edges, &pairs);
            let (mut c, mut strange) = (Vec::new(), 0_u64);
            self.rows(stream, n, dimension, |xi| {
                let weight = if own {
                    self.own(xi, &mut c, tallies);
                    1.0
                } else {
                    self.other(xi, &mut c, tallies)
                };
                if c.len() == coordinates {
                    binned.push(&edges, &pairs, &c, weight);
                } else {
                    strange += 1;
                }
            });
            tallies.dimension.holds(strange == 0, || {
                format!("{strange} points do not have {coordinates} coordinates")
            });
            binned
        };
        let own = fill(Stream::Samples, n, dimension, true);
        let other = fill(Stream::Reference, n.saturating_mul(REFERENCE), inner, false);

        let exact = self.exact(&edges, &pairs, inner, &other.total);
        let mut findings = vec![self.integral(&exact, &other.total, coordinates, &pairs)];
        let worth = suffices(&other.total);
        let level = self.options.level(1 + 2 * coordinates + pairs.len());
        let mut lacking = findings[0].verdict == Verdict::Unresolved;
        for (d, edges) in edges.iter().enumerate() {
            let (chi, ks) = (Law::ChiSquared(d), Law::Kolmogorov(d));
            let masses = exact.marginals[d].as_deref();
            if masses.is_none() && !worth {
                lacking = true;
                findings.extend([chi, ks].map(|law| unresolved(law, "the reference is too poor")));
                continue;
            }
            findings.extend(marginal(
                chi,
                ks,
                edges,
                &own.marginals[d],
                &other.marginals[d],
                masses,
                level,
            ));
        }
        for (k, &(d, e)) in pairs.iter().enumerate() {
            let law = Law::JointChiSquared(d, e);
            let (cells, masses) = (edges[e].joint.len() + 1, exact.joints[k].as_deref());
            if masses.is_none() && !worth {
                findings.push(unresolved(law, "the reference is too poor"));
                continue;
            }
            let fit = fit(&own.joints[k].count, &other.joints[k], masses);
            findings.push(describe(law, fit, level, |bins| {
                let cell = |edges: &Edges, k: usize| interval(&framed(&edges.joint), &(k..k + 1));
                let (i, j) = (bins.start / cells, bins.start % cells);
                let more = bins.len() - 1;
                let and = if more > 0 { format!(" and {more} more") } else { String::new() };
                format!("{} × {}{and}", cell(&edges[d], i), cell(&edges[e], j))
            }));
        }
        if lacking {
            let (worth, count) = (other.total.effective(), other.total.count);
            let why = format!(
                "its {count} samples are worth {worth:.1}, the largest is {:.1} % of the integral; \
                 take a reference that is nearer to the technique",
                100.0 * other.total.share()
            );
            let mut finding = unresolved(Law::Reference, &why);
            (finding.measured, finding.allowed) = (other.total.share(), SHARE);
            findings.push(finding);
        }
        findings
    }

    /// The coordinates of a sample of the technique.
    fn own(&self, xi: &[f64], c: &mut Vec<f64>, tallies: &mut Tallies) {
        c.clear();
        self.row(xi, || {
            let x = self.sample(self.p, xi);
            self.coordinates(&x, c);
            let (pdf, ln_pdf) = self.density(self.p, &x);
            let positive = pdf > 0.0 || (pdf == 0.0 && ln_pdf.is_finite());
            tallies.density.holds(pdf.is_finite() && positive, || {
                format!("pdf(sample({})) = {pdf:?}, x = {}", text(&xi), text(&x))
            });
            let (pdf, ln_pdf) = self.density(self.reference, &x);
            tallies.reference.holds(pdf > 0.0 || ln_pdf > f64::NEG_INFINITY, || {
                format!("the reference has the density {pdf:?} at the sample {}", text(&x))
            });
        });
    }

    /// The coordinates of a sample of the reference, and p / r there.
    fn other(&self, xi: &[f64], c: &mut Vec<f64>, tallies: &mut Tallies) -> f64 {
        c.clear();
        let ratio = self.row(xi, || {
            let x = self.sample(self.reference, xi);
            self.coordinates(&x, c);
            let (pdf, ratio) = self.ratio(&x);
            tallies.anywhere.holds(pdf >= 0.0, || format!("pdf = {pdf:?} at {}", text(&x)));
            tallies.reference.holds(!ratio.is_nan() || pdf.is_nan() || pdf < 0.0, || {
                format!("the reference has no density at its own sample {}", text(&x))
            });
            ratio
        });
        ratio.unwrap_or(f64::NAN)
    }

    /// p, and p / r with r of the reference, at one of its samples.
    pub(super) fn ratio(&self, x: &P) -> (f64, f64) {
        let (p, ln_p) = self.density(self.p, x);
        let (r, ln_r) = self.density(self.reference, x);
        let ratio = if r.is_normal() && (p.is_normal() || p == 0.0 && ln_p == f64::NEG_INFINITY) {
            p / r
        } else if p.is_nan() || p < 0.0 {
            f64::NAN
        } else {
            let ln = |pdf: f64, ln: f64| if pdf.is_normal() { pdf.ln() } else { ln };
            (ln(p, ln_p) - ln(r, ln_r)).exp()
        };
        (p, ratio)
    }

    fn integral(
        &self,
        exact: &Exact,
        total: &Total,
        coordinates: usize,
        pairs: &[(usize, usize)],
    ) -> Finding {
        let mut tally = Tally::new(Law::Integral);
        if let Some(total) = exact.total {
            tally.limit((total - 1.0).abs(), self.options.integral, || too_much(total));
            return tally.finding();
        }
        let (mean, error) = (total.mean(), total.error());
        let level = self.options.level(1 + 2 * coordinates + pairs.len());
        let allowed = largest_score(level) * error + self.options.integral;
        let place = || format!("{}, with a standard error of {error:.1e}", too_much(mean));
        tally.limit((mean - 1.0).abs(), allowed, place);
        let mut finding = tally.finding();
        if !suffices(total) && !mean.is_nan() {
            finding.verdict = Verdict::Unresolved;
            finding.detail = format!("{}; the reference is too poor to tell", too_much(mean));
        }
        finding
    }
}

/// Whether weighted samples tell masses; NaN does not.
fn suffices(total: &Total) -> bool {
    total.effective() >= WORTH && total.share() <= SHARE
}

fn fit(counts: &[f64], reference: &Weighted, exact: Option<&[f64]>) -> Option<Fit> {
    match exact {
        Some(masses) => known_masses(counts, masses),
        None => estimated_masses(counts, reference),
    }
}

/// All edges of bins with these inner ones.
fn framed(inner: &[f64]) -> Vec<f64> {
    let mut edges = vec![f64::NEG_INFINITY];
    edges.extend(inner);
    edges.push(f64::INFINITY);
    edges
}

/// χ² and Kolmogorov's distance in one coordinate.
fn marginal(
    chi: Law,
    ks: Law,
    edges: &Edges,
    own: &Weighted,
    other: &Weighted,
    exact: Option<&[f64]>,
    level: f64,
) -> [Finding; 2] {
    let fine = framed(&edges.fine);
    let masses = exact.unwrap_or(&other.sum);
    let shape = shape(&fine, &own.count, masses);
    let joined = Weighted {
        count: coarse(&other.count),
        sum: coarse(&other.sum),
        square: coarse(&other.square),
    };
    let known = exact.map(coarse);
    let fit = fit(&coarse(&own.count), &joined, known.as_deref());
    let mut chi = describe(chi, fit, level, |bins| {
        interval(&fine, &(bins.start * COARSE..(bins.end * COARSE).min(fine.len() - 1)))
    });
    if !chi.passed() && !shape.is_empty() {
        chi.detail = format!("{}; {shape}", chi.detail);
    }

    let n: f64 = own.count.iter().sum();
    let total: f64 = masses.iter().sum();
    let squares: f64 = other.square.iter().sum::<f64>() / (total * total);
    let (mut below, mut mass, mut square) = (0.0, 0.0, 0.0);
    let (mut distance, mut deviation) = (0.0_f64, 0.0_f64);
    for ((count, m), s) in own.count.iter().zip(masses).zip(&other.square) {
        below += count / n;
        mass += m / total;
        square += s / (total * total);
        let miss = (below - mass).abs();
        distance = if miss.is_nan() { f64::NAN } else { distance.max(miss) };
        let noise = square * (1.0 - 2.0 * mass) + squares * mass * mass;
        deviation = deviation.max(mass * (1.0 - mass) / n + noise);
    }
    // Kolmogorov's process has the standard deviation 1/2 where it is largest.
    let scale = if exact.is_some() { n.sqrt().recip() } else { 2.0 * deviation.sqrt() };
    let mut tally = Tally::new(ks);
    tally.limit(distance, kolmogorov_factor(level) * scale, || shape.clone());
    [chi, tally.finding()]
}
