//! What a run's diagnostics are made of.

use std::slice::ChunksExact;

use serde::{Deserialize, Serialize};

use crate::lanes;
use crate::moments::Moments;
use crate::tail::Tail;

/// How many samples of each technique are looked at in a range.
const LOOK: usize = 384;

/// The most techniques whose densities are compared.
const PAIRED: usize = 64;

/// A closer look at some of the samples of a range: the first of each technique, up to 384.
///
/// The first chunks of a run hold no more than that, and are looked at as a whole; of full ones,
/// the look would cost too much.
#[derive(Debug)]
pub(crate) struct Evidence<'a> {
    /// One for each component of each technique, a technique's side by side.
    pub(crate) tails: &'a mut [Tail],
    pub(crate) seen: &'a mut [Seen],
    /// Σ d and Σ d² over the samples of technique i, with d = p_k / Σ α_m p_m - 1, at i K + k.
    ///
    /// The mean of 1 + d over all samples, each technique by its share α_i, has the expectation
    /// ∫ p_k = 1, if every technique samples the pdf that it states and the pdf integrates to 1.
    /// NaN if some density left the range of `f64`; zeros where only one technique has samples,
    /// and where the weights are constant; empty for more than 64 techniques, of which the pairs
    /// would cost more than the samples.
    pub(crate) densities: &'a mut [[f64; 2]],
}

/// How many samples of a technique were looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub(crate) struct Seen {
    pub(crate) samples: u64,
    /// Of them, those whose contribution is not 0 in every component.
    pub(crate) contributions: u64,
}

impl Evidence<'_> {
    /// How many sums of densities there are for so many techniques.
    pub(crate) fn pairs(techniques: usize) -> usize {
        if techniques > PAIRED { 0 } else { techniques * techniques }
    }

    /// How many samples of a block of technique `i` are to be looked at.
    pub(super) fn look(&self, i: usize, samples: usize) -> usize {
        let seen = self.seen.get(i).map_or(0, |seen| seen.samples);
        let left = LOOK.saturating_sub(usize::try_from(seen).unwrap_or(LOOK));
        samples.min(left)
    }

    /// Adds the contributions of samples of technique `i`: a row for each component. In its block,
    /// `zeros` samples contribute 0, and the components have these moments.
    pub(super) fn contributions<'a>(
        &mut self,
        i: usize,
        rows: impl ExactSizeIterator<Item = &'a [f64]> + Clone,
        zeros: u64,
        blocks: &[Moments],
    ) {
        let samples = rows.clone().next().map_or(0, <[f64]>::len);
        let is_some = |j: &usize| rows.clone().any(|y| y.get(*j).is_some_and(|y| *y != 0.0));
        if let Some(seen) = self.seen.get_mut(i) {
            let contributions = match zeros {
                0 => samples,
                _ => (0..samples).filter(is_some).count(),
            };
            seen.samples += samples as u64;
            seen.contributions += contributions as u64;
        }
        let tails = self.tails.iter_mut().skip(i * rows.len());
        for ((tail, y), block) in tails.zip(rows).zip(blocks) {
            tail.push(y, block.largest);
        }
    }

    /// Adds the densities at the samples of technique `i`. `rows` holds the pdfs of each technique
    /// and `inverse` has room for 1 / Σ α_k p_k.
    pub(super) fn densities(
        &mut self,
        i: usize,
        alpha: &[f64],
        rows: &ChunksExact<'_, f64>,
        inverse: &mut [f64],
    ) {
        let techniques = alpha.len();
        let active = || rows.clone().zip(alpha).enumerate().filter(|(_, (_, alpha))| **alpha > 0.0);
        if self.densities.is_empty() || active().count() < 2 {
            return;
        }
        for (n, (_, (row, alpha))) in active().enumerate() {
            for (sum, p) in inverse.iter_mut().zip(row) {
                *sum = if n == 0 { alpha * p } else { *sum + alpha * p };
            }
        }
        for sum in inverse.iter_mut() {
            *sum = 1.0 / *sum;
        }
        for (k, (row, _)) in active() {
            let row = row.get(..inverse.len()).unwrap_or(row);
            if let Some([sum, squares]) = self.densities.get_mut(i * techniques + k) {
                let [d, d2] = lanes::relative_sums(row, inverse);
                *sum += d;
                *squares += d2;
            }
        }
    }
}
