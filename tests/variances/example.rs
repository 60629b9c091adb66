//! An example, the exact moments of its estimates, and ensembles of them.

use std::f64::consts::PI;

use mis::points::Random;
use mis::weighting::weights;
use mis::{Estimate, EstimateError, Estimator, MultiSample, OneSample, Sample, Technique};

use crate::ensemble::{Any, Z};

pub(crate) type Technique1 = Box<dyn Technique<Point = f64>>;

/// An integral over an interval and the techniques for it.
pub(crate) struct Example {
    pub(crate) name: &'static str,
    pub(crate) f: fn(f64) -> f64,
    pub(crate) mean: f64,
    /// The interval; outside it, whatever is integrated is negligible.
    pub(crate) domain: [f64; 2],
    pub(crate) techniques: Vec<Technique1>,
}

/// How techniques are sampled.
#[derive(Clone)]
pub(crate) enum Model {
    /// One sample of each of these techniques.
    Multi(Vec<usize>),
    /// One sample of one technique, chosen with these probabilities.
    One(Vec<f64>),
    /// The same, with weights made of the densities without the probabilities.
    WithoutProbabilities(Vec<f64>),
}

/// Exact moments of an estimate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Exact {
    pub(crate) mean: f64,
    pub(crate) variance: f64,
    /// E (F − μ)⁴ − V², which divided by R is the variance of a variance from R estimates.
    pub(crate) of_estimates: f64,
    /// Σ_i of the same for each technique's contributions: that of the reported variance.
    pub(crate) of_reports: f64,
}

/// Nodes and weights of the double-exponential rule on \[a, b\], good to 1e-12 for functions that
/// are analytic within and integrable at the ends.
pub(crate) fn nodes(a: f64, b: f64) -> impl Iterator<Item = (f64, f64)> {
    const STEP: f64 = 1.0 / 64.0;
    (-293..=293).map(move |k| {
        let t = STEP * f64::from(k);
        let q = (-PI * t.sinh().abs()).exp();
        let distance = (b - a) * q / (1.0 + q);
        let x = if t < 0.0 { a + distance } else { b - distance };
        (x, STEP * (b - a) * PI * t.cosh() * q / ((1.0 + q) * (1.0 + q)))
    })
}

impl Example {
    /// Effective densities q_k at `x`; 0 for techniques that take no part.
    pub(crate) fn densities(&self, model: &Model, x: f64) -> Vec<f64> {
        let factor = |k: usize| match model {
            Model::Multi(which) => f64::from(which.contains(&k)),
            Model::One(p) => p[k],
            Model::WithoutProbabilities(p) => f64::from(p[k] > 0.0),
        };
        let scaled = |(k, t): (usize, &Technique1)| {
            let a = factor(k);
            if a == 0.0 { 0.0 } else { a * t.pdf(&x) }
        };
        self.techniques.iter().enumerate().map(scaled).collect()
    }

    /// The domain in pieces within which no weight jumps.
    pub(crate) fn pieces(&self, model: &Model, weighting: &Any) -> Vec<f64> {
        let [a, b] = self.domain;
        let signature = |x: f64| -> Vec<bool> {
            let q = self.densities(model, x);
            weights(&weighting, &q).unwrap().iter().map(|w| *w > 0.0).collect()
        };
        let cells = 1000;
        let at = |k: i32| a + (b - a) * (f64::from(k) + 0.5) / f64::from(cells);
        let mut cuts = vec![a];
        // The examples on the whole line are symmetric.
        if a < 0.0 {
            cuts.push(0.0);
        }
        for k in 1..cells {
            let (mut left, mut right) = (at(k - 1), at(k));
            let before = signature(left);
            if before == signature(right) {
                continue;
            }
            for _ in 0..60 {
                let middle = 0.5 * (left + right);
                if signature(middle) == before {
                    left = middle;
                } else {
                    right = middle;
                }
            }
            cuts.push(left);
        }
        cuts.push(b);
        cuts.sort_by(f64::total_cmp);
        cuts
    }

    pub(crate) fn exact(&self, model: &Model, weighting: &Any) -> Exact {
        let techniques = self.techniques.len();
        // Σ over the nodes of q_i (w_i f / q_i)^k, k = 0 to 4.
        let mut moments = vec![[0.0; 5]; techniques];
        for cut in self.pieces(model, weighting).windows(2) {
            for (x, width) in nodes(cut[0], cut[1]) {
                let q = self.densities(model, x);
                let Some(w) = weights(&weighting, &q) else { continue };
                for i in (0..techniques).filter(|i| q[*i] > 0.0 && w[*i] > 0.0) {
                    // The density of sampling technique i, at x.
                    let density = match model {
                        Model::WithoutProbabilities(p) => p[i] * q[i],
                        _ => q[i],
                    };
                    let y = w[i] * (self.f)(x) / density;
                    let mut term = width * density;
                    for m in &mut moments[i] {
                        *m += term;
                        term *= y;
                    }
                }
            }
        }
        let central = |[_, m1, m2, m3, m4]: [f64; 5]| {
            let fourth = m4 - 4.0 * m3 * m1 + 6.0 * m2 * m1 * m1 - 3.0 * m1.powi(4);
            (m2 - m1 * m1, fourth)
        };
        let mean = moments.iter().map(|m| m[1]).sum();
        match model {
            Model::Multi(_) => {
                let each: Vec<_> = moments.iter().map(|m| central(*m)).collect();
                let variance: f64 = each.iter().map(|(v, _)| v).sum();
                let of_reports: f64 = each.iter().map(|(v, fourth)| fourth - v * v).sum();
                // Independent parts: cross terms of the fourth moment are 6 v_i v_k.
                let squares: f64 = each.iter().map(|(v, _)| v * v).sum();
                let of_estimates = of_reports + 2.0 * (variance * variance - squares);
                Exact { mean, variance, of_estimates, of_reports }
            }
            Model::One(_) | Model::WithoutProbabilities(_) => {
                let mut all = [0.0; 5];
                for m in &moments {
                    for (sum, m) in all.iter_mut().zip(m) {
                        *sum += m;
                    }
                }
                let (variance, fourth) = central(all);
                let of_estimates = fourth - variance * variance;
                Exact { mean, variance, of_estimates, of_reports: of_estimates }
            }
        }
    }

    /// One run of `n` samples of each technique, or `n` in all.
    pub(crate) fn run<I>(
        &self,
        model: &Model,
        weighting: &Any,
        n: u64,
        seed: u64,
        inspect: I,
    ) -> Result<Estimate, EstimateError>
    where
        I: FnMut(&Sample<'_, f64, f64>),
    {
        let f = |x: &f64| (self.f)(*x);
        let points = Random::new(seed);
        match model {
            Model::Multi(which) => {
                let n = |k: usize| if which.contains(&k) { n } else { 0 };
                let techniques = self.techniques.iter().enumerate();
                let given: Vec<(&dyn Technique<Point = f64>, u64)> =
                    techniques.map(|(k, t)| (&**t, n(k))).collect();
                let mis = MultiSample::new(&given).unwrap().weighting(weighting).unwrap();
                mis.inspect(&f, &points, inspect)
            }
            Model::One(p) | Model::WithoutProbabilities(p) => {
                let given: Vec<(&dyn Technique<Point = f64>, f64)> =
                    self.techniques.iter().map(|t| &**t).zip(p.iter().copied()).collect();
                let mis = OneSample::new(&given, n).unwrap().weighting(weighting).unwrap();
                let equal = matches!(model, Model::WithoutProbabilities(_));
                let mis = if equal { mis.weights_without_probabilities() } else { mis };
                mis.inspect(&f, &points, inspect)
            }
        }
    }

    /// Sample j of every technique together are one estimate with n = (1, …, 1); a run of many
    /// samples is an ensemble of those. Compares their variance, and the variance that the run
    /// reports, with the exact one.
    pub(crate) fn ensemble(
        &self,
        model: &Model,
        weighting: &Any,
        exact: Exact,
        limits: Limits,
    ) -> [f64; 2] {
        const N: u64 = 1024;
        let v = exact.variance;
        let needed = exact.of_estimates / (limits.error * v).powi(2);
        let heavy = needed > limits.estimates;
        let accepted = if heavy { limits.heavy } else { 1.01 * limits.error };
        let seeds = (needed.min(limits.estimates) / N as f64).ceil().max(64.0);
        // A contribution's part in the estimate from one sample of each technique.
        let share = match model {
            Model::Multi(which) => 1.0 / which.len() as f64,
            _ => 1.0,
        };
        let (mut squares, mut reported) = (0.0, 0.0);
        for seed in 0..seeds as u64 {
            let mut estimates = [0.0; N as usize];
            let estimate = self.run(model, weighting, N, seed, |sample| {
                estimates[sample.index() as usize] += share * sample.contribution();
            });
            reported += N as f64 * estimate.unwrap().variance().unwrap();
            squares += estimates.iter().map(|f| (f - self.mean).powi(2)).sum::<f64>();
        }
        let count = seeds * N as f64;
        let name = format!("{}, {}, {}", self.name, model.name(), weighting.0);
        let figures = [
            (squares / count, exact.of_estimates),
            (reported / seeds, exact.of_reports + 2.0 * v * v / N as f64),
        ];
        figures.map(|(measured, fourth)| {
            let error = (fourth / count).sqrt();
            assert!(error <= accepted * v, "{name}: {measured} ± {error}");
            let z = (measured - v) / error;
            assert!(z.abs() <= Z, "{name}: {measured} ± {error}, exactly {v}, z = {z:.2}");
            z
        })
    }
}

impl Model {
    pub(crate) fn name(&self) -> String {
        match self {
            Model::Multi(which) => format!("n = 1 of {which:?}"),
            Model::One(p) => format!("one sample, P = {p:.3?}"),
            Model::WithoutProbabilities(p) => {
                format!("one sample, weights without probabilities, P = {p:.3?}")
            }
        }
    }
}

/// How many estimates an ensemble has: enough for the relative standard error `error` of its
/// variance, but at most `estimates`, which leaves heavy tails with a standard error up to `heavy`.
#[derive(Clone, Copy)]
pub(crate) struct Limits {
    pub(crate) error: f64,
    pub(crate) estimates: f64,
    pub(crate) heavy: f64,
}

/// Example A's sin² x has a kurtosis of 14 000, and so have constant weights with it.
pub(crate) const QUICK: Limits = Limits { error: 0.02, estimates: 3.25e5, heavy: 0.3 };
pub(crate) const FULL: Limits = Limits { error: 0.02, estimates: f64::INFINITY, heavy: 0.0 };
