//! The rounds that a run has, and the files in which they are kept.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::checkpoint::{self, Identity, Saved, Shard};
use super::error::CheckpointError;
use super::schedule::Span;
use super::shape::Shape;
use super::state::{Leaf, Round};

/// What changes while a run goes on.
pub(super) struct Session {
    pub(super) identity: Identity,
    pub(super) shard: Shard,
    /// The most samples, in all shards.
    pub(super) limit: u64,
    /// Of the estimator.
    pub(super) techniques: usize,
    /// Of the points.
    pub(super) replicates: usize,
    pub(super) path: Option<PathBuf>,
    pub(super) save_every: Duration,
    pub(super) began: Instant,
    pub(super) rounds: Vec<Round>,
    /// The samples that were there at the start.
    pub(super) loaded: u64,
    pub(super) last_save: Instant,
    pub(super) last_watch: Instant,
    /// Whether all samples so far are good enough for the present round to confirm it.
    pub(super) confirming: bool,
    /// Why the last attempt to save failed.
    pub(super) save_error: Option<CheckpointError>,
}

impl Session {
    pub(super) fn span(&self, number: u32) -> Span {
        Span::new(number, self.limit, self.streams())
    }

    /// The most samples, in this shard.
    pub(super) fn own_limit(&self) -> u64 {
        let own = |span: Span| span.samples_of(&span.share(self.shard.index, self.shard.of));
        // Rounds double: there are fewer than a count has bits.
        (0..u64::BITS).map(|number| own(self.span(number))).sum()
    }

    /// The replicates of all techniques.
    fn streams(&self) -> usize {
        self.techniques.saturating_mul(self.replicates)
    }

    /// What a round has come to.
    pub(super) fn total(&self, number: u32) -> Option<Leaf> {
        self.rounds.get(place(number)).and_then(Round::total)
    }

    /// Takes a round out, to add to it.
    pub(super) fn take(&mut self, number: u32) -> Round {
        if self.rounds.len() <= place(number) {
            self.rounds.resize_with(place(number) + 1, Round::default);
        }
        self.rounds.get_mut(place(number)).map(std::mem::take).unwrap_or_default()
    }

    /// Puts a round back.
    pub(super) fn put(&mut self, number: u32, round: Round) {
        if let Some(slot) = self.rounds.get_mut(place(number)) {
            *slot = round;
        }
    }

    /// How many samples the rounds stand for; a technique's share of them may leave out one.
    pub(super) fn samples(&self) -> u64 {
        (0..).zip(&self.rounds).map(|(number, round)| round.samples(&self.span(number))).sum()
    }

    /// Leaves out the rounds behind this one, to which an earlier session went.
    pub(super) fn truncate(&mut self, number: u32) {
        self.rounds.truncate(place(number).saturating_add(1));
    }

    /// Saves everything, if there is a file for it.
    pub(super) fn save(&mut self) {
        let Some(path) = &self.path else { return };
        let saved = Saved {
            identity: self.identity.clone(),
            shard: self.shard,
            limit: self.limit,
            rounds: self.rounds.clone(),
        };
        self.save_error = checkpoint::save(path, &saved).err();
        self.last_save = Instant::now();
    }

    /// Saves everything, with a round that was taken out, if it is time to.
    pub(super) fn save_if_due(&mut self, number: u32, round: &dyn Fn() -> Round) {
        if self.path.is_some() && self.last_save.elapsed() >= self.save_every {
            self.put(number, round());
            self.save();
        }
    }

    /// Continues from the file, if there is one.
    pub(super) fn load(&mut self) -> Result<(), CheckpointError> {
        self.rounds = self.loaded_rounds(&self.identity)?;
        Ok(())
    }

    /// # Errors
    ///
    /// Rounds that no run of this kind has, although the file is as it was written.
    fn check(&self, path: &Path, saved: &Saved) -> Result<(), CheckpointError> {
        let Identity { components, sums, .. } = saved.identity;
        let Self { techniques, replicates, .. } = *self;
        let shape = Shape { techniques, replicates, components, sums };
        for (number, round) in (0..).zip(&saved.rounds) {
            let endless = Span::new(number, u64::MAX, self.streams());
            round.check(&endless, shape).map_err(|problem| CheckpointError::Damaged {
                path: path.into(),
                problem: format!("its round {number} has {problem}"),
            })?;
        }
        Ok(())
    }

    /// The rounds in the file, if there is one, as far as this run needs them.
    fn loaded_rounds(&self, identity: &Identity) -> Result<Vec<Round>, CheckpointError> {
        let Some(path) = self.path.clone() else { return Ok(Vec::new()) };
        let Some(saved) = checkpoint::load(&path)? else { return Ok(Vec::new()) };
        saved.check(&path, identity, self.shard)?;
        self.check(&path, &saved)?;
        let other = |difference| CheckpointError::OtherRun { path: path.clone(), difference };
        if self.shard.of > 1 && saved.limit != self.limit {
            return Err(other(format!(
                "it is of a run of {} samples, not {}",
                saved.limit, self.limit
            )));
        }
        let mut rounds = saved.rounds;
        for (number, round) in (0..).zip(&mut rounds) {
            let span = self.span(number);
            if !round.fit(&span, span.share(self.shard.index, self.shard.of)) {
                return Err(other(format!(
                    "it holds more of round {number} than a run of {} samples",
                    self.limit
                )));
            }
        }
        Ok(rounds)
    }

    /// Puts the shards of a run together.
    pub(super) fn gather(&mut self, files: &[&Path]) -> Result<(), CheckpointError> {
        let shards = |problem: String| CheckpointError::Shards { problem };
        let mut parts: Vec<(&Path, Saved)> = Vec::new();
        for path in files {
            match checkpoint::load(path)? {
                Some(saved) => parts.push((path, saved)),
                None => return Err(shards(format!("there is no file {}", path.display()))),
            }
        }
        parts.sort_by_key(|(_, saved)| saved.shard.index);
        let Some((_, first)) = parts.first() else {
            return Err(shards("there are no files".into()));
        };
        let of = first.shard.of;
        // A run can be merged without what made its sums.
        self.identity.sums = first.identity.sums;
        self.identity.first_sums = first.identity.first_sums;
        // What is there already must be a part of the same run.
        self.loaded_rounds(&self.identity)?;
        for (index, (path, saved)) in (0..).zip(&parts) {
            let found = saved.shard.index;
            saved.check(path, &self.identity, Shard { index: found, of })?;
            self.check(path, saved)?;
            if saved.limit != self.limit {
                let difference = format!("it is of {} samples, not {}", saved.limit, self.limit);
                return Err(CheckpointError::OtherRun { path: path.to_path_buf(), difference });
            }
            if found != index {
                let (which, problem) =
                    if found > index { (index, "missing") } else { (found, "there twice") };
                return Err(shards(format!("shard {which} of {of} is {problem}")));
            }
            if found >= of {
                return Err(shards(format!("{} is shard {found} of {of}", path.display())));
            }
        }
        if (parts.len() as u64) < of {
            return Err(shards(format!("shard {} of {of} is missing", parts.len())));
        }
        for (path, saved) in parts {
            let mut rounds = saved.rounds.into_iter();
            for number in 0.. {
                let span = self.span(number);
                if span.chunks() == 0 {
                    break;
                }
                let mut round = rounds.next().unwrap_or_default();
                let share = span.share(saved.shard.index, of);
                if !round.fit(&span, share.clone()) {
                    let name = path.display();
                    return Err(shards(format!("{name} has more of round {number} than its part")));
                }
                if !share.is_empty() && round.done() != Some(share) {
                    return Err(shards(format!("{} is not finished", path.display())));
                }
                let mut whole = self.take(number);
                whole.append(round);
                self.put(number, whole);
            }
        }
        Ok(())
    }
}

fn place(number: u32) -> usize {
    usize::try_from(number).unwrap_or(usize::MAX)
}
