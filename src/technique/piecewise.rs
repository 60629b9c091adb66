//! Piecewise constant densities.

use super::elementary::clamp;
use super::{InverseCdf, Technique, batch, canonical};
use crate::error::{ArgumentError, finite, greater};

pub(super) const OWNER: &str = "PiecewiseConstant";

/// A density that is constant on each of K bins, with respect to length.
///
/// With the edges e₀ < e₁ < ... and Pₖ the probability of bin k, eₖ <= x < eₖ₊₁:
/// p(x) = Pₖ / (eₖ₊₁ - eₖ), P(x) = P₀ + ... + Pₖ₋₁ + p(x) (x - eₖ), and P⁻¹ solves that in the bin which a binary
/// search finds.
///
/// Bins of weight 0 are never sampled; the support begins and ends with bins of positive weight.
/// The last bin includes its upper edge.
///
/// ```
/// use mis::technique::{InverseCdf, PiecewiseConstant, Technique};
/// # fn main() -> Result<(), mis::ArgumentError> {
/// let p = PiecewiseConstant::new(&[0.0, 1.0, 2.0, 4.0], &[1.0, 0.0, 3.0])?;
/// assert_eq!(p.pdf(&0.5), 0.25);
/// assert_eq!(p.pdf(&1.5), 0.0);
/// assert_eq!(p.pdf(&3.0), 0.375);
/// assert_eq!(p.inverse_cdf(0.625), 3.0);
/// # Ok(())
/// # }
/// ```
///
/// # Numerics
///
/// The running sums are compensated, and summed from the left for the CDF and from the right for
/// the survival function, so each tail keeps its relative precision with any number of bins. A
/// weight below about 1e-323 times the sum of the weights counts as 0.
#[derive(Debug, Clone, PartialEq)]
pub struct PiecewiseConstant {
    edges: Vec<f64>,
    bins: Vec<Bin>,
    /// The smallest u for which each bin, or one after it, has the mass u below its points.
    starts: Vec<f64>,
}

/// One bin, and what a search for it leads to.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bin {
    probability: f64,
    /// The lower and the upper edge.
    ends: [f64; 2],
    /// The probabilities of the bins before and after.
    beyond: [f64; 2],
    /// The last point, which is not in the next bin.
    last: f64,
}

impl Bin {
    fn width(&self) -> f64 {
        self.ends[1] - self.ends[0]
    }

    /// The point with the mass `v` beyond it on the lower (0) or the upper (1) `side`.
    ///
    /// Without branches: a side is a matter of chance.
    fn place(&self, v: f64, side: usize) -> f64 {
        let part = (v - self.beyond[side]) / self.probability;
        let inwards = 1.0 - 2.0 * side as f64;
        clamp(self.ends[side] + inwards * (part * self.width()), self.ends[0], self.last)
    }
}

impl PiecewiseConstant {
    /// Bin k is \[edges\[k\], edges\[k + 1\]) and has a probability proportional to `weights[k]`.
    ///
    /// # Errors
    ///
    /// Edges must be finite and increase, by differences that neither overflow nor are subnormal;
    /// there must be at least one weight and one edge more than weights. Weights must be finite
    /// and not negative, not all 0, and the densities must be finite.
    pub fn new(edges: &[f64], weights: &[f64]) -> Result<Self, ArgumentError> {
        if edges.len() < 2 || edges.len() - 1 != weights.len() {
            let rule =
                format!("it must be at least 2, and one more than weights = {}", weights.len());
            return Err(ArgumentError::new(OWNER, "number of edges", edges.len(), rule));
        }
        for (k, &edge) in edges.iter().enumerate() {
            finite(OWNER, format!("edges[{k}]"), edge)?;
        }
        for (k, pair) in edges.windows(2).enumerate() {
            let name = format!("edges[{}]", k + 1);
            greater(OWNER, name, pair[1], format!("edges[{k}]"), pair[0])?;
            if !(pair[1] - pair[0]).is_normal() {
                let name = format!("edges[{}] - edges[{k}]", k + 1);
                let rule = "it must be within the range of normal numbers";
                return Err(ArgumentError::new(OWNER, name, pair[1] - pair[0], rule));
            }
        }
        for (k, &weight) in weights.iter().enumerate() {
            if !(weight.is_finite() && weight >= 0.0) {
                let rule = "it must be finite and not negative";
                return Err(ArgumentError::new(OWNER, format!("weights[{k}]"), weight, rule));
            }
        }
        let largest = weights.iter().fold(0.0, |m: f64, &w| m.max(w));
        if largest == 0.0 {
            let rule = "they must not all be 0";
            return Err(ArgumentError::new(OWNER, "weights", weights, rule));
        }
        // Relative to the largest, so that the sum does not overflow.
        let total = running_sums(weights.iter().map(|w| w / largest)).1;
        let mut probabilities: Vec<f64> = weights.iter().map(|w| w / largest / total).collect();
        let positive = |&p: &f64| p > 0.0;
        let first = probabilities.iter().position(positive).unwrap_or(0);
        let last = probabilities.iter().rposition(positive).unwrap_or(0);
        probabilities.truncate(last + 1);
        probabilities.drain(..first);
        let edges = edges[first..=last + 1].to_vec();
        for (k, (pair, p)) in edges.windows(2).zip(&probabilities).enumerate() {
            let density = p / (pair[1] - pair[0]);
            if !density.is_finite() {
                let name = format!("density of bin {}", first + k);
                return Err(ArgumentError::new(OWNER, name, density, "it must be finite"));
            }
        }
        let (mut below, _) = running_sums(probabilities.iter().copied());
        let (mut above, _) = running_sums(probabilities.iter().rev().copied());
        above.reverse();
        // The sums of rounded probabilities, which are 1 to an ulp.
        below[probabilities.len()] = 1.0;
        above[0] = 1.0;
        let mut bins = Vec::with_capacity(probabilities.len());
        for (k, &probability) in probabilities.iter().enumerate() {
            let ends = [edges[k], edges[k + 1]];
            let last = if k + 1 == probabilities.len() { ends[1] } else { ends[1].next_down() };
            bins.push(Bin { probability, ends, beyond: [below[k], above[k + 1]], last });
        }
        let starts = below.iter().zip(&above).map(|(&below, &above)| {
            // From 1/2 on, the first u of which 1 - u is less than the mass above.
            let u = 1.0 - above;
            let from_above = if 1.0 - u < above { u } else { u.next_up() };
            if below < 0.5 { below } else { from_above.max(0.5) }
        });
        let starts = starts.take(bins.len()).collect();
        Ok(Self { edges, bins, starts })
    }

    /// One more than there are bins, from the lower end of the support to the upper.
    pub(super) fn edges(&self) -> &[f64] {
        &self.edges
    }

    /// The probability of every bin, and its ends.
    pub(super) fn bins(&self) -> impl Iterator<Item = (f64, [f64; 2])> {
        self.bins.iter().map(|bin| (bin.probability, bin.ends))
    }

    /// The bin that holds x, or that is nearest to it.
    fn bin(&self, x: f64) -> &Bin {
        let after = self.edges.partition_point(|&e| e <= x);
        &self.bins[after.saturating_sub(1).min(self.bins.len() - 1)]
    }

    fn contains(&self, x: f64) -> bool {
        self.edges[0] <= x && x <= self.edges[self.edges.len() - 1]
    }

    /// The x with the mass `u` below it.
    fn place(&self, u: f64) -> f64 {
        // The last bin that starts at or before u has, therefore, a positive probability.
        let k = self.starts.partition_point(|&start| start <= u).saturating_sub(1);
        let side = usize::from(u >= 0.5);
        self.bins[k].place((side as f64 - u).abs(), side)
    }

    /// The x with the mass `v` above it, from the sums from the right.
    fn with_mass_above(&self, v: f64) -> f64 {
        let k = self.bins.partition_point(|bin| bin.beyond[1] > v);
        self.bins[k.min(self.bins.len() - 1)].place(v, 1)
    }
}

/// 0, v₀, v₀ + v₁, ..., and the total, with compensation.
///
/// Source: A. Neumaier, *Rundungsfehleranalyse einiger Verfahren zur Summation endlicher Summen*,
/// ZAMM 54 (1974) 39-51.
fn running_sums(values: impl Iterator<Item = f64>) -> (Vec<f64>, f64) {
    let (mut sum, mut lost) = (0.0_f64, 0.0);
    let mut sums = vec![0.0];
    for v in values {
        let next = sum + v;
        lost += if sum >= v { (sum - next) + v } else { (v - next) + sum };
        sum = next;
        sums.push(sum + lost);
    }
    (sums, sum + lost)
}

impl Technique for PiecewiseConstant {
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        self.inverse_cdf(canonical(xi, 0))
    }

    fn pdf(&self, x: &f64) -> f64 {
        let bin = self.bin(*x);
        if self.contains(*x) { bin.probability / bin.width() } else { 0.0 }
    }

    fn ln_pdf(&self, x: &f64) -> f64 {
        if !self.contains(*x) {
            return f64::NEG_INFINITY;
        }
        // The quotient itself may underflow.
        let bin = self.bin(*x);
        bin.probability.ln() - bin.width().ln()
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<f64>) {
        batch::sample(self, xi, xs);
    }
}

impl InverseCdf for PiecewiseConstant {
    fn cdf(&self, x: f64) -> f64 {
        if x.is_nan() {
            return f64::NAN;
        }
        if x <= self.edges[0] {
            return 0.0;
        }
        if x >= self.edges[self.edges.len() - 1] {
            return 1.0;
        }
        let bin = self.bin(x);
        let sum = bin.beyond[0] + (x - bin.ends[0]) / bin.width() * bin.probability;
        sum.min(1.0)
    }

    fn inverse_cdf(&self, u: f64) -> f64 {
        if (0.0..=1.0).contains(&u) { self.place(u) } else { f64::NAN }
    }

    fn survival(&self, x: f64) -> f64 {
        if x.is_nan() {
            return f64::NAN;
        }
        if x <= self.edges[0] {
            return 1.0;
        }
        if x >= self.edges[self.edges.len() - 1] {
            return 0.0;
        }
        let bin = self.bin(x);
        let sum = bin.beyond[1] + (bin.ends[1] - x) / bin.width() * bin.probability;
        sum.min(1.0)
    }

    fn inverse_survival(&self, v: f64) -> f64 {
        if !(0.0..=1.0).contains(&v) {
            f64::NAN
        } else if v < 0.5 {
            self.with_mass_above(v)
        } else {
            self.place(1.0 - v)
        }
    }

    fn sample_slice(&self, xi: &[f64], xs: &mut [f64]) {
        batch::places(xi, xs, |u| self.place(u));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LARGEST: f64 = 1.0 - f64::EPSILON / 2.0;

    fn message(edges: &[f64], weights: &[f64]) -> String {
        PiecewiseConstant::new(edges, weights).unwrap_err().to_string()
    }

    #[test]
    fn bins_of_weight_zero_are_never_returned() {
        let edges: Vec<f64> = (0..=7).map(f64::from).collect();
        let p = PiecewiseConstant::new(&edges, &[0.0, 1.0, 0.0, 2.0, 0.0, 1.0, 0.0]).unwrap();
        assert_eq!(p.support(), (1.0, 6.0));
        let mut us = vec![0.0, 5e-324, LARGEST, 1.0];
        for sum in [0.25_f64, 0.5, 0.75] {
            us.extend([sum.next_down(), sum, sum.next_up()]);
        }
        for u in us {
            for x in [p.inverse_cdf(u), p.inverse_survival(u), p.sample(&[u])] {
                assert!(p.pdf(&x) > 0.0, "u = {u:e}: x = {x:?}");
            }
        }
        // At a boundary the mass on both sides is exact, from either bin.
        for x in [p.inverse_cdf(0.25), p.inverse_survival(0.75)] {
            assert!(
                (p.cdf(x) - 0.25).abs() <= f64::EPSILON && (x == 3.0 || x == 2.0_f64.next_down())
            );
        }
        assert!(p.pdf(&2.5) == 0.0 && p.pdf(&6.5) == 0.0 && p.pdf(&f64::NAN) == 0.0);
        assert_eq!(p.ln_pdf(&2.5), f64::NEG_INFINITY);
        assert!((p.ln_pdf(&3.5) - p.pdf(&3.5).ln()).abs() < 4.0 * f64::EPSILON);
    }

    #[test]
    fn huge_ratios_of_weights_keep_both_tails() {
        let p = PiecewiseConstant::new(&[0.0, 1.0, 2.0], &[1e-300, 1e300]).unwrap();
        assert_eq!(p.support(), (1.0, 2.0));
        let p = PiecewiseConstant::new(&[0.0, 1.0, 2.0, 3.0], &[1e-200, 1.0, 1e-200]).unwrap();
        assert_eq!(p.inverse_survival(0.5e-200), 2.5);
        assert_eq!(p.survival(2.5), 0.5e-200);
        assert_eq!(p.inverse_cdf(0.5e-200), 0.5);
        assert_eq!(p.cdf(0.5), 0.5e-200);
        let p = PiecewiseConstant::new(&[0.0, 1.0, 2.0], &[f64::MAX, f64::MAX]).unwrap();
        assert_eq!(p.pdf(&0.5), 0.5);
    }

    #[test]
    fn a_million_bins_keep_the_sums_exact() {
        let n = 1_000_000_u32;
        let edges: Vec<f64> = (0..=n).map(f64::from).collect();
        let p = PiecewiseConstant::new(&edges, &vec![0.1; edges.len() - 1]).unwrap();
        for x in [0.5, 1234.25, 499_999.5, 500_000.5, 999_999.5] {
            let u = x / f64::from(n);
            assert!((p.cdf(x) / u - 1.0).abs() <= 2.0 * f64::EPSILON);
            let v = (f64::from(n) - x) / f64::from(n);
            assert!((p.survival(x) / v - 1.0).abs() <= 2.0 * f64::EPSILON);
            assert!((p.inverse_cdf(u) / x - 1.0).abs() <= 4.0 * f64::EPSILON);
        }
    }

    #[test]
    fn one_bin_of_one_float_is_a_density() {
        let p = PiecewiseConstant::new(&[1.0, 1.0_f64.next_up(), 2.0], &[1.0, 1.0]).unwrap();
        assert_eq!(p.inverse_cdf(0.4), 1.0);
        assert_eq!(p.pdf(&1.0), 0.5 / f64::EPSILON);
        for u in [f64::NAN, -0.1, 1.1, f64::INFINITY] {
            assert!(p.inverse_cdf(u).is_nan() && p.inverse_survival(u).is_nan());
        }
        assert!(p.sample(&[]).is_nan() && p.cdf(f64::NAN).is_nan());
    }

    #[test]
    fn errors_name_argument_value_and_rule() {
        assert_eq!(
            message(&[0.0, 1.0], &[1.0, 2.0]),
            "PiecewiseConstant: `number of edges` is 2, but it must be at least 2, and one more \
             than weights = 2"
        );
        assert!(message(&[], &[]).contains("`number of edges` is 0"));
        assert!(message(&[0.0, f64::NAN], &[1.0]).contains("`edges[1]` is NaN"));
        assert!(message(&[1.0, 1.0], &[1.0]).contains("`edges[1]` is 1.0, but it must be greater"));
        assert!(message(&[-1e308, 1e308], &[1.0]).contains("`edges[1] - edges[0]` is inf"));
        assert!(message(&[0.0, 1e-310], &[1.0]).contains("`edges[1] - edges[0]` is 1e-310"));
        assert!(message(&[0.0, 1.0], &[-1.0]).contains("`weights[0]` is -1.0"));
        assert!(message(&[0.0, 1.0], &[f64::INFINITY]).contains("`weights[0]` is inf"));
        assert!(message(&[0.0, 1.0], &[0.0]).contains("they must not all be 0"));
    }
}
