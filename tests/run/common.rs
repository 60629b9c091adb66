//! Small runs of every kind, and all that can be said of their results.

use std::fmt::Debug;
use std::path::{Path, PathBuf};
use std::sync::Once;
use std::sync::atomic::{AtomicU64, Ordering};

use mis::points::{Antithetic, PointSource, Random, Sobol, Stratified};
use mis::technique::{Linear, PiecewiseConstant, Uniform, canonical};
use mis::weighting::Constant;
use mis::{
    Integrand, MultiSample, OnFault, OneSample, Report, Run, RunError, Sample, Stop, Tally, Target,
    Technique, Value,
};

pub(crate) const SEED: u64 = 7;

/// A folder of its own for a test, removed at its end.
#[derive(Debug)]
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new() -> Self {
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let name = format!("mis-run-{}-{number}", std::process::id());
        // In memory where there is such a place: thousands of files are flushed.
        let memory = Path::new("/dev/shm");
        let disk = Path::new(env!("CARGO_TARGET_TMPDIR"));
        let path = if memory.is_dir() { memory } else { disk }.join(name);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// The names of all files in it, in order.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).unwrap();
        let name = |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name();
        let mut names: Vec<String> =
            entries.map(|entry| name(entry).to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).ok();
    }
}

/// A technique of given functions, right or wrong.
pub(crate) struct Raw<S, P> {
    pub(crate) sample: S,
    pub(crate) pdf: P,
}

impl<S: Fn(f64) -> f64 + Sync, P: Fn(f64) -> f64 + Sync> Technique for Raw<S, P> {
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        (self.sample)(canonical(xi, 0))
    }

    fn pdf(&self, x: &f64) -> f64 {
        (self.pdf)(*x)
    }
}

/// What a run came to, as text: equal if and only if all bits are.
#[derive(Clone, PartialEq)]
pub(crate) struct Outcome {
    /// Every number, and the moments that they are made of; nothing of why the run ended.
    pub(crate) numbers: String,
    /// With the status, and the report as it is printed.
    pub(crate) all: String,
    pub(crate) samples: u64,
    pub(crate) stop: Stop,
    /// What went wrong, if something did.
    pub(crate) error: Option<String>,
}

impl Debug for Outcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let printed = self.all.split_once('\n').map_or("", |(_, printed)| printed);
        let Self { numbers, samples, stop, error, .. } = self;
        write!(f, "{samples} {stop:?} {error:?} {:016x}\n{printed}", hash(numbers))
    }
}

/// FNV-1a.
pub(crate) fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

impl Outcome {
    pub(crate) fn of<V: Value>(report: &Report<V>) -> Self {
        let debug = format!("{report:?}");
        // The time, what was drawn in this session, and settings are left out.
        let (debug, _) = debug.split_once(", elapsed: ").unwrap();
        let (judged, rest) = debug.split_once(", stop: ").unwrap();
        let (_, rounds) = rest.split_once(", rounds: [").unwrap();
        let settings = ["threads: ", "checkpoint: ", "shard: ", "target: "];
        let printed: String = report
            .to_string()
            .lines()
            .filter(|line| !line.ends_with(" per second"))
            .filter(|line| !settings.iter().any(|name| line.starts_with(name)))
            .fold(String::new(), |text, line| text + line + "\n");
        Self {
            numbers: format!("{judged} {rounds}"),
            all: format!("{debug}\n{printed}"),
            samples: report.samples(),
            stop: report.stop(),
            error: None,
        }
    }

    pub(crate) fn of_result<V: Value>(result: Result<Report<V>, RunError<V>>) -> Self {
        match result {
            Ok(report) => Self::of(&report),
            Err(error) => Self {
                error: Some(error.to_string()),
                ..error.report().map_or_else(
                    || Self {
                        numbers: String::new(),
                        all: String::new(),
                        samples: 0,
                        stop: Stop::Fault,
                        error: None,
                    },
                    Self::of,
                )
            },
        }
    }
}

/// Called at every evaluation.
pub(crate) type Hook<'a> = &'a (dyn Fn() + Sync);

type Go = dyn Fn(Run<'_>, u64, Hook<'_>) -> Outcome + Sync;
type Merge = dyn Fn(Run<'_>, &[PathBuf]) -> Outcome + Sync;

/// A run that takes its target, threads, interruptions and files from elsewhere.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) target: Target,
    go: Box<Go>,
    merge: Box<Merge>,
}

impl Case {
    pub(crate) fn go(&self, run: Run<'_>) -> Outcome {
        (self.go)(run, SEED, &|| ())
    }

    pub(crate) fn seeded(&self, run: Run<'_>, seed: u64) -> Outcome {
        (self.go)(run, seed, &|| ())
    }

    pub(crate) fn hooked(&self, run: Run<'_>, hook: Hook<'_>) -> Outcome {
        (self.go)(run, SEED, hook)
    }

    pub(crate) fn merge(&self, run: Run<'_>, files: &[PathBuf]) -> Outcome {
        (self.merge)(run, files)
    }

    /// To its own target, on one thread.
    pub(crate) fn run<'a>(&self) -> Run<'a> {
        Run::new(self.target).threads(1).unwrap()
    }

    /// The whole run at once.
    pub(crate) fn whole(&self) -> Outcome {
        let outcome = self.go(self.run());
        assert_eq!(outcome.error, None, "{}", self.name);
        outcome
    }
}

impl Debug for Case {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

/// An integrand that calls a hook first.
struct Hooked<'a, F>(&'a F, Hook<'a>);

impl<F: Integrand<f64>> Integrand<f64> for Hooked<'_, F> {
    type Value = F::Value;

    fn eval(&self, x: &f64) -> F::Value {
        (self.1)();
        self.0.eval(x)
    }
}

/// Of additions, multiplications, divisions and square roots only, which IEEE 754 rounds in one
/// way: the bits are the same on every platform.
pub(crate) fn f(x: &f64) -> f64 {
    x.sqrt() / (1.0 + x * x)
}

fn vector(x: &f64) -> [f64; 2] {
    [f(x), if *x < 0.3 { -x } else { 0.0 }]
}

fn with_faults(x: &f64) -> f64 {
    if *x < 0.02 { f64::NAN } else { f(x) }
}

fn flat() -> Uniform {
    Uniform::new(0.0, 2.0).unwrap()
}

fn ramp() -> Linear {
    Linear::new(0.0, 2.0, 0.0, 1.0).unwrap()
}

fn steps() -> PiecewiseConstant {
    PiecewiseConstant::new(&[0.0, 0.5, 2.0], &[1.0, 3.0]).unwrap()
}

/// Four bins, a sum to which a sample adds twice, and calls that miss.
fn observe<V>(sample: &Sample<'_, f64, V>, tally: &mut Tally<'_>)
where
    V: Value<Each<f64> = f64>,
{
    let y = sample.contribution();
    let x = *sample.x();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 3")]
    tally.add((x * 2.0) as usize, y);
    if x > 1.5 {
        tally.add(4, y);
        tally.add(4, y * x);
        tally.add(5, y);
    }
}

const SUMS: usize = 5;

/// The points of a seed.
type Points = fn(u64) -> Box<dyn PointSource>;

fn random(seed: u64) -> Box<dyn PointSource> {
    Box::new(Random::new(seed))
}

pub(crate) fn sobol(seed: u64) -> Box<dyn PointSource> {
    Box::new(Sobol::new(seed).with_replicates(4).unwrap())
}

fn multi<U, F>(
    name: &'static str,
    points: Points,
    target: Target,
    weighting: U,
    on_fault: OnFault,
    f: F,
) -> Case
where
    U: mis::weighting::Weighting + Clone + 'static,
    F: Integrand<f64> + Sync + Clone + 'static,
{
    fn estimator<'a, U: mis::weighting::Weighting>(
        techniques: (&'a Uniform, &'a Linear, &'a PiecewiseConstant),
        weighting: U,
        on_fault: OnFault,
    ) -> MultiSample<'a, f64, U> {
        let (a, b, c) = techniques;
        let mis = MultiSample::new(&[(a, 900), (b, 570), (c, 233)]).unwrap();
        mis.weighting(weighting).unwrap().on_fault(on_fault)
    }
    let (also, same) = (f.clone(), weighting.clone());
    Case {
        name,
        target,
        go: Box::new(move |run, seed, hook| {
            let (a, b, c) = (flat(), ramp(), steps());
            let mis = estimator((&a, &b, &c), weighting.clone(), on_fault);
            Outcome::of_result(run.execute_from(&mis, &Hooked(&f, hook), &*points(seed)))
        }),
        merge: Box::new(move |run, files| {
            let (a, b, c) = (flat(), ramp(), steps());
            let mis = estimator((&a, &b, &c), same.clone(), on_fault);
            Outcome::of_result(run.merge(&mis, &also, &*points(SEED), files))
        }),
    }
}

/// Runs of at least two rounds, the last of them cut, and its last chunk too.
pub(crate) fn cases() -> Vec<Case> {
    use mis::weighting::{Balance, Power};
    let pairs: Points = |seed| Box::new(Antithetic::new(seed).with_replicates(4).unwrap());
    let strata: Points = |seed| Box::new(Stratified::new(seed, 7).unwrap());
    let own = Target::new();
    let error = OnFault::Error;
    let zero = OnFault::count_as_zero(0.1).unwrap();
    let tolerance = Target::new().relative(0.04).unwrap().samples(9000).unwrap();
    let finer = Target::new().relative(0.004).unwrap().samples(9000).unwrap();
    vec![
        multi("multi-sample", random, Target::new().samples(2377).unwrap(), Balance, error, f),
        multi("vector, power", random, own, Power::squared(), error, vector),
        multi("constant weights", random, own, Constant::new([0.5, 0.3, 0.2]).unwrap(), error, f),
        multi("faults as zero", random, own, Balance, zero, with_faults),
        multi("tolerance", random, tolerance, Balance, error, f),
        multi("tolerance, replicates", sobol, finer, Balance, error, f),
        multi("vector, replicates", sobol, own, Balance, error, vector),
        multi("antithetic pairs", pairs, own, Balance, error, f),
        multi("strata", strata, own, Balance, error, vector),
        one_sample("one-sample", random),
        one_sample("one-sample, replicates", sobol),
        one_sample("one-sample, strata", strata),
        tally("tally", random),
        tally("tally, replicates", sobol),
    ]
}

pub(crate) fn one_sample(name: &'static str, points: Points) -> Case {
    fn estimator<'a>(a: &'a Uniform, b: &'a Linear) -> OneSample<'a, f64> {
        OneSample::new(&[(a, 0.25), (b, 0.75)], 1600).unwrap()
    }
    Case {
        name,
        target: Target::new(),
        go: Box::new(move |run, seed, hook| {
            let (a, b) = (flat(), ramp());
            let (mis, f) = (estimator(&a, &b), Hooked(&f, hook));
            Outcome::of_result(run.execute_from(&mis, &f, &*points(seed)))
        }),
        merge: Box::new(move |run, files| {
            let (a, b) = (flat(), ramp());
            Outcome::of_result(run.merge(&estimator(&a, &b), &f, &*points(SEED), files))
        }),
    }
}

pub(crate) fn tally(name: &'static str, points: Points) -> Case {
    fn estimator<'a>(a: &'a Uniform, b: &'a Linear) -> MultiSample<'a, f64> {
        MultiSample::new(&[(a, 1000), (b, 700)]).unwrap()
    }
    Case {
        name,
        target: Target::new(),
        go: Box::new(move |run, seed, hook| {
            let (a, b) = (flat(), ramp());
            let mis = estimator(&a, &b);
            let f = Hooked(&f, hook);
            Outcome::of_result(run.tally(&mis, &f, &*points(seed), SUMS, observe))
        }),
        merge: Box::new(move |run, files| {
            let (a, b) = (flat(), ramp());
            Outcome::of_result(run.merge(&estimator(&a, &b), &f, &*points(SEED), files))
        }),
    }
}

/// Keeps panics that a test plants from the standard error of the tests.
pub(crate) fn quiet() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if !info.to_string().contains("planted") {
                usual(info);
            }
        }));
    });
}

/// A small generator for schedules, the same on every run.
#[derive(Debug)]
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    pub(crate) fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % n
    }
}
