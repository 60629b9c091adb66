//! Runs within pools of threads, and integrands that use them.

use std::sync::mpsc;
use std::time::Duration;

use mis::technique::{Linear, Uniform};
use mis::{MultiSample, Run, Target};
use rayon::prelude::*;

use crate::common::{Outcome, f};

/// What comes of `work`, which must end within a minute.
fn ends<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || sender.send(work()));
    receiver.recv_timeout(Duration::from_secs(60)).expect("it hangs")
}

fn pool() -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap()
}

/// A run on so many threads, or on those of the present pool.
fn go(threads: Option<usize>, f: impl Fn(&f64) -> f64 + Sync) -> Outcome {
    let flat = Uniform::new(0.0, 2.0).unwrap();
    let ramp = Linear::new(0.0, 2.0, 0.0, 1.0).unwrap();
    let mis = MultiSample::new(&[(&flat, 1), (&ramp, 1)]).unwrap();
    let run = Run::new(Target::new().samples(3000).unwrap());
    let run = match threads {
        Some(threads) => run.threads(threads).unwrap(),
        None => run,
    };
    Outcome::of(&run.execute(&mis, &f, 7).unwrap())
}

/// f, in two halves that may run at the same time.
fn divided(x: &f64) -> f64 {
    let (half, other) = rayon::join(|| f(x) / 2.0, || f(x) / 2.0);
    half + other
}

#[test]
fn from_every_thread_of_a_pool() {
    let whole = go(Some(1), f);
    for threads in [None, Some(1), Some(3)] {
        let all = ends(move || {
            let runs = (0..6).into_par_iter();
            pool().install(|| runs.map(|_| go(threads, f)).collect::<Vec<_>>())
        });
        assert!(all.iter().all(|outcome| *outcome == whole), "{threads:?}");
    }
}

#[test]
fn integrands_that_use_the_pool() {
    let whole = go(Some(1), f);
    for threads in [None, Some(1), Some(3)] {
        // From within the pool, and from a thread that is none of its own.
        assert_eq!(ends(move || pool().install(|| go(threads, divided))), whole);
        assert_eq!(ends(move || go(threads, divided)), whole);
        // From all its threads at once.
        let all = ends(move || pool().broadcast(|_| go(threads, divided)));
        assert!(all.iter().all(|outcome| *outcome == whole), "{threads:?}");
        // Another pool than that of the run.
        let other = pool();
        let elsewhere = move |x: &f64| other.install(|| divided(x));
        assert_eq!(ends(move || go(threads, elsewhere)), whole);
    }
}

#[test]
fn a_run_as_an_integrand() {
    let inner = |x: &f64| {
        let flat = Uniform::new(0.0, 1.0).unwrap();
        let mis = MultiSample::new(&[(&flat, 1)]).unwrap();
        let target = Target::new().samples(70).unwrap();
        Run::new(target).execute(&mis, &|y: &f64| x * y, 3).unwrap().value()
    };
    let whole = go(Some(1), inner);
    for threads in [None, Some(3)] {
        assert_eq!(ends(move || go(threads, inner)), whole);
        assert_eq!(ends(move || pool().install(|| go(threads, inner))), whole);
    }
}
