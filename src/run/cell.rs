//! The amounts that were added to one sum of a tally.

use serde::{Deserialize, Serialize};

/// Count, mean and squared deviations of the amounts that were added.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Cell {
    pub(super) count: u64,
    pub(super) mean: f64,
    pub(super) m2: f64,
}

impl Cell {
    /// B. P. Welford, *Note on a Method for Calculating Corrected Sums of Squares and Products*,
    /// 1962, doi:10.1080/00401706.1962.10490022.
    pub(super) fn push(&mut self, amount: f64) {
        self.count += 1;
        let delta = amount - self.mean;
        self.mean += delta / self.count as f64;
        self.m2 += delta * (amount - self.mean);
    }

    pub(super) fn merge(self, other: Self) -> Self {
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
    pub(super) fn of_all(self, n: u64) -> Self {
        self.merge(Self { count: n.saturating_sub(self.count), mean: 0.0, m2: 0.0 })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::Cell;

    fn cell(amounts: &[f64]) -> Cell {
        let mut cell = Cell::default();
        for amount in amounts {
            cell.push(*amount);
        }
        cell
    }

    /// Count, mean and squared deviations by plain sums.
    pub(in crate::run) fn plain(amounts: &[f64]) -> (u64, f64, f64) {
        let n = amounts.len() as f64;
        let mean = amounts.iter().sum::<f64>() / n;
        (amounts.len() as u64, mean, amounts.iter().map(|a| (a - mean).powi(2)).sum())
    }

    pub(in crate::run) fn agree(cell: Cell, (count, mean, m2): (u64, f64, f64)) {
        assert_eq!(cell.count, count);
        assert!((cell.mean - mean).abs() < 1e-14 && (cell.m2 - m2).abs() < 1e-13, "{cell:?}");
    }

    const AMOUNTS: [f64; 7] = [1.5, -0.25, 3.0, 0.0, 2.75, -1.0, 0.5];

    #[test]
    fn cells_are_plain_sums() {
        agree(cell(&AMOUNTS), plain(&AMOUNTS));
        for cut in 0..=AMOUNTS.len() {
            let (left, right) = AMOUNTS.split_at(cut);
            agree(cell(left).merge(cell(right)), plain(&AMOUNTS));
        }
        let with_zeros = [&AMOUNTS[..], &[0.0; 13]].concat();
        agree(cell(&AMOUNTS).of_all(20), plain(&with_zeros));
        agree(cell(&AMOUNTS).of_all(7), plain(&AMOUNTS));
    }
}
