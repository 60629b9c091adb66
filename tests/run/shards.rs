//! Shards of a run, drawn apart, are the run.

use std::path::PathBuf;

use mis::{Run, Stop, Target};

use crate::common::{Case, Dice, Folder, Outcome, cases};

/// Draws all shards, and returns their files.
fn draw(case: &Case, folder: &Folder, of: u64) -> Vec<PathBuf> {
    (0..of)
        .map(|index| {
            let path = folder.file(&format!("{} {index} of {of}", case.name));
            let run = case.run().checkpoint(&path).shard(index, of).unwrap();
            let outcome = case.go(run);
            assert_eq!((outcome.error, outcome.stop), (None, Stop::Samples));
            path
        })
        .collect()
}

fn shuffled(files: &[PathBuf], dice: &mut Dice) -> Vec<PathBuf> {
    let mut files = files.to_vec();
    for last in (1..files.len()).rev() {
        let other = dice.below(last as u64 + 1);
        files.swap(last, usize::try_from(other).unwrap());
    }
    files
}

/// A tolerance or a time cannot be divided.
fn divisible() -> impl Iterator<Item = Case> {
    cases().into_iter().filter(|case| !case.name.starts_with("tolerance"))
}

fn error(case: &Case, files: &[PathBuf]) -> String {
    case.merge(case.run(), files).error.unwrap()
}

#[test]
fn merged_in_any_order() {
    let mut dice = Dice(1);
    for case in divisible() {
        let whole = case.whole();
        // 90 are more than there are chunks.
        for of in [1, 2, 5, 90] {
            let folder = Folder::new();
            let files = draw(&case, &folder, of);
            for _ in 0..of.min(6) {
                let merged = case.merge(case.run(), &shuffled(&files, &mut dice));
                assert_eq!(merged.error, None);
                assert!(merged.numbers == whole.numbers, "{case:?} {of}\n{merged:?}\n{whole:?}");
                assert_eq!(merged.stop, Stop::Samples);
            }
        }
    }
}

#[test]
fn interrupted_and_continued_shards() {
    use std::ops::ControlFlow::{Break, Continue};
    let case = &cases()[0];
    let whole = case.whole();
    let folder = Folder::new();
    let files: Vec<PathBuf> = (0..3)
        .map(|index| {
            let path = folder.file(&format!("{index}"));
            let mut sessions = 0;
            loop {
                let mut left = 3;
                let watcher = |_: &mis::Progress| {
                    left -= 1;
                    if left == 0 { Break(()) } else { Continue(()) }
                };
                let run = case.run().checkpoint(&path).shard(index, 3).unwrap();
                let outcome = case.go(run.progress(std::time::Duration::ZERO, watcher));
                assert_eq!(outcome.error, None);
                sessions += 1;
                if outcome.stop == Stop::Samples {
                    break;
                }
                let [a, b] = [0, 1].map(|k| folder.file(&format!("{k}")));
                let files = [a, b, path.clone()];
                assert!(
                    case.merge(case.run(), &files[2 - usize::try_from(index).unwrap()..])
                        .error
                        .is_some()
                );
            }
            assert!(sessions > 3);
            path
        })
        .collect();
    assert!(case.merge(case.run(), &files).numbers == whole.numbers);
}

#[test]
fn a_merged_run_goes_on() {
    for name in ["multi-sample", "tally"] {
        let case = divisible().find(|case| case.name == name).unwrap();
        let folder = Folder::new();
        let files = draw(&case, &folder, 2);
        let place = folder.file("merged");
        let whole = case.whole();
        for _ in 0..2 {
            // A second time is no harm.
            let merged = case.merge(case.run().checkpoint(&place), &files);
            assert!(merged.numbers == whole.numbers, "{merged:?}");
        }
        assert_eq!(case.go(case.run().checkpoint(&place)), whole);
        let more = Target::new().samples(6000).unwrap();
        let outcome = case.go(Run::new(more).checkpoint(&place));
        assert_eq!(outcome, case.go(Run::new(more)));
        // Merging again would throw samples away.
        let error = case.merge(case.run().checkpoint(&place), &files).error.unwrap();
        assert!(
            error.contains("it holds more of round 1 than") || error.contains("of round 2"),
            "{error}"
        );
        assert_eq!(case.go(Run::new(more).checkpoint(&place)), outcome);
    }
}

#[test]
fn what_is_merged_does_not_overwrite_something_else() {
    let case = &cases()[0];
    let folder = Folder::new();
    let files = draw(case, &folder, 2);
    let before = std::fs::read(&files[0]).unwrap();
    let error = case.merge(case.run().checkpoint(&files[0]), &files).error.unwrap();
    assert!(error.contains("it is shard 0 of 2, not shard 0 of 1"), "{error}");
    assert_eq!(std::fs::read(&files[0]).unwrap(), before);
    let foreign = folder.file("foreign");
    std::fs::write(&foreign, "letters from home").unwrap();
    assert!(case.merge(case.run().checkpoint(&foreign), &files).error.is_some());
    assert_eq!(std::fs::read(&foreign).unwrap(), b"letters from home");
}

#[test]
fn shards_that_do_not_make_up_a_run_are_named() {
    let case = &cases()[0];
    let folder = Folder::new();
    let files = draw(case, &folder, 3);
    let [a, b, c] = [&files[0], &files[1], &files[2]].map(Clone::clone);
    let says = |files: &[&PathBuf], expected: &str| {
        let files: Vec<PathBuf> = files.iter().map(|path| (*path).clone()).collect();
        let text = error(case, &files);
        assert!(text.contains(expected), "{text}");
    };
    says(&[], "there are no files");
    says(&[&b, &c], "shard 0 of 3 is missing");
    says(&[&c, &a], "shard 1 of 3 is missing");
    says(&[&b, &a], "shard 2 of 3 is missing");
    says(&[&b, &a, &c, &b], "shard 1 of 3 is there twice");
    says(&[&c, &a, &b, &a], "shard 0 of 3 is there twice");
    says(&[&a, &b, &c, &c], "shard 2 of 3 is there twice");
    let nothing = folder.file("nothing");
    says(&[&a, &b, &nothing], "there is no file");

    // Not finished.
    let short = folder.file("short");
    let started = {
        let mut first = true;
        let watcher = move |_: &mis::Progress| {
            let flow = if first {
                std::ops::ControlFlow::Continue(())
            } else {
                std::ops::ControlFlow::Break(())
            };
            first = false;
            flow
        };
        let run = case.run().checkpoint(&short).shard(2, 3).unwrap();
        case.go(run.progress(std::time::Duration::ZERO, watcher))
    };
    assert_eq!(started.stop, Stop::Cancelled);
    says(&[&a, &short, &b], "short is not finished");

    // Of another division, another limit, another seed, another run.
    let halves = draw(case, &folder, 2);
    says(&[&a, &halves[1], &c], "it is shard 1 of 2, not shard 1 of 3");
    let longer = folder.file("longer");
    let target = Target::new().samples(3000).unwrap();
    let run = Run::new(target).checkpoint(&longer).shard(1, 3).unwrap();
    assert_eq!(case.go(run).error, None);
    says(&[&a, &longer, &c], "it is of 3000 samples, not 2377");
    let run = Run::new(target);
    let text = case.merge(run, &files).error.unwrap();
    assert!(text.contains("it is of 2377 samples, not 3000"), "{text}");
    let seeded = folder.file("seeded");
    let run = case.run().checkpoint(&seeded).shard(1, 3).unwrap();
    assert_eq!(case.seeded(run, 8).error, None);
    says(&[&a, &seeded, &c], "its first samples contribute something else");
    let all = cases();
    let tally = all.iter().find(|case| case.name == "tally").unwrap();
    let other = folder.file("other");
    assert_eq!(tally.go(tally.run().checkpoint(&other).shard(1, 3).unwrap()).error, None);
    says(&[&a, &other, &c], "its number of sums is 5, not 0");
    // A damaged one.
    let mut bytes = std::fs::read(&b).unwrap();
    bytes[100] ^= 4;
    let damaged = folder.file("damaged");
    std::fs::write(&damaged, bytes).unwrap();
    says(&[&a, &damaged, &c], "damaged");
}

#[test]
fn shards_of_a_shard_and_of_open_ends_are_refused() {
    let case = &cases()[0];
    let folder = Folder::new();
    let shard = |target| Run::new(target).shard(0, 2).unwrap();
    let fails = |outcome: Outcome| outcome.error.unwrap();
    let path = folder.file("run");
    let second = std::time::Duration::from_secs(1);
    for text in [
        fails(case.go(shard(case.target))),
        fails(case.go(shard(case.target.time(second)).checkpoint(&path))),
        fails(case.go(shard(case.target.relative(0.1).unwrap()).checkpoint(&path))),
    ] {
        assert!(text.contains("a shard needs a checkpoint and a fixed number"), "{text}");
    }
    let files = draw(case, &folder, 2);
    let text = fails(case.merge(shard(case.target).checkpoint(&path), &files));
    assert!(text.contains("a shard needs"), "{text}");
    for target in [case.target.time(second), case.target.absolute(0.1).unwrap()] {
        let text = fails(case.merge(Run::new(target), &files));
        assert!(text.contains("without a tolerance or a time"), "{text}");
    }
    assert!(!path.exists());
    for (index, of) in [(2, 2), (0, 0), (u64::MAX, 1)] {
        assert!(Run::new(Target::new()).shard(index, of).is_err());
    }
    // A shard goes on only as what it is.
    let text = fails(case.go(case.run().checkpoint(&files[0]).shard(1, 2).unwrap()));
    assert!(text.contains("it is shard 0 of 2, not shard 1 of 2"), "{text}");
    let text = fails(case.go(case.run().checkpoint(&files[0])));
    assert!(text.contains("it is shard 0 of 2, not shard 0 of 1"), "{text}");
    let target = Target::new().samples(3000).unwrap();
    let text = fails(case.go(Run::new(target).checkpoint(&files[0]).shard(0, 2).unwrap()));
    assert!(text.contains("it is of a run of 2377 samples, not 3000"), "{text}");
}
