//! The largest contributions, of which the tail of their distribution is judged.

use serde::{Deserialize, Serialize};

/// How many are kept: the 256 that a tail is fitted to, and the next, at which it begins.
const KEPT: usize = 257;

/// The largest magnitudes of a set of contributions.
///
/// Which they are does not depend on the order in which contributions come, nor on how they are
/// divided among threads.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Tail {
    /// Nothing up to here is among the largest.
    above: f64,
    magnitudes: Vec<f64>,
}

impl Tail {
    /// Begins anew, with a set in which at least 257 others are known to reach `above`.
    pub(crate) fn begin(&mut self, above: f64) {
        self.above = above;
        self.magnitudes.clear();
    }

    /// Where the tail begins: what is not above cannot change it.
    pub(crate) fn threshold(&self) -> f64 {
        self.above
    }

    /// Adds contributions, the largest of which has magnitude `largest`.
    pub(crate) fn push(&mut self, ys: &[f64], largest: f64) {
        if largest > self.above {
            let above = self.above;
            // Whole chunks are compared without a branch for each element.
            for ys in ys.chunks(8) {
                if ys.iter().fold(false, |any, y| any | (y.abs() > above)) {
                    self.magnitudes.extend(ys.iter().map(|y| y.abs()).filter(|y| *y > above));
                }
            }
            if self.magnitudes.len() >= 2 * KEPT {
                self.prune();
            }
        }
    }

    /// Adds those of another set.
    pub(crate) fn merge(&mut self, other: &Self) {
        let above = self.above;
        self.magnitudes.extend(other.magnitudes.iter().filter(|y| **y > above));
        if self.magnitudes.len() >= 2 * KEPT {
            self.prune();
        }
    }

    /// Gives back the memory that it does not need.
    pub(crate) fn shrink(&mut self) {
        self.magnitudes.shrink_to_fit();
    }

    /// The largest 257 magnitudes, or all that are not 0, in no order.
    pub(crate) fn magnitudes(&mut self) -> &[f64] {
        self.prune();
        &self.magnitudes
    }

    /// Keeps the largest 257.
    fn prune(&mut self) {
        if self.magnitudes.len() >= KEPT {
            let (_, least, _) =
                self.magnitudes.select_nth_unstable_by(KEPT - 1, |a, b| b.total_cmp(a));
            self.above = self.above.max(*least);
            self.magnitudes.truncate(KEPT);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{KEPT, Tail};

    fn numbers(n: u32) -> Vec<f64> {
        (0..n).map(|k| f64::from(k * 7919 % 10_007) * if k % 2 == 0 { 1.0 } else { -1.0 }).collect()
    }

    fn sorted(tail: &Tail) -> Vec<f64> {
        let mut all = tail.clone().magnitudes().to_vec();
        all.sort_by(f64::total_cmp);
        all
    }

    fn of(ys: &[f64]) -> Tail {
        let mut tail = Tail::default();
        for ys in ys.chunks(100) {
            tail.push(ys, ys.iter().fold(0.0, |most: f64, y| most.max(y.abs())));
        }
        tail
    }

    #[test]
    fn the_largest_are_kept_however_the_set_is_divided() {
        let ys = numbers(5000);
        let mut largest: Vec<f64> = ys.iter().map(|y| y.abs()).collect();
        largest.sort_by(f64::total_cmp);
        let expected = largest[5000 - KEPT..].to_vec();
        assert_eq!(sorted(&of(&ys)), expected);
        for cut in [1, 300, 2500, 4999] {
            let (left, right) = ys.split_at(cut);
            let mut merged = of(right);
            merged.merge(&of(left));
            assert_eq!(sorted(&merged), expected, "{cut}");
            // What a threshold that is already reached leaves out is not missed.
            let mut known = of(left);
            let mut rest = of(&numbers(1000));
            rest.begin(known.threshold());
            rest.push(right, 1e9);
            known.merge(&rest);
            assert_eq!(sorted(&known), expected, "{cut} with a threshold");
        }
    }

    #[test]
    fn zeros_are_no_tail() {
        assert_eq!(of(&[0.0; 1000]).magnitudes(), &[] as &[f64]);
        assert_eq!(sorted(&of(&[0.0, -2.0, 0.0, 1.0])), [1.0, 2.0]);
    }
}
