//! The rounds of a run, from the first to the one that ends it.

use std::fmt::Debug;
use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};

use super::checkpoint::{self, Identity, Saved, Shard};
use super::error::{CheckpointError, RunError, RunFault};
use super::judge::{Gate, Judged};
use super::progress::Progress;
use super::report::{Report, RoundSummary, Settings};
use super::schedule::Span;
use super::state::{Leaf, Round};
use super::status::Stop;
use super::target::Target;
use super::threads::Threads;
use super::worker::{Brake, Job, Observer, Outcome, caught};
use super::{Run, tally};
use crate::error::ArgumentError;
use crate::estimator::{Estimator, Evidence, Frame, OnFault};
use crate::integrand::{Integrand, Value};
use crate::part::{Counts, Part};
use crate::points::PointSource;

/// A round is taken for large enough if its half-width times this is within the tolerance, so that
/// the next one hardly ever fails to confirm it.
const MARGIN: f64 = 1.1;

/// How many samples of each technique tell one run from another.
const FIRST_SAMPLES: u64 = 16;

pub(super) struct Driver<'a, P, F: ?Sized, E: ?Sized, S: ?Sized, O> {
    run: Run<'a>,
    job: Job<'a, P, F, E, S, O>,
    limit: u64,
    /// If the points are those of a seed.
    seed: Option<u64>,
}

/// What changes while a run goes on.
struct Session {
    began: Instant,
    rounds: Vec<Round>,
    /// The samples that were there at the start.
    loaded: u64,
    identity: Identity,
    last_save: Instant,
    last_watch: Instant,
    save_error: Option<CheckpointError>,
}

impl<'a, P, F, E, S, O> Driver<'a, P, F, E, S, O>
where
    P: Debug,
    F: Integrand<P> + Sync + ?Sized,
    E: Estimator<P> + ?Sized,
    S: PointSource + ?Sized,
    O: Observer<P, F::Value>,
{
    pub(super) fn new(
        run: Run<'a>,
        estimator: &'a E,
        f: &'a F,
        points: &'a S,
        observer: &'a O,
        seed: Option<u64>,
    ) -> Self {
        let limit = run.target.limit(estimator.frame().samples);
        let job = Job { estimator, f, points, observer, point: PhantomData };
        Self { run, job, limit, seed }
    }

    /// Runs to the end; from the files of all shards, if there are any.
    pub(super) fn run(
        mut self,
        files: Option<&[&Path]>,
    ) -> Result<Report<F::Value>, RunError<F::Value>> {
        let began = Instant::now();
        self.check(files)?;
        let threads = Threads::new(self.run.threads)?;
        let cancel = self.run.cancel.clone();
        let deadline = self.run.target.limit_of_time().and_then(|time| began.checked_add(time));
        let brake = Brake::new(cancel.as_ref(), deadline);
        let mut session = Session {
            began,
            rounds: Vec::new(),
            loaded: 0,
            identity: self.identity(files.is_some()),
            last_save: began,
            last_watch: began,
            save_error: None,
        };
        match files {
            Some(files) => {
                self.check_place(&session.identity)?;
                self.gather(files, &mut session)?;
            }
            None => self.load(&mut session)?,
        }
        session.loaded = self.samples(&session.rounds);
        if let Some(path) = &self.run.checkpoint {
            // Where nothing can be saved, nothing is run.
            checkpoint::save(path, &self.saved(&session))?;
        }

        let mut passed = false;
        let mut all: Option<Leaf> = None;
        let mut number = 0;
        let (stop, fault, confirming) = loop {
            let span = self.span(number);
            if span.chunks() == 0 {
                break (Stop::Samples, None, None);
            }
            let outcome = self.round(number, &span, &threads, &brake, &mut session);
            let own = session.round(number).and_then(Round::total);
            if let Some(own) = &own {
                all = Some(all.map_or_else(|| own.clone(), |all: Leaf| all.merge(own)));
            }
            match outcome {
                Outcome::Failed(fault) => break (Stop::Fault, Some(fault), None),
                Outcome::Interrupted if brake.is_cancelled() => {
                    break (Stop::Cancelled, None, None);
                }
                Outcome::Interrupted => break (Stop::Time, None, None),
                Outcome::Done | Outcome::Loaded => {}
            }
            if let Some(fault) = all.as_ref().and_then(|all| self.hopeless(all)) {
                break (Stop::Fault, Some(fault), None);
            }
            let (Some(own), Some(all)) = (own, &all) else {
                number += 1;
                continue;
            };
            // What an earlier session has drawn was shown and saved by it.
            let fresh = matches!(outcome, Outcome::Done);
            if fresh {
                self.watch(&mut session, number, all, &brake);
            }
            if self.run.target.has_tolerance() {
                let confirming = self.judged(own);
                if passed && self.holds(&confirming, Gate::Confirming, 1.0) {
                    break (Stop::Tolerance, None, Some(confirming));
                }
                passed = self.holds(&self.judged(all.clone()), Gate::NearNormal, MARGIN);
            }
            if let Some(path) = &self.run.checkpoint
                && fresh
                && span.end < self.limit
            {
                session.note(checkpoint::save(path, &self.saved(&session)));
            }
            number += 1;
        };
        let too_many = all.as_ref().and_then(|all| self.too_many_faults(all, stop));
        let (stop, fault, confirming) = match too_many {
            Some(too_many) => (Stop::Fault, Some(too_many), None),
            None => (stop, fault, confirming),
        };

        let end = match &self.run.checkpoint {
            Some(path) => checkpoint::save(path, &self.saved(&session)),
            None => Ok(()),
        };
        // Where an earlier session went further, that is in the file, but not in this report.
        session.rounds.truncate(usize::try_from(number).unwrap_or(usize::MAX).saturating_add(1));
        let fault = match (fault, end) {
            (None, Err(error)) => Some(error.into()),
            (fault, end) => {
                session.note(end);
                fault
            }
        };
        let report = self.report(&mut session, stop, confirming, all);
        match fault {
            Some(fault) => Err(RunError::new(fault, (report.samples > 0).then_some(report))),
            None => Ok(report),
        }
    }

    fn frame(&self) -> Frame<'_> {
        self.job.estimator.frame()
    }

    /// # Errors
    ///
    /// Settings that do not go together.
    fn check(&self, files: Option<&[&Path]>) -> Result<(), ArgumentError> {
        self.run.target.check(F::Value::COMPONENTS)?;
        let target = &self.run.target;
        let fixed = !target.has_tolerance() && target.limit_of_time().is_none();
        let shard = self.run.shard;
        if shard.of > 1 && (!fixed || self.run.checkpoint.is_none() || files.is_some()) {
            let rule = "a shard needs a checkpoint and a fixed number of samples, without a \
                        tolerance or a time";
            return Err(ArgumentError::new("Run", "shard", shard, rule));
        }
        if files.is_some() && !fixed {
            let rule =
                "shards are merged to their number of samples, without a tolerance or a time";
            return Err(ArgumentError::new("Run::merge", "target", target, rule));
        }
        Ok(())
    }

    /// What tells this run from others; the first samples only if there are files to compare with.
    fn identity(&self, files: bool) -> Identity {
        let Job { estimator, f, points, observer, .. } = &self.job;
        let mut words = Vec::new();
        if files || self.run.checkpoint.is_some() {
            let probed = caught(|| {
                estimator.probe(*f, *points, FIRST_SAMPLES, |sample| {
                    words.push(sample.technique() as u64);
                    (0..F::Value::COMPONENTS)
                        .for_each(|c| words.push(sample.contribution_to(c).to_bits()));
                })
            });
            // A fault is as good a mark as a value.
            let mark = match probed {
                Ok(Ok(())) => String::new(),
                Ok(Err(error)) => error.to_string(),
                Err(panic) => panic,
            };
            words.extend(mark.bytes().map(u64::from));
        }
        Identity {
            estimator: format!("{:?}", self.frame()),
            components: F::Value::COMPONENTS,
            sums: observer.sums(),
            first_samples: checkpoint::digest(words),
            label: self.run.label.clone(),
        }
    }

    /// Continues from the checkpoint, if there is one.
    fn load(&self, session: &mut Session) -> Result<(), CheckpointError> {
        let Some(path) = &self.run.checkpoint else { return Ok(()) };
        let Some(saved) = checkpoint::load(path)? else { return Ok(()) };
        saved.check(path, &session.identity, self.run.shard)?;
        if self.run.shard.of > 1 && saved.limit != self.limit {
            let difference =
                format!("it is of a run of {} samples, not {}", saved.limit, self.limit);
            return Err(CheckpointError::OtherRun { path: path.clone(), difference });
        }
        session.rounds = saved.rounds;
        self.check_rounds(path, self.run.shard, &mut session.rounds)
    }

    /// # Errors
    ///
    /// Where shards that are merged are to be saved, there is a file already, and it is of
    /// something else.
    fn check_place(&self, identity: &Identity) -> Result<(), CheckpointError> {
        let Some(path) = &self.run.checkpoint else { return Ok(()) };
        let Some(saved) = checkpoint::load(path)? else { return Ok(()) };
        // Only the file knows of sums before the shards are read.
        let identity = Identity { sums: saved.identity.sums, ..identity.clone() };
        saved.check(path, &identity, self.run.shard)?;
        self.check_rounds(path, self.run.shard, &mut saved.rounds.clone())
    }

    /// Fits the rounds that were loaded to this run.
    ///
    /// # Errors
    ///
    /// They are not the beginning of each round's chunks.
    fn check_rounds(
        &self,
        path: &Path,
        shard: Shard,
        rounds: &mut [Round],
    ) -> Result<(), CheckpointError> {
        for (number, round) in (0..).zip(rounds) {
            let span = self.span(number);
            round.fit(&span);
            let share = span.share(shard.index, shard.of);
            let fits = match round.done() {
                Some(done) if done.is_empty() => true,
                Some(done) => done.start == share.start && done.end <= share.end,
                None => false,
            };
            if !fits {
                let difference =
                    format!("it holds more of round {number} than a run of {} samples", self.limit);
                return Err(CheckpointError::OtherRun { path: path.into(), difference });
            }
        }
        Ok(())
    }

    /// Puts the shards together.
    fn gather(&mut self, files: &[&Path], session: &mut Session) -> Result<(), CheckpointError> {
        let shards = |problem: String| CheckpointError::Shards { problem };
        let mut parts: Vec<(&Path, Saved)> = Vec::new();
        for path in files {
            let Some(saved) = checkpoint::load(path)? else {
                return Err(shards(format!("there is no file {}", path.display())));
            };
            parts.push((path, saved));
        }
        parts.sort_by_key(|(_, saved)| saved.shard.index);
        let Some((_, first)) = parts.first() else {
            return Err(shards("there are no files".into()));
        };
        let (of, limit) = (first.shard.of, first.limit);
        session.identity.sums = first.identity.sums;
        if limit != self.limit {
            let problem = format!("they are of a run of {limit} samples, not {}", self.limit);
            return Err(shards(problem));
        }
        for (index, (path, saved)) in (0..).zip(&parts) {
            saved.check(path, &session.identity, Shard { index: saved.shard.index, of })?;
            if saved.limit != limit {
                let difference = format!("it is of {} samples, not {limit}", saved.limit);
                return Err(CheckpointError::OtherRun { path: path.to_path_buf(), difference });
            }
            match saved.shard.index {
                found if found > index => {
                    return Err(shards(format!("shard {index} of {of} is missing")));
                }
                found if found < index => {
                    return Err(shards(format!("shard {found} of {of} is there twice")));
                }
                _ => {}
            }
        }
        if (parts.len() as u64) < of {
            return Err(shards(format!("shard {} of {of} is missing", parts.len())));
        }
        for (path, saved) in parts {
            let Saved { shard, rounds, .. } = saved;
            for number in 0.. {
                let span = self.span(number);
                if span.chunks() == 0 {
                    break;
                }
                let place = usize::try_from(number).unwrap_or(usize::MAX);
                let round = rounds.get(place).cloned().unwrap_or_default();
                let share = span.share(shard.index, shard.of);
                if !share.is_empty() && round.done() != Some(share) {
                    let problem = format!("{} is not finished", path.display());
                    return Err(shards(problem));
                }
                if session.rounds.len() <= place {
                    session.rounds.resize_with(place + 1, Round::default);
                }
                if let Some(whole) = session.rounds.get_mut(place) {
                    whole.append(round);
                }
            }
        }
        Ok(())
    }

    fn saved(&self, session: &Session) -> Saved {
        Saved {
            identity: session.identity.clone(),
            shard: self.run.shard,
            limit: self.limit,
            rounds: session.rounds.clone(),
        }
    }

    /// Draws what is missing of a round.
    fn round(
        &mut self,
        number: u32,
        span: &Span,
        threads: &Threads,
        brake: &Brake<'_>,
        session: &mut Session,
    ) -> Outcome {
        let place = usize::try_from(number).unwrap_or(usize::MAX);
        if session.rounds.len() <= place {
            session.rounds.resize_with(place + 1, Round::default);
        }
        let share = span.share(self.run.shard.index, self.run.shard.of);
        let done = session.rounds.get(place).and_then(Round::done).filter(|done| !done.is_empty());
        let todo = done.map_or(share.start, |done| done.end)..share.end;
        if todo.is_empty() {
            return Outcome::Loaded;
        }
        // Out of the session while the threads have it.
        let mut round = session.rounds.get_mut(place).map(std::mem::take).unwrap_or_default();
        let before = self.samples(&session.rounds);
        let Self { run, job, limit, .. } = self;
        let mut tick = |round: &dyn Fn() -> Round| {
            let now = Instant::now();
            if let Some(path) = &run.checkpoint
                && now.duration_since(session.last_save) >= run.save_every
            {
                let mut rounds = session.rounds.clone();
                if let Some(slot) = rounds.get_mut(place) {
                    *slot = round();
                }
                let identity = session.identity.clone();
                let saved = Saved { identity, shard: run.shard, limit: *limit, rounds };
                session.note(checkpoint::save(path, &saved));
            }
            if let Some((interval, watcher)) = &mut run.watcher
                && now.duration_since(session.last_watch) >= *interval
            {
                session.last_watch = now;
                let round = round();
                let earlier = session.rounds.iter().filter_map(Round::total);
                let all = earlier.chain(round.total()).reduce(|all, leaf| all.merge(&leaf));
                if let Some(all) = all {
                    let frame = job.estimator.frame();
                    let samples = (before + round.samples(span), *limit);
                    let seen =
                        progress::<F::Value>(&frame, &run.target, samples, number, all, session);
                    if watcher(&seen) == ControlFlow::Break(()) {
                        brake.pull();
                    }
                }
            }
        };
        let outcome = job.complete(span, todo, &mut round, threads, brake, &mut tick);
        if let Some(slot) = session.rounds.get_mut(place) {
            *slot = round;
        }
        outcome
    }

    fn watch(&mut self, session: &mut Session, number: u32, all: &Leaf, brake: &Brake<'_>) {
        let samples = (self.samples(&session.rounds), self.limit);
        let Some((_, watcher)) = &mut self.run.watcher else { return };
        session.last_watch = Instant::now();
        let frame = self.job.estimator.frame();
        let seen =
            progress::<F::Value>(&frame, &self.run.target, samples, number, all.clone(), session);
        if watcher(&seen) == ControlFlow::Break(()) {
            brake.pull();
        }
    }

    /// Whether there are so many faults that there is no use in going on: more than all samples
    /// of the run may have, or more by far than these may have.
    fn hopeless(&self, all: &Leaf) -> Option<RunFault> {
        let counts = all.node.part.all();
        let OnFault::CountAsZero { at_most } = self.frame().on_fault else { return None };
        let expected = at_most * counts.samples as f64;
        // Ten more than five standard deviations: by chance in less than 1e-6 of runs.
        let far = counts.faults() as f64 > expected + 5.0 * expected.sqrt() + 10.0;
        let hopeless = far || counts.faults() as f64 > at_most * self.limit as f64;
        hopeless.then(|| self.faults_in(counts)).flatten()
    }

    /// Whether there are too many faults in a run that is over. A shard is only a part of one.
    fn too_many_faults(&self, all: &Leaf, stop: Stop) -> Option<RunFault> {
        let over = matches!(stop, Stop::Tolerance | Stop::Samples | Stop::Time);
        let whole = over && self.run.shard.of == 1;
        whole.then(|| self.faults_in(all.node.part.all())).flatten()
    }

    fn faults_in(&self, counts: Counts) -> Option<RunFault> {
        let Counts { samples, .. } = counts;
        self.frame().on_fault.check(counts.faults(), samples).err().map(RunFault::from)
    }

    fn judged(&self, leaf: Leaf) -> Judged<F::Value> {
        Judged::new(&self.frame(), leaf)
    }

    fn holds(&self, judged: &Judged<F::Value>, gate: Gate, margin: f64) -> bool {
        let target = &self.run.target;
        margin * target.excess(&judged.estimate) <= 1.0
            && judged.doubts(&self.frame(), target, gate).is_empty()
    }

    fn span(&self, number: u32) -> Span {
        Span::new(number, self.limit, self.frame().shares.len())
    }

    /// By their numbers, of which a technique's share may leave out one.
    fn samples(&self, rounds: &[Round]) -> u64 {
        (0..).zip(rounds).map(|(number, round)| round.samples(&self.span(number))).sum()
    }

    fn report(
        &self,
        session: &mut Session,
        stop: Stop,
        confirming: Option<Judged<F::Value>>,
        all: Option<Leaf>,
    ) -> Report<F::Value> {
        let frame = self.frame();
        let all = all.unwrap_or_else(|| self.nothing());
        let samples = self.samples(&session.rounds);
        let mut cumulative: Option<Leaf> = None;
        let mut rounds = Vec::new();
        let mut last = None;
        for own in session.rounds.iter().filter_map(Round::total) {
            let both = cumulative.map_or_else(|| own.clone(), |all| all.merge(&own));
            rounds.push(RoundSummary {
                estimate: self.judged(own.clone()).estimate,
                cumulative: self.judged(both.clone()).estimate,
            });
            cumulative = Some(both);
            last = Some(own);
        }
        // The sums are from the samples of the estimate.
        let counted = match &confirming {
            Some(_) => last.unwrap_or_else(|| self.nothing()),
            None => all.clone(),
        };
        let judged = confirming.unwrap_or_else(|| self.judged(all));
        let status = judged.status(&frame, &self.run.target, stop);
        let elapsed = session.began.elapsed();
        Report {
            judged,
            stop,
            status,
            rounds,
            tallied: counted.node.cells.tallied(&frame, &counted.node.part),
            misplaced: counted.node.cells.misplaced,
            samples,
            elapsed,
            drawn: samples.saturating_sub(session.loaded),
            settings: self.settings(),
            checkpoint_error: session.save_error.take(),
        }
    }

    fn settings(&self) -> Settings {
        let mut others = Vec::new();
        if let Some(seed) = self.seed {
            others.push(("seed", seed.to_string()));
        }
        if let Some(threads) = self.run.threads {
            others.push(("threads", threads.to_string()));
        }
        if let Some(path) = &self.run.checkpoint {
            let every = self.run.save_every.as_secs_f64();
            others.push(("checkpoint", format!("{} every {every} s", path.display())));
        }
        if !self.run.label.is_empty() {
            others.push(("label", self.run.label.clone()));
        }
        if self.run.shard.of > 1 {
            others.push(("shard", format!("{} of {}", self.run.shard.index, self.run.shard.of)));
        }
        let estimator = format!("{:?}", self.frame());
        Settings { target: self.run.target, estimator, others }
    }

    /// No samples.
    fn nothing(&self) -> Leaf {
        let techniques = self.frame().shares.len();
        let part = Part::empty(techniques, F::Value::COMPONENTS);
        let Evidence { tails, densities } =
            Evidence::new(techniques, &vec![0.0; techniques * F::Value::COMPONENTS]);
        let cells = tally::Cells::new(techniques, self.job.observer.sums());
        Leaf { node: super::tree::Node { part, densities, cells }, tails }
    }
}

impl Session {
    fn round(&self, number: u32) -> Option<&Round> {
        self.rounds.get(usize::try_from(number).unwrap_or(usize::MAX))
    }

    fn note(&mut self, saved: Result<(), CheckpointError>) {
        self.save_error = saved.err().or(self.save_error.take());
        self.last_save = Instant::now();
    }
}

/// How far a run has come that has drawn `all`, so many samples of so many.
fn progress<V: Value>(
    frame: &Frame<'_>,
    target: &Target,
    (samples, limit): (u64, u64),
    round: u32,
    all: Leaf,
    session: &Session,
) -> Progress {
    let estimate = Judged::<V>::new(frame, all).estimate;
    let elapsed = session.began.elapsed();
    let rate = samples.saturating_sub(session.loaded) as f64 / elapsed.as_secs_f64().max(1e-9);
    let excess = target.has_tolerance().then(|| target.excess(&estimate));
    // Twice, for the round that confirms it.
    let needed = excess.map_or(limit as f64, |excess| {
        (2.0 * samples as f64 * (MARGIN * excess).powi(2)).min(limit as f64)
    });
    let seconds = (needed - samples as f64).max(0.0) / rate;
    let until = target.limit_of_time().map(|time| time.saturating_sub(elapsed));
    let remaining = Duration::try_from_secs_f64(seconds).ok();
    let remaining = match (remaining, until) {
        (Some(remaining), Some(until)) => Some(remaining.min(until)),
        (remaining, until) => remaining.or(until),
    };
    Progress {
        round,
        samples,
        limit,
        value: estimate.value_of(0),
        standard_error: estimate.error_of(0),
        excess,
        elapsed,
        rate,
        remaining,
    }
}
