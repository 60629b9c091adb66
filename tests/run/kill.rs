//! A process that is killed at any moment, and continued.
#![cfg(unix)]

use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::{Case, Dice, Folder, cases};

const VARIABLE: &str = "MIS_TEST_KILLED_RUN";

/// Which kind of run the process draws.
const CASES: [&str; 3] = ["multi-sample", "tally", "tolerance"];

fn case(name: &str) -> Case {
    cases().into_iter().find(|case| case.name == name).unwrap()
}

/// Not a test but the process that is killed: it does something only where the variable is set.
#[test]
fn child() {
    let Ok(what) = std::env::var(VARIABLE) else { return };
    let (name, path) = what.split_once('|').unwrap();
    let case = case(name);
    let run = case.run().threads(2).unwrap().checkpoint(path).save_every(Duration::ZERO);
    let outcome = case.hooked(run, &|| std::thread::sleep(Duration::from_micros(20)));
    assert_eq!(outcome.error, None);
}

fn spawn(case: &Case, path: &Path) -> Child {
    Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "kill::child", "--test-threads", "1"])
        .env(VARIABLE, format!("{}|{}", case.name, path.display()))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

fn check(kills: u32) {
    let folder = Folder::new();
    let mut dice = Dice(u64::from(std::process::id()));
    let mut midway = 0;
    for number in 0..kills {
        let case = case(CASES[number as usize % CASES.len()]);
        let path = folder.file(&number.to_string());
        // Once, or again and again.
        let times = if number % 2 == 0 { 1 } else { 3 };
        for _ in 0..times {
            let existed = path.exists();
            let mut child = spawn(&case, &path);
            let began = Instant::now();
            while !existed && !path.exists() && child.try_wait().unwrap().is_none() {
                assert!(began.elapsed() < Duration::from_secs(60), "the process does not begin");
                std::thread::sleep(Duration::from_millis(1));
            }
            std::thread::sleep(Duration::from_micros(dice.below(80_000)));
            child.kill().unwrap();
            let status = child.wait().unwrap();
            assert!(status.success() || status.signal() == Some(9), "{status}");
            midway += u32::from(status.signal() == Some(9));
        }
        let whole = case.whole();
        assert_eq!(case.go(case.run().checkpoint(&path)), whole, "{case:?}, kill {number}");
    }
    assert!(2 * midway >= kills, "only {midway} were killed before they ended");
}

#[test]
fn killed_and_continued() {
    check(5);
}

#[test]
#[ignore = "a few seconds"]
fn killed_and_continued_often() {
    check(40);
}
