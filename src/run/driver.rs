//! The rounds of a run, from the first to the one that ends it.

use std::fmt::Debug;
use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use super::Run;
use super::checkpoint::{self, Identity};
use super::error::{RunError, RunFault};
use super::judge::{Gate, Judged};
use super::progress::{MARGIN, Progress};
use super::report::{Report, RoundSummary, Settings};
use super::session::Session;
use super::state::{Leaf, Round};
use super::status::Stop;
use super::tally::{Cells, Pending};
use super::threads::Threads;
use super::worker::{Brake, Job, Observer, Outcome, caught};
use crate::error::{ArgumentError, shortened};
use crate::estimate::Estimate;
use crate::estimator::{Estimator, Frame};
use crate::integrand::{Integrand, Value};
use crate::part::Counts;
use crate::points::PointSource;

/// How many samples of each technique tell one run from another.
const FIRST_SAMPLES: u64 = 16;

/// The most sums of a tally, over all techniques and replicates: 400 MB for each chunk that is at work.
const MOST_SUMS: usize = 1 << 24;

pub(super) struct Driver<'a, P, F: ?Sized, E: ?Sized, S: ?Sized, O> {
    run: Run<'a>,
    job: Job<'a, P, F, E, S, O>,
}

/// How a run ended.
struct End<V> {
    stop: Stop,
    fault: Option<RunFault>,
    /// The round that confirmed the tolerance.
    confirming: Option<(Leaf, Judged<V>)>,
    /// All rounds together.
    all: Option<Leaf>,
    /// The last one.
    round: u32,
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
    ) -> Self {
        Self { run, job: Job { estimator, f, points, observer, point: PhantomData } }
    }

    /// Runs to the end; from the files of all shards, if there are any.
    pub(super) fn run(
        mut self,
        files: Option<&[&Path]>,
    ) -> Result<Report<F::Value>, RunError<F::Value>> {
        let began = Instant::now();
        self.check(files.is_some())?;
        let threads = Threads::new(self.run.threads)?;
        let cancel = self.run.cancel.clone();
        let deadline = self.run.target.limit_of_time().and_then(|time| began.checked_add(time));
        let brake = Brake::new(cancel.as_ref(), deadline);
        let frame = self.frame();
        let mut session = Session {
            identity: self.identity(files.is_some()),
            shard: self.run.shard,
            limit: self.run.target.limit(frame.samples),
            techniques: frame.shares.len(),
            replicates: self.job.replicates(),
            path: self.run.checkpoint.clone(),
            save_every: self.run.save_every,
            began,
            rounds: Vec::new(),
            loaded: 0,
            last_save: began,
            last_watch: began,
            save_error: None,
            confirming: false,
        };
        match files {
            Some(files) => session.gather(files)?,
            None => session.load()?,
        }
        session.loaded = session.samples();
        // Where nothing can be saved, nothing is run.
        session.save();
        if let Some(error) = session.save_error.take() {
            return Err(error.into());
        }

        let mut end = self.rounds(&threads, &brake, &mut session);
        if let Some(fault) = end.all.as_ref().and_then(|all| self.too_many_faults(all, end.stop)) {
            (end.stop, end.fault, end.confirming) = (Stop::Fault, Some(fault), None);
        }
        session.save();
        // What an earlier session went further is in the file, but not in this report.
        session.truncate(end.round);
        let fault = end.fault.take();
        let unsaved = fault.is_none().then(|| session.save_error.take()).flatten();
        let report = self.report(session, end);
        match fault.or(unsaved.map(RunFault::from)) {
            Some(fault) => Err(RunError::new(fault, (report.samples > 0).then_some(report))),
            None => Ok(report),
        }
    }

    fn frame(&self) -> Frame<'a> {
        self.job.estimator.frame()
    }

    /// # Errors
    ///
    /// Settings that do not go together.
    fn check(&self, merges: bool) -> Result<(), ArgumentError> {
        let Run { target, shard, checkpoint, .. } = &self.run;
        target.check(F::Value::COMPONENTS)?;
        let sums = self.job.observer.sums();
        if sums.checked_mul(self.job.shape().streams()).is_none_or(|cells| cells > MOST_SUMS) {
            let rule = "there may be 2^24 at most, over all techniques and replicates";
            return Err(ArgumentError::new("Run::tally", "sums", sums, rule));
        }
        let fixed = !target.has_tolerance() && target.limit_of_time().is_none();
        if shard.of > 1 && (!fixed || checkpoint.is_none() || merges) {
            let rule = "a shard needs a checkpoint and a fixed number of samples, without a \
                        tolerance or a time";
            return Err(ArgumentError::new("Run", "shard", shard, rule));
        }
        if merges && !fixed {
            let rule =
                "shards are merged to their number of samples, without a tolerance or a time";
            return Err(ArgumentError::new("Run::merge", "target", target, rule));
        }
        Ok(())
    }

    /// What tells this run from others; the first samples only if there are files to compare with.
    fn identity(&self, merges: bool) -> Identity {
        let Job { estimator, f, points, observer, .. } = &self.job;
        let mut words = Vec::new();
        let mut cells = Cells::new(self.job.shape().streams(), observer.sums());
        if merges || self.run.checkpoint.is_some() {
            let mut pending = Pending::default();
            let probed = caught(|| {
                estimator.probe(*f, *points, FIRST_SAMPLES, |sample| {
                    words.push(sample.technique() as u64);
                    // The contributions alone would not do: of a rare event, all are 0.
                    words.extend(format!("{:?}", sample.x()).bytes().map(u64::from));
                    words.push(sample.weight().to_bits());
                    let contributions =
                        (0..F::Value::COMPONENTS).map(|c| sample.contribution_to(c));
                    words.extend(contributions.map(f64::to_bits));
                    if observer.sums() > 0 {
                        let stream =
                            sample.technique() * self.job.replicates() + sample.replicate();
                        cells.sample(stream, &mut pending, |tally| {
                            observer.observe(sample, tally);
                        });
                    }
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
            first_sums: checkpoint::digest(cells.words()),
            label: self.run.label.clone(),
        }
    }

    /// Draws round after round, until one ends the run.
    fn rounds(
        &mut self,
        threads: &Threads,
        brake: &Brake<'_>,
        session: &mut Session,
    ) -> End<F::Value> {
        let mut all: Option<Leaf> = None;
        let mut round = 0;
        for number in 0.. {
            if session.span(number).chunks() == 0 {
                break;
            }
            round = number;
            let outcome = self.round(number, threads, brake, session);
            let own = session.total(number);
            if let Some(own) = &own {
                all = Some(all.map_or_else(|| own.clone(), |all| all.merge(own)));
            }
            // What an earlier session has drawn was shown and saved by it.
            let fresh = matches!(outcome, Outcome::Done);
            let ended = match outcome {
                Outcome::Failed(fault) => Some((Stop::Fault, Some(fault))),
                Outcome::Interrupted if brake.is_cancelled() => Some((Stop::Cancelled, None)),
                Outcome::Interrupted => Some((Stop::Time, None)),
                Outcome::Done | Outcome::Loaded => all
                    .as_ref()
                    .and_then(|all| self.hopeless(all, session.limit))
                    .map(|fault| (Stop::Fault, Some(fault))),
            };
            if let Some((stop, fault)) = ended {
                return End { stop, fault, confirming: None, all, round };
            }
            let (Some(own), Some(together)) = (own, &all) else { continue };
            if fresh {
                self.watch(session, number, together, brake);
            }
            if self.run.target.has_tolerance() {
                // Replicates of twice the points have an error that hardly depends on the one
                // before; and half of the points alone would be far from as even as all.
                let fresh = if self.job.replicates() > 1 { together.clone() } else { own };
                let judged = self.judged(fresh.clone());
                if session.confirming && self.holds(&judged, Gate::Confirming, 1.0) {
                    let confirming = Some((fresh, judged));
                    return End { stop: Stop::Tolerance, fault: None, confirming, all, round };
                }
                session.confirming =
                    self.holds(&self.judged(together.clone()), Gate::NearNormal, MARGIN);
            }
            if fresh {
                session.save();
            }
        }
        End { stop: Stop::Samples, fault: None, confirming: None, all, round }
    }

    /// Draws what is missing of a round.
    fn round(
        &mut self,
        number: u32,
        threads: &Threads,
        brake: &Brake<'_>,
        session: &mut Session,
    ) -> Outcome {
        let span = session.span(number);
        let share = span.share(session.shard.index, session.shard.of);
        // Out of the session while the threads have it.
        let mut round = session.take(number);
        let done = round.done().filter(|done| !done.is_empty());
        let todo = done.map_or(share.start, |done| done.end)..share.end;
        let outcome = if todo.is_empty() {
            Outcome::Loaded
        } else {
            let before = session.samples();
            let Self { run, job, .. } = self;
            let target = run.target;
            let mut tick = |round: &dyn Fn() -> Round| {
                session.save_if_due(number, round);
                if let Some((interval, watcher)) = &mut run.watcher
                    && session.last_watch.elapsed() >= *interval
                {
                    session.last_watch = Instant::now();
                    let round = round();
                    let samples = before + round.samples(&span);
                    let earlier =
                        session.rounds.iter().zip(0..number).filter_map(|(r, _)| r.total());
                    let all = earlier.chain(round.total()).reduce(|all, leaf| all.merge(&leaf));
                    let frame = job.estimator.frame();
                    let seen = all.map(|all| {
                        Progress::new::<F::Value>(&frame, &target, number, samples, &all, session)
                    });
                    if seen.is_some_and(|seen| watcher(&seen) == ControlFlow::Break(())) {
                        brake.pull();
                    }
                }
            };
            job.complete(&span, todo, &mut round, threads, brake, &mut tick)
        };
        session.put(number, round);
        outcome
    }

    fn watch(&mut self, session: &mut Session, number: u32, all: &Leaf, brake: &Brake<'_>) {
        let frame = self.frame();
        let Some((interval, mut watcher)) = self.run.watcher.take() else { return };
        let samples = session.span(number).end.min(session.samples());
        session.last_watch = Instant::now();
        let seen =
            Progress::new::<F::Value>(&frame, &self.run.target, number, samples, all, session);
        if watcher(&seen) == ControlFlow::Break(()) {
            brake.pull();
        }
        self.run.watcher = Some((interval, watcher));
    }

    /// Whether there are so many faults that there is no use in going on: more than all samples of
    /// the run may have, or more by far than these may have.
    fn hopeless(&self, all: &Leaf, limit: u64) -> Option<RunFault> {
        let counts = all.node.part.all();
        let hopeless = self.frame().on_fault.is_hopeless(counts.faults(), counts.samples, limit);
        hopeless.then(|| self.faults_in(counts)).flatten()
    }

    /// Whether there are too many faults in a run that is over. A shard is only a part of one.
    fn too_many_faults(&self, all: &Leaf, stop: Stop) -> Option<RunFault> {
        let over = matches!(stop, Stop::Tolerance | Stop::Samples | Stop::Time);
        let whole = over && self.run.shard.of == 1;
        whole.then(|| self.faults_in(all.node.part.all())).flatten()
    }

    fn faults_in(&self, counts: Counts) -> Option<RunFault> {
        self.frame().on_fault.check(counts.faults(), counts.samples).err().map(RunFault::from)
    }

    fn judged(&self, leaf: Leaf) -> Judged<F::Value> {
        Judged::new(&self.frame(), leaf)
    }

    fn holds(&self, judged: &Judged<F::Value>, gate: Gate, margin: f64) -> bool {
        let target = &self.run.target;
        margin * target.excess(&judged.estimate) <= 1.0
            && judged.doubts(&self.frame(), target, gate).is_empty()
    }

    fn report(&self, session: Session, end: End<F::Value>) -> Report<F::Value> {
        let frame = self.frame();
        let all = end.all.unwrap_or_else(|| self.nothing());
        let samples = session.samples();
        let estimate =
            |leaf: &Leaf| Estimate::new(frame.design, frame.shares, leaf.node.part.clone());
        let mut cumulative: Option<Leaf> = None;
        let mut rounds = Vec::new();
        for own in session.rounds.iter().filter_map(Round::total) {
            let both = cumulative.map_or_else(|| own.clone(), |all| all.merge(&own));
            rounds.push(RoundSummary { estimate: estimate(&own), cumulative: estimate(&both) });
            cumulative = Some(both);
        }
        let (leaf, judged) = end.confirming.unwrap_or_else(|| (all.clone(), self.judged(all)));
        let status = judged.status(&frame, &self.run.target, end.stop);
        Report {
            judged,
            stop: end.stop,
            status,
            rounds,
            tallied: leaf.node.cells.tallied(&frame, &leaf.node.part, F::Value::COMPONENTS),
            misplaced: leaf.node.cells.misplaced,
            samples,
            elapsed: session.began.elapsed(),
            drawn: samples.saturating_sub(session.loaded),
            settings: self.settings(),
            checkpoint_error: session.save_error,
        }
    }

    fn settings(&self) -> Settings {
        let Run { target, threads, checkpoint, save_every, label, shard, .. } = &self.run;
        let all = [
            Some(("points", shortened(&self.job.points))),
            threads.map(|threads| ("threads", threads.to_string())),
            checkpoint.as_ref().map(|path| {
                ("checkpoint", format!("{}, every {} s", path.display(), save_every.as_secs_f64()))
            }),
            (!label.is_empty()).then(|| ("label", label.clone())),
            (shard.of > 1).then(|| ("shard", format!("{} of {}", shard.index, shard.of))),
        ];
        let estimator = format!("{:?}", self.frame());
        Settings { target: *target, estimator, others: all.into_iter().flatten().collect() }
    }

    /// No samples.
    fn nothing(&self) -> Leaf {
        let mut leaf = Leaf::default();
        leaf.clear(self.job.shape(), &[]);
        leaf
    }
}
