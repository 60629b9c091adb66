//! The threads of a run.

use super::error::RunFault;

/// Threads that work beside the one that called.
///
/// The calling thread always works too, so that a run that is started from within a pool of threads
/// ends even if no other thread of it is free.
#[derive(Debug)]
pub(super) struct Threads {
    /// How many beside the calling one.
    others: usize,
    /// A pool of its own, if their number was given.
    #[cfg(feature = "parallel")]
    pool: Option<rayon::ThreadPool>,
}

#[cfg(feature = "parallel")]
impl Threads {
    /// So many threads, the calling one included; as many as the global pool has if `None`.
    pub(super) fn new(threads: Option<usize>) -> Result<Self, RunFault> {
        let Some(threads) = threads else {
            return Ok(Self { others: rayon::current_num_threads() - 1, pool: None });
        };
        let others = threads - 1;
        if others == 0 {
            return Ok(Self { others, pool: None });
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(others).build();
        match pool {
            Ok(pool) => Ok(Self { others, pool: Some(pool) }),
            Err(error) => Err(RunFault::Threads { threads, message: error.to_string() }),
        }
    }

    /// Runs `own` on this thread and `other` on the others, no more of them than there are `tasks`,
    /// until all have ended.
    pub(super) fn run(&self, tasks: u64, other: &(impl Fn() + Sync), own: impl FnOnce()) {
        let most = usize::try_from(tasks.saturating_sub(1)).unwrap_or(usize::MAX);
        let others = self.others.min(most);
        if others == 0 {
            return own();
        }
        match &self.pool {
            Some(pool) => pool.in_place_scope(|scope| {
                (0..others).for_each(|_| scope.spawn(|_| other()));
                own();
            }),
            None => rayon::in_place_scope(|scope| {
                (0..others).for_each(|_| scope.spawn(|_| other()));
                own();
            }),
        }
    }
}

#[cfg(not(feature = "parallel"))]
impl Threads {
    /// One thread, however many were asked for.
    #[expect(clippy::unnecessary_wraps, reason = "with the feature, threads may not start")]
    pub(super) fn new(_: Option<usize>) -> Result<Self, RunFault> {
        Ok(Self { others: 0 })
    }

    /// Runs `own`.
    pub(super) fn run(&self, _: u64, _: &(impl Fn() + Sync), own: impl FnOnce()) {
        debug_assert_eq!(self.others, 0);
        own();
    }
}
