//! Many runs of a row, and what became of them.

use std::num::NonZero;
use std::sync::atomic::{AtomicU64, Ordering};

use mis::Target;

use super::suite::{Outcome, Row, Verdict};

/// What 95 % intervals may cover.
pub(crate) const BAND: [f64; 2] = [0.94, 0.96];

/// How many standard deviations of a share count as noise. A share that is truly at the bound is
/// beyond it once in 740. Coverage that is truly 95 % leaves band and noise once in 10¹² at 10⁴
/// runs, and once in 10⁴ at 200.
pub(crate) const NOISE: f64 = 3.0;

/// The most samples of a run to a tolerance.
pub(crate) const LIMIT: u64 = 1 << 16;

/// The samples at which the half-width times the driver's margin of 1.1 is about the tolerance:
/// the end of a round, so that chance decides whether it is the last but one.
const ENOUGH: u64 = 4096;

/// How often something happened.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Share {
    pub(crate) hits: u64,
    pub(crate) of: u64,
}

impl Share {
    fn add(&mut self, hit: bool) {
        self.hits += u64::from(hit);
        self.of += 1;
    }

    fn merge(&mut self, other: Self) {
        self.hits += other.hits;
        self.of += other.of;
    }

    /// NaN of nothing.
    pub(crate) fn value(self) -> f64 {
        self.hits as f64 / self.of as f64
    }

    /// Whether it is less than `bound` beyond noise.
    pub(crate) fn is_below(self, bound: f64) -> bool {
        self.value() < bound - self.noise(bound)
    }

    /// Whether it is greater than `bound` beyond noise.
    pub(crate) fn is_above(self, bound: f64) -> bool {
        self.value() > bound + self.noise(bound)
    }

    pub(crate) fn is_outside(self, [lower, upper]: [f64; 2]) -> bool {
        self.is_below(lower) || self.is_above(upper)
    }

    fn noise(self, p: f64) -> f64 {
        NOISE * (p * (1.0 - p) / self.of as f64).sqrt()
    }
}

/// What became of the runs of a row with one target.
#[derive(Debug, Clone, Default)]
pub(crate) struct Cell {
    pub(crate) runs: u64,
    /// In the order of [`Verdict`].
    pub(crate) verdicts: [u64; 4],
    /// Of all runs together.
    pub(crate) samples: u64,
    pub(crate) components: Vec<Component>,
}

/// How often an interval held the integral, at each level, and the error was within a tolerance.
///
/// A run without an error bar has none that holds it.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Component {
    pub(crate) all: [Share; 3],
    /// Of the runs that are not suspect.
    pub(crate) sound: [Share; 3],
    /// Of the runs that converged.
    pub(crate) converged: [Share; 3],
    pub(crate) within_of_converged: Share,
    pub(crate) within_of_sound: Share,
    /// The runs that are not suspect and whose 95 % interval does not hold the integral.
    pub(crate) silent: Share,
}

impl Cell {
    /// The runs that are neither suspect nor without signal.
    pub(crate) fn sound(&self) -> Share {
        Share { hits: self.verdicts[0] + self.verdicts[1], of: self.runs }
    }

    pub(crate) fn verdict(&self, verdict: Verdict) -> Share {
        Share { hits: self.verdicts[verdict as usize], of: self.runs }
    }

    fn add(&mut self, outcome: &Outcome, row: &Row, tolerance: f64) {
        self.runs += 1;
        self.verdicts[outcome.verdict as usize] += 1;
        self.samples += outcome.samples;
        self.components.resize_with(row.components.len(), Component::default);
        let converged = outcome.verdict == Verdict::Converged;
        let sound = converged || outcome.verdict == Verdict::Spent;
        let truths = row.components.iter().map(|(_, integral)| integral);
        for ((counted, found), truth) in
            self.components.iter_mut().zip(&outcome.components).zip(truths)
        {
            let (value, error, intervals) = found;
            let holds = intervals.map(|interval| error.is_some() && interval.contains(*truth));
            for (l, hit) in holds.into_iter().enumerate() {
                counted.all[l].add(hit);
                if sound {
                    counted.sound[l].add(hit);
                }
                if converged {
                    counted.converged[l].add(hit);
                }
            }
            let within = (value - truth).abs() <= tolerance * truth.abs();
            if sound {
                counted.within_of_sound.add(within);
            }
            if converged {
                counted.within_of_converged.add(within);
            }
            counted.silent.add(sound && !holds[1]);
        }
    }

    fn merge(mut self, other: &Self) -> Self {
        self.runs += other.runs;
        self.samples += other.samples;
        self.verdicts.iter_mut().zip(other.verdicts).for_each(|(a, b)| *a += b);
        self.components
            .resize_with(other.components.len().max(self.components.len()), Component::default);
        for (a, b) in self.components.iter_mut().zip(&other.components) {
            for l in 0..3 {
                a.all[l].merge(b.all[l]);
                a.sound[l].merge(b.sound[l]);
                a.converged[l].merge(b.converged[l]);
            }
            a.within_of_converged.merge(b.within_of_converged);
            a.within_of_sound.merge(b.within_of_sound);
            a.silent.merge(b.silent);
        }
        self
    }
}

/// Runs of `samples` samples, from the seeds 0 up to `seeds`.
pub(crate) fn fixed(row: &Row, samples: u64, seeds: u64) -> Cell {
    measure(row, Target::new().samples(samples).unwrap(), f64::INFINITY, seeds)
}

/// Runs to a relative tolerance, of at most [`LIMIT`] samples.
pub(crate) fn to_tolerance(row: &Row, tolerance: f64, seeds: u64) -> Cell {
    let target = Target::new().relative(tolerance).unwrap().samples(LIMIT).unwrap();
    measure(row, target, tolerance, seeds)
}

/// The relative tolerance, of two digits, that about [`ENOUGH`] samples reach in the component that
/// needs most of them.
pub(crate) fn tolerance(row: &Row) -> f64 {
    // From replicates, no law says how the error falls.
    let (samples, t) = if row.replicates { (ENOUGH, 2.13) } else { (LIMIT, 1.96) };
    let pilot = row.run(Target::new().samples(samples).unwrap(), u64::MAX);
    let spreads = pilot.components.iter().zip(&row.components).map(|(found, (_, integral))| {
        found.1.unwrap() * (pilot.samples as f64 / ENOUGH as f64).sqrt() / integral.abs()
    });
    let tolerance = 1.1 * t * spreads.fold(0.0, f64::max);
    format!("{tolerance:.1e}").parse().unwrap()
}

/// The sums of all threads are counts: the same however many threads there are.
fn measure(row: &Row, target: Target, tolerance: f64, seeds: u64) -> Cell {
    const BLOCK: u64 = 8;
    let next = AtomicU64::new(0);
    let work = || {
        let mut cell = Cell::default();
        loop {
            let start = next.fetch_add(BLOCK, Ordering::Relaxed);
            if start >= seeds {
                return cell;
            }
            for seed in start..(start + BLOCK).min(seeds) {
                cell.add(&row.run(target, seed), row, tolerance);
            }
        }
    };
    std::thread::scope(|scope| {
        let threads = std::thread::available_parallelism().map_or(1, NonZero::get);
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(work)).collect();
        let own = work();
        others.into_iter().fold(own, |sum, other| sum.merge(&other.join().unwrap()))
    })
}
