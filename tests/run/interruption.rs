//! A run that was interrupted and continued has the bits of one that was not.

use std::ops::ControlFlow::{Break, Continue};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use mis::{Cancel, Run, Stop, Target};

use crate::common::{Case, Folder, Outcome, cases};

/// Runs until the callback was called `calls` times.
fn with_callbacks(case: &Case, run: Run<'_>, calls: u64) -> Outcome {
    let mut left = calls;
    let watcher = |_: &mis::Progress| {
        left = left.saturating_sub(1);
        if left == 0 { Break(()) } else { Continue(()) }
    };
    case.go(run.progress(Duration::ZERO, watcher))
}

/// Runs until `evaluations` evaluations were begun.
fn with_evaluations(case: &Case, run: Run<'_>, evaluations: u64) -> Outcome {
    let cancel = Cancel::new();
    let count = AtomicU64::new(0);
    let hook = || {
        if count.fetch_add(1, Ordering::Relaxed) + 1 == evaluations {
            cancel.cancel();
        }
    };
    case.hooked(run.cancel(&cancel), &hook)
}

/// The same numbers, whatever ended the runs.
fn assert_same(a: &Outcome, b: &Outcome) {
    assert!(a.numbers == b.numbers, "{a:?}\n{b:?}");
}

/// What a run of exactly so many samples comes to.
fn replay(case: &Case, samples: u64) -> Outcome {
    let run = Run::new(Target::new().samples(samples).unwrap()).threads(1).unwrap();
    case.go(run)
}

fn at(path: &Path, case: &Case) -> Run<'static> {
    case.run().checkpoint(path)
}

#[test]
fn after_every_chunk() {
    let folder = Folder::new();
    for (number, case) in (0..).zip(cases()) {
        let whole = case.whole();
        let mut earlier = 0;
        // The others do not differ from these in how they are driven; they begin one chunk apart.
        let each = ["multi-sample", "tolerance, replicates", "one-sample, strata", "tally"];
        let each = each.contains(&case.name);
        let (first, step) = if each { (1, 1) } else { (1 + number % 5, 5) };
        for calls in (first..).step_by(step) {
            let path = folder.file("run");
            let stopped = with_callbacks(&case, at(&path, &case), calls);
            assert_eq!(stopped.error, None);
            if stopped.stop != Stop::Cancelled {
                assert_eq!(stopped, whole);
                assert!(calls > 24, "{case:?} has {calls} chunks");
                std::fs::remove_file(&path).unwrap();
                break;
            }
            // A call at the end of a round adds no chunk.
            assert!(stopped.samples >= earlier && stopped.samples <= whole.samples);
            assert!(stopped.samples > 0);
            if stopped.samples > earlier {
                earlier = stopped.samples;
                let replayed = replay(&case, stopped.samples);
                assert_same(&stopped, &replayed);
            }
            assert_eq!(case.go(at(&path, &case)), whole, "{case:?}, call {calls}");
            std::fs::remove_file(&path).unwrap();
        }
    }
}

#[test]
fn within_chunks_on_several_threads() {
    let folder = Folder::new();
    for case in cases() {
        let whole = case.whole();
        for evaluations in (1..whole.samples).step_by(149) {
            let path = folder.file("run");
            let run = Run::new(case.target).threads(3).unwrap().checkpoint(&path);
            let stopped = with_evaluations(&case, run, evaluations);
            assert_eq!(stopped.error, None);
            if stopped.stop == Stop::Cancelled && stopped.samples > 0 {
                assert_same(&stopped, &replay(&case, stopped.samples));
            }
            assert_eq!(case.go(at(&path, &case)), whole, "{case:?}, evaluation {evaluations}");
            std::fs::remove_file(&path).unwrap();
        }
    }
}

/// As many sessions as there are chunks.
#[test]
fn again_and_again() {
    let folder = Folder::new();
    for case in cases() {
        let path = folder.file(case.name);
        let whole = case.whole();
        for session in 1.. {
            let outcome = with_callbacks(&case, at(&path, &case), 1);
            if outcome.stop != Stop::Cancelled {
                assert_eq!(outcome, whole);
                assert!(session > 24, "{session}");
                break;
            }
            assert!(session < 500, "{case:?} does not get ahead");
        }
        // A run that is over stays so.
        assert_eq!(case.go(at(&path, &case)), whole);
    }
    assert_eq!(folder.names().len(), cases().len(), "{:?}", folder.names());
}

#[test]
fn a_limit_of_time() {
    let folder = Folder::new();
    let case = &cases()[0];
    let whole = case.whole();
    let path = folder.file("run");
    let slow = || std::thread::sleep(Duration::from_micros(50));
    let mut sessions = 0;
    loop {
        let target = Target::new().samples(whole.samples).unwrap();
        let target = target.time(Duration::from_millis(20));
        let run = Run::new(target).threads(2).unwrap().checkpoint(&path);
        let outcome = case.hooked(run, &slow);
        assert_eq!(outcome.error, None);
        sessions += 1;
        if outcome.stop == Stop::Samples {
            assert_same(&outcome, &whole);
            break;
        }
        assert_eq!(outcome.stop, Stop::Time);
        if outcome.samples > 0 {
            assert_same(&outcome, &replay(case, outcome.samples));
        }
        assert!(sessions < 1000);
    }
    assert!(sessions > 1, "{sessions}");
    // No time at all.
    let outcome = case.go(Run::new(Target::new().time(Duration::ZERO)));
    assert_eq!((outcome.stop, outcome.samples, outcome.error), (Stop::Time, 0, None));
}

#[test]
fn more_samples_continue_as_if_they_had_been_asked_for() {
    let folder = Folder::new();
    let case = &cases()[0];
    let path = folder.file("run");
    for samples in
        [1, 31, 32, 33, 63, 64, 65, 1023, 1024, 1025, 2047, 2048, 2500, 2501, 2560, 6000, 6001]
    {
        let target = Target::new().samples(samples).unwrap();
        let outcome = case.go(Run::new(target).checkpoint(&path));
        assert_eq!(outcome.error, None);
        assert_eq!(outcome, replay(case, samples), "{samples}");
    }
    // Fewer would have to be taken back, but for those of a chunk that was cut.
    for (samples, refused) in [(6000, false), (5990, false), (5000, true), (1024, true)] {
        let before = std::fs::read(&path).unwrap();
        let target = Target::new().samples(samples).unwrap();
        let outcome = case.go(Run::new(target).checkpoint(&path));
        if let Some(error) = outcome.error {
            assert!(refused && error.contains("it holds more of round"), "{samples} {error}");
            assert!(std::fs::read(&path).unwrap() == before);
        } else {
            assert!(!refused);
            assert_eq!(outcome, replay(case, samples), "{samples}");
        }
    }
}

#[test]
fn another_tolerance_continues_as_if_it_had_been_asked_for() {
    let folder = Folder::new();
    let all = cases();
    for name in ["multi-sample", "one-sample", "tally", "faults as zero"] {
        let case = all.iter().find(|case| case.name == name).unwrap();
        let path = folder.file(name);
        let mut samples = Vec::new();
        // Tighter and tighter, and looser again.
        for relative in [0.1, 0.03, 0.015, 0.05, 0.02, 0.008] {
            let target = Target::new().relative(relative).unwrap();
            let fresh = case.go(Run::new(target));
            assert_eq!((fresh.stop, &fresh.error), (Stop::Tolerance, &None));
            let outcome = case.go(Run::new(target).checkpoint(&path));
            assert_eq!(outcome, fresh, "{case:?}, {relative}");
            samples.push(fresh.samples);
        }
        assert!(samples[2] > samples[0] && samples[5] > samples[2], "{samples:?}");
        assert!(samples[3] < samples[2], "{samples:?}");
    }
}
