//! The tree in which chunks are merged.

use serde::{Deserialize, Serialize};

use super::tally::Cells;
use crate::estimator::Seen;
use crate::part::Part;

/// What one chunk came to, or several that lie side by side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    /// Adds a node that lies behind all others.
    pub(super) fn push(&mut self, level: u32, index: u64, node: Node) {
        let (mut level, mut index, mut node) = (level, index, node);
        while let Some((_, _, left)) = self
            .nodes
            .pop_if(|(last, left, _)| *last == level && index % 2 == 1 && *left == index - 1)
        {
            node = left.merge(&node);
            (level, index) = (level + 1, index / 2);
        }
        self.nodes.push((level, index, node));
    }

    /// Adds the nodes of a tree whose chunks lie behind all of these.
    pub(super) fn append(&mut self, right: Self) {
        for (level, index, node) in right.nodes {
            self.push(level, index, node);
        }
    }

    /// The chunks that the nodes cover, if there is no gap between them.
    pub(super) fn chunks(&self) -> Option<std::ops::Range<u64>> {
        let mut covered: Option<std::ops::Range<u64>> = None;
        for (level, index, _) in &self.nodes {
            let first = index.checked_shl(*level)?;
            let end = index.checked_add(1)?.checked_shl(*level)?;
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
