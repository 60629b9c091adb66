//! The samples of a pilot, as predictions use them.

use std::ops::Range;

use crate::estimator::Kept;

/// Densities and contributions at the samples of a mixture p° = Σ α°_k p_k.
///
/// All is relative to p°: d_k = p_k / p°, and y = f / p°. So any ratio of f and the p_k can be
/// formed, and what has ∫ g as its integral has g / p° as its mean.
#[derive(Debug, Clone)]
pub(super) struct Data {
    pub(super) samples: usize,
    pub(super) techniques: usize,
    /// A row of samples for each technique.
    d: Vec<f64>,
    /// A row of samples for each component.
    y: Vec<f64>,
    /// Which of them each technique has drawn, and its share α°.
    groups: Vec<(Range<usize>, f64)>,
}

impl Data {
    /// `kept` has the d_k as regressors, and the samples of a technique next to each other.
    pub(super) fn new(kept: &Kept, techniques: usize, components: usize) -> Self {
        let samples = kept.len();
        let mut d = vec![0.0; techniques * samples];
        let mut y = vec![0.0; components * samples];
        let mut counts = vec![0_usize; techniques];
        for (j, (of, densities, contributions)) in kept.samples().enumerate() {
            for (k, density) in densities.iter().enumerate() {
                // A sample at fault has none; its contribution is 0.
                d[k * samples + j] = if density.is_finite() { *density } else { 0.0 };
            }
            for (c, contribution) in contributions.iter().enumerate() {
                y[c * samples + j] = *contribution;
            }
            counts[of.technique] += 1;
        }
        let mut start = 0;
        let groups = counts
            .iter()
            .map(|count| {
                let group = start..start + count;
                start = group.end;
                (group, *count as f64 / samples as f64)
            })
            .collect();
        Self { samples, techniques, d, y, groups }
    }

    /// About as many of the samples that there are at most `most` densities.
    pub(super) fn thinned(&self, most: usize) -> Self {
        let step = (self.d.len() / most.max(1)).max(1);
        let picked: Vec<usize> =
            self.groups.iter().flat_map(|(group, _)| group.clone().step_by(step)).collect();
        let pick = |rows: &[f64]| -> Vec<f64> {
            let rows = rows.chunks_exact(self.samples.max(1));
            rows.flat_map(|row| picked.iter().map(|j| row[*j])).collect()
        };
        let mut start = 0;
        let groups = self
            .groups
            .iter()
            .map(|(group, share)| {
                let group = start..start + group.len().div_ceil(step);
                start = group.end;
                (group, *share)
            })
            .collect();
        let (d, y, techniques) = (pick(&self.d), pick(&self.y), self.techniques);
        Self { samples: picked.len(), techniques, d, y, groups }
    }

    /// d_k at all samples.
    pub(super) fn d(&self, k: usize) -> &[f64] {
        &self.d[k * self.samples..][..self.samples]
    }

    /// All d, a row for each technique.
    pub(super) fn densities(&self) -> &[f64] {
        &self.d
    }

    /// y of component c at all samples.
    pub(super) fn y(&self, c: usize) -> &[f64] {
        &self.y[c * self.samples..][..self.samples]
    }

    pub(super) fn components(&self) -> usize {
        self.y.len() / self.samples.max(1)
    }

    /// E_k\[h\], the mean of h under p_k: Σ d_k h / Σ d_k, by the samples of all techniques.
    pub(super) fn expected(&self, k: usize, h: &[f64]) -> f64 {
        // Sums that do not wait for each other.
        const LANES: usize = 8;
        let (mut sums, mut all) = ([0.0; LANES], [0.0; LANES]);
        for (d, h) in self.d(k).chunks(LANES).zip(h.chunks(LANES)) {
            for (((d, h), sum), all) in d.iter().zip(h).zip(&mut sums).zip(&mut all) {
                // Where p_k is 0, h may be anything.
                *sum += if *d > 0.0 { d * h } else { 0.0 };
                *all += d;
            }
        }
        let (sum, all): (f64, f64) = (sums.iter().sum(), all.iter().sum());
        if all > 0.0 { sum / all } else { 0.0 }
    }

    /// The mean of t over the mixture, and its standard error.
    pub(super) fn mean(&self, t: &[f64]) -> (f64, f64) {
        let (mut mean, mut variance) = (0.0, 0.0);
        for (group, share) in &self.groups {
            let own = &t[group.clone()];
            let n = own.len() as f64;
            if n > 0.0 {
                let m = own.iter().sum::<f64>() / n;
                mean += share * m;
                let squares: f64 = own.iter().map(|t| (t - m).powi(2)).sum();
                variance += share * share * squares / (n - 1.0) / n;
            }
        }
        (mean, variance.sqrt())
    }

    /// Σ α_k d_k at all samples.
    pub(super) fn mixture(&self, shares: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.samples];
        for (k, alpha) in shares.iter().enumerate().filter(|(_, alpha)| **alpha > 0.0) {
            for (sum, d) in sum.iter_mut().zip(self.d(k)) {
                *sum += alpha * d;
            }
        }
        sum
    }
}
