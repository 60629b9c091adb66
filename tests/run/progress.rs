//! How a run is watched, stopped, saved and printed while it goes on.

use std::collections::HashSet;
use std::ops::ControlFlow::Continue;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use mis::technique::{Linear, Uniform};
use mis::{Cancel, MultiSample, Progress, Report, Run, Stop, Target};

use crate::common::{Folder, f};

fn flat() -> Uniform {
    Uniform::new(0.0, 2.0).unwrap()
}

fn ramp() -> Linear {
    Linear::new(0.0, 2.0, 0.0, 1.0).unwrap()
}

fn to(samples: u64) -> Target {
    Target::new().samples(samples).unwrap()
}

/// With so many shares that a technique's are rounded.
fn go(run: Run<'_>) -> Report {
    let (flat, ramp) = (flat(), ramp());
    MultiSample::new(&[(&flat, 2), (&ramp, 1)])
        .map(|mis| run.execute(&mis, &f, 1).unwrap())
        .unwrap()
}

/// All calls of a run on one thread.
fn calls(run: Run<'_>, interval: Duration) -> (Vec<Progress>, Report) {
    let mut seen = Vec::new();
    let watcher = |progress: &Progress| {
        seen.push(*progress);
        Continue(())
    };
    let report = go(run.threads(1).unwrap().progress(interval, watcher));
    (seen, report)
}

#[test]
fn once_a_round() {
    let (seen, report) = calls(Run::new(to(5000)), Duration::MAX);
    let samples: Vec<u64> = seen.iter().map(|progress| progress.samples).collect();
    assert_eq!(samples, [1024, 2048, 4096, 5000]);
    let rounds: Vec<u32> = seen.iter().map(|progress| progress.round).collect();
    assert_eq!(rounds, [0, 1, 2, 3]);
    for (progress, round) in seen.iter().zip(report.rounds()) {
        assert!(!progress.confirming && !progress.unsaved);
        assert_eq!(progress.value, round.cumulative.value());
        assert_eq!(progress.standard_error, round.cumulative.standard_error());
        assert_eq!((progress.limit, progress.excess), (5000, None));
        assert!(progress.elapsed <= report.elapsed());
        let rate = progress.samples as f64 / progress.elapsed.as_secs_f64();
        assert!((progress.rate / rate - 1.0).abs() < 1e-9);
        let remaining = (5000 - progress.samples) as f64 / rate;
        assert!((progress.remaining.unwrap().as_secs_f64() - remaining).abs() < 1e-6);
    }
}

#[test]
fn after_every_chunk_of_the_calling_thread() {
    let (seen, report) = calls(Run::new(to(2400)), Duration::ZERO);
    assert_eq!(report.samples(), 2400);
    // 16, 16 and 3 chunks, and the ends of three rounds.
    assert_eq!(seen.len(), 16 + 16 + 3 + 3);
    for (k, progress) in seen.iter().enumerate().take(16) {
        let samples = 64 * (k as u64 + 1);
        let prefix = go(Run::new(to(samples)));
        assert_eq!((progress.round, progress.samples), (0, samples));
        assert_eq!(progress.value, prefix.value());
        assert_eq!(progress.standard_error, prefix.standard_error());
    }
    assert_eq!((seen[16].round, seen[16].samples), (0, 1024));
    assert_eq!((seen[17].round, seen[17].samples), (1, 1024 + 64));
    assert_eq!(seen.last().unwrap().samples, 2400);
    assert_eq!(seen.last().unwrap().value, report.value());
}

#[test]
fn an_interval_of_time() {
    let (flat, mut times) = (flat(), Vec::new());
    let mis = MultiSample::new(&[(&flat, 1)]).unwrap();
    let slow = |x: &f64| {
        std::thread::sleep(Duration::from_micros(100));
        f(x)
    };
    let interval = Duration::from_millis(25);
    let run = Run::new(to(1024)).threads(1).unwrap().progress(interval, |progress| {
        times.push(progress.elapsed);
        Continue(())
    });
    run.execute(&mis, &slow, 1).unwrap();
    // The last is the end of the round.
    times.pop();
    assert!(times.len() >= 2, "{times:?}");
    assert!(
        times.windows(2).all(|pair| pair[1].saturating_sub(pair[0]) > interval / 2),
        "{times:?}"
    );
    assert!(times[0] >= interval);
}

#[test]
fn a_tolerance() {
    let target = Target::new().absolute(0.004).unwrap().confidence(0.9).unwrap();
    let (seen, report) = calls(Run::new(target), Duration::MAX);
    assert_eq!(report.stop(), Stop::Tolerance);
    assert_eq!(seen.len(), report.rounds().len());
    for (progress, round) in seen.iter().zip(report.rounds()) {
        let interval = round.cumulative.interval(0.9).unwrap();
        let value = round.cumulative.value();
        let half = (interval.upper - value).max(value - interval.lower);
        assert!((progress.excess.unwrap() / (half / 0.004) - 1.0).abs() < 1e-12);
        assert_eq!(progress.limit, 1 << 53);
        // To the end of a round that has what the tolerance with its margin takes, and of the next.
        let needed = progress.samples as f64 * (1.1 * progress.excess.unwrap()).powi(2);
        let mut last = progress.samples;
        while !progress.confirming && (last as f64) < needed {
            last *= 2;
        }
        if !progress.confirming {
            last *= 2;
        }
        let remaining = (last - progress.samples) as f64 / progress.rate;
        assert!(
            (progress.remaining.unwrap().as_secs_f64() - remaining).abs() < 1e-6 + 1e-6 * remaining
        );
    }
    // A round confirms if the tolerance was reached with its margin before it.
    assert!(seen.len() > 2 && seen[seen.len() - 1].confirming && !seen[0].confirming);
    for pair in seen.windows(2) {
        assert_eq!(pair[1].confirming, 1.1 * pair[0].excess.unwrap() <= 1.0, "{pair:?}");
    }
    assert_eq!(seen[seen.len() - 1].remaining, Some(Duration::ZERO));
    let text = report.to_string();
    let confirming = report.estimate().samples();
    assert!(text.contains(&format!("of which {confirming} confirm and are reported")), "{text}");
    // A time is a bound of what remains.
    let hour = Duration::from_secs(3600);
    let target = Target::new().absolute(1e-9).unwrap().samples(3000).unwrap().time(hour);
    let (seen, _) = calls(Run::new(target), Duration::MAX);
    assert!(seen.iter().all(|progress| progress.remaining.unwrap() <= hour));
}

#[test]
fn a_shard_counts_its_own_part() {
    let folder = Folder::new();
    let mut limits = 0;
    for index in 0..3 {
        let run = Run::new(to(100_000)).checkpoint(folder.file(&format!("{index}")));
        let (seen, report) = calls(run.shard(index, 3).unwrap(), Duration::MAX);
        let limit = seen[0].limit;
        for progress in &seen {
            assert_eq!(progress.limit, limit);
            let remaining = (limit - progress.samples) as f64 / progress.rate;
            assert!((progress.remaining.unwrap().as_secs_f64() - remaining).abs() < 1e-6);
        }
        let last = seen.last().unwrap();
        assert_eq!((last.samples, last.remaining), (limit, Some(Duration::ZERO)));
        assert_eq!(report.samples(), limit);
        limits += limit;
    }
    assert_eq!(limits, 100_000);
}

#[test]
fn a_continued_run_shows_only_what_is_new() {
    let folder = Folder::new();
    let path = folder.file("run");
    go(Run::new(to(3000)).checkpoint(&path));
    let (seen, report) = calls(Run::new(to(6000)).checkpoint(&path), Duration::MAX);
    let samples: Vec<u64> = seen.iter().map(|progress| progress.samples).collect();
    assert_eq!(samples, [4096, 6000]);
    let last = seen[1];
    // The cut chunk of 3000 samples is drawn again.
    let new = last.rate * last.elapsed.as_secs_f64();
    assert!((6000.0 - 3000.0 - new).abs() < 65.0, "{new}");
    let text = report.to_string();
    assert!(text.contains("6000 samples; 30"), "{text}");
    let (seen, _) = calls(Run::new(to(6000)).checkpoint(&path), Duration::ZERO);
    assert!(seen.is_empty());
}

/// Other threads go on while the callback takes its time.
#[cfg(feature = "parallel")]
#[test]
fn a_slow_callback_does_not_hold_up_other_threads() {
    let (flat, count) = (flat(), AtomicU64::new(0));
    let mis = MultiSample::new(&[(&flat, 1)]).unwrap();
    let counting = |x: &f64| {
        count.fetch_add(1, Ordering::Relaxed);
        f(x)
    };
    let mut first = true;
    let watcher = |progress: &Progress| {
        let before = count.load(Ordering::Relaxed);
        // The other thread may have a chunk in hand, and must have others to draw.
        let chunk = (1 << progress.round) * 512 / 16;
        let left = 4 * chunk <= (1024 << progress.round) - before;
        if first && progress.round >= 4 && left {
            first = false;
            let began = std::time::Instant::now();
            while count.load(Ordering::Relaxed) < before + 3 * chunk {
                assert!(began.elapsed() < Duration::from_secs(60), "the other thread waits");
                std::thread::yield_now();
            }
        }
        Continue(())
    };
    let run = Run::new(to(1 << 16)).threads(2).unwrap().progress(Duration::ZERO, watcher);
    run.execute(&mis, &counting, 1).unwrap();
    assert!(!first);
}

#[test]
fn as_many_threads_as_were_asked_for() {
    let flat = flat();
    let mis = MultiSample::new(&[(&flat, 1)]).unwrap();
    for threads in [1, 2, 5] {
        let seen = Mutex::new(HashSet::new());
        let counting = |x: &f64| {
            seen.lock().unwrap().insert(std::thread::current().id());
            std::thread::sleep(Duration::from_micros(20));
            f(x)
        };
        Run::new(to(4096)).threads(threads).unwrap().execute(&mis, &counting, 1).unwrap();
        let seen = seen.into_inner().unwrap();
        assert!(seen.contains(&std::thread::current().id()));
        let expected = if cfg!(feature = "parallel") { threads } else { 1 };
        assert_eq!(seen.len(), expected);
    }
    assert!(Run::new(Target::new()).threads(0).is_err());
}

#[test]
fn cancelled_from_another_thread() {
    let flat = flat();
    let mis = MultiSample::new(&[(&flat, 1)]).unwrap();
    let cancel = Cancel::new();
    let count = AtomicU64::new(0);
    let counting = |x: &f64| {
        count.fetch_add(1, Ordering::Relaxed);
        f(x)
    };
    let report = std::thread::scope(|scope| {
        scope.spawn(|| {
            while count.load(Ordering::Relaxed) < 5000 {
                std::thread::yield_now();
            }
            cancel.cancel();
        });
        Run::new(to(1 << 50)).cancel(&cancel).execute(&mis, &counting, 1).unwrap()
    });
    assert_eq!(report.stop(), Stop::Cancelled);
    assert!(
        report.samples() >= 4096 && report.to_string().contains(", incomplete; it was cancelled\n")
    );
    assert!(!Cancel::default().is_cancelled());
}

#[test]
fn checkpoints_at_rounds_and_at_intervals() {
    let folder = Folder::new();
    for (every, at_least, at_most) in [(Duration::ZERO, 35, 38), (Duration::MAX, 3, 4)] {
        let path = folder.file(&format!("{every:?}"));
        let mut files = HashSet::new();
        let watcher = |_: &Progress| {
            files.insert(std::fs::read(&path).unwrap());
            Continue(())
        };
        let run = Run::new(to(2400)).threads(1).unwrap().checkpoint(&path).save_every(every);
        go(run.progress(Duration::ZERO, watcher));
        files.insert(std::fs::read(&path).unwrap());
        assert!((at_least..=at_most).contains(&files.len()), "{every:?}: {}", files.len());
    }
}

#[test]
fn every_setting_is_printed() {
    let folder = Folder::new();
    let path = folder.file("run");
    let run = Run::new(to(2400)).threads(3).unwrap().label("mine").checkpoint(&path);
    let text = go(run.save_every(Duration::from_millis(2500)).shard(1, 2).unwrap()).to_string();
    for line in [
        "target: at most 2400 samples",
        "estimator: multi-sample, shares [0.6666666666666666, 0.3333333333333333], weighting Balance",
        "points: Random { seed: 1 }",
        "threads: 3",
        &format!("checkpoint: {}, every 2.5 s", path.display()),
        "label: mine",
        "shard: 1 of 2",
    ] {
        assert!(text.lines().any(|found| found == line), "{line}\n{text}");
    }
    let text = go(Run::new(to(2400))).to_string();
    for name in ["threads:", "checkpoint:", "label:", "shard:"] {
        assert!(!text.contains(name), "{text}");
    }
    assert!(text.contains(", budget spent; all samples are drawn\n95 % interval: ["), "{text}");
    assert!(text.contains("2400 samples; 2400 in "), "{text}");
    let agreement = |line: &&str| line.starts_with("rounds against each other: chi2/dof ");
    assert_eq!(text.lines().filter(agreement).count(), 1, "{text}");
    assert_eq!(
        text.lines().filter(|line| line.trim_start().starts_with("2 ")).count(),
        1,
        "{text}"
    );
}
