//! The tree in which chunks are merged.

use serde::{Deserialize, Serialize};

use super::tally::Cells;
use crate::estimator::Seen;
use crate::part::Part;

/// What one chunk came to, or several that lie side by side.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Node {
    pub(super) part: Part,
    /// See [`Evidence`](crate::estimator::Evidence).
    pub(super) seen: Vec<Seen>,
    pub(super) densities: Vec<[f64; 2]>,
    pub(super) cells: Cells,
}

impl Node {
    /// Both together; `self` comes first.
    pub(super) fn merge(mut self, right: &Self) -> Self {
        self.part = self.part.merge(&right.part);
        for (left, right) in self.seen.iter_mut().zip(&right.seen) {
            left.samples += right.samples;
            left.contributions += right.contributions;
        }
        for (left, right) in self.densities.iter_mut().zip(&right.densities) {
            left.iter_mut().zip(right).for_each(|(left, right)| *left += right);
        }
        self.cells.merge(&right.cells);
        self
    }
}

/// The chunks of a round, merged in the dyadic tree over their indices.
///
/// The node at (level, index) covers the chunks from index · 2^level to (index + 1) · 2^level - 1.
/// Only neighbours that make up a node of the next level are merged, left with right, so that every
/// node has the same bits, however the chunks were divided among threads, processes and sessions.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Tree {
    /// In the order of their chunks.
    nodes: Vec<(u32, u64, Node)>,
}

impl Tree {
    /// Adds a node that lies behind all others. Nodes that are merged into others go to `spent`.
    pub(super) fn push(&mut self, level: u32, index: u64, node: Node, spent: &mut Vec<Node>) {
        let (mut level, mut index, mut node) = (level, index, node);
        while let Some((_, _, left)) = self
            .nodes
            .pop_if(|(last, left, _)| *last == level && index % 2 == 1 && *left == index - 1)
        {
            let merged = left.merge(&node);
            spent.push(std::mem::replace(&mut node, merged));
            (level, index) = (level + 1, index / 2);
        }
        self.nodes.push((level, index, node));
    }

    /// Adds the nodes of a tree whose chunks lie behind all of these.
    pub(super) fn append(&mut self, right: Self) {
        for (level, index, node) in right.nodes {
            self.push(level, index, node, &mut Vec::new());
        }
    }

    /// The nodes, each with the chunks that it covers.
    pub(super) fn nodes(&self) -> impl Iterator<Item = (std::ops::Range<u64>, &Node)> {
        let at = |level: &u32, index: u64| index.saturating_mul(1_u64.unbounded_shl(*level));
        let chunks =
            move |level, index: &u64| at(level, *index)..at(level, index.saturating_add(1));
        self.nodes.iter().map(move |(level, index, node)| (chunks(level, index), node))
    }

    /// Whether all neighbours that make up a node are merged.
    pub(super) fn is_merged(&self) -> bool {
        let pair = |a: &(u32, u64, Node), b: &(u32, u64, Node)| {
            a.0 == b.0 && b.1 % 2 == 1 && a.1 == b.1 - 1
        };
        self.nodes.iter().zip(self.nodes.iter().skip(1)).all(|(a, b)| !pair(a, b))
    }

    /// The chunks that the nodes cover, if there is no gap between them.
    pub(super) fn chunks(&self) -> Option<std::ops::Range<u64>> {
        let mut covered: Option<std::ops::Range<u64>> = None;
        for (level, index, _) in &self.nodes {
            let chunks = 1_u64.checked_shl(*level)?;
            let first = index.checked_mul(chunks)?;
            let end = first.checked_add(chunks)?;
            let start = match covered {
                None => first,
                Some(covered) if covered.end == first => covered.start,
                Some(_) => return None,
            };
            covered = Some(start..end);
        }
        Some(covered.unwrap_or(0..0))
    }

    /// Everything together, merged from last to first.
    pub(super) fn total(&self) -> Option<Node> {
        let mut nodes = self.nodes.iter().rev().map(|(_, _, node)| node);
        let last = nodes.next()?.clone();
        Some(nodes.fold(last, |right, left| left.clone().merge(&right)))
    }
}

#[cfg(test)]
mod tests {
    use super::{Node, Tree};
    use crate::estimator::Seen;
    use crate::moments::Moments;
    use crate::part::{Contributions, Counts, Extreme, Part};

    /// What a chunk of two samples came to; sums of any two are rounded. All extremes are equal, so
    /// that of several nodes the first shows.
    fn node(k: u64) -> Node {
        let ys = [(k as f64 + 0.1).sqrt(), 1.0 / (k as f64 + 0.3)];
        let extreme = Extreme { y: 1.0, index: k };
        Node {
            part: Part {
                contributions: vec![Contributions { moments: Moments::of_block(&ys), extreme }],
                counts: vec![Counts { samples: 2, ..Counts::default() }],
            },
            seen: vec![Seen { samples: 2, contributions: k }],
            densities: vec![[ys[0], ys[1]]],
            cells: crate::run::tally::Cells::default(),
        }
    }

    fn tree(chunks: std::ops::Range<u64>) -> Tree {
        let mut tree = Tree::default();
        chunks.for_each(|k| tree.push(0, k, node(k), &mut Vec::new()));
        tree
    }

    #[test]
    fn nodes_do_not_depend_on_how_chunks_are_divided() {
        for n in 1..=17 {
            let whole = tree(0..n);
            assert_eq!(whole.nodes.len(), n.count_ones() as usize);
            for a in 0..=n {
                for b in a..=n {
                    let mut parts = tree(0..a);
                    parts.append(tree(a..b));
                    parts.append(tree(b..n));
                    assert_eq!(parts, whole, "{a} {b} {n}");
                }
            }
        }
    }

    #[test]
    fn all_nodes_that_are_merged_are_handed_on() {
        for n in 1..=17 {
            let (mut tree, mut spent) = (Tree::default(), Vec::new());
            (0..n).for_each(|k| tree.push(0, k, node(k), &mut spent));
            assert_eq!((tree.nodes.len() + spent.len()) as u64, n);
        }
    }

    #[test]
    fn neighbours_merge_and_leftovers_from_last_to_first() {
        let pair = |k| node(k).merge(&node(k + 1));
        let four = pair(0).merge(&pair(2));
        assert_eq!(tree(0..4).total(), Some(four.clone()));
        let seven = four.merge(&pair(4).merge(&node(6)));
        assert_eq!(tree(0..7).total(), Some(seven.clone()));
        assert_eq!(seven.part.contributions[0].extreme.index, 0);
        // The halves of a hundred: 64, 32 and 4.
        let total = |range| tree(range).total().unwrap();
        let hundred = total(0..64).merge(&total(64..96).merge(&total(96..100)));
        assert_eq!(total(0..100), hundred);
        assert_ne!(total(0..64).merge(&total(64..96)).merge(&total(96..100)), hundred);
        // In another order, other bits.
        assert_ne!(Some((1..7).fold(node(0), |sum, k| sum.merge(&node(k)))), tree(0..7).total());
        assert_eq!(seven.part.counts[0].samples, 14);
        assert_eq!(Tree::default().total(), None);
    }

    #[test]
    fn chunks_1_and_2_are_neighbours_but_no_pair() {
        let [one, two] = [node(1), node(2)];
        let tree = tree(1..3);
        assert_eq!(tree.nodes, [(0, 1, one), (0, 2, two)]);
        let mut apart = Tree::default();
        apart.push(0, 1, node(1), &mut Vec::new());
        apart.push(0, 3, node(3), &mut Vec::new());
        assert_eq!(apart.nodes.len(), 2);
        // Nor are two of different levels.
        let mut levels = Tree::default();
        levels.push(1, 0, node(0), &mut Vec::new());
        levels.push(0, 1, node(1), &mut Vec::new());
        assert_eq!(levels.nodes.len(), 2);
    }

    #[test]
    fn the_chunks_that_are_covered() {
        assert_eq!(Tree::default().chunks(), Some(0..0));
        for (start, end) in [(0, 1), (0, 7), (3, 8), (5, 6), (1, 16)] {
            assert_eq!(tree(start..end).chunks(), Some(start..end));
        }
        let mut gap = tree(0..3);
        gap.append(tree(4..6));
        assert_eq!(gap.chunks(), None);
        let mut twice = tree(0..3);
        twice.append(tree(2..4));
        assert_eq!(twice.chunks(), None);
        // Beyond the range of counts: bits must not be lost.
        for (level, index, chunks) in [
            (63, 0, Some(0..1 << 63)),
            (63, 1, None),
            (63, 2, None),
            (64, 0, None),
            (1, 1 << 63, None),
            (0, u64::MAX - 1, Some(u64::MAX - 1..u64::MAX)),
            (0, u64::MAX, None),
        ] {
            assert_eq!(Tree { nodes: vec![(level, index, node(0))] }.chunks(), chunks);
        }
    }

    #[test]
    fn nodes_and_whether_they_are_merged() {
        let seven = tree(1..8);
        let chunks: Vec<_> = seven.nodes().map(|(chunks, _)| chunks).collect();
        assert_eq!(chunks, [1..2, 2..4, 4..8]);
        assert!(seven.nodes().all(|(chunks, node)| {
            node.part.counts[0].samples == 2 * (chunks.end - chunks.start)
        }));
        for start in 0..6 {
            assert!((start..9).all(|end| tree(start..end).is_merged()));
        }
        let nodes = |nodes: [(u32, u64); 2]| Tree {
            nodes: nodes.map(|(level, index)| (level, index, node(0))).to_vec(),
        };
        assert!(!nodes([(0, 4), (0, 5)]).is_merged() && !nodes([(3, 0), (3, 1)]).is_merged());
        assert!(nodes([(0, 5), (0, 6)]).is_merged() && nodes([(1, 0), (0, 1)]).is_merged());
        assert!(nodes([(0, 0), (0, 3)]).is_merged());
    }
}
