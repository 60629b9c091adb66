//! Sums over the samples of a run that its user defines: histograms, derived observables.

use serde::{Deserialize, Serialize};

use crate::estimator::{Design, Frame};
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

/// Count, mean and squared deviations of the amounts that were added.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Cell {
    count: u64,
    mean: f64,
    m2: f64,
}

impl Cell {
    /// B. P. Welford, *Note on a Method for Calculating Corrected Sums of Squares and Products*,
    /// 1962, doi:10.1080/00401706.1962.10490022.
    fn push(&mut self, amount: f64) {
        self.count += 1;
        let delta = amount - self.mean;
        self.mean += delta / self.count as f64;
        self.m2 += delta * (amount - self.mean);
    }

    fn merge(self, other: Self) -> Self {
        if self.count == 0 {
            return other;
        }
        if other.count == 0 {
            return self;
        }
        let (a, b) = (self.count as f64, other.count as f64);
        let delta = other.mean - self.mean;
        Self {
            count: self.count + other.count,
            mean: self.mean + delta * (b / (a + b)),
            m2: self.m2 + other.m2 + delta * delta * (a * b / (a + b)),
        }
    }

    /// With the samples that added nothing, `n` in all.
    fn of_all(self, n: u64) -> Self {
        self.merge(Self { count: n.saturating_sub(self.count), mean: 0.0, m2: 0.0 })
    }
}

/// All sums of all techniques.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Cells {
    sums: usize,
    /// A row for each technique.
    rows: Vec<Cell>,
    pub(super) misplaced: u64,
}

impl Cells {
    pub(super) fn new(techniques: usize, sums: usize) -> Self {
        Self { sums, rows: vec![Cell::default(); techniques * sums], misplaced: 0 }
    }

    /// Adds what `observe` says of one sample of technique `i`.
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

    pub(super) fn merge(&mut self, right: &Self) {
        for (left, right) in self.rows.iter_mut().zip(&right.rows) {
            *left = left.merge(*right);
        }
        self.misplaced += right.misplaced;
    }

    /// The sums as estimates, where the samples were these.
    pub(super) fn tallied(&self, frame: &Frame<'_>, part: &Part) -> Vec<Tallied> {
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
}
