//! Samples that are kept, to be combined when coefficients for them are known.

use super::regression::Regression;
use super::{BLOCK, Sample};
use crate::integrand::Value;
use crate::moments::{Accumulator, Moments};
use crate::part::{Counts, Part};

/// Contributions, each with what a regression may explain it by.
#[derive(Debug, Clone)]
pub(crate) struct Kept {
    regressors: usize,
    components: usize,
    /// Of each sample its regressors, then its contributions y.
    rows: Vec<f64>,
    of: Vec<Origin>,
}

/// Where a sample comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Origin {
    pub(crate) technique: usize,
    pub(crate) replicate: usize,
    pub(crate) index: u64,
}

impl Kept {
    pub(crate) fn new(regressors: usize, components: usize) -> Self {
        Self { regressors, components, rows: Vec::new(), of: Vec::new() }
    }

    /// Forgets all samples.
    pub(crate) fn clear(&mut self) {
        self.rows.clear();
        self.of.clear();
    }

    /// Keeps a sample with what is appended for it as regressors.
    pub(crate) fn push<P, V: Value>(
        &mut self,
        sample: &Sample<'_, P, V>,
        append: impl FnOnce(&mut Vec<f64>),
    ) {
        append(&mut self.rows);
        self.rows.extend((0..self.components).map(|c| sample.contribution_to(c)));
        let (technique, replicate) = (sample.technique(), sample.replicate());
        self.of.push(Origin { technique, replicate, index: sample.index() });
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.of.len()
    }

    /// Every sample: where it comes from, its regressors, and its contributions.
    pub(crate) fn samples(&self) -> impl Iterator<Item = (&Origin, &[f64], &[f64])> {
        let rows = self.rows.chunks_exact((self.regressors + self.components).max(1));
        self.of.iter().zip(rows).map(|(of, row)| {
            let (regressors, y) = row.split_at(self.regressors);
            (of, regressors, y)
        })
    }

    /// Adds the samples that `among` picks to a regression.
    pub(crate) fn add_to(&self, fit: &mut Regression, among: impl Fn(&Origin) -> bool) {
        for (_, z, y) in self.samples().filter(|(of, _, _)| among(of)) {
            fit.push(1.0, z.iter().copied(), y.iter().copied());
        }
    }
}

/// y - β z.
pub(crate) fn controlled(y: f64, z: &[f64], beta: &[f64]) -> f64 {
    let control: f64 = beta.iter().zip(z).map(|(beta, z)| beta * z).sum();
    // A sample at fault has no densities to speak of; it is counted.
    y - if control.is_finite() { control } else { 0.0 }
}

/// Sums of contributions from which β z has been subtracted.
#[derive(Debug)]
pub(crate) struct Adjusted {
    components: usize,
    replicates: usize,
    accumulators: Vec<Accumulator>,
    counts: Vec<Counts>,
    /// What is left of the contributions of a block, a row for each component.
    left: Vec<f64>,
    indices: Vec<u64>,
}

impl Adjusted {
    pub(crate) fn new(strata: usize, replicates: usize, components: usize) -> Self {
        Self {
            components,
            replicates,
            accumulators: vec![Accumulator::default(); strata * replicates * components],
            counts: vec![Counts::default(); strata],
            left: vec![0.0; components * BLOCK],
            indices: Vec::with_capacity(BLOCK),
        }
    }

    /// Adds all of `kept`, each to the stratum and with the coefficients that `of` says: a row for each
    /// component, or none at all.
    pub(crate) fn add<'b>(&mut self, kept: &Kept, of: impl Fn(&Origin) -> (usize, &'b [Vec<f64>])) {
        let stratum = |origin: &Origin| of(origin).0;
        self.add_each(kept, stratum, |_, origin, c, y, z| {
            of(origin).1.get(c).map_or(y, |beta| controlled(y, z, beta))
        });
    }

    /// Adds all of `kept`, each to the stratum that `stratum` says, as what `each` makes of its number,
    /// origin, component, contribution and regressors.
    pub(crate) fn add_each(
        &mut self,
        kept: &Kept,
        stratum: impl Fn(&Origin) -> usize,
        each: impl Fn(usize, &Origin, usize, f64, &[f64]) -> f64,
    ) {
        let mut last = None;
        for (j, (origin, z, ys)) in kept.samples().enumerate() {
            let stratum = stratum(origin);
            let into = stratum * self.replicates + origin.replicate;
            if self.indices.len() == BLOCK || last.is_some_and(|last| last != into) {
                self.flush(last.unwrap_or(into));
            }
            last = Some(into);
            let at = self.indices.len();
            for (c, y) in ys.iter().enumerate() {
                self.left[c * BLOCK + at] = each(j, origin, c, *y, z);
            }
            self.indices.push(origin.index);
            let counts = &mut self.counts[stratum];
            counts.samples += 1;
            counts.zero += u64::from(ys.iter().all(|y| *y == 0.0));
        }
        if let Some(last) = last {
            self.flush(last);
        }
    }

    fn flush(&mut self, into: usize) {
        let Self { components, accumulators, left, indices, .. } = self;
        let accumulators = accumulators.iter_mut().skip(into * *components);
        for (sum, left) in accumulators.zip(left.chunks_exact(BLOCK)) {
            let left = &left[..indices.len()];
            let index = |j: usize| indices.get(j).copied().unwrap_or(u64::MAX);
            sum.push(left, Moments::of_block(left), index);
        }
        indices.clear();
    }

    /// Adds what a range of samples had of faults, by technique, to the strata from `first` on.
    pub(crate) fn add_faults(&mut self, first: usize, counts: &[Counts]) {
        for (own, counts) in self.counts.iter_mut().skip(first).zip(counts) {
            own.uncovered += counts.uncovered;
            own.non_finite += counts.non_finite;
        }
    }

    pub(crate) fn into_part(self) -> Part {
        let contributions = self.accumulators.iter().map(Accumulator::total).collect();
        Part { contributions, counts: self.counts }
    }
}
