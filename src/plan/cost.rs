//! What samples cost.

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::method::Method;
use crate::error::{ArgumentError, positive};
use crate::integrand::{Integrand, Value};
use crate::technique::Technique;

/// What the parts of a sample cost: seconds of one core as measured by a pilot, or any unit that they are
/// declared in.
///
/// A sample of technique i costs `sampling[i]` + `integrand` + `combining`, and `pdf[k]` for every
/// technique k whose pdf is evaluated: its own for a single technique and constant weights, those of
/// all techniques with samples otherwise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Costs {
    /// Of making a point from canonical numbers, for each technique.
    pub sampling: Vec<f64>,
    /// Of evaluating a pdf at a point, for each technique.
    pub pdf: Vec<f64>,
    /// Of evaluating the integrand.
    pub integrand: f64,
    /// Of all else: canonical numbers, weights, sums. Measured for each method on its own; this is that
    /// of the balance heuristic.
    pub combining: f64,
}

impl Costs {
    /// Declared costs, in any unit. A plan that is made with them is a function of its inputs and
    /// seed, to the bit: no clock is read.
    ///
    /// # Errors
    ///
    /// There must be as many of `sampling` as of `pdf`, and all must be finite and greater than 0.
    pub fn declared(
        sampling: impl Into<Vec<f64>>,
        pdf: impl Into<Vec<f64>>,
        integrand: f64,
        combining: f64,
    ) -> Result<Self, ArgumentError> {
        let costs = Self { sampling: sampling.into(), pdf: pdf.into(), integrand, combining };
        costs.check(costs.sampling.len()).map(|()| costs)
    }

    pub(super) fn check(&self, techniques: usize) -> Result<(), ArgumentError> {
        const OWNER: &str = "Costs";
        for (name, list) in [("sampling", &self.sampling), ("pdf", &self.pdf)] {
            if list.len() != techniques {
                let rule = format!("there must be one for each of {techniques} techniques");
                return Err(ArgumentError::new(OWNER, name, list, rule));
            }
            list.iter().try_for_each(|cost| positive(OWNER, name, *cost).map(drop))?;
        }
        positive(OWNER, "integrand", self.integrand)?;
        positive(OWNER, "combining", self.combining)?;
        Ok(())
    }

    /// The cost of a sample of each technique, by a method whose combining costs this.
    pub(super) fn of(&self, method: &Method, shares: &[f64], combining: f64) -> Vec<f64> {
        let pdfs = self.pdf.iter().zip(shares).filter(|(_, share)| **share > 0.0);
        let all: f64 = pdfs.map(|(cost, _)| cost).sum();
        let one = |(sampling, pdf): (&f64, &f64)| {
            let pdfs = if method.evaluates_all() { all } else { *pdf };
            sampling + pdfs + self.integrand + combining
        };
        self.sampling.iter().zip(&self.pdf).map(one).collect()
    }
}

/// Times of batches: seconds, and for how many samples.
#[derive(Debug, Default)]
pub(super) struct Clock(Mutex<Vec<(f64, usize)>>);

impl Clock {
    fn measure<T>(&self, samples: usize, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        let seconds = start.elapsed().as_secs_f64();
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push((seconds, samples));
        result
    }

    /// Seconds per sample: the median of the batches, which an interruption does not move.
    pub(super) fn per_sample(&self) -> f64 {
        let mut times: Vec<f64> = self
            .0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .iter()
            .filter(|(_, samples)| *samples > 0)
            .map(|(seconds, samples)| seconds / *samples as f64)
            .collect();
        times.sort_unstable_by(f64::total_cmp);
        // A clock may be too coarse to see a batch.
        times.get(times.len() / 2).copied().unwrap_or(0.0).max(1e-12)
    }

    /// All seconds.
    pub(super) fn total(&self) -> f64 {
        let times = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        times.iter().map(|(seconds, _)| seconds).sum()
    }
}

/// A technique whose batches are timed.
pub(super) struct TimedTechnique<'a, P> {
    pub(super) inner: &'a dyn Technique<Point = P>,
    pub(super) sampling: Clock,
    pub(super) pdf: Clock,
}

impl<'a, P> TimedTechnique<'a, P> {
    pub(super) fn new(inner: &'a dyn Technique<Point = P>) -> Self {
        Self { inner, sampling: Clock::default(), pdf: Clock::default() }
    }
}

impl<P> Technique for TimedTechnique<'_, P> {
    type Point = P;

    fn dimension(&self) -> usize {
        self.inner.dimension()
    }

    fn sample(&self, xi: &[f64]) -> P {
        self.inner.sample(xi)
    }

    fn pdf(&self, x: &P) -> f64 {
        self.inner.pdf(x)
    }

    fn ln_pdf(&self, x: &P) -> f64 {
        self.inner.ln_pdf(x)
    }

    fn point_len(&self) -> Option<usize> {
        self.inner.point_len()
    }

    fn sample_into(&self, xi: &[f64], x: &mut P) {
        self.inner.sample_into(xi, x);
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<P>) {
        let samples = xi.len() / self.inner.dimension().max(1);
        self.sampling.measure(samples, || self.inner.sample_batch(xi, xs));
    }

    fn pdf_batch(&self, xs: &[P], out: &mut [f64]) {
        self.pdf.measure(xs.len(), || self.inner.pdf_batch(xs, out));
    }
}

/// An integrand whose batches are timed.
pub(super) struct TimedIntegrand<'a, F: ?Sized> {
    pub(super) inner: &'a F,
    pub(super) clock: Clock,
}

impl<P, F: Integrand<P> + ?Sized> Integrand<P> for TimedIntegrand<'_, F> {
    type Value = F::Value;

    fn eval(&self, x: &P) -> F::Value {
        self.inner.eval(x)
    }

    fn eval_batch(&self, xs: &[P], out: &mut [F::Value]) {
        self.clock.measure(xs.len(), || self.inner.eval_batch(xs, out));
    }
}

/// An integrand that costs nothing.
#[derive(Debug)]
pub(super) struct Nothing<V>(pub(super) std::marker::PhantomData<fn() -> V>);

impl<P, V: Value> Integrand<P> for Nothing<V> {
    type Value = V;

    fn eval(&self, _: &P) -> V {
        V::zero()
    }

    fn eval_batch(&self, _: &[P], out: &mut [V]) {
        out.fill(V::zero());
    }
}
