//! Random schedules: threads, interruptions, checkpoints, shards and the order in which they are
//! merged. The bits are always the same.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use mis::{Cancel, Run, Stop};
use proptest::prelude::*;

use crate::common::{Case, Folder, Outcome, cases};

/// One session: so many threads, until so many evaluations, saved every so many microseconds.
type Session = (usize, u64, u64);

#[derive(Debug, Clone)]
struct Schedule {
    case: usize,
    /// For each shard; the last session is not interrupted.
    shards: Vec<Vec<Session>>,
    order: u64,
}

fn schedule() -> impl Strategy<Value = Schedule> {
    let session = (1..9_usize, 1..2500_u64, prop_oneof![Just(0), 1..2000_u64, Just(u64::MAX)]);
    let sessions = prop::collection::vec(session, 1..5);
    let shards = prop::collection::vec(sessions, 1..5);
    (0..7_usize, shards, any::<u64>()).prop_map(|(case, shards, order)| Schedule {
        case,
        shards,
        order,
    })
}

fn session(case: &Case, run: Run<'_>, (threads, evaluations, every): Session) -> Outcome {
    let cancel = Cancel::new();
    let count = AtomicU64::new(0);
    let hook = || {
        if count.fetch_add(1, Ordering::Relaxed) == evaluations {
            cancel.cancel();
        }
    };
    let run = run.threads(threads).unwrap().save_every(Duration::from_micros(every));
    case.hooked(run.cancel(&cancel), &hook)
}

fn follows(cases: &[Case], schedule: &Schedule) {
    let case = &cases[schedule.case];
    let whole = case.whole();
    let folder = Folder::new();
    // A run to a tolerance cannot be divided.
    let whole_only = case.name.starts_with("tolerance");
    let shards = if whole_only { &schedule.shards[..1] } else { &schedule.shards[..] };
    let of = shards.len() as u64;
    let mut files = Vec::new();
    for (index, sessions) in (0..of).zip(shards) {
        let path = folder.file(&index.to_string());
        let run = || case.run().checkpoint(&path).shard(index, of).unwrap();
        for one in sessions {
            let outcome = session(case, run(), *one);
            assert_eq!(outcome.error, None);
        }
        let outcome = case.go(run());
        assert!(matches!(outcome.stop, Stop::Samples | Stop::Tolerance));
        if of == 1 {
            assert_eq!(outcome, whole);
        }
        files.push(path);
    }
    if !whole_only {
        files.rotate_left(usize::try_from(schedule.order % of).unwrap());
        if schedule.order.is_multiple_of(2) {
            files.reverse();
        }
        let merged = case.merge(case.run(), &files);
        assert!(merged.numbers == whole.numbers, "{merged:?}\n{whole:?}");
    }
}

fn check(number: u32) {
    let cases = cases();
    let config = ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(number) };
    let mut runner = proptest::test_runner::TestRunner::new_with_rng(
        config,
        proptest::test_runner::TestRng::deterministic_rng(
            proptest::test_runner::RngAlgorithm::ChaCha,
        ),
    );
    runner
        .run(&schedule(), |schedule| {
            follows(&cases, &schedule);
            Ok(())
        })
        .unwrap();
}

#[test]
fn the_bits_do_not_depend_on_the_schedule() {
    check(40);
}

#[test]
#[ignore = "a minute"]
fn the_bits_do_not_depend_on_many_schedules() {
    check(2000);
}
