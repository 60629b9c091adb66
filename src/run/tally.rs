//! Sums over the samples of a run that its user defines: histograms, derived observables.

use std::fmt::{self, Display};

use serde::{Deserialize, Serialize};

use super::cell::Cell;
use crate::estimate::with_error;
use crate::estimator::{Design, Frame};
use crate::moments::Moments;
use crate::part::Part;

/// Where an observer puts what a sample adds to each of several sums.
///
/// A sum is an integral of its own: with y the contribution of a sample, `add(k, g · y)` makes sum k
/// an estimate of ∫ g f. What one sample adds to the same sum, in one call or in several, counts as
/// one amount; where it adds nothing, its amount is 0.
#[derive(Debug)]
pub struct Tally<'a> {
    cells: &'a mut Cells,
    /// What the present sample has added.
    pending: &'a mut Pending,
}

impl Tally<'_> {
    /// Adds `amount` to sum `k`. There is no effect on the sums if there is no sum k, but the call
    /// is [counted](crate::Report::misplaced).
    pub fn add(&mut self, k: usize, amount: f64) {
        self.pending.add(k, amount, self.cells);
    }
}

/// One sum of a [`Tally`], as an estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Tallied {
    /// Its value.
    pub value: f64,
    /// Its standard error; `None` where it cannot be known, as where no sample added to it.
    pub standard_error: Option<f64>,
    /// How many samples added to it.
    pub samples: u64,
}

/// `0.50012(21)`.
impl Display for Tallied {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&with_error(self.value, self.standard_error, 2))
    }
}

/// What the present sample has added to which sums.
#[derive(Debug, Default)]
pub(super) struct Pending {
    amounts: Vec<(usize, f64)>,
    /// Where the amount for a sum is, if it is there.
    places: Vec<usize>,
}

impl Pending {
    fn add(&mut self, k: usize, amount: f64, cells: &mut Cells) {
        if k >= cells.sums {
            cells.misplaced += 1;
            return;
        }
        self.places.resize(cells.sums, 0);
        let place = self.places[k];
        match self.amounts.get_mut(place) {
            Some((known, sum)) if *known == k => *sum += amount,
            _ => {
                self.places[k] = self.amounts.len();
                self.amounts.push((k, amount));
            }
        }
    }
}

/// All sums of all techniques.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Cells {
    sums: usize,
    /// A row for each replicate of each technique.
    rows: Vec<Cell>,
    pub(super) misplaced: u64,
}

impl Cells {
    pub(super) fn new(streams: usize, sums: usize) -> Self {
        Self { sums, rows: vec![Cell::default(); streams * sums], misplaced: 0 }
    }

    /// Forgets all amounts.
    pub(super) fn clear(&mut self, streams: usize, sums: usize) {
        self.rows.clear();
        self.rows.resize(streams * sums, Cell::default());
        (self.sums, self.misplaced) = (sums, 0);
    }

    /// Adds what `observe` says of one sample of stream `i`, a replicate of a technique.
    pub(super) fn sample(
        &mut self,
        i: usize,
        pending: &mut Pending,
        observe: impl FnOnce(&mut Tally<'_>),
    ) {
        observe(&mut Tally { cells: self, pending });
        let row = &mut self.rows[i * self.sums..];
        for (k, amount) in pending.amounts.drain(..) {
            row[k].push(amount);
        }
    }

    pub(super) fn sums(&self) -> usize {
        self.sums
    }

    /// How many samples added to each cell.
    pub(super) fn counts(&self) -> impl ExactSizeIterator<Item = u64> {
        self.rows.iter().map(|cell| cell.count)
    }

    /// What tells these from other sums of the same samples.
    pub(super) fn words(&self) -> impl Iterator<Item = u64> {
        let words = |cell: &Cell| [cell.count, cell.mean.to_bits(), cell.m2.to_bits()];
        self.rows.iter().flat_map(words).chain([self.misplaced])
    }

    pub(super) fn merge(&mut self, right: &Self) {
        for (left, right) in self.rows.iter_mut().zip(&right.rows) {
            *left = left.merge(*right);
        }
        // Calls are not bounded by the samples.
        self.misplaced = self.misplaced.saturating_add(right.misplaced);
    }

    /// The sums as estimates, where the samples were these; `components` is the number of them in
    /// the value.
    pub(super) fn tallied(
        &self,
        frame: &Frame<'_>,
        part: &Part,
        components: usize,
    ) -> Vec<Tallied> {
        let replicates = part.replicates(components);
        if replicates > 1 {
            let samples: Vec<u64> = part
                .contributions
                .iter()
                .step_by(components.max(1))
                .map(|contributions| contributions.moments.count)
                .collect();
            let one = |k| self.tallied_in_replicates(frame, k, replicates, &samples);
            let mut sums: Vec<Tallied> = (0..self.sums).map(one).collect();
            if sums.iter().any(|sum| !sum.value.is_finite()) {
                // Some replicate lacks samples: a value from all, but no error, as of the estimate.
                let all = self.together(replicates).tallied_from_samples(frame, part);
                for (sum, all) in sums.iter_mut().zip(all).filter(|(sum, _)| !sum.value.is_finite())
                {
                    *sum = Tallied { standard_error: None, ..all };
                }
            }
            return sums;
        }
        self.tallied_from_samples(frame, part)
    }

    /// A row for each technique, of all its replicates.
    fn together(&self, replicates: usize) -> Self {
        let mut all = Self { sums: self.sums, rows: Vec::new(), misplaced: self.misplaced };
        for rows in self.rows.chunks(self.sums.saturating_mul(replicates).max(1)) {
            let row = |k: usize| rows.iter().skip(k).step_by(self.sums).copied();
            let merged = (0..self.sums).map(|k| row(k).fold(Cell::default(), Cell::merge));
            all.rows.extend(merged);
        }
        all
    }

    /// The sums from a row of cells for each technique, whose samples are independent.
    fn tallied_from_samples(&self, frame: &Frame<'_>, part: &Part) -> Vec<Tallied> {
        let all = part.all().samples;
        let one = |k: usize| {
            let column = self.rows.iter().skip(k).step_by(self.sums);
            let added = column.clone().map(|cell| cell.count).sum();
            if frame.design == Design::Pooled {
                let cell = column.fold(Cell::default(), |sum, cell| sum.merge(*cell)).of_all(all);
                let n = cell.count as f64;
                let known = added > 0 && all > 1;
                let standard_error = known.then(|| (cell.m2 / (n - 1.0) / n).sqrt());
                let value = if all > 0 { cell.mean } else { f64::NAN };
                return Tallied { value, standard_error, samples: added };
            }
            let (mut value, mut variance, mut known) = (0.0, 0.0, added > 0);
            for ((cell, alpha), counts) in column.zip(frame.shares).zip(&part.counts) {
                if *alpha > 0.0 {
                    let cell = cell.of_all(counts.samples);
                    let n = cell.count as f64;
                    known &= cell.count > 1;
                    // Without a sample, the technique's part is missing.
                    value += if n > 0.0 { alpha * cell.mean } else { f64::NAN };
                    variance += alpha * alpha * cell.m2 / (n - 1.0) / n;
                }
            }
            Tallied { value, standard_error: known.then(|| variance.sqrt()), samples: added }
        };
        (0..self.sums).map(one).collect()
    }

    /// Sum `k` from the values that replicates come to, each for itself; NaN where one of them lacks
    /// samples. `samples` are those of each replicate of each technique.
    fn tallied_in_replicates(
        &self,
        frame: &Frame<'_>,
        k: usize,
        replicates: usize,
        samples: &[u64],
    ) -> Tallied {
        let cells: Vec<Cell> = self.rows.iter().skip(k).step_by(self.sums).copied().collect();
        let value = |r: usize| {
            let column = || cells.iter().zip(samples).skip(r).step_by(replicates);
            let total: u64 = column().map(|(_, n)| n).sum();
            let parts = column().zip(frame.shares).filter(|(_, share)| **share > 0.0);
            parts.fold(0.0, |sum, ((cell, n), share)| {
                let alpha = match frame.design {
                    Design::Stratified => *share,
                    Design::Pooled => *n as f64 / total as f64,
                };
                let mean = if *n > 0 { cell.of_all(*n).mean } else { f64::NAN };
                // Where the part is random, it may be 0.
                sum + if alpha == 0.0 { 0.0 } else { alpha * mean }
            })
        };
        let values: Vec<f64> = (0..replicates).map(value).collect();
        let values = Moments::of_block(&values);
        let added = cells.iter().map(|cell| cell.count).sum();
        let standard_error = values.standard_error().filter(|_| added > 0);
        Tallied { value: values.mean, standard_error, samples: added }
    }
}

#[cfg(test)]
mod tests {
    use super::{Cells, Pending, Tallied};
    use crate::estimator::{Design, Frame, OnFault};
    use crate::part::{Counts, Part};
    use crate::run::cell::tests::{agree, plain};
    use crate::weighting::Balance;

    /// Two sums of two techniques, three samples of each.
    fn cells() -> Cells {
        let (mut cells, mut pending) = (Cells::new(2, 2), Pending::default());
        let samples: [(usize, &[(usize, f64)]); 6] = [
            (0, &[(0, 1.0), (1, 5.0)]),
            (0, &[(1, 2.0), (0, 0.5), (1, 4.0), (0, 0.25)]), // 0.75 and 6, in four calls
            (0, &[]),
            (1, &[(0, 4.0), (2, 9.0)]),
            (1, &[(usize::MAX, 1.0)]),
            (1, &[(0, 2.0)]),
        ];
        for (technique, amounts) in samples {
            cells.sample(technique, &mut pending, |tally| {
                for (k, amount) in amounts {
                    tally.add(*k, *amount);
                }
            });
        }
        cells
    }

    fn tallied(cells: &Cells, design: Design, samples: [u64; 2]) -> Vec<Tallied> {
        let counts = samples.map(|samples| Counts { samples, ..Counts::default() });
        let part = Part { contributions: Vec::new(), counts: counts.to_vec() };
        let (shares, on_fault) = (&[0.25, 0.75], OnFault::Error);
        let frame =
            Frame { design, shares, samples: 6, on_fault, weighting: &Balance, controls: None };
        cells.tallied(&frame, &part, 1)
    }

    #[test]
    fn what_a_sample_adds_to_a_sum_is_one_amount() {
        let cells = cells();
        let counts: Vec<u64> = cells.rows.iter().map(|cell| cell.count).collect();
        assert_eq!((counts, cells.misplaced), (vec![2, 2, 2, 0], 2));
        agree(cells.rows[0], plain(&[1.0, 0.75]));
        agree(cells.rows[1], plain(&[5.0, 6.0]));
        agree(cells.rows[2], plain(&[4.0, 2.0]));
    }

    #[test]
    fn sums_are_means_over_all_samples() {
        let [a, b] = [plain(&[1.0, 0.75, 0.0]), plain(&[4.0, 0.0, 2.0])];
        let sums = tallied(&cells(), Design::Stratified, [3, 3]);
        assert_eq!((sums[0].samples, sums[1].samples), (4, 2));
        assert!((sums[0].value - (0.25 * a.1 + 0.75 * b.1)).abs() < 1e-15);
        let variance = (0.0625 * a.2 + 0.5625 * b.2) / 6.0;
        assert!((sums[0].standard_error.unwrap() - variance.sqrt()).abs() < 1e-15);
        assert!((sums[1].value - 0.25 * 11.0 / 3.0).abs() < 1e-15);

        let all = plain(&[1.0, 0.75, 0.0, 4.0, 0.0, 2.0]);
        let sums = tallied(&cells(), Design::Pooled, [3, 3]);
        assert!((sums[0].value - all.1).abs() < 1e-15);
        let error = (all.2 / 5.0 / 6.0).sqrt();
        assert!((sums[0].standard_error.unwrap() - error).abs() < 1e-15);
    }

    #[test]
    fn a_technique_without_a_share_takes_no_part() {
        let mut cells = Cells::new(2, 1);
        for amount in [1.0, 2.0, 4.0] {
            cells.sample(1, &mut Pending::default(), |tally| tally.add(0, amount));
        }
        let counts = [0, 3].map(|samples| Counts { samples, ..Counts::default() });
        let part = Part { contributions: Vec::new(), counts: counts.to_vec() };
        let (design, on_fault) = (Design::Stratified, OnFault::Error);
        let shares = &[0.0, 1.0];
        let frame =
            Frame { design, shares, samples: 3, on_fault, weighting: &Balance, controls: None };
        let sum = cells.tallied(&frame, &part, 1)[0];
        let (_, mean, m2) = plain(&[1.0, 2.0, 4.0]);
        assert!((sum.value - mean).abs() < 1e-15);
        assert!((sum.standard_error.unwrap() - (m2 / 6.0).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn what_cannot_be_known() {
        for design in [Design::Stratified, Design::Pooled] {
            let none = tallied(&Cells::new(2, 1), design, [3, 3]);
            assert_eq!((none[0].value, none[0].standard_error, none[0].samples), (0.0, None, 0));
            let nothing = tallied(&Cells::new(2, 1), design, [0, 0]);
            assert!(nothing[0].value.is_nan() && nothing[0].standard_error.is_none());
        }
        let mut one = Cells::new(2, 1);
        one.sample(0, &mut Pending::default(), |tally| tally.add(0, 2.0));
        // A technique without a sample, and one with a single sample.
        assert!(tallied(&one, Design::Stratified, [3, 0])[0].value.is_nan());
        let single = tallied(&one, Design::Stratified, [3, 1]);
        assert!(single[0].value.is_finite() && single[0].standard_error.is_none());
        assert_eq!(tallied(&one, Design::Pooled, [1, 0])[0].standard_error, None);
        assert!(tallied(&one, Design::Pooled, [1, 1])[0].standard_error.is_some());
    }

    #[test]
    fn merging_adds_every_cell() {
        let mut twice = cells();
        twice.merge(&cells());
        assert_eq!(twice.misplaced, 4);
        agree(twice.rows[0], plain(&[1.0, 0.75, 1.0, 0.75]));
        agree(twice.rows[2], plain(&[4.0, 2.0, 4.0, 2.0]));
        // No number of calls is too many.
        twice.misplaced = u64::MAX;
        twice.merge(&cells());
        assert_eq!(twice.misplaced, u64::MAX);
    }
}
