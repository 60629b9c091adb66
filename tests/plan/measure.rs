//! What was predicted, beside what is realised.

use std::sync::atomic::{AtomicUsize, Ordering};

use mis::Target;
use mis::plan::{Caution, Method, Plan, Planner, Prediction};

use crate::problems::{Kind, Problem};

/// One row of a plan's table, and what became of it.
pub(crate) struct Row {
    pub(crate) prediction: Prediction,
    /// N times the variance of each component, and its noise; NaN where it was not looked for.
    pub(crate) realised: Vec<f64>,
    pub(crate) noise: f64,
    /// 1 / (variance · cost), all components together as the plan has it.
    pub(crate) efficiency: f64,
}

/// A plan of one pilot, the rows in its order.
pub(crate) struct Measured {
    pub(crate) seed: u64,
    pub(crate) rows: Vec<Row>,
}

impl Row {
    /// The largest of |ln(predicted / realised)|, over the components.
    pub(crate) fn off(&self) -> f64 {
        let both = self.prediction.variance.iter().zip(&self.realised);
        both.map(|(p, r)| if p == r { 0.0 } else { (p / r - 1.0).abs() }).fold(0.0, f64::max)
    }
}

/// What stays the same from seed to seed is looked for once.
pub(crate) type Known = std::sync::Mutex<Vec<(Method, Vec<f64>, (Vec<f64>, f64))>>;

/// N times the variance of each component, from samples through the plan's estimator, with its noise.
pub(crate) fn realised(problem: &Problem, plan: &Plan, samples: u64) -> (Vec<f64>, f64) {
    const PARTS: u64 = 4;
    let target = Target::new().samples(samples / PARTS).unwrap();
    let parts: Vec<Vec<f64>> = (0..PARTS)
        .map(|seed| {
            let outcome = problem.run(plan, target, 1_000_000 + seed);
            let n = outcome.samples as f64;
            outcome.errors.iter().map(|e| e.map_or(f64::NAN, |e| n * e * e)).collect()
        })
        .collect();
    let components = parts[0].len();
    let mut noise = 0.0_f64;
    let means = (0..components)
        .map(|c| {
            let mean = parts.iter().map(|part| part[c]).sum::<f64>() / PARTS as f64;
            let squares: f64 = parts.iter().map(|part| (part[c] - mean).powi(2)).sum();
            let error = (squares / (PARTS * (PARTS - 1)) as f64).sqrt();
            if mean > 0.0 {
                noise = noise.max(error / mean);
            }
            mean
        })
        .collect();
    (means, noise)
}

/// The plan of a pilot with declared costs, and every row of its table against `samples` samples.
pub(crate) fn measure(
    problem: &Problem,
    planner: &Planner,
    kind: Kind,
    seed: u64,
    samples: u64,
    known: &Known,
) -> Measured {
    let planner = planner.clone().costs(problem.costs(kind));
    let pilot = problem.pilot(&planner, seed);
    let mut plan = pilot.plan().unwrap();
    let rows = (0..plan.predictions.len())
        .map(|number| {
            plan.choose(number).unwrap();
            let prediction = plan.predictions[number].clone();
            let found = {
                let known = known.lock().unwrap();
                let same = known
                    .iter()
                    .find(|(m, s, _)| *m == prediction.method && *s == prediction.shares);
                same.map(|(_, _, found)| found.clone())
            };
            let (realised, noise) = found.unwrap_or_else(|| {
                let biased =
                    matches!(prediction.caution, Some(Caution::Biased { .. } | Caution::NoSignal));
                let found = if biased {
                    (vec![f64::NAN; prediction.variance.len()], f64::NAN)
                } else {
                    realised(problem, &plan, samples)
                };
                if !prediction.optimised {
                    let key = (prediction.method.clone(), prediction.shares.clone());
                    known.lock().unwrap().push((key.0, key.1, found.clone()));
                }
                found
            });
            // The plan's efficiency, with realised variances; components in the same proportions.
            let total = |variance: &[f64]| -> f64 {
                variance.iter().zip(&plan.pilot_value).map(|(v, mu)| v / (v + mu * mu)).sum()
            };
            let _ = total;
            let ratio = realised
                .iter()
                .zip(&prediction.variance)
                .map(|(r, p)| if r == p { 1.0 } else { r / p })
                .sum::<f64>()
                / realised.len() as f64;
            let efficiency = prediction.efficiency / ratio;
            Row { prediction, realised, noise, efficiency }
        })
        .collect();
    Measured { seed, rows }
}

/// Does `work` for 0 up to `count` on two threads; the results in order.
pub(crate) fn parallel<T: Send>(count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let some = || {
        let mut done = Vec::new();
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= count {
                return done;
            }
            done.push((i, work(i)));
        }
    };
    let mut all = std::thread::scope(|scope| {
        let other = scope.spawn(some);
        let mut all = some();
        all.extend(other.join().unwrap());
        all
    });
    all.sort_by_key(|(i, _)| *i);
    all.into_iter().map(|(_, found)| found).collect()
}
