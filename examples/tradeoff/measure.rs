//! Ensembles of estimates: root mean square errors against the exact value, and times.

use std::error::Error;
use std::fmt::Debug;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

use indicatif::ProgressBar;
use mis::Integrand;
use mis::plan::Method;

use crate::entries::{self, Entry, Points, Way};
use crate::options::Options;
use crate::problems::{Case, Visit};

/// Below, the error is rounding.
pub(crate) const ROUNDING: f64 = 1e-12;

/// An estimate takes part in the realised variance from so many samples on.
const SETTLED: u64 = 1024;

/// What was measured of a problem.
pub(crate) struct Results {
    pub(crate) name: &'static str,
    pub(crate) about: &'static str,
    pub(crate) exact: f64,
    pub(crate) techniques: Vec<&'static str>,
    pub(crate) series: Vec<Series>,
    /// How long pilot and plan took, in seconds.
    pub(crate) planning: f64,
}

/// One entry over all numbers of samples.
pub(crate) struct Series {
    pub(crate) entry: Entry,
    pub(crate) points: Vec<Point>,
    /// N times the relative variance, of all estimates that have settled, with its standard error.
    pub(crate) variance: (f64, f64),
    /// The mean error in standard errors.
    pub(crate) z: f64,
}

/// The ensemble at one number of samples.
pub(crate) struct Point {
    pub(crate) samples: u64,
    /// The mean squared relative error, with its standard error.
    pub(crate) mse: (f64, f64),
    /// The first decile of the times of an estimate.
    pub(crate) seconds: f64,
}

impl Point {
    pub(crate) fn rmse(&self) -> f64 {
        self.mse.0.sqrt()
    }

    /// The root mean square error, one standard error down and up.
    pub(crate) fn band(&self) -> [f64; 2] {
        let (mse, error) = self.mse;
        [(mse - error).max(0.04 * mse).sqrt(), (mse + error).sqrt()]
    }
}

impl Series {
    pub(crate) fn is_exact(&self) -> bool {
        self.last().is_some_and(|last| last.rmse() < ROUNDING)
    }

    pub(crate) fn last(&self) -> Option<&Point> {
        self.points.last()
    }

    /// Whether it is one technique alone, with random points.
    pub(crate) fn is_single(&self) -> bool {
        matches!(self.entry.way, Way::Planned(Method::Single(_))) && self.is_random()
    }

    pub(crate) fn is_random(&self) -> bool {
        self.entry.points == Points::Random
    }

    /// The variance at the most samples: of random points from all estimates, as it is in proportion to 1/N.
    fn last_variance(&self) -> (f64, f64) {
        self.last().map_or((f64::NAN, f64::NAN), |last| {
            let n = last.samples as f64;
            if self.is_random() { (self.variance.0 / n, self.variance.1 / n) } else { last.mse }
        })
    }

    /// The relative error at the most samples.
    pub(crate) fn error(&self) -> f64 {
        self.last_variance().0.sqrt()
    }

    /// 1 / (variance · time) at the most samples, with its relative standard error.
    pub(crate) fn efficiency(&self) -> (f64, f64) {
        let (variance, error) = self.last_variance();
        let seconds = self.last().map_or(f64::NAN, |last| last.seconds);
        ((variance * seconds).recip(), error / variance)
    }

    /// By what the best is chosen: efficiency; of those that are exact, time.
    pub(crate) fn worth(&self) -> f64 {
        if self.is_exact() { 1e100 / self.nanoseconds() } else { self.efficiency().0 }
    }

    pub(crate) fn nanoseconds(&self) -> f64 {
        self.last().map_or(f64::NAN, |last| 1e9 * last.seconds / last.samples as f64)
    }
}

impl Results {
    /// The first that is so.
    pub(crate) fn find(&self, is: impl Fn(&Entry) -> bool) -> Option<&Series> {
        self.series.iter().find(|series| is(&series.entry))
    }

    pub(crate) fn named(&self, name: &str) -> Option<&Series> {
        self.find(|entry| entry.name == name)
    }

    /// The single technique of the least variance, from random points.
    pub(crate) fn least_single(&self) -> Option<&Series> {
        let singles = self.series.iter().filter(|s| s.is_single());
        singles.min_by(|a, b| a.error().total_cmp(&b.error()))
    }

    /// The most efficient of some.
    pub(crate) fn best(&self, is: impl Fn(&Series) -> bool) -> Option<&Series> {
        let some = self.series.iter().filter(|series| is(series));
        some.max_by(|a, b| a.worth().total_cmp(&b.worth()))
    }

    pub(crate) fn plan(&self) -> Option<&Series> {
        self.find(|entry| entry.plan && entry.points == Points::Random)
    }
}

/// Measures every problem.
pub(crate) struct Runner<'a> {
    pub(crate) options: &'a Options,
    pub(crate) bar: &'a ProgressBar,
    pub(crate) results: Vec<Results>,
}

impl Visit for Runner<'_> {
    fn visit<P: Debug + Sync, F: Integrand<P, Value = f64> + Sync>(
        &mut self,
        case: &Case<'_, P, F>,
    ) -> Result<(), Box<dyn Error>> {
        self.bar.set_message(case.name);
        let start = Instant::now();
        let mut plan = entries::plan(case, self.options.clock, 1)?;
        let planning = start.elapsed().as_secs_f64();
        if self.options.clock {
            self.bar.suspend(|| println!("{}: {:?}\n{plan}\n", case.name, plan.costs));
        }
        let entries = entries::all(case, &plan);
        plan.predictions.clear();
        let k = case.techniques.len() as u64;
        let sizes: Vec<u64> = self.options.sizes(k);
        let work = Work { case, plan: &plan, entries: &entries, sizes: &sizes };
        let samples = work.measure(self.options.seeds, self.bar)?;
        let series = entries
            .iter()
            .zip(samples)
            .map(|(entry, samples)| series(entry.clone(), &sizes, samples))
            .collect();
        self.results.push(Results {
            name: case.name,
            about: case.about,
            exact: case.exact,
            techniques: case.techniques.iter().map(|named| named.name).collect(),
            series,
            planning,
        });
        Ok(())
    }
}

/// Estimates of one problem.
struct Work<'a, 'b, P, F: ?Sized> {
    case: &'a Case<'b, P, F>,
    plan: &'a mis::Plan,
    entries: &'a [Entry],
    sizes: &'a [u64],
}

/// Seeds that one thread takes at a time.
pub(crate) const CHUNK: u64 = 4;

/// Relative error and time.
type Sample = (f64, f64);

impl<P: Debug + Sync, F: Integrand<P, Value = f64> + Sync> Work<'_, '_, P, F> {
    /// For each entry and size, an estimate for each seed, in their order.
    fn measure(&self, seeds: u64, bar: &ProgressBar) -> Result<Vec<Vec<Vec<Sample>>>, String> {
        let chunks = usize::try_from(seeds.div_ceil(CHUNK)).map_err(|e| e.to_string())?;
        let (next, failed) = (AtomicUsize::new(0), AtomicBool::new(false));
        let worker = || {
            let mut done = Vec::new();
            loop {
                let task = next.fetch_add(1, Ordering::Relaxed);
                if task >= chunks * self.sizes.len() || failed.load(Ordering::Relaxed) {
                    return Ok(done);
                }
                let (size, chunk) = (task % self.sizes.len(), (task / self.sizes.len()) as u64);
                for seed in chunk * CHUNK..((chunk + 1) * CHUNK).min(seeds) {
                    // One entry after the other, so that what else the machine does falls on all alike.
                    for entry in 0..self.entries.len() {
                        let sample = self.estimate(entry, size, seed).inspect_err(|_| {
                            failed.store(true, Ordering::Relaxed);
                        })?;
                        done.push((entry, size, seed, sample));
                    }
                }
                bar.inc(self.sizes[size] * CHUNK);
            }
        };
        let mut all = thread::scope(|scope| {
            let threads = [scope.spawn(worker), scope.spawn(worker)];
            let results = threads.map(|thread| {
                thread.join().unwrap_or_else(|_| Err("a thread has panicked".to_string()))
            });
            let mut all: Vec<(usize, usize, u64, Sample)> = Vec::new();
            for result in results {
                all.extend(result?);
            }
            Ok::<_, String>(all)
        })?;
        all.sort_by_key(|(entry, size, seed, _)| (*entry, *size, *seed));
        let mut samples = vec![vec![Vec::new(); self.sizes.len()]; self.entries.len()];
        for (entry, size, _, sample) in all {
            samples[entry][size].push(sample);
        }
        Ok(samples)
    }

    fn estimate(&self, entry: usize, size: usize, seed: u64) -> Result<Sample, String> {
        let (case, entry) = (self.case, &self.entries[entry]);
        let n = self.sizes[size];
        if matches!(entry.way, Way::Adaptive { .. }) && n < SETTLED {
            return Ok((f64::NAN, f64::NAN)); // it takes as many
        }
        let seed = 1_000_000 * size as u64 + seed;
        let (value, seconds) = entries::estimate(case, self.plan, entry, n, seed)
            .map_err(|error| format!("{}, {}: {error}", case.name, entry.name))?;
        Ok(((value - case.exact) / case.exact.abs(), seconds))
    }
}

fn series(entry: Entry, sizes: &[u64], samples: Vec<Vec<Sample>>) -> Series {
    let (mut points, mut pooled) = (Vec::new(), Vec::new());
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for (n, samples) in sizes.iter().zip(samples) {
        if samples.iter().any(|(error, _)| error.is_nan()) {
            continue;
        }
        let errors: Vec<f64> = samples.iter().map(|(error, _)| *error).collect();
        let squares: Vec<f64> = errors.iter().map(|e| e * e).collect();
        let mut seconds: Vec<f64> = samples.iter().map(|(_, seconds)| *seconds).collect();
        seconds.sort_unstable_by(f64::total_cmp);
        // Other processes only add to it.
        let seconds = seconds[seconds.len() / 10];
        points.push(Point { samples: *n, mse: mean(&squares), seconds });
        if *n >= SETTLED {
            pooled.extend(squares.iter().map(|square| square * *n as f64));
        }
        let (bias, error) = mean(&errors);
        if error > ROUNDING {
            sum += bias / error;
            count += 1.0;
        }
    }
    let z = if count > 0.0 { sum / count.sqrt() } else { 0.0 };
    Series { entry, points, variance: mean(&pooled), z }
}

/// Mean and standard error.
fn mean(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (mean, (squares / (n * (n - 1.0))).sqrt())
}
