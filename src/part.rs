//! What a range of samples came to.

use serde::{Deserialize, Serialize};

use crate::moments::Moments;

/// A contribution of large magnitude, and the index of its sample.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Extreme {
    pub(crate) y: f64,
    pub(crate) index: u64,
}

/// The contributions of one technique, one component.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Contributions {
    pub(crate) moments: Moments,
    /// The first of the largest magnitude.
    pub(crate) extreme: Extreme,
}

impl Contributions {
    pub(crate) fn merge(self, right: Self) -> Self {
        let larger = right.extreme.y.abs() > self.extreme.y.abs();
        Self {
            moments: self.moments.merge(right.moments),
            extreme: if larger { right.extreme } else { self.extreme },
        }
    }
}

/// How many samples one technique drew, and how many of them call for attention.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub(crate) struct Counts {
    pub(crate) samples: u64,
    /// Of contributions that are 0 in every component, faults included.
    pub(crate) zero: u64,
    pub(crate) uncovered: u64,
    pub(crate) non_finite: u64,
}

impl Counts {
    pub(crate) fn merge(self, other: Self) -> Self {
        Self {
            samples: self.samples + other.samples,
            zero: self.zero + other.zero,
            uncovered: self.uncovered + other.uncovered,
            non_finite: self.non_finite + other.non_finite,
        }
    }

    /// Samples without a usable contribution.
    pub(crate) fn faults(&self) -> u64 {
        self.uncovered + self.non_finite
    }
}

/// What a range of an estimator's samples came to.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Part {
    /// One for each component of each replicate of each technique, a technique's side by side, and
    /// a replicate's; of contributions y = w f / (α p), so that the estimate is their mean.
    pub(crate) contributions: Vec<Contributions>,
    /// One for each technique.
    pub(crate) counts: Vec<Counts>,
}

impl Part {
    /// No samples.
    pub(crate) fn empty(techniques: usize, replicates: usize, components: usize) -> Self {
        Self {
            contributions: vec![Contributions::default(); techniques * replicates * components],
            counts: vec![Counts::default(); techniques],
        }
    }

    /// How many replicates the samples are divided among.
    pub(crate) fn replicates(&self, components: usize) -> usize {
        (self.contributions.len() / (self.counts.len() * components).max(1)).max(1)
    }

    /// Both parts together; `self` comes first.
    pub(crate) fn merge(mut self, right: &Self) -> Self {
        let pairs = self.contributions.iter_mut().zip(&right.contributions);
        pairs.for_each(|(left, right)| *left = left.merge(*right));
        let pairs = self.counts.iter_mut().zip(&right.counts);
        pairs.for_each(|(left, right)| *left = left.merge(*right));
        self
    }

    /// The counts of all techniques together.
    pub(crate) fn all(&self) -> Counts {
        self.counts.iter().fold(Counts::default(), |sum, counts| sum.merge(*counts))
    }
}

#[cfg(test)]
mod tests {
    use super::{Contributions, Counts, Extreme, Part};
    use crate::moments::Moments;

    #[test]
    fn the_first_of_the_largest_is_kept() {
        let of = |y: f64, index| Contributions {
            moments: Moments::of_block(&[y]),
            extreme: Extreme { y, index },
        };
        assert_eq!(of(-5.0, 1).merge(of(5.0, 2)).extreme, Extreme { y: -5.0, index: 1 });
        assert_eq!(of(4.0, 1).merge(of(5.0, 2)).extreme, Extreme { y: 5.0, index: 2 });
    }

    #[test]
    fn counts_add_for_each_technique() {
        let one = |k: u64| Counts { samples: 8 * k, zero: 4 * k, uncovered: 2 * k, non_finite: k };
        let part = |a, b| Part { contributions: Vec::new(), counts: vec![one(a), one(b)] };
        let both = part(1, 2).merge(&part(10, 20));
        assert_eq!(both.counts, [one(11), one(22)]);
        assert_eq!((both.all(), both.all().faults()), (one(33), 99));
    }
}
