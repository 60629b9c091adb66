//! Pearson's and Kolmogorov's tests.
//!
//! Sources: K. Pearson, *On the Criterion that a Given System of Deviations …*, Philosophical
//! Magazine 50 (1900); E. B. Wilson and M. M. Hilferty, *The Distribution of Chi-Square*, PNAS 17
//! (1931); A. N. Kolmogorov, *Sulla determinazione empirica di una legge di distribuzione*,
//! Giornale dell'Istituto Italiano degli Attuari 4 (1933), with the leading term of its tail.

use std::ops::Range;

use crate::technique::{InverseCdf, Normal};

/// The fewest samples that a cell is expected to have; poorer ones are joined.
const FEWEST: f64 = 5.0;

/// The |z| that a standard score exceeds with the probability `level`.
pub(super) fn largest_score(level: f64) -> f64 {
    Normal::standard().inverse_survival(0.5 * level)
}

/// The c for which Kolmogorov's distance exceeds c / sqrt(n) with the probability `level`:
/// 2 e^(-2c²), the first term of the series.
pub(super) fn kolmogorov_factor(level: f64) -> f64 {
    (0.5 * (2.0 / level).ln()).sqrt()
}

/// Kolmogorov's distance between `ranks` and the uniform law; NaN if one of them is.
pub(super) fn kolmogorov(ranks: &mut [f64]) -> f64 {
    ranks.sort_by(f64::total_cmp);
    let n = ranks.len() as f64;
    ranks.iter().enumerate().fold(0.0_f64, |d, (k, u)| {
        let k = k as f64;
        if u.is_nan() || d.is_nan() { f64::NAN } else { d.max(u - k / n).max((k + 1.0) / n - u) }
    })
}

/// χ², and the group of bins that adds most to it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fit {
    pub(super) statistic: f64,
    pub(super) freedom: f64,
    /// The statistic as a standard score.
    pub(super) score: f64,
    /// The bins that are worst.
    pub(super) bins: Range<usize>,
    pub(super) count: f64,
    pub(super) expected: f64,
}

/// Wilson and Hilferty's standard score.
fn score(statistic: f64, freedom: f64) -> f64 {
    let spread = 2.0 / (9.0 * freedom);
    ((statistic / freedom).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// Neighbouring bins, joined until `enough` of what they hold together.
fn groups(bins: usize, enough: impl Fn(Range<usize>) -> bool) -> Vec<Range<usize>> {
    let mut groups: Vec<Range<usize>> = Vec::new();
    let mut start = 0;
    for end in 1..=bins {
        if enough(start..end) {
            groups.push(start..end);
            start = end;
        }
    }
    match groups.last_mut() {
        Some(last) => last.end = bins,
        None => groups.push(0..bins),
    }
    groups
}

fn sum(values: &[f64], bins: Range<usize>) -> f64 {
    values.get(bins).unwrap_or_default().iter().sum()
}

/// The counts of samples in bins of known masses; the masses need not add up to 1.
///
/// Infinite if there are samples where there is no mass, NaN if a mass is. Nothing if there are
/// fewer than two bins to compare.
pub(super) fn known_masses(counts: &[f64], masses: &[f64]) -> Option<Fit> {
    let n: f64 = counts.iter().sum();
    let total: f64 = masses.iter().sum();
    let expected: Vec<f64> = masses.iter().map(|mass| n * mass / total).collect();
    let groups = groups(counts.len(), |bins| sum(&expected, bins) >= FEWEST);
    let freedom = groups.len() as f64 - 1.0;
    let mut fit =
        Fit { statistic: 0.0, freedom, score: 0.0, bins: 0..0, count: 0.0, expected: 0.0 };
    let mut worst = -1.0;
    let mut take = |bins: Range<usize>, count: f64, expected: f64, term: f64| {
        if !(term <= worst) {
            (worst, fit.bins, fit.count, fit.expected) = (term, bins, count, expected);
        }
        fit.statistic += term;
    };
    for bins in groups {
        let (count, mean) = (sum(counts, bins.clone()), sum(&expected, bins.clone()));
        take(bins, count, mean, (count - mean).powi(2) / mean);
    }
    for (k, (count, mean)) in counts.iter().zip(&expected).enumerate() {
        if *count > 0.0 && *mean == 0.0 {
            take(k..k + 1, *count, 0.0, f64::INFINITY);
        }
    }
    if fit.statistic.is_finite() && freedom < 1.0 {
        return None;
    }
    fit.score = score(fit.statistic, freedom.max(1.0));
    Some(fit)
}

/// Weighted samples of a reference in bins.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Weighted {
    /// Per bin: how many, Σ w, Σ w².
    pub(super) count: Vec<f64>,
    pub(super) sum: Vec<f64>,
    pub(super) square: Vec<f64>,
}

impl Weighted {
    pub(super) fn new(bins: usize) -> Self {
        Self { count: vec![0.0; bins], sum: vec![0.0; bins], square: vec![0.0; bins] }
    }

    pub(super) fn push(&mut self, bin: usize, weight: f64) {
        let cells = (self.count.get_mut(bin), self.sum.get_mut(bin), self.square.get_mut(bin));
        if let (Some(count), Some(sum), Some(square)) = cells {
            *count += 1.0;
            *sum += weight;
            *square += weight * weight;
        }
    }

    fn join(&self, groups: &[Range<usize>]) -> Self {
        let joined = |v: &[f64]| groups.iter().map(|bins| sum(v, bins.clone())).collect();
        Self { count: joined(&self.count), sum: joined(&self.sum), square: joined(&self.square) }
    }

    /// (Σ w)² / Σ w², the number of unweighted samples that are worth as much.
    pub(super) fn effective(&self) -> f64 {
        self.sum.iter().sum::<f64>().powi(2) / self.square.iter().sum::<f64>()
    }
}

/// The counts of samples against bins whose masses are known from weighted samples only.
///
/// d_b = n_b / n - Σ_b w / Σ w has the covariance of a multinomial share,
/// (P_a δ_ab - P_a P_b) / n, plus that of a ratio of means, (S_a δ_ab - S_a P_b - P_a S_b +
/// S P_a P_b) / (Σ w)² with S_a = Σ_a w², S = Σ S_a; χ² = dᵀ C⁻¹ d without the last bin, which is
/// 1 minus the others.
pub(super) fn estimated_masses(counts: &[f64], reference: &Weighted) -> Option<Fit> {
    let n: f64 = counts.iter().sum();
    let total: f64 = reference.sum.iter().sum();
    let effective = reference.effective();
    // Under the law both samples tell the masses: together they are never 0 where there is a count.
    let shares = |counts: &[f64], weights: &[f64]| -> Vec<f64> {
        let both = counts.iter().zip(weights);
        both.map(|(k, w)| (k + effective * w / total) / (n + effective)).collect()
    };
    let pooled = shares(counts, &reference.sum);
    let groups = groups(counts.len(), |bins| {
        n * sum(&pooled, bins.clone()) >= FEWEST && sum(&reference.count, bins) >= 2.0 * FEWEST
    });
    let counts: Vec<f64> = groups.iter().map(|bins| sum(counts, bins.clone())).collect();
    let reference = reference.join(&groups);
    let p = shares(&counts, &reference.sum);
    let s: Vec<f64> = reference.square.iter().map(|s| s / (total * total)).collect();
    let s_total: f64 = s.iter().sum();
    let size = groups.len() - 1;
    let covariance = |a: usize, b: usize| {
        let (same_p, same_s) = if a == b { (p[a], s[a]) } else { (0.0, 0.0) };
        (same_p - p[a] * p[b]) / n + same_s - s[a] * p[b] - p[a] * s[b] + s_total * p[a] * p[b]
    };
    let miss = |b: usize| counts[b] / n - reference.sum[b] / total;
    let (statistic, freedom) = quadratic_form(size, covariance, miss);
    let worst = (0..groups.len())
        .max_by(|&a, &b| {
            let z = |b: usize| miss(b).abs() / covariance(b, b).sqrt();
            z(a).total_cmp(&z(b))
        })
        .unwrap_or(0);
    if size == 0 || freedom < 1.0 {
        return None;
    }
    Some(Fit {
        statistic,
        freedom,
        score: score(statistic, freedom),
        bins: groups[worst].clone(),
        count: counts[worst],
        expected: n * reference.sum[worst] / total,
    })
}

/// dᵀ C⁻¹ d by Cholesky's factors, and the rank of C.
fn quadratic_form(
    size: usize,
    covariance: impl Fn(usize, usize) -> f64,
    d: impl Fn(usize) -> f64,
) -> (f64, f64) {
    let mut lower = vec![0.0; size * size];
    let mut solved: Vec<f64> = Vec::with_capacity(size);
    let (mut form, mut rank) = (0.0, 0.0);
    for a in 0..size {
        for b in 0..=a {
            let dot: f64 = (0..b).map(|k| lower[a * size + k] * lower[b * size + k]).sum();
            let rest = covariance(a, b) - dot;
            lower[a * size + b] = if a != b {
                let pivot = lower[b * size + b];
                if pivot > 0.0 { rest / pivot } else { 0.0 }
            } else if rest <= 1e-10 * covariance(a, a) {
                0.0
            } else {
                rest.sqrt()
            };
        }
        let dot: f64 = (0..a).map(|k| lower[a * size + k] * solved[k]).sum();
        let pivot = lower[a * size + a];
        let y = if pivot == 0.0 { 0.0 } else { (d(a) - dot) / pivot };
        rank += f64::from(u8::from(pivot != 0.0));
        form += y * y;
        solved.push(y);
    }
    (form, rank)
}

/// The points below which a quarter and three quarters of the mass are, linear within bins.
fn quartiles(edges: &[f64], masses: &[f64]) -> Option<[f64; 2]> {
    let total: f64 = masses.iter().sum();
    let at = |share: f64| {
        let mut below = 0.0;
        for (edge, mass) in edges.windows(2).zip(masses) {
            let part = (share * total - below) / mass;
            if part <= 1.0 {
                return Some(edge[0] + part.max(0.0) * (edge[1] - edge[0]));
            }
            below += mass;
        }
        None
    };
    let both = [at(0.25)?, at(0.75)?];
    both.iter().all(|x| x.is_finite()).then_some(both)
}

/// How the middle half of the samples lies to that of the masses: relative width, and the shift
/// of its centre in units of the width.
pub(super) fn middle_half(edges: &[f64], counts: &[f64], masses: &[f64]) -> Option<(f64, f64)> {
    let ([a, b], [c, d]) = (quartiles(edges, counts)?, quartiles(edges, masses)?);
    let width = d - c;
    let (ratio, shift) = ((b - a) / width, 0.5 * ((a - c) + (b - d)) / width);
    (ratio.is_finite() && shift.is_finite()).then_some((ratio, shift))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_the_statistics() {
        assert!((largest_score(1e-5) - 4.417_173).abs() < 1e-6);
        assert!((kolmogorov_factor(1e-5) - 2.470_5).abs() < 1e-4);
        // The median of χ² on 31 degrees of freedom is 30.336, its upper 1e-3 point 61.098.
        assert!(score(30.336, 31.0).abs() < 1e-3);
        assert!((score(61.098, 31.0) - 3.090).abs() < 0.01);
    }

    #[test]
    fn distance_of_ranks() {
        assert_eq!(kolmogorov(&mut [0.75, 0.25]), 0.25);
        assert_eq!(kolmogorov(&mut [0.0, 0.0]), 1.0);
        assert!(kolmogorov(&mut [0.5, f64::NAN, 0.1]).is_nan());
    }

    #[test]
    fn poor_cells_are_joined_and_empty_ones_hold_no_sample() {
        let fit = known_masses(&[60.0, 40.0], &[0.5, 0.5]).unwrap();
        assert_eq!((fit.statistic, fit.freedom, fit.bins), (4.0, 1.0, 0..1));
        let fit = known_masses(&[1.0, 59.0, 40.0, 0.0], &[0.01, 0.49, 0.48, 0.02]).unwrap();
        assert_eq!((fit.statistic, fit.freedom), (4.0, 1.0));
        let fit = known_masses(&[60.0, 39.0, 1.0], &[0.5, 0.5, 0.0]).unwrap();
        assert_eq!((fit.score, fit.bins, fit.count), (f64::INFINITY, 2..3, 1.0));
        assert!(known_masses(&[60.0, 40.0], &[0.5, f64::NAN]).unwrap().score.is_nan());
        assert_eq!(known_masses(&[100.0], &[1.0]), None);
    }

    #[test]
    fn estimated_masses_are_known_ones_in_the_limit() {
        let known = known_masses(&[30.0, 25.0, 45.0], &[0.3, 0.3, 0.4]).unwrap();
        let (count, sum) = (vec![3e12, 3e12, 4e12], vec![3e12, 3e12, 4e12]);
        let reference = Weighted { square: sum.clone(), count, sum };
        let fit = estimated_masses(&[30.0, 25.0, 45.0], &reference).unwrap();
        assert!((fit.statistic / known.statistic - 1.0).abs() < 1e-6, "{fit:?} {known:?}");
        // As many samples on either side double the variance; that of the reference is its own.
        let sum = vec![30.0, 30.0, 40.0];
        let reference = Weighted { square: sum.clone(), count: sum.clone(), sum };
        let fit = estimated_masses(&[30.0, 25.0, 45.0], &reference).unwrap();
        assert!((fit.statistic / (25.0 / 55.0 + 25.0 / 85.0) - 1.0).abs() < 0.03, "{fit:?}");
    }

    #[test]
    fn widths_of_the_middle_half() {
        let edges = [0.0, 1.0, 2.0, 3.0, 4.0];
        let (ratio, shift) = middle_half(&edges, &[0.0, 1.0, 1.0, 0.0], &[1.0; 4]).unwrap();
        assert_eq!((ratio, shift), (0.5, 0.0));
        assert_eq!(middle_half(&edges, &[0.0; 4], &[1.0; 4]), None);
    }
}
