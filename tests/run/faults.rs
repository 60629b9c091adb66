//! What a user's code, or a clock, can do to a run.

use std::ops::ControlFlow::Continue;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use mis::points::{PointSource, Random};
use mis::technique::{Linear, Uniform};
use mis::{
    Cancel, EstimateError, MultiSample, OnFault, Report, Run, RunError, RunFault, Status, Stop,
    Target, Technique,
};

use crate::common::{Dice, Folder, Outcome, Raw, f, quiet};

fn flat() -> Uniform {
    Uniform::new(0.0, 2.0).unwrap()
}

fn ramp() -> Linear {
    Linear::new(0.0, 2.0, 0.0, 1.0).unwrap()
}

/// The point of sample `index` of technique `technique`, with seed 1.
fn point(technique: &dyn Technique<Point = f64>, stream: usize, index: u64) -> f64 {
    let mut xi = [0.0];
    Random::new(1).fill(stream, index, 1, &mut xi).unwrap();
    technique.sample(&xi)
}

fn run<'a>(samples: u64, threads: usize) -> Run<'a> {
    Run::new(Target::new().samples(samples).unwrap()).threads(threads).unwrap()
}

/// A run with a value that is NaN at sample `index` of the second technique.
fn one_in(samples: u64, index: u64) {
    let (flat, ramp) = (flat(), ramp());
    let mis = MultiSample::new(&[(&flat, 1), (&ramp, 1)]).unwrap();
    let bad = point(&ramp, 1, index);
    let planted = |x: &f64| if *x == bad { f64::NAN } else { f(x) };
    for threads in [1, 2, 8] {
        let error = run(samples, threads).execute(&mis, &planted, 1).unwrap_err();
        let RunFault::Estimate(EstimateError::Value { technique: 1, sample, point, value }) =
            error.fault()
        else {
            panic!("{error}")
        };
        assert_eq!((*sample, point), (index, &format!("{bad:?}")));
        assert_eq!(value, "NaN");
        let report = error.report().unwrap();
        // The chunk of the sample is missing, and nothing before it.
        assert!(2 * index - report.samples() < 8192, "{}", report.samples());
        let before = run(report.samples(), 1).execute(&mis, &f, 1).unwrap();
        assert_eq!(Outcome::of(report).numbers, Outcome::of(&before).numbers);
        assert_eq!(report.stop(), Stop::Fault);
    }
}

#[test]
fn a_nan_is_an_error_that_names_the_sample() {
    one_in(300_000, 123_456);
}

/// The rest of the round would be drawn in vain.
#[test]
fn nothing_is_drawn_after_a_fault() {
    let flat = flat();
    let mis = MultiSample::new(&[(&flat, 1)]).unwrap();
    let bad = point(&flat, 0, 17_000);
    let count = AtomicU64::new(0);
    let planted = |x: &f64| {
        count.fetch_add(1, Ordering::Relaxed);
        if *x == bad { f64::NAN } else { f(x) }
    };
    let error = run(1 << 20, 1).execute(&mis, &planted, 1).unwrap_err();
    // A chunk has 1024 samples here.
    assert_eq!(error.report().unwrap().samples(), 1 << 14);
    assert!(count.into_inner() <= (1 << 14) + 1024);
}

#[test]
#[ignore = "10^7 samples"]
fn a_nan_at_one_sample_in_ten_million() {
    one_in(10_000_000, 4_987_654);
}

#[test]
fn of_several_faults_the_first_is_reported_by_any_number_of_threads() {
    quiet();
    let (flat, ramp) = (flat(), ramp());
    let mis = MultiSample::new(&[(&flat, 1), (&ramp, 1)]).unwrap();
    let mut dice = Dice(3);
    for _ in 0..12 {
        let mut bad: Vec<(f64, bool)> = (0..10)
            .map(|k| {
                let index = dice.below(20_000);
                let x = if k % 2 == 0 { point(&flat, 0, index) } else { point(&ramp, 1, index) };
                (x, dice.below(2) == 0)
            })
            .collect();
        bad.sort_by(|a, b| a.0.total_cmp(&b.0));
        let planted = |x: &f64| match bad.iter().find(|bad| bad.0 == *x) {
            Some((_, true)) => panic!("planted at {x}"),
            Some((_, false)) => f64::INFINITY,
            None => f(x),
        };
        let one = Outcome::of_result(run(40_000, 1).execute(&mis, &planted, 1));
        assert!(one.error.is_some());
        for threads in [2, 3, 8] {
            for _ in 0..3 {
                let again = Outcome::of_result(run(40_000, threads).execute(&mis, &planted, 1));
                assert_eq!(again, one);
            }
        }
        if one.samples > 0 {
            let before = Outcome::of_result(run(one.samples, 2).execute(&mis, &planted, 1));
            assert_eq!((before.error, before.numbers), (None, one.numbers));
        }
    }
}

#[test]
fn a_fault_in_the_first_chunk_leaves_no_report() {
    let flat = flat();
    let mis = MultiSample::new(&[(&flat, 1)]).unwrap();
    let bad = point(&flat, 0, 63);
    let error = run(5000, 1).execute(&mis, &|x: &f64| bad / (bad - x), 1).unwrap_err();
    assert!(error.report().is_none() && error.to_string().contains("sample 63"), "{error}");
    let bad = point(&flat, 0, 64);
    let error = run(5000, 1).execute(&mis, &|x: &f64| bad / (bad - x), 1).unwrap_err();
    assert_eq!(error.report().unwrap().samples(), 64);
}

#[test]
fn faults_that_count_as_zero() {
    let flat = flat();
    let mis = |at_most: f64| {
        let mis = MultiSample::new(&[(&flat, 5000)]).unwrap();
        mis.on_fault(OnFault::count_as_zero(at_most).unwrap())
    };
    let below = |b: f64| move |x: &f64| if *x < b { f64::NAN } else { 1.0 };
    // 1 %.
    let report = run(5000, 2).execute(&mis(0.02), &below(0.02), 1).unwrap();
    let counted = report.estimate().non_finite();
    assert!((20..90).contains(&counted));
    assert!((report.value() / 2.0 - (1.0 - counted as f64 / 5000.0)).abs() < 1e-15);
    assert_eq!(report.estimate().zero(), counted);
    // The bound itself is allowed, and one sample less is not.
    let at = counted as f64 / 5000.0;
    assert!(run(5000, 2).execute(&mis(at), &below(0.02), 1).is_ok());
    let error = run(5000, 2).execute(&mis(at - 1e-6), &below(0.02), 1).unwrap_err();
    let text = error.to_string();
    assert!(text.starts_with(&format!("{counted} of 5000 samples have no usable")), "{text}");
    assert_eq!(error.report().unwrap().samples(), 5000);
    // Where a half is faulty, the first round is enough to know it.
    let error = run(1 << 40, 2).execute(&mis(0.01), &below(1.0), 1).unwrap_err();
    assert_eq!(error.report().unwrap().samples(), 1024);
    // More than the whole run may have.
    let error = run(2000, 2).execute(&mis(0.0), &below(0.02), 1).unwrap_err();
    assert_eq!(error.report().unwrap().samples(), 1024);
    // Too many, but not so many that the first rounds could tell.
    let target = Target::new().relative(0.05).unwrap();
    let error = Run::new(target).execute(&mis(0.3), &below(0.64), 1).unwrap_err();
    let report = error.report().unwrap();
    assert_eq!((report.stop(), report.samples()), (Stop::Fault, 2048));
    assert_eq!(report.estimate().samples(), 2048);
    assert!(Run::new(target).execute(&mis(0.4), &below(0.64), 1).is_ok());
    // A run that ends within a round.
    let target = Target::new().time(Duration::from_millis(200));
    let slow = |x: &f64| {
        std::thread::sleep(Duration::from_millis(5));
        below(0.4)(x)
    };
    let error = Run::new(target).execute(&mis(0.1), &slow, 1).unwrap_err();
    assert!(error.report().unwrap().samples() < 1024);
    assert!(matches!(error.fault(), RunFault::Estimate(EstimateError::Faults { .. })), "{error}");
}

/// Of a run that was cancelled, or of a shard, the samples that are missing may have fewer.
#[test]
fn too_many_faults_in_a_part_of_a_run() {
    let (flat, folder) = (flat(), Folder::new());
    let mis = MultiSample::new(&[(&flat, 1)]).unwrap();
    let mis = mis.on_fault(OnFault::count_as_zero(0.02).unwrap());
    // 3 %.
    let planted = |x: &f64| if *x < 0.06 { f64::NAN } else { f(x) };
    let too_many =
        |report: &Report| report.estimate().non_finite() as f64 > 0.02 * report.samples() as f64;
    assert!(run(5000, 2).execute(&mis, &planted, 1).is_err());
    let cancelled = run(5000, 2).progress(Duration::MAX, |_| std::ops::ControlFlow::Break(()));
    let report = cancelled.execute(&mis, &planted, 1).unwrap();
    assert_eq!((report.stop(), report.samples(), too_many(&report)), (Stop::Cancelled, 1024, true));
    let files = [0, 1].map(|index| {
        let path = folder.file(&format!("{index}"));
        let shard = run(5000, 2).checkpoint(&path).shard(index, 2).unwrap();
        let report = shard.execute(&mis, &planted, 1).unwrap();
        assert_eq!((report.stop(), too_many(&report)), (Stop::Samples, true));
        path
    });
    let error = run(5000, 2).merge(&mis, &planted, &Random::new(1), &files).unwrap_err();
    assert!(matches!(error.fault(), RunFault::Estimate(EstimateError::Faults { .. })), "{error}");
}

/// One fault in the first samples is not one in a thousand of them.
#[test]
fn faults_that_come_early_do_not_count_more() {
    let flat = flat();
    let mis = MultiSample::new(&[(&flat, 1)]).unwrap();
    let mis = mis.on_fault(OnFault::count_as_zero(1e-4).unwrap());
    let bad = [point(&flat, 0, 5), point(&flat, 0, 900), point(&flat, 0, 40_000)];
    let planted = |x: &f64| if bad.contains(x) { f64::NAN } else { f(x) };
    let report = run(50_000, 2).execute(&mis, &planted, 1).unwrap();
    assert_eq!(report.estimate().non_finite(), 3);
    let error = run(20_000, 2).execute(&mis, &|x: &f64| planted(x), 1).map(|_| ());
    assert!(error.is_ok(), "two of 20 000");
    assert!(run(19_999, 2).execute(&mis, &planted, 1).is_err());
}

fn message<V: mis::Value>(result: Result<Report<V>, RunError<V>>) -> (u64, u64, String, u64) {
    let error = result.unwrap_err();
    let RunFault::Panic { first, last, message } = error.fault() else { panic!("{error}") };
    let text = error.to_string();
    assert!(text.contains(&format!("samples {first} to {last}")) && text.contains(message));
    (*first, *last, message.clone(), error.report().map_or(0, Report::samples))
}

#[test]
fn a_panic_in_a_worker_is_an_error() {
    quiet();
    let flat = flat();
    let bad = point(&flat, 0, 10_000);
    let when = |x: f64| if x == bad { panic!("planted at {x}") } else { x };
    let sampler = Raw { sample: |u: f64| when(2.0 * u), pdf: |_| 0.5 };
    let pdf = Raw { sample: |u: f64| 2.0 * u, pdf: |x| 0.5 + 0.0 * when(x) };
    let sound = Raw { sample: |u: f64| 2.0 * u, pdf: |_| 0.5 };
    let with = |technique: &dyn Technique<Point = f64>, threads| {
        let mis = MultiSample::new(&[(technique, 1)]).unwrap();
        message(run(100_000, threads).execute(&mis, &f, 1))
    };
    let mis = MultiSample::new(&[(&sound, 1)]).unwrap();
    for threads in [1, 8] {
        let run = || run(100_000, threads);
        for (first, last, message, before) in [
            message(run().execute(&mis, &|x: &f64| f(&when(*x)), 1)),
            with(&sampler, threads),
            with(&pdf, threads),
            message(run().tally(&mis, &f, &Random::new(1), 1, |sample, tally| {
                tally.add(0, when(*sample.x()));
            })),
        ] {
            assert!((first..=last).contains(&10_000) && last - first == 511, "{first} {last}");
            assert_eq!((message, before), (format!("planted at {bad}"), first));
        }
    }
    // What a panic says may be no text.
    let odd = |x: &f64| if *x == bad { std::panic::panic_any(bad) } else { 1.0 };
    let (_, _, message, _) = message(run(100_000, 2).execute(&mis, &odd, 1));
    assert_eq!(message, "a panic without a message");
}

#[test]
fn a_panic_in_the_callback_takes_the_run_along_but_does_not_hang_it() {
    quiet();
    let flat = flat();
    let mis = MultiSample::new(&[(&flat, 1)]).unwrap();
    for threads in [1, 8] {
        for interval in [Duration::ZERO, Duration::MAX] {
            let mut calls = 0;
            let watcher = |_: &mis::Progress| {
                calls += 1;
                assert!(calls < 3, "planted");
                Continue(())
            };
            let run = run(100_000, threads).progress(interval, watcher);
            let panic = catch_unwind(AssertUnwindSafe(|| run.execute(&mis, &f, 1))).unwrap_err();
            assert_eq!(panic.downcast_ref::<&str>(), Some(&"planted"));
            assert_eq!(calls, 3);
        }
        assert!(run(10_000, threads).execute(&mis, &f, 1).is_ok());
    }
}

/// The integrand does not return while the run is cancelled, or while its time ends.
#[test]
fn an_integrand_that_blocks_is_waited_for_and_no_more() {
    const BLOCK: u64 = 512;
    let (flat, ramp) = (flat(), ramp());
    let mis = MultiSample::new(&[(&flat, 1), (&ramp, 1)]).unwrap();
    for threads in [1, 3] {
        for late in [false, true] {
            let cancel = Cancel::new();
            let count = AtomicU64::new(0);
            // When the brake is on, how many were evaluated.
            let evaluated = AtomicU64::new(u64::MAX);
            let over = AtomicBool::new(false);
            let limit = Duration::from_millis(600);
            let began = std::time::Instant::now();
            let blocking = |x: &f64| {
                if count.fetch_add(1, Ordering::Relaxed) == 10_000 {
                    if late {
                        std::thread::sleep(limit.saturating_sub(began.elapsed()));
                    } else {
                        cancel.cancel();
                    }
                    // Others come to the end of their blocks.
                    std::thread::sleep(Duration::from_millis(100));
                    evaluated.store(count.load(Ordering::Relaxed), Ordering::Relaxed);
                    over.store(true, Ordering::Relaxed);
                }
                f(x)
            };
            let mut target = Target::new().samples(1 << 40).unwrap();
            if late {
                target = target.time(limit);
            }
            let run = Run::new(target).threads(threads).unwrap().cancel(&cancel);
            let report = run.execute(&mis, &blocking, 1).unwrap();
            assert!(over.load(Ordering::Relaxed), "so slow a machine that time was up before");
            assert_eq!(report.stop(), if late { Stop::Time } else { Stop::Cancelled });
            let evaluated = evaluated.load(Ordering::Relaxed);
            let after = count.load(Ordering::Relaxed) - evaluated;
            assert!(after <= BLOCK, "{after} evaluations");
            assert!(report.samples() <= evaluated + BLOCK);
            let replayed = self::run(report.samples(), 1).execute(&mis, &f, 1).unwrap();
            assert_eq!(Outcome::of(&report).numbers, Outcome::of(&replayed).numbers);
        }
    }
}

#[test]
fn a_switch_that_was_thrown_before_stops_at_once() {
    let flat = flat();
    let mis = MultiSample::new(&[(&flat, 5000)]).unwrap();
    let cancel = Cancel::new();
    cancel.clone().cancel();
    assert!(cancel.is_cancelled());
    let count = AtomicU64::new(0);
    let counting = |_: &f64| count.fetch_add(1, Ordering::Relaxed) as f64;
    let report = Run::new(Target::new()).cancel(&cancel).execute(&mis, &counting, 1).unwrap();
    assert_eq!((report.samples(), report.status()), (0, &Status::Cancelled));
    assert!(report.value().is_nan() && report.standard_error().is_none());
    assert_eq!(count.into_inner(), 0);
}

/// Within a pool of threads that are all busy with runs.
#[cfg(feature = "parallel")]
#[test]
fn runs_within_runs_and_pools_end() {
    let flat = flat();
    let mis = MultiSample::new(&[(&flat, 3000)]).unwrap();
    let alone = Outcome::of(&run(3000, 1).execute(&mis, &f, 1).unwrap());
    for size in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(size).build().unwrap();
        let (mis, alone) = (&mis, &alone);
        pool.scope(|scope| {
            for k in 0..8 {
                scope.spawn(move |_| {
                    let run = Run::new(Target::new());
                    let run = if k % 2 == 0 { run } else { run.threads(3).unwrap() };
                    assert_eq!(Outcome::of(&run.execute(mis, &f, 1).unwrap()), *alone);
                });
            }
        });
    }
    // An integrand that is a run itself.
    let inner = MultiSample::new(&[(&flat, 64)]).unwrap();
    let nested = |x: &f64| {
        let g = |y: &f64| x * y;
        Run::new(Target::new()).execute(&inner, &g, 1).unwrap().value()
    };
    let several = Run::new(Target::new().samples(500).unwrap()).execute(&mis, &nested, 1).unwrap();
    let one = run(500, 1).execute(&mis, &nested, 1).unwrap();
    assert_eq!(several.value(), one.value());
}
