//! What tells one run from another, and what a report says of sound and of wrong densities.

use std::path::PathBuf;
use std::time::Duration;

use mis::points::Random;
use mis::technique::{FnTechnique, Normal, Uniform};
use mis::{Estimator, MultiSample, Run, RunError, Target};

fn file(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("mis-{}-{name}", std::process::id()));
    std::fs::remove_file(&path).ok();
    path
}

/// Of a rare event, the first contributions are all 0; of a constant, all are the same.
#[test]
fn another_seed_or_technique_is_told_without_contributions() {
    let (a, b) = (Uniform::new(0.0, 1.0).unwrap(), Uniform::new(0.0, 1.5).unwrap());
    let path = file("told");
    let rare = |x: &f64| f64::from(u8::from(*x < 1e-9));
    let execute = |technique: &Uniform, seed| {
        let mis = MultiSample::new(&[(technique, 100)]).unwrap();
        Run::new(Target::new()).checkpoint(&path).execute(&mis, &rare, seed)
    };
    execute(&a, 1).unwrap();
    execute(&a, 1).unwrap();
    let refused = |result: Result<_, RunError>| {
        let message = result.unwrap_err().to_string();
        assert!(message.contains("of another run"), "{message}");
    };
    refused(execute(&a, 2));
    refused(execute(&b, 1));
    std::fs::remove_file(path).ok();
}

#[test]
fn another_tally_is_told() {
    let p = Uniform::new(0.0, 1.0).unwrap();
    let mis = MultiSample::new(&[(&p, 100)]).unwrap();
    let path = file("tally");
    let tally = |scale: f64| {
        let run = Run::new(Target::new()).checkpoint(&path);
        run.tally(&mis, &|x: &f64| *x, &Random::new(1), 2, |sample, tally| {
            tally.add(0, scale * sample.contribution());
        })
    };
    tally(1.0).unwrap();
    tally(1.0).unwrap();
    let message = tally(2.0).unwrap_err().to_string();
    assert!(message.contains("its sums are of something else"), "{message}");
    // Files of shards can be merged without what made their sums.
    std::fs::remove_file(&path).ok();
    tally(3.0).unwrap();
    let merged = Run::new(Target::new()).merge(&mis, &|x: &f64| *x, &Random::new(1), &[&path]);
    assert!((merged.unwrap().tallied()[0].value - 1.5).abs() < 0.5);
    std::fs::remove_file(path).ok();
}

#[test]
fn more_threads_than_machines_have_are_refused() {
    for threads in [0, 4097, usize::MAX] {
        let message = Run::new(Target::new()).threads(threads).unwrap_err().to_string();
        assert!(message.contains("at most 4096"), "{message}");
    }
}

#[test]
fn more_sums_than_there_is_room_for_are_refused() {
    let p = Uniform::new(0.0, 1.0).unwrap();
    let mis = MultiSample::new(&[(&p, 100), (&p, 100)]).unwrap();
    for sums in [usize::MAX, usize::MAX / 2 + 2, (1 << 23) + 1] {
        let run = Run::new(Target::new());
        let result = run.tally(&mis, &|x: &f64| *x, &Random::new(1), sums, |_, _| ());
        let message = result.unwrap_err().to_string();
        assert!(message.contains("sums"), "{message}");
    }
}

/// Runs that are saved to the same file at once, from several threads.
#[test]
fn runs_of_one_process_share_no_temporary_file() {
    let p = Uniform::new(0.0, 1.0).unwrap();
    let mis = MultiSample::new(&[(&p, 20_000)]).unwrap();
    let path = file("shared");
    let run = || Run::new(Target::new()).checkpoint(&path).save_every(Duration::ZERO);
    let again = || (0..20).for_each(|_| drop(run().execute(&mis, &|x: &f64| *x, 1).unwrap()));
    std::thread::scope(|scope| {
        scope.spawn(again);
        scope.spawn(again);
        again();
    });
    std::fs::remove_file(path).ok();
}

#[test]
fn bounds_do_not_concern_a_technique_without_samples() {
    let p = Uniform::new(0.0, 1.0).unwrap();
    let mis = MultiSample::new(&[(&p, 1000), (&p, 0)]).unwrap();
    let estimate = mis.estimate(&|x: &f64| 1.0 + x, 1).unwrap();
    assert!(estimate.interval_within(0.95, [1.0, 2.0]).unwrap().contains(1.5));
    assert!(estimate.interval_within(0.95, [0.0, 1.5]).is_err());
}

/// Samples of a wide technique that should have met a narrow one and have not.
#[test]
fn narrow_densities_agree_although_the_wide_technique_has_not_met_them() {
    let wide = Uniform::new(0.0, 1.0).unwrap();
    for sigma in [1e-3, 1e-4, 1e-5, 1e-6, 1e-8] {
        let narrow = Normal::new(0.5, sigma).unwrap();
        let mis = MultiSample::new(&[(&wide, 10_000), (&narrow, 10_000)]).unwrap();
        for seed in 0..40 {
            let report = Run::new(Target::new()).execute(&mis, &|x: &f64| *x, seed).unwrap();
            for z in report.density_scores() {
                assert!(z.unwrap().abs() < 4.42, "{sigma} {seed}: {z:?}");
            }
        }
    }
}

/// Equal densities agree up to rounding, which is no standard error; a multiple does not.
#[test]
fn constant_ratios_of_densities() {
    let a = Uniform::new(0.0, 1.0 / 3.0).unwrap();
    for scale in [1.0, 1.05] {
        let p = move |_: f64| 3.0 * scale;
        let b = FnTechnique::new([0.0, 1.0 / 3.0], p, |x| 3.0 * x, |u| u / 3.0).unwrap();
        let mis = MultiSample::new(&[(&a, 3000), (&b, 7000)]).unwrap();
        let report = Run::new(Target::new()).execute(&mis, &|x: &f64| *x, 1).unwrap();
        let large = report.density_scores().iter().flatten().any(|z| z.abs() > 4.42);
        assert_eq!(large, scale != 1.0, "{scale}: {:?}", report.density_scores());
    }
}

/// A sampler that is 10 % too wide.
#[derive(Debug)]
struct Wrong(Normal, Normal);
impl mis::Technique for Wrong {
    type Point = f64;
    fn dimension(&self) -> usize {
        1
    }
    fn sample(&self, xi: &[f64]) -> f64 {
        self.1.sample(xi)
    }
    fn pdf(&self, x: &f64) -> f64 {
        self.0.pdf(x)
    }
}

#[test]
fn a_wrong_width_is_still_seen() {
    let wide = Normal::new(0.0, 3.0).unwrap();
    let sampler = Normal::new(0.0, 1.1).unwrap();
    let wrong = Wrong(Normal::new(0.0, 1.0).unwrap(), sampler);
    let mis = MultiSample::new(&[(&wide, 20_000), (&wrong, 20_000)]).unwrap();
    let target = Target::new().samples(40_000).unwrap();
    let report = Run::new(target).execute(&mis, &|x: &f64| (-x * x).exp(), 1).unwrap();
    let z = report.density_scores().iter().flatten().fold(0.0, |most: f64, z| most.max(z.abs()));
    assert!(z > 4.42, "{z}");
}
