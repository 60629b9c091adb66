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
    squares: Vec<f64>,
}

impl Measured {
    /// Whether the row's prediction is within `most` of what is realised, in every component.
    pub(crate) fn is_within(&self, row: &Row, most: f64) -> bool {
        self.off(row) <= most
    }

    /// How far it is off, in the component that is worst.
    pub(crate) fn off(&self, row: &Row) -> f64 {
        let all = row.prediction.variance.iter().zip(&row.realised).zip(&self.squares);
        let one = |((p, r), square): ((&f64, &f64), &f64)| {
            let exact = *p <= EXACT * square && *r <= EXACT * square;
            let off = (p / r - 1.0).abs();
            if exact || off.is_nan() { if exact { 0.0 } else { f64::INFINITY } } else { off }
        };
        all.into_iter().map(one).fold(0.0, f64::max)
    }

    /// The first row's efficiency over that of the best row whose variance is known.
    pub(crate) fn recommended(&self) -> f64 {
        let known = self.rows.iter().filter(|row| row.noise <= 0.1 && row.efficiency.is_finite());
        let best = known.map(|row| row.efficiency).fold(0.0, f64::max);
        self.rows[0].efficiency / best
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
    let exact = problem.variances();
    let mut rows: Vec<Row> = (0..plan.predictions.len())
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
                    let exactly = exact.as_ref().and_then(|v| by_quadrature(&prediction, v));
                    exactly.unwrap_or_else(|| {
                        let mut found = realised(problem, &plan, samples);
                        for more in [8, 64] {
                            // Where it matters that the noise is small.
                            if found.1 > 0.05 && prediction.caution.is_none() {
                                found = realised(problem, &plan, more * samples);
                            }
                        }
                        found
                    })
                };
                if !prediction.optimised {
                    let key = (prediction.method.clone(), prediction.shares.clone());
                    known.lock().unwrap().push((key.0, key.1, found.clone()));
                }
                found
            });
            Row { prediction, realised, noise, efficiency: f64::NAN }
        })
        .collect();
    // What a component's variance counts for: one over its mean square, which the one-sample variance
    // with equal shares is, less the square of the mean.
    let square = |c: usize| {
        let mixture = rows.iter().find(|row| match row.prediction.method {
            Method::OneSample => !row.prediction.optimised,
            _ => problem.techniques == 1,
        });
        mixture.map_or(f64::NAN, |row| row.realised[c] + plan.pilot_value[c].powi(2))
    };
    let squares: Vec<f64> = (0..plan.pilot_value.len()).map(square).collect();
    for row in &mut rows {
        let relative = |(v, square): (&f64, &f64)| (v / square).max(EXACT);
        let total: f64 = row.realised.iter().zip(&squares).map(relative).sum();
        row.efficiency = (total * row.prediction.cost).recip();
    }
    Measured { seed, rows, squares }
}

/// A variance over the mean square that is nothing but rounding.
pub(crate) const EXACT: f64 = 1e-26;

/// The variance of a technique alone and of constant weights, from those of the techniques.
fn by_quadrature(prediction: &Prediction, alone: &[f64]) -> Option<(Vec<f64>, f64)> {
    let variance = match &prediction.method {
        Method::Single(i) => alone[*i],
        Method::Constant(weights) => {
            let all = weights.iter().zip(&prediction.shares).zip(alone);
            all.map(|((w, alpha), v)| if *w > 0.0 { w * w * v / alpha } else { 0.0 }).sum()
        }
        _ => return None,
    };
    Some((vec![variance], 0.0))
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
