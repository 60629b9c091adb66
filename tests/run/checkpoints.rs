//! Files that are of something else, or cannot be written.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use mis::technique::{Linear, Uniform};
use mis::weighting::Power;
use mis::{
    CheckpointError, Integrand, MultiSample, OnFault, OneSample, Report, Run, RunError, RunFault,
    Stop, Target,
};

use crate::common::{Folder, f};

pub(crate) fn flat() -> Uniform {
    Uniform::new(0.0, 2.0).unwrap()
}

pub(crate) fn ramp() -> Linear {
    Linear::new(0.0, 2.0, 0.0, 1.0).unwrap()
}

pub(crate) fn fault<V: mis::Value>(result: Result<Report<V>, RunError<V>>) -> (String, bool) {
    let error = result.map(|_| ()).unwrap_err();
    let RunFault::Checkpoint(_) = error.fault() else { panic!("{error}") };
    (error.to_string(), error.report().is_some())
}

/// A run that counts evaluations, at most so many; the files are the only difference.
pub(crate) fn counted(run: Run<'_>, seed: u64) -> (Result<Report, RunError>, u64) {
    let (flat, ramp) = (flat(), ramp());
    let mis = MultiSample::new(&[(&flat, 600), (&ramp, 500)]).unwrap();
    let count = AtomicU64::new(0);
    let counting = |x: &f64| {
        count.fetch_add(1, Ordering::Relaxed);
        f(x)
    };
    let result = run.execute(&mis, &counting, seed);
    (result, count.into_inner())
}

/// The samples that tell one run from another.
const PROBES: u64 = 2 * 16;

#[test]
fn a_place_that_cannot_be_written_is_an_error_before_anything_is_run() {
    let folder = Folder::new();
    let file = folder.file("file");
    fs::write(&file, "something").unwrap();
    let directory = folder.file("directory");
    fs::create_dir(&directory).unwrap();
    let mut places = vec![
        (folder.file("missing").join("run"), "writing"),
        (file.join("run"), "reading"),
        (directory, "reading"),
        (PathBuf::new(), "writing"),
    ];
    if Path::new("/proc/version").exists() {
        // Where not even root can write.
        places.push((PathBuf::from("/proc/run"), "writing"));
    }
    for (path, action) in places {
        let (result, count) = counted(Run::new(Target::new()).checkpoint(&path), 1);
        assert!(count <= PROBES, "{count}");
        let (text, report) = fault(result);
        assert!(text.contains(action) && text.contains(path.to_str().unwrap()), "{text}");
        assert!(!report);
    }
    assert_eq!(folder.names(), ["directory", "file"]);
    assert_eq!(fs::read(&file).unwrap(), b"something");
}

/// No space is left from the start, or from some moment on.
#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_is_full() {
    use std::os::unix::fs::symlink;
    let full = Path::new("/dev/full");
    if !full.exists() {
        return;
    }
    let folder = Folder::new();
    let path = folder.file("run");
    // The name that the file has before it is renamed: writing there fails as on a full disk.
    let temporary = folder.file(&format!("run.{}.tmp", std::process::id()));
    symlink(full, &temporary).unwrap();
    let (result, count) = counted(Run::new(Target::new()).checkpoint(&path), 1);
    let (text, report) = fault(result);
    assert!(text.contains("No space left") && !report && count <= PROBES, "{text}");
    assert!(folder.names().is_empty());

    let mut unsaved = Vec::new();
    let watcher = |progress: &mis::Progress| {
        unsaved.push((progress.samples, progress.unsaved));
        if progress.samples == 1024 {
            symlink(full, &temporary).unwrap();
        }
        std::ops::ControlFlow::Continue(())
    };
    let run = Run::new(Target::new()).threads(1).unwrap().checkpoint(&path);
    let (result, _) = counted(run.progress(Duration::MAX, watcher), 1);
    let report = result.unwrap();
    // The end was saved: the run had another try.
    assert_eq!(unsaved, [(1024, false), (1100, true)]);
    assert!(report.checkpoint_error().is_none(), "{report}");
    assert!(!report.to_string().contains("No space left"), "{report}");
    assert_eq!(folder.names(), ["run"]);
    let (again, count) = counted(Run::new(Target::new()).checkpoint(&path), 1);
    assert_eq!((again.unwrap().value(), count), (report.value(), PROBES));
}

/// The file turns into a folder during the run, so that it cannot be replaced.
#[test]
fn a_failure_later_does_not_stop_the_run_but_is_shown() {
    let folder = Folder::new();
    let path = folder.file("run");
    for recovers in [true, false] {
        let (mut calls, mut unsaved) = (0, Vec::new());
        let watcher = |progress: &mis::Progress| {
            calls += 1;
            if progress.unsaved {
                unsaved.push(calls);
            }
            if calls == 2 {
                fs::remove_file(&path).unwrap();
                fs::create_dir(&path).unwrap();
            } else if calls == 10 && recovers {
                fs::remove_dir(&path).unwrap();
            }
            std::ops::ControlFlow::Continue(())
        };
        let run = Run::new(Target::new()).threads(1).unwrap().checkpoint(&path);
        let run = run.save_every(Duration::ZERO).progress(Duration::ZERO, watcher);
        let (result, _) = counted(run, 1);
        let whole = counted(Run::new(Target::new()), 1).0.unwrap();
        if recovers {
            let report = result.unwrap();
            assert_eq!(report.value(), whole.value());
            assert!(report.checkpoint_error().is_none(), "{report}");
            // Each call comes after an attempt to save, and from the tenth on they succeed.
            assert_eq!(unsaved, (3..=10).collect::<Vec<_>>());
            let (again, count) = counted(Run::new(Target::new()).checkpoint(&path), 1);
            assert_eq!((again.unwrap().value(), count), (whole.value(), PROBES));
            fs::remove_file(&path).unwrap();
        } else {
            let error = result.unwrap_err();
            let RunFault::Checkpoint(CheckpointError::System {
                path: named,
                action: "writing",
                ..
            }) = error.fault()
            else {
                panic!("{error}")
            };
            assert_eq!(*named, path);
            let report = error.report().unwrap();
            assert_eq!((report.value(), report.stop()), (whole.value(), Stop::Samples));
            // The failure is the error itself.
            assert!(report.checkpoint_error().is_none());
            // 16 and 2 chunks, and the ends of two rounds.
            assert_eq!(unsaved, (3..=20).collect::<Vec<_>>());
            fs::remove_dir(&path).unwrap();
        }
        assert!(folder.names().is_empty(), "{:?}", folder.names());
    }
}

#[test]
fn a_file_that_cannot_be_replaced_stays_as_it_is() {
    let folder = Folder::new();
    let inner = folder.file("inner");
    fs::create_dir(&inner).unwrap();
    let path = inner.join("run");
    let first = Target::new().samples(1024).unwrap();
    counted(Run::new(first).checkpoint(&path), 1).0.unwrap();
    // The folder moves away: the old file is in it.
    let moved = folder.file("moved");
    let mut before = Vec::new();
    let watcher = |_: &mis::Progress| {
        if inner.exists() {
            before = fs::read(&path).unwrap();
            fs::rename(&inner, &moved).unwrap();
        }
        std::ops::ControlFlow::Continue(())
    };
    let second = Target::new().samples(1100).unwrap();
    let run = Run::new(second).checkpoint(&path).progress(Duration::ZERO, watcher);
    let (result, _) = counted(run.threads(1).unwrap(), 1);
    let error = result.unwrap_err();
    assert_eq!(error.report().unwrap().samples(), 1100);
    assert_eq!(error.report().unwrap().stop(), Stop::Samples);
    assert!(fs::read(moved.join("run")).unwrap() == before);
    assert_eq!(fs::read_dir(&moved).unwrap().count(), 1);
}

/// A fault, and a file that fails at the same end are both reported.
#[test]
fn a_fault_at_the_end_does_not_hide_that_it_was_not_saved() {
    let folder = Folder::new();
    let path = folder.file("run");
    let flat = flat();
    let mis = MultiSample::new(&[(&flat, 5000)]).unwrap();
    let count = AtomicU64::new(0);
    let planted = |_: &f64| {
        if count.fetch_add(1, Ordering::Relaxed) < 3000 {
            return 1.0;
        }
        if path.is_file() {
            fs::remove_file(&path).unwrap();
            fs::create_dir(&path).unwrap();
        }
        f64::NAN
    };
    let run = Run::new(Target::new()).threads(1).unwrap().checkpoint(&path);
    let error = run.execute(&mis, &planted, 1).unwrap_err();
    assert!(error.to_string().contains("the integrand is NaN"), "{error}");
    assert!(error.report().unwrap().checkpoint_error().is_some());
}

#[test]
fn files_of_other_runs_are_refused_and_kept() {
    let folder = Folder::new();
    let path = folder.file("run");
    let (a, b) = (flat(), ramp());
    let multi = |n: u64| MultiSample::new(&[(&a, n), (&b, 500)]).unwrap();
    let target = Target::new().samples(1100).unwrap();
    let run = || Run::new(target).checkpoint(&path).label("mine");
    run().execute(&multi(600), &f, 1).unwrap();
    let before = fs::read(&path).unwrap();
    let refused = |(text, report): (String, bool), expected: &str| {
        assert!(text.contains("it is of another run") && text.contains(expected), "{text}");
        assert!(!report);
        assert_eq!(fs::read(&path).unwrap(), before);
        assert_eq!(folder.names(), ["run"]);
    };
    let first = "its first samples contribute something else";
    refused(fault(run().execute(&multi(600), &f, 2)), first);
    refused(fault(run().execute(&multi(600), &|x: &f64| f(x) * (1.0 + 1e-15), 1)), first);
    let narrow = Uniform::new(0.0, 1.999_999_999).unwrap();
    let other = MultiSample::new(&[(&narrow, 600), (&b, 500)]).unwrap();
    refused(fault(run().execute(&other, &f, 1)), first);
    let swapped = MultiSample::new(&[(&b, 600), (&a, 500)]).unwrap();
    refused(fault(run().execute(&swapped, &f, 1)), first);
    let nan = |x: &f64| if *x > 1.0 { f64::NAN } else { f(x) };
    refused(fault(run().execute(&multi(600), &nan, 1)), first);
    let panics = |x: &f64| if *x > 1.0 { panic!("planted") } else { f(x) };
    crate::common::quiet();
    refused(fault(run().execute(&multi(600), &panics, 1)), first);

    let shares = "its estimator is \"multi-sample, shares [0.5454";
    refused(fault(run().execute(&multi(601), &f, 1)), shares);
    let three = MultiSample::new(&[(&a, 600), (&b, 500), (&a, 1)]).unwrap();
    refused(fault(run().execute(&three, &f, 1)), shares);
    let squared = multi(600).weighting(Power::squared()).unwrap();
    refused(fault(run().execute(&squared, &f, 1)), "weighting Power");
    let lenient = multi(600).on_fault(OnFault::count_as_zero(0.5).unwrap());
    refused(fault(run().execute(&lenient, &f, 1)), "at most 0.5 may be faults");
    let one = OneSample::new(&[(&a, 0.5), (&b, 0.5)], 1100).unwrap();
    refused(fault(run().execute(&one, &f, 1)), "one-sample, probabilities");

    let two = |x: &f64| [f(x), f(x)];
    refused(fault(run().execute(&multi(600), &two, 1)), "its number of components is 1, not 2");
    let points = mis::points::Random::new(1);
    let with_sums = run().tally(&multi(600), &f, &points, 3, |_, _| ());
    refused(fault(with_sums), "its number of sums is 0, not 3");
    let label = run().label("yours").execute(&multi(600), &f, 1);
    refused(fault(label), "its label is \"mine\", not \"yours\"");
    let none = Run::new(target).checkpoint(&path).execute(&multi(600), &f, 1);
    refused(fault(none), "its label is \"mine\", not \"\"");
    let shard = run().shard(0, 2).unwrap().execute(&multi(600), &f, 1);
    refused(fault(shard), "it is shard 0 of 1, not shard 0 of 2");

    // The same shares, in other numbers, and the same points by another way, are the same run.
    let doubled = MultiSample::new(&[(&a, 1200), (&b, 1000)]).unwrap();
    assert_eq!(run().execute(&doubled, &f, 1).unwrap().samples(), 1100);
    assert!(run().execute_from(&doubled, &f, &points).is_ok());
}

/// With files every few microseconds, none is ever half there.
#[test]
fn there_is_a_whole_file_at_any_time() {
    let folder = Folder::new();
    let path = folder.file("run");
    let done = std::sync::atomic::AtomicBool::new(false);
    std::thread::scope(|scope| {
        let reader = scope.spawn(|| {
            let (mut seen, mut reads) = (0, 0);
            while !done.load(Ordering::Relaxed) {
                if let Ok(bytes) = fs::read(&path) {
                    let (body, checksum) = bytes.split_at(bytes.len() - 8);
                    let crc = crc::Crc::<u64>::new(&crc::CRC_64_XZ);
                    assert_eq!(crc.checksum(body).to_le_bytes(), checksum);
                    seen += 1;
                }
                reads += 1;
            }
            (seen, reads)
        });
        let run = Run::new(Target::new().samples(60_000).unwrap()).threads(2).unwrap();
        counted(run.checkpoint(&path).save_every(Duration::ZERO), 1).0.unwrap();
        done.store(true, Ordering::Relaxed);
        assert!(reader.join().unwrap().0 > 0);
    });
    assert_eq!(folder.names(), ["run"]);
}

/// An integrand with its own batches is asked for the same points.
#[test]
fn an_integrand_with_batches_has_the_same_file() {
    struct Batch;
    impl Integrand<f64> for Batch {
        type Value = f64;
        fn eval(&self, _: &f64) -> f64 {
            f64::NAN
        }
        fn eval_batch(&self, xs: &[f64], out: &mut [f64]) {
            out.iter_mut().zip(xs).for_each(|(out, x)| *out = f(x));
        }
    }
    let folder = Folder::new();
    let flat = flat();
    let mis = MultiSample::new(&[(&flat, 3000)]).unwrap();
    let run = |name: &str| Run::new(Target::new()).checkpoint(folder.file(name));
    let one = run("one").execute(&mis, &Batch, 1).unwrap();
    let two = run("two").execute(&mis, &f, 1).unwrap();
    assert_eq!(one.value(), two.value());
    assert_eq!(run("one").execute(&mis, &f, 1).unwrap().value(), one.value());
}
