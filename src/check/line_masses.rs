//! The laws of an [`InverseCdf`](crate::InverseCdf) about integrals of its pdf.

use super::histogram::{Histogram, describe, unresolved};
use super::line::{Line, Samples};
use super::quadrature::integral;
use super::report::{Finding, Law, Tally};
use super::statistics::{known_masses, kolmogorov, kolmogorov_factor};

const TAIL: [f64; 4] = [1e-25, 1e-12, 1e-6, 1e-3];
const BINS: u32 = 32;

impl Line<'_> {
    /// ∫ p = 1, and the CDF between random points and in the tails.
    pub(super) fn masses(&self, us: &[f64]) -> [Finding; 3] {
        let options = self.options;
        let splits = self.splits();
        let mut whole = Tally::new(Law::Integral);
        let total = self.mass(self.a, self.b, &splits);
        whole.limit((total - 1.0).abs(), options.integral, || too_much(total));

        let mut between = Tally::new(Law::Mass);
        for pair in us.chunks_exact(2).take(50) {
            let (x, y) = (self.inverse_cdf(pair[0]), self.inverse_cdf(pair[1]));
            let (x, y) = (x.min(y), x.max(y));
            let (mass, difference) = (self.mass(x, y, &splits), self.cdf(y) - self.cdf(x));
            let bound = options.integral + self.grain(x) + self.grain(y);
            between.limit((difference - mass).abs(), bound, || {
                format!("∫ p over [{x:?}, {y:?}] = {mass:.6}, by the cdf {difference:.6}")
            });
        }

        let mut tails = Tally::new(Law::TailMass);
        for v in TAIL {
            if v < options.tail_from {
                continue;
            }
            let (x, y) = (self.inverse_cdf(v), self.inverse_survival(v));
            let bound = 100.0 * options.integral.max(options.tail);
            let (mass, cdf) = (self.mass(self.a, x, &splits), self.cdf(x));
            tails.limit((cdf - mass).abs() / v, bound + 2.0 * self.grain(x) / v, || {
                format!("∫ p below {x:?} = {mass:e}, by the cdf {cdf:e}")
            });
            let (mass, survival) = (self.mass(y, self.b, &splits), self.survival(y));
            tails.limit((survival - mass).abs() / v, bound + 2.0 * self.grain(y) / v, || {
                format!("∫ p above {y:?} = {mass:e}, by the survival function {survival:e}")
            });
        }
        [whole.finding(), between.finding(), tails.finding()]
    }

    /// χ² and Kolmogorov's distance of samples.
    pub(super) fn statistics(&self, many: &Samples, level: f64) -> [Finding; 2] {
        let xs = &many.xs;
        if xs.is_empty() {
            return [Law::ChiSquared(0), Law::Kolmogorov(0)]
                .map(|law| unresolved(law, "no samples"));
        }
        let mut edges: Vec<f64> =
            (0..=BINS).map(|k| self.inverse_cdf(f64::from(k) / f64::from(BINS))).collect();
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        let splits = self.splits();
        let masses: Vec<f64> =
            edges.windows(2).map(|cell| self.mass(cell[0], cell[1], &splits)).collect();
        let mut histogram = Histogram::new(edges);
        for x in xs {
            histogram.push(*x);
        }
        let shape = histogram.shape(&masses);
        let fit = known_masses(&histogram.counts, &masses);
        let mut chi_squared =
            describe(Law::ChiSquared(0), fit, level, |bins| histogram.range(bins));

        let mut ranks = self.calls.numbers("cdf", xs, |x| self.p.cdf(x));
        let distance = kolmogorov(&mut ranks);
        let mut tally = Tally::new(Law::Kolmogorov(0));
        let bound = kolmogorov_factor(level) / (xs.len() as f64).sqrt();
        tally.limit(distance, bound, || shape.clone());
        if !chi_squared.passed() && !shape.is_empty() {
            chi_squared.detail = format!("{}; {shape}", chi_squared.detail);
        }
        [chi_squared, tally.finding()]
    }

    /// ∫ p between `lower` and `upper`, split at the quantiles and where the density jumps.
    fn mass(&self, lower: f64, upper: f64, splits: &[f64]) -> f64 {
        let f = |x: f64| self.p.pdf(&x);
        let centre = self.inverse_cdf(0.5);
        let mut cuts = vec![lower, upper];
        cuts.extend(splits.iter().copied().filter(|x| lower < *x && *x < upper));
        cuts.sort_by(f64::total_cmp);
        let pieces = cuts.windows(2).map(|cut| {
            let scale = (cut[0].max(-f64::MAX) - centre).abs();
            let scale = scale.min((cut[1].min(f64::MAX) - centre).abs());
            let what = || format!("pdf between {:?} and {:?}", cut[0], cut[1]);
            let mass = self.calls.try_call(what, || integral(&f, cut[0], cut[1], scale));
            mass.unwrap_or(f64::NAN)
        });
        pieces.sum()
    }

    /// Where quadrature starts anew: quantiles, and the splits that the options name.
    fn splits(&self) -> Vec<f64> {
        let mut splits: Vec<f64> =
            (1..BINS).map(|k| self.inverse_cdf(f64::from(k) / f64::from(BINS))).collect();
        splits.extend(TAIL.map(|v| self.inverse_cdf(v)));
        splits.extend(TAIL.map(|v| self.inverse_survival(v)));
        splits.extend(&self.options.splits);
        splits.retain(|x| x.is_finite());
        splits.sort_by(f64::total_cmp);
        splits.dedup();
        splits
    }
}

/// "the pdf integrates to 1.0500, 5.0 % too much".
pub(super) fn too_much(total: f64) -> String {
    if total.is_nan() {
        return "the integral of the pdf is NaN".into();
    }
    let percent = 100.0 * (total - 1.0);
    let (size, way) = (percent.abs(), if percent > 0.0 { "much" } else { "little" });
    if size >= 0.01 {
        format!("the pdf integrates to {total:.4}, {size:.2} % too {way}")
    } else {
        format!("the pdf integrates to {total:?}, {size:.1e} % too {way}")
    }
}
