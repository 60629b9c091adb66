//! What a run has done so far: all that a checkpoint has to hold.

use serde::{Deserialize, Serialize};

use super::schedule::Span;
use super::tree::{Node, Tree};
use crate::tail::Tail;

/// What some chunks of a round came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Leaf {
    pub(super) node: Node,
    /// One for each component of each technique.
    pub(super) tails: Vec<Tail>,
}

/// A chunk that is shorter than its round would have it, as the run ends within it. It is kept
/// apart, so that the run can go on as if it had never been drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Cut {
    index: u64,
    /// The samples of its range.
    start: u64,
    end: u64,
    leaf: Leaf,
}

/// The chunks of a round that are done.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Round {
    tree: Tree,
    tails: Vec<Tail>,
    cut: Option<Cut>,
}

impl Round {
    /// Adds the chunk that follows those that are there.
    pub(super) fn push(&mut self, span: &Span, index: u64, leaf: Leaf) {
        if span.is_cut(index) {
            let std::ops::Range { start, end } = span.chunk(index);
            self.cut = Some(Cut { index, start, end, leaf });
        } else {
            merge_tails(&mut self.tails, &leaf.tails);
            self.tree.push(0, index, leaf.node);
        }
    }

    /// Forgets a cut chunk that this span has longer.
    pub(super) fn fit(&mut self, span: &Span) {
        self.cut.take_if(|cut| span.chunk(cut.index) != (cut.start..cut.end));
    }

    /// The chunks that are done; `None` if there are gaps between them.
    pub(super) fn done(&self) -> Option<std::ops::Range<u64>> {
        let whole = self.tree.chunks()?;
        match &self.cut {
            None => Some(whole),
            Some(cut) if whole.is_empty() => Some(cut.index..cut.index + 1),
            Some(cut) if cut.index == whole.end => Some(whole.start..cut.index + 1),
            Some(_) => None,
        }
    }

    /// How many samples its chunks stand for.
    pub(super) fn samples(&self, span: &Span) -> u64 {
        self.done().map_or(0, |chunks| span.samples_of(&chunks))
    }

    /// Adds the chunks of another part of the round, which lie behind these.
    pub(super) fn append(&mut self, right: Self) {
        self.tree.append(right.tree);
        merge_tails(&mut self.tails, &right.tails);
        self.cut = self.cut.take().or(right.cut);
    }

    /// What all its chunks came to.
    pub(super) fn total(&self) -> Option<Leaf> {
        let Some(cut) = &self.cut else {
            return Some(Leaf { node: self.tree.total()?, tails: self.tails.clone() });
        };
        let (mut tree, mut tails) = (self.tree.clone(), self.tails.clone());
        tree.push(0, cut.index, cut.leaf.node.clone());
        merge_tails(&mut tails, &cut.leaf.tails);
        Some(Leaf { node: tree.total()?, tails })
    }

    /// Where the tails begin, for chunks to come.
    pub(super) fn thresholds(&self, out: &mut [f64]) {
        for (out, tail) in out.iter_mut().zip(&self.tails) {
            *out = tail.threshold();
        }
    }
}

impl Leaf {
    /// Both together; `self` comes first.
    pub(super) fn merge(mut self, right: &Self) -> Self {
        self.node = self.node.merge(&right.node);
        merge_tails(&mut self.tails, &right.tails);
        self
    }
}

fn merge_tails(left: &mut Vec<Tail>, right: &[Tail]) {
    left.resize(left.len().max(right.len()), Tail::default());
    left.iter_mut().zip(right).for_each(|(left, right)| left.merge(right));
}
