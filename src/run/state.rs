//! What a run has done so far: all that a checkpoint has to hold.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::schedule::Span;
use super::shape::{Lengths, Shape};
use super::tree::{Node, Tree};
use crate::tail::Tail;

/// What some chunks of a round came to.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Leaf {
    pub(super) node: Node,
    /// One for each component of each technique.
    pub(super) tails: Vec<Tail>,
}

/// Memory that chunks to come can have.
#[derive(Debug, Default)]
pub(super) struct Spare {
    nodes: Vec<Node>,
    tails: Vec<Vec<Tail>>,
}

impl Spare {
    /// A leaf to be cleared.
    pub(super) fn leaf(&mut self) -> Leaf {
        let node = self.nodes.pop().unwrap_or_default();
        Leaf { node, tails: self.tails.pop().unwrap_or_default() }
    }
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
    /// Adds the chunk that follows those that are there. What memory is then free goes to `spare`.
    pub(super) fn push(&mut self, span: &Span, index: u64, leaf: Leaf, spare: &mut Spare) {
        if span.is_cut(index) {
            let Range { start, end } = span.chunk(index);
            self.cut = Some(Cut { index, start, end, leaf });
        } else {
            merge_tails(&mut self.tails, &leaf.tails);
            spare.tails.push(leaf.tails);
            self.tree.push(0, index, leaf.node, &mut spare.nodes);
        }
    }

    /// Whether a round from a file can be one at all, wherever its run ends. `span` is the round of
    /// a run without end.
    ///
    /// # Errors
    ///
    /// What is wrong with it.
    pub(super) fn check(&self, span: &Span, shape: Shape) -> Result<(), String> {
        let whole = self.tree.chunks().filter(|whole| whole.end <= span.chunks());
        if whole.is_none() || self.done().is_none() || !self.tree.is_merged() {
            return Err("chunks that do not follow one another".into());
        }
        for (chunks, node) in self.tree.nodes() {
            shape.check(node, span.samples_of(&chunks))?;
        }
        if self.tree.nodes().next().is_some() {
            shape.check_tails(&self.tails)?;
        } else if !self.tails.is_empty() {
            return Err("tails without chunks".into());
        }
        if let Some(Cut { index, start, end, leaf }) = &self.cut {
            let chunk = span.chunk(*index);
            if *start != chunk.start || start >= end || *end >= chunk.end {
                return Err(format!("samples {start} to {end} as chunk {index}"));
            }
            shape.check_leaf(leaf, end - start)?;
        }
        Ok(())
    }

    /// Forgets a cut chunk that this span has longer or shorter. Whether what is left is the
    /// beginning of `share`, the chunks of the span that are to be here.
    pub(super) fn fit(&mut self, span: &Span, share: Range<u64>) -> bool {
        self.cut.take_if(|cut| span.chunk(cut.index) != (cut.start..cut.end));
        let whole = self.tree.chunks();
        // A whole chunk, where the span has only a part of it.
        let longer = |whole: Range<u64>| !whole.is_empty() && span.is_cut(whole.end - 1);
        match self.done() {
            Some(done) if done.is_empty() => true,
            Some(done) => {
                done.start == share.start && done.end <= share.end && !whole.is_some_and(longer)
            }
            None => false,
        }
    }

    /// The chunks that are done; `None` if there are gaps between them.
    pub(super) fn done(&self) -> Option<Range<u64>> {
        let whole = self.tree.chunks()?;
        match &self.cut {
            None => Some(whole),
            Some(cut) if whole.is_empty() => Some(cut.index..cut.index.saturating_add(1)),
            Some(cut) if cut.index == whole.end => Some(whole.start..cut.index.saturating_add(1)),
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

    /// Gives back what memory its tails do not need: a run keeps all its rounds.
    pub(super) fn shrink(&mut self) {
        self.tails.iter_mut().for_each(Tail::shrink);
    }

    /// What all its chunks came to.
    pub(super) fn total(&self) -> Option<Leaf> {
        let Some(cut) = &self.cut else {
            return Some(Leaf { node: self.tree.total()?, tails: self.tails.clone() });
        };
        let (mut tree, mut tails) = (self.tree.clone(), self.tails.clone());
        tree.push(0, cut.index, cut.leaf.node.clone(), &mut Vec::new());
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
    /// Makes it one of no samples; tails begin at `thresholds`.
    pub(super) fn clear(&mut self, shape: Shape, thresholds: &[f64]) {
        let Lengths { contributions, counts, seen, densities, tails, .. } = shape.lengths();
        let Node { part, cells, .. } = &mut self.node;
        refill(&mut part.contributions, contributions);
        refill(&mut part.counts, counts);
        cells.clear(shape.streams(), shape.sums);
        refill(&mut self.node.seen, seen);
        refill(&mut self.node.densities, densities);
        self.tails.resize(tails, Tail::default());
        let thresholds = thresholds.iter().chain(std::iter::repeat(&0.0));
        self.tails.iter_mut().zip(thresholds).for_each(|(tail, above)| tail.begin(*above));
    }

    /// Both together; `self` comes first.
    pub(super) fn merge(mut self, right: &Self) -> Self {
        self.node = self.node.merge(&right.node);
        merge_tails(&mut self.tails, &right.tails);
        self
    }
}

/// So many defaults, in the memory that is there.
fn refill<T: Clone + Default>(list: &mut Vec<T>, length: usize) {
    list.clear();
    list.resize(length, T::default());
}

fn merge_tails(left: &mut Vec<Tail>, right: &[Tail]) {
    left.resize(left.len().max(right.len()), Tail::default());
    left.iter_mut().zip(right).for_each(|(left, right)| left.merge(right));
}

#[cfg(test)]
mod tests {
    use super::{Leaf, Round, Spare};
    use crate::estimator::Seen;
    use crate::part::{Counts, Part};
    use crate::run::schedule::Span;
    use crate::run::shape::Shape;
    use crate::run::tally::{Cells, Pending};
    use crate::run::tree::{Node, Tree};
    use crate::tail::Tail;

    /// So many samples, with one large contribution.
    fn leaf(samples: u64, y: f64) -> Leaf {
        let mut tail = Tail::default();
        tail.push(&[y], y);
        let counts = vec![Counts { samples, ..Counts::default() }];
        let part = Part { contributions: Vec::new(), counts };
        let (seen, densities) = (vec![Seen::default()], vec![[0.0; 2]]);
        let node = Node { part, seen, densities, cells: Cells::default() };
        Leaf { node, tails: vec![tail] }
    }

    fn samples(round: &Round) -> u64 {
        round.total().map_or(0, |leaf| leaf.node.part.all().samples)
    }

    /// The first round, of chunks of 64, cut after `samples`, and done up to chunk `chunks`.
    fn round(samples: u64, chunks: std::ops::Range<u64>) -> (Span, Round) {
        let span = Span::new(0, samples, 1);
        let mut round = Round::default();
        for k in chunks {
            let range = span.chunk(k);
            let leaf = leaf(range.end - range.start, (k + 1) as f64);
            round.push(&span, k, leaf, &mut Spare::default());
        }
        (span, round)
    }

    #[test]
    fn a_cut_chunk_counts_but_can_be_taken_back() {
        let (span, mut cut) = round(200, 0..4);
        assert_eq!((cut.done(), samples(&cut), cut.samples(&span)), (Some(0..4), 200, 200));
        assert_eq!(cut.total().unwrap().tails[0].magnitudes(), [1.0, 2.0, 3.0, 4.0]);
        // Where the run ends at the same sample, it stays.
        let before = cut.clone();
        assert!(cut.fit(&span, 0..4));
        assert_eq!(cut, before);
        for other in [199, 201, 1024] {
            let mut cut = before.clone();
            assert!(cut.fit(&Span::new(0, other, 1), 0..4));
            assert_eq!((cut.done(), samples(&cut)), (Some(0..3), 192), "{other}");
            assert_eq!(cut, round(192, 0..3).1);
        }
        // Chunks of another shard, and more than there are to be.
        for share in [1..4, 0..2] {
            assert!(!before.clone().fit(&span, share));
        }
        // A whole chunk, where there is to be a part of one.
        assert!(!round(192, 0..3).1.fit(&Span::new(0, 150, 1), 0..3));
    }

    #[test]
    fn a_cut_chunk_alone_and_behind_a_gap() {
        assert_eq!(round(200, 3..4).1.done(), Some(3..4));
        assert_eq!(round(20, 0..1).1.done(), Some(0..1));
        let (span, mut gap) = round(200, 0..2);
        gap.append(round(200, 3..4).1);
        assert!(!gap.fit(&span, 0..4));
        assert_eq!((gap.done(), gap.samples(&span)), (None, 0));
        assert_eq!(Round::default().done(), Some(0..0));
        assert!(Round::default().total().is_none());
    }

    #[test]
    fn what_no_run_has_is_refused() {
        let shape = Shape { techniques: 1, replicates: 1, components: 0, sums: 0 };
        let endless = Span::new(0, u64::MAX, 1);
        let check = |change: fn(&mut Round)| {
            let (_, mut cut) = round(200, 0..4);
            // Of no component, there are no tails.
            cut.tails.clear();
            cut.cut.as_mut().unwrap().leaf.tails.clear();
            change(&mut cut);
            cut.check(&endless, shape)
        };
        assert_eq!(check(|_| ()), Ok(()));
        assert_eq!(check(|round| round.cut = None), Ok(()));
        assert_eq!(check(|round| round.tree = Tree::default()), Ok(()));
        assert_eq!(check(|round| *round = Round::default()), Ok(()));

        let says = |change: fn(&mut Round), text: &str| {
            assert_eq!(check(change), Err(text.into()));
        };
        let gap = "chunks that do not follow one another";
        says(|round| round.tree.push(0, 8, leaf(64, 1.0).node, &mut Vec::new()), gap);
        says(|round| round.tree.push(0, u64::MAX, leaf(64, 1.0).node, &mut Vec::new()), gap);
        says(|round| round.cut.as_mut().unwrap().index = 4, gap);
        // Chunks 0 and 1 apart, as a file can have them.
        let apart = |round: &mut Round| {
            let nodes = vec![(0_u32, 0_u64, leaf(64, 1.0).node), (0, 1, leaf(64, 1.0).node)];
            round.cut = None;
            round.tree = postcard::from_bytes(&postcard::to_stdvec(&nodes).unwrap()).unwrap();
            assert_eq!(round.done(), Some(0..2));
        };
        says(apart, gap);
        // More chunks than the first round has.
        let more = |round: &mut Round| {
            round.cut = None;
            (3..17).for_each(|k| round.tree.push(0, k, leaf(64, 1.0).node, &mut Vec::new()));
        };
        says(more, gap);
        let samples = |start, end, index| format!("samples {start} to {end} as chunk {index}");
        for (start, end) in [(191, 200), (192, 192), (200, 192), (192, 256), (192, u64::MAX)] {
            let (_, mut cut) = round(200, 3..4);
            let own = cut.cut.as_mut().unwrap();
            (own.start, own.end) = (start, end);
            assert_eq!(cut.check(&endless, shape), Err(samples(start, end, 3)));
        }
        let (_, mut last) = round(200, 3..4);
        last.cut.as_mut().unwrap().index = u64::MAX;
        assert_eq!(last.check(&endless, shape), Err(samples(192, 200, u64::MAX)));

        says(
            |round| round.cut.as_mut().unwrap().leaf = leaf(8, 1.0),
            "1 tails where there should be 0",
        );
        let other = |round: &mut Round| round.cut.as_mut().unwrap().leaf.node = leaf(9, 1.0).node;
        says(other, "9 samples where there should be 8");
        says(|round| round.tails = leaf(8, 1.0).tails, "1 tails where there should be 0");
        let without = |round: &mut Round| {
            round.tree = Tree::default();
            round.tails = leaf(8, 1.0).tails;
        };
        says(without, "tails without chunks");
        let fewer = |round: &mut Round| {
            round.tree = Tree::default();
            round.tree.push(1, 0, leaf(127, 1.0).node, &mut Vec::new());
            round.tree.push(0, 2, leaf(64, 1.0).node, &mut Vec::new());
        };
        says(fewer, "127 samples where there should be 128");
    }

    #[test]
    fn parts_of_a_round_make_up_the_round() {
        let (_, whole) = round(200, 0..4);
        for cut in 0..=4 {
            let (_, mut left) = round(200, 0..cut);
            left.append(round(200, cut..4).1);
            assert_eq!(left, whole, "{cut}");
        }
    }

    #[test]
    fn tails_of_chunks_to_come_begin_where_those_of_the_round_do() {
        let (_, mut round) = round(1024, 0..2);
        let mut thresholds = [-1.0, -1.0];
        round.thresholds(&mut thresholds);
        assert_eq!(thresholds, [0.0, -1.0]);
        let span = Span::new(0, 1024, 1);
        for k in 2..16 {
            let mut many = leaf(64, 1.0);
            many.tails[0].push(&[7.0; 40], 7.0);
            round.push(&span, k, many, &mut Spare::default());
        }
        round.thresholds(&mut thresholds);
        assert_eq!(thresholds, [7.0, -1.0]);
        assert_eq!(round.total().unwrap().tails[0].magnitudes().len(), 257);
    }

    /// A chunk finds nothing of the one before, of which it has the memory.
    #[test]
    fn cleared_leaves_are_like_new() {
        let shape = Shape { techniques: 2, replicates: 3, components: 2, sums: 5 };
        let cleared = |mut leaf: Leaf, thresholds: &[f64]| {
            leaf.clear(shape, thresholds);
            leaf
        };
        let fresh = cleared(Leaf::default(), &[]);
        let mut part = Part::empty(2, 3, 2);
        part.contributions[11].extreme.y = 1.0;
        part.counts[1].zero = 1;
        let seen = vec![Seen { samples: 1, contributions: 1 }; 2];
        let mut cells = Cells::new(6, 5);
        cells.sample(5, &mut Pending::default(), |tally| {
            tally.add(4, 1.0);
            tally.add(5, 1.0);
        });
        let node = Node { part, seen, densities: vec![[1.0; 2]; 4], cells };
        let mut used = Leaf { node, tails: fresh.tails.clone() };
        used.tails.iter_mut().for_each(|tail| tail.push(&[1.0], 1.0));
        assert_eq!(cleared(used.clone(), &[]), fresh);
        // Or of one of another shape.
        assert_eq!(cleared(leaf(3, 1.0), &[]), fresh);
        let thresholds = [1.0, 2.0, 3.0, 4.0];
        let tails = cleared(used, &thresholds).tails;
        assert_eq!(tails.iter().map(Tail::threshold).collect::<Vec<_>>(), thresholds);
    }

    #[test]
    fn leaves_merge_in_all_their_parts() {
        let mut both = leaf(3, 1.0).merge(&leaf(4, 2.0));
        assert_eq!(both.node.part.all().samples, 7);
        assert_eq!(both.tails[0].magnitudes(), [1.0, 2.0]);
    }
}
