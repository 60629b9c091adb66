//! Which samples make a round, and which a chunk.

use std::ops::Range;

/// The samples of the first round; each later round has as many as all before it together.
const FIRST: u64 = 1024;

/// How many chunks a round is divided into, until chunks are full.
const CHUNKS: u64 = 16;

/// The samples of a full chunk, or 512 for each stream of points if that is more.
const FULL: u64 = 8192;

/// The samples of a round, and how they are divided.
///
/// Chunks are the unit of work and of summation. They depend on the round alone: neither on the
/// number of threads nor on where the run ends. Early rounds have small ones, so that a run whose
/// integrand takes seconds is still divided among threads, and can still be interrupted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Span {
    pub(super) start: u64,
    pub(super) end: u64,
    /// The samples of a chunk; the last may have fewer.
    chunk: u64,
}

impl Span {
    /// Round `number` (from 0) of a run that ends with sample `limit` and draws from so many streams,
    /// the replicates of all techniques; empty if the run has ended before.
    pub(super) fn new(number: u32, limit: u64, streams: usize) -> Self {
        let before = |number: u32| match number {
            0 => 0,
            _ => u64::try_from(u128::from(FIRST) << (number - 1).min(64)).unwrap_or(u64::MAX),
        };
        let (start, end) = (before(number), before(number.saturating_add(1)));
        let full = FULL.max(512 * streams as u64);
        let chunk = ((end - start) / CHUNKS).clamp(1, full);
        Self { start: start.min(limit), end: end.min(limit), chunk }
    }

    pub(super) fn samples(&self) -> u64 {
        self.end - self.start
    }

    /// The samples of some chunks.
    pub(super) fn samples_of(&self, chunks: &Range<u64>) -> u64 {
        self.chunk(chunks.end).start.saturating_sub(self.chunk(chunks.start).start)
    }

    /// How many chunks there are.
    pub(super) fn chunks(&self) -> u64 {
        self.samples().div_ceil(self.chunk)
    }

    /// The samples of one chunk.
    pub(super) fn chunk(&self, index: u64) -> Range<u64> {
        let at = |index: u64| self.start.saturating_add(index.saturating_mul(self.chunk));
        at(index).min(self.end)..at(index.saturating_add(1)).min(self.end)
    }

    /// Whether a chunk is shorter than the others because the run ends within it.
    pub(super) fn is_cut(&self, index: u64) -> bool {
        let Range { start, end } = self.chunk(index);
        end - start < self.chunk
    }

    /// The chunks that fall to shard `shard` of `shards`.
    pub(super) fn share(&self, shard: u64, shards: u64) -> Range<u64> {
        let at = |shard: u64| {
            let chunks = u128::from(self.chunks()) * u128::from(shard) / u128::from(shards.max(1));
            u64::try_from(chunks).unwrap_or(u64::MAX)
        };
        at(shard)..at(shard + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::Span;

    #[test]
    fn rounds_double_and_leave_no_sample_out() {
        let limit = 1_000_000;
        let mut end = 0;
        for number in 0..12 {
            let span = Span::new(number, limit, 2);
            assert_eq!(span.start, end);
            assert!(number == 0 || span.samples() == span.start || span.end == limit);
            let mut next = span.start;
            for chunk in 0..span.chunks() {
                let range = span.chunk(chunk);
                assert!(range.start == next && range.end > next);
                assert_eq!(span.is_cut(chunk), number == 10 && chunk + 1 == span.chunks());
                next = range.end;
            }
            assert_eq!(next, span.end);
            end = span.end;
        }
        assert_eq!(end, limit);
        assert_eq!(Span::new(11, limit, 2).chunks(), 0);
    }

    #[test]
    fn where_a_run_ends_does_not_change_its_chunks() {
        let whole = Span::new(9, u64::MAX, 3);
        let cut = Span::new(9, whole.start + 10_000, 3);
        for chunk in 0..cut.chunks() - 1 {
            assert_eq!(cut.chunk(chunk), whole.chunk(chunk));
        }
    }

    #[test]
    fn full_chunks_give_every_stream_a_block() {
        assert_eq!(Span::new(20, u64::MAX, 1).chunk(0).count(), 8192);
        assert_eq!(Span::new(20, u64::MAX, 64).chunk(0).count(), 512 * 64);
    }

    #[test]
    fn the_last_rounds_stay_within_the_range_of_counts() {
        for number in [53, 60, 64, 200, u32::MAX] {
            let span = Span::new(number, 1 << 53, 1);
            assert!(span.end <= 1 << 53 && span.start <= span.end);
        }
    }

    #[test]
    fn shards_divide_every_round() {
        for number in [0, 5, 12] {
            let span = Span::new(number, 1_000_003, 2);
            for shards in [1, 2, 5, 1000] {
                let mut next = 0;
                for shard in 0..shards {
                    let share = span.share(shard, shards);
                    assert_eq!(share.start, next);
                    next = share.end;
                }
                assert_eq!(next, span.chunks());
            }
        }
    }
}
