//! The chunks of a round, drawn by one thread or by several.

use std::any::Any;
use std::collections::VecDeque;
use std::fmt::Debug;
use std::marker::PhantomData;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use super::error::RunFault;
use super::progress::Cancel;
use super::schedule::Span;
use super::shape::Shape;
use super::state::{Leaf, Round, Spare};
use super::tally::{Pending, Tally};
use super::threads::Threads;
use super::tree::Node;
use crate::estimator::{Buffers, Draw, Evidence, Sample, Sums};
use crate::integrand::{Integrand, Value};
use crate::points::{PointSource, replicates};

/// What is drawn.
pub(super) struct Job<'a, P, F: ?Sized, E: ?Sized, S: ?Sized, O> {
    pub(super) estimator: &'a E,
    pub(super) f: &'a F,
    pub(super) points: &'a S,
    pub(super) observer: &'a O,
    pub(super) point: PhantomData<fn(P)>,
}

/// Whom samples are shown to.
pub(super) trait Observer<P, V>: Sync {
    /// How many sums it makes.
    fn sums(&self) -> usize;

    fn observe(&self, sample: &Sample<'_, P, V>, tally: &mut Tally<'_>);
}

/// Nobody.
impl<P, V> Observer<P, V> for () {
    fn sums(&self) -> usize {
        0
    }

    fn observe(&self, _: &Sample<'_, P, V>, _: &mut Tally<'_>) {}
}

/// A function, and how many sums it makes.
impl<P, V, C: Fn(&Sample<'_, P, V>, &mut Tally<'_>) + Sync> Observer<P, V> for (usize, C) {
    fn sums(&self) -> usize {
        self.0
    }

    fn observe(&self, sample: &Sample<'_, P, V>, tally: &mut Tally<'_>) {
        self.1(sample, tally);
    }
}

/// When to begin no more samples.
#[derive(Debug)]
pub(super) struct Brake<'a> {
    cancel: Option<&'a Cancel>,
    deadline: Option<Instant>,
    pulled: AtomicBool,
}

impl<'a> Brake<'a> {
    pub(super) fn new(cancel: Option<&'a Cancel>, deadline: Option<Instant>) -> Self {
        Self { cancel, deadline, pulled: AtomicBool::new(false) }
    }

    pub(super) fn pull(&self) {
        self.pulled.store(true, Ordering::Relaxed);
    }

    pub(super) fn is_cancelled(&self) -> bool {
        self.pulled.load(Ordering::Relaxed) || self.cancel.is_some_and(Cancel::is_cancelled)
    }

    pub(super) fn is_late(&self) -> bool {
        self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }

    fn applies(&self) -> bool {
        self.is_cancelled() || self.is_late()
    }
}

/// An integrand that is evaluated no more once the brake applies. What is drawn then is thrown
/// away.
struct Braked<'a, F: ?Sized> {
    f: &'a F,
    brake: &'a Brake<'a>,
    skipped: AtomicBool,
}

impl<P, F: Integrand<P> + ?Sized> Integrand<P> for Braked<'_, F> {
    type Value = F::Value;

    fn eval(&self, x: &P) -> F::Value {
        self.f.eval(x)
    }

    fn eval_batch(&self, xs: &[P], out: &mut [F::Value]) {
        if self.brake.applies() {
            self.skipped.store(true, Ordering::Relaxed);
            out.fill(F::Value::zero());
        } else {
            self.f.eval_batch(xs, out);
        }
    }
}

/// What is to be done between chunks, given a way to have the round.
pub(super) type Tick<'a> = dyn FnMut(&dyn Fn() -> Round) + 'a;

/// How the work on a round ended.
#[derive(Debug)]
pub(super) enum Outcome {
    /// All its chunks were there before.
    Loaded,
    Done,
    Interrupted,
    /// The lowest chunk that failed.
    Failed(RunFault),
}

/// How much of a chunk was drawn.
enum Drawn {
    All,
    /// The brake was applied before the last sample.
    Braked,
}

/// What the threads share.
struct Shared<'a> {
    round: &'a mut Round,
    /// The chunk that the round needs next.
    next: u64,
    /// From that one on, those that are done before it.
    early: VecDeque<Option<Leaf>>,
    spare: Spare,
    failure: Option<(u64, RunFault)>,
}

/// What a thread uses again from chunk to chunk.
struct Workspace<P, V> {
    /// Where the tails of a chunk begin.
    thresholds: Vec<f64>,
    buffers: Buffers<P, V>,
    pending: Pending,
}

impl<P, F, E, S, O> Job<'_, P, F, E, S, O>
where
    P: Debug,
    F: Integrand<P> + Sync + ?Sized,
    E: Draw<P> + ?Sized,
    S: PointSource + ?Sized,
    O: Observer<P, F::Value>,
{
    /// How many replicates the points have.
    pub(super) fn replicates(&self) -> usize {
        replicates(self.points)
    }

    /// What its samples come to.
    pub(super) fn shape(&self) -> Shape {
        Shape {
            techniques: self.estimator.frame().shares.len(),
            replicates: self.replicates(),
            components: F::Value::COMPONENTS,
            sums: self.observer.sums(),
        }
    }

    /// Draws the chunks `todo` of a round, which follow those that are there. `tick` is called
    /// by this thread between chunks, and can ask for the round as it is; the others work on.
    ///
    /// Chunks enter the round in their order, so that it holds all chunks up to some one at any
    /// time.
    pub(super) fn complete(
        &self,
        span: &Span,
        todo: Range<u64>,
        round: &mut Round,
        threads: &Threads,
        brake: &Brake<'_>,
        tick: &mut Tick<'_>,
    ) -> Outcome {
        let end = todo.end;
        let next = AtomicU64::new(todo.start);
        // Chunks from here on are of no use: an earlier one has failed.
        let limit = AtomicU64::new(end);
        let shared = Mutex::new(Shared {
            round,
            next: todo.start,
            early: VecDeque::new(),
            spare: Spare::default(),
            failure: None,
        });
        let shape = self.shape();
        let work = |tick: &mut Tick<'_>| {
            let mut workspace = Workspace {
                thresholds: vec![0.0; shape.lengths().tails],
                buffers: Buffers::new(),
                pending: Pending::default(),
            };
            let mut leaf = Leaf::default();
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                if index >= limit.load(Ordering::Relaxed) || brake.applies() {
                    return;
                }
                leaf.clear(shape, &workspace.thresholds);
                let drawn = self.chunk(span.chunk(index), &mut leaf, &mut workspace, brake);
                let mut guard = lock(&shared);
                match drawn {
                    Ok(Drawn::All) => guard.push(span, index, leaf),
                    Ok(Drawn::Braked) => return,
                    Err(fault) => {
                        limit.fetch_min(index, Ordering::Relaxed);
                        return guard.fail(index, fault);
                    }
                }
                leaf = guard.spare.leaf();
                guard.round.thresholds(&mut workspace.thresholds);
                drop(guard);
                tick(&|| lock(&shared).round.clone());
            }
        };
        threads.run(end - todo.start, &|| work(&mut |_| ()), || {
            // A watcher that panics takes the run along, but not before the threads have ended.
            if let Err(panic) = catch_unwind(AssertUnwindSafe(|| work(tick))) {
                brake.pull();
                resume_unwind(panic);
            }
        });
        let Shared { round, next, failure, .. } =
            shared.into_inner().unwrap_or_else(PoisonError::into_inner);
        round.shrink();
        match failure {
            Some((_, fault)) => Outcome::Failed(fault),
            None if next == end => Outcome::Done,
            None => Outcome::Interrupted,
        }
    }

    /// Draws the samples of a range, into a leaf that is empty.
    fn chunk(
        &self,
        range: Range<u64>,
        leaf: &mut Leaf,
        workspace: &mut Workspace<P, F::Value>,
        brake: &Brake<'_>,
    ) -> Result<Drawn, RunFault> {
        let Range { start, end } = range;
        let f = Braked { f: self.f, brake, skipped: AtomicBool::new(false) };
        let Leaf { node: Node { part, seen, densities, cells }, tails } = leaf;
        let Workspace { buffers, pending, .. } = workspace;
        let sums = Sums { part, evidence: Some(Evidence { tails, seen, densities }) };
        let drawn = caught(|| {
            if self.observer.sums() == 0 {
                return self.estimator.draw(&f, self.points, range, buffers, sums, |_| ());
            }
            self.estimator.draw(&f, self.points, range, buffers, sums, |sample| {
                let stream = sample.technique() * self.replicates() + sample.replicate();
                cells.sample(stream, pending, |tally| self.observer.observe(sample, tally));
            })
        });
        if f.skipped.into_inner() {
            return Ok(Drawn::Braked);
        }
        drawn.map_err(|message| RunFault::Panic { first: start, last: end - 1, message })??;
        Ok(Drawn::All)
    }
}

impl Shared<'_> {
    fn push(&mut self, span: &Span, index: u64, leaf: Leaf) {
        let place = usize::try_from(index - self.next).unwrap_or(usize::MAX);
        self.early.resize_with(self.early.len().max(place.saturating_add(1)), || None);
        if let Some(early) = self.early.get_mut(place) {
            *early = Some(leaf);
        }
        while let Some(leaf) = self.early.front_mut().and_then(Option::take) {
            self.early.pop_front();
            self.round.push(span, self.next, leaf, &mut self.spare);
            self.next += 1;
        }
    }

    fn fail(&mut self, index: u64, fault: RunFault) {
        if self.failure.as_ref().is_none_or(|(lowest, _)| index < *lowest) {
            self.failure = Some((index, fault));
        }
    }
}

/// A lock that a panic elsewhere does not close: what it guards is whole between calls.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What `work` returns, or what its panic said.
pub(super) fn caught<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic: Box<dyn Any + Send>| {
        let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
        text.unwrap_or_else(|| "a panic without a message".into())
    })
}

#[cfg(test)]
mod tests {
    use super::{Brake, Cancel, caught};
    use std::time::{Duration, Instant};

    #[test]
    fn what_a_panic_says() {
        assert_eq!(caught(|| 3), Ok(3));
        // `resume_unwind` does not call the hook, which would print the panic.
        let panics = |payload: Box<dyn std::any::Any + Send>| {
            caught::<()>(|| std::panic::resume_unwind(payload)).unwrap_err()
        };
        assert_eq!(panics(Box::new("text")), "text");
        assert_eq!(panics(Box::new(String::from("owned"))), "owned");
        assert_eq!(panics(Box::new(3)), "a panic without a message");
    }

    #[test]
    fn a_brake_is_applied_by_any_of_three() {
        let hour = Duration::from_secs(3600);
        let cancel = Cancel::new();
        let brake = Brake::new(Some(&cancel), Some(Instant::now() + hour));
        assert!(!brake.applies() && !brake.is_late() && !brake.is_cancelled());
        cancel.cancel();
        assert!(brake.applies() && brake.is_cancelled() && !brake.is_late());
        let brake = Brake::new(None, Some(Instant::now()));
        assert!(brake.applies() && brake.is_late() && !brake.is_cancelled());
        let brake = Brake::new(None, None);
        assert!(!brake.applies());
        brake.pull();
        assert!(brake.applies() && brake.is_cancelled());
    }
}
