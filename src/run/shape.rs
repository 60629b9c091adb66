//! How long the lists of a run are, and what its counts can be.

use super::state::Leaf;
use super::tree::Node;
use crate::estimator::Evidence;
use crate::tail::Tail;

/// What the lengths of all lists follow from. A file is held against it: the checksum tells only
/// that the file is as it was written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shape {
    pub(super) techniques: usize,
    pub(super) replicates: usize,
    pub(super) components: usize,
    pub(super) sums: usize,
}

/// The lengths of the lists of a [`Leaf`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Lengths {
    pub(super) contributions: usize,
    pub(super) counts: usize,
    pub(super) seen: usize,
    pub(super) densities: usize,
    /// The cells of a tally.
    pub(super) cells: usize,
    pub(super) tails: usize,
}

impl Shape {
    /// The replicates of all techniques.
    pub(super) fn streams(self) -> usize {
        self.techniques.saturating_mul(self.replicates)
    }

    /// What the lengths must be.
    pub(super) fn lengths(self) -> Lengths {
        let Self { techniques, components, sums, .. } = self;
        let streams = self.streams();
        Lengths {
            contributions: streams.saturating_mul(components),
            counts: techniques,
            seen: techniques,
            densities: Evidence::pairs(techniques),
            cells: streams.saturating_mul(sums),
            tails: techniques.saturating_mul(components),
        }
    }

    /// # Errors
    ///
    /// What is wrong with a leaf of so many samples.
    pub(super) fn check_leaf(self, leaf: &Leaf, samples: u64) -> Result<(), String> {
        self.check(&leaf.node, samples)?;
        self.check_tails(&leaf.tails)
    }

    /// # Errors
    ///
    /// What is wrong with a node of so many samples.
    pub(super) fn check(self, node: &Node, samples: u64) -> Result<(), String> {
        let lengths = self.lengths();
        has("contributions", node.part.contributions.len(), lengths.contributions)?;
        has("counts", node.part.counts.len(), lengths.counts)?;
        has("counts of what was looked at", node.seen.len(), lengths.seen)?;
        has("sums of densities", node.densities.len(), lengths.densities)?;
        has("sums of a tally", node.cells.sums(), self.sums)?;
        has("cells of a tally", node.cells.counts().len(), lengths.cells)?;
        self.check_counts(node, samples)
    }

    /// # Errors
    ///
    /// There are too many tails, or too few.
    pub(super) fn check_tails(self, tails: &[Tail]) -> Result<(), String> {
        has("tails", tails.len(), self.lengths().tails)
    }

    /// Whether what was counted can come of so many samples. Whatever passes adds up to no more
    /// than all samples of the run, so that no sum of counts overflows.
    fn check_counts(self, node: &Node, samples: u64) -> Result<(), String> {
        let all: u128 = node.part.counts.iter().map(|counts| u128::from(counts.samples)).sum();
        // A technique's share of the samples is rounded.
        if all.abs_diff(u128::from(samples)) >= self.techniques as u128 {
            return Err(format!("{all} samples where there should be {samples}"));
        }
        // So many of each list are a technique's.
        let each = |length: usize| length / self.techniques.max(1);
        let contributions = each(node.part.contributions.len());
        let cells = each(node.cells.counts().len());
        for (i, (counts, seen)) in node.part.counts.iter().zip(&node.seen).enumerate() {
            let n = counts.samples;
            let faults = u128::from(counts.uncovered) + u128::from(counts.non_finite);
            let moments = || node.part.contributions.iter().skip(i * contributions);
            let counted = || moments().take(contributions).map(|one| one.moments.count);
            let total: u128 = counted().map(u128::from).sum();
            let mut added = node.cells.counts().skip(i * cells).take(cells);
            let sound = faults <= u128::from(counts.zero)
                && counts.zero <= n
                && seen.contributions <= seen.samples
                && seen.samples <= n
                && counted().all(|count| count <= n)
                && total == u128::from(n) * self.components as u128
                && moments().take(contributions).all(|one| one.moments.is_sound())
                && added.all(|count| count <= n);
            if !sound {
                return Err(format!("counts that contradict the {n} samples of technique {i}"));
            }
        }
        Ok(())
    }
}

fn has(what: &str, found: usize, expected: usize) -> Result<(), String> {
    if found == expected {
        Ok(())
    } else {
        Err(format!("{found} {what} where there should be {expected}"))
    }
}

#[cfg(test)]
mod tests {
    use super::{Lengths, Shape};
    use crate::estimator::Seen;
    use crate::moments::Moments;
    use crate::part::Counts;
    use crate::run::state::Leaf;
    use crate::run::tally::{Cells, Pending};
    use crate::run::tree::Node;

    const SHAPE: Shape = Shape { techniques: 2, replicates: 1, components: 3, sums: 4 };

    /// Two samples of the first technique, five of the second.
    fn leaf() -> Leaf {
        let mut leaf = Leaf::default();
        leaf.clear(SHAPE, &[0.0; 6]);
        let Node { part, seen, cells, .. } = &mut leaf.node;
        for (k, contributions) in part.contributions.iter_mut().enumerate() {
            contributions.moments = Moments::of_block(&[1.0; 5][..if k < 3 { 2 } else { 5 }]);
        }
        part.counts[0] = Counts { samples: 2, zero: 2, uncovered: 1, non_finite: 1 };
        part.counts[1] = Counts { samples: 5, ..Counts::default() };
        seen[0] = Seen { samples: 2, contributions: 2 };
        for i in [0, 0, 1, 1, 1, 1, 1] {
            cells.sample(i, &mut Pending::default(), |tally| tally.add(3, 1.0));
        }
        leaf
    }

    fn problem(samples: u64, change: impl Fn(&mut Leaf)) -> String {
        let mut leaf = leaf();
        change(&mut leaf);
        SHAPE.check_leaf(&leaf, samples).unwrap_err()
    }

    #[test]
    fn lengths() {
        assert_eq!(SHAPE.check_leaf(&leaf(), 7), Ok(()));
        for (change, text) in [
            (
                (|leaf| leaf.node.part.contributions.truncate(5)) as fn(&mut Leaf),
                "5 contributions where there should be 6",
            ),
            (|leaf| leaf.node.part.counts.truncate(1), "1 counts where there should be 2"),
            (
                |leaf| leaf.node.seen.clear(),
                "0 counts of what was looked at where there should be 2",
            ),
            (
                |leaf| leaf.node.densities.push([0.0; 2]),
                "5 sums of densities where there should be 4",
            ),
            (
                |leaf| leaf.node.cells = Cells::new(4, 2),
                "2 sums of a tally where there should be 4",
            ),
            (
                |leaf| leaf.node.cells = Cells::new(1, 4),
                "4 cells of a tally where there should be 8",
            ),
            (|leaf| leaf.tails.truncate(3), "3 tails where there should be 6"),
        ] {
            assert_eq!(problem(7, change), text);
        }
        // Of many techniques, densities are not compared.
        let many = Shape { techniques: 65, replicates: 3, components: 2, sums: 4 };
        let Lengths { contributions, densities, cells, tails, .. } = many.lengths();
        // Contributions and cells are a replicate's.
        assert_eq!((contributions, densities, cells, tails), (390, 0, 780, 130));
    }

    #[test]
    fn as_many_samples_as_there_are_up_to_rounding() {
        for (samples, right) in [(5, false), (6, true), (8, true), (9, false)] {
            assert_eq!(SHAPE.check_leaf(&leaf(), samples).is_ok(), right, "{samples}");
        }
        assert_eq!(problem(9, |_| ()), "7 samples where there should be 9");
        let most = |leaf: &mut Leaf| leaf.node.part.counts[1].samples = u64::MAX;
        let text = "18446744073709551617 samples where there should be 1";
        assert_eq!(problem(1, most), text);
    }

    #[test]
    fn counts_that_contradict_each_other() {
        let changes = [
            (0, (|leaf| leaf.node.part.counts[0].zero = 1) as fn(&mut Leaf)),
            (1, |leaf| leaf.node.part.counts[1].zero = 6),
            (1, |leaf| leaf.node.part.counts[1].uncovered = 1),
            (1, |leaf| {
                leaf.node.part.counts[1] =
                    Counts { samples: 5, zero: 0, uncovered: u64::MAX, non_finite: 1 };
            }),
            (0, |leaf| leaf.node.seen[0].samples = 3),
            (0, |leaf| leaf.node.seen[0].samples = 1),
            (0, |leaf| leaf.node.part.contributions[2].moments = Moments::default()),
            (1, |leaf| leaf.node.part.contributions[5].moments.count = u64::MAX),
            (1, |leaf| {
                // Five numbers, in a unit that is none.
                let fields = (5_u64, 1.0, 0.0, 0.0, 1021_i32, 1.0);
                let bytes = postcard::to_stdvec(&fields).unwrap();
                leaf.node.part.contributions[4].moments = postcard::from_bytes(&bytes).unwrap();
            }),
            // The sum is right.
            (1, |leaf| {
                leaf.node.part.contributions[3].moments.count = 4;
                leaf.node.part.contributions[5].moments.count = 6;
            }),
            (1, |leaf| {
                leaf.node.cells.sample(1, &mut Pending::default(), |tally| tally.add(3, 1.0));
            }),
        ];
        for (k, (i, change)) in changes.into_iter().enumerate() {
            let n = [2, 5][i];
            let text = format!("counts that contradict the {n} samples of technique {i}");
            assert_eq!(problem(7, change), text, "{k}");
        }
    }
}
