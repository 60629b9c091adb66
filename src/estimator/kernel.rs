//! The block kernel: every sample of every estimator passes through it.

use std::fmt::Debug;

use super::Dyn;
use crate::error::{EstimateError, Fault};
use crate::estimate::Counts;
use crate::integrand::{Integrand, Value};
use crate::lanes;
use crate::moments::{Accumulator, Moments};
use crate::weighting::{Densities, SAFE, Weighting};

/// Samples per block: the buffers of a few techniques fit the first-level cache, and a virtual
/// call per block costs nothing.
pub(super) const BLOCK: usize = 512;

/// What to do with a sample that has no usable contribution: the integrand is not finite, the
/// contribution overflows, or the technique's own pdf is 0, negative or NaN.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum OnFault {
    /// Stop with an [`EstimateError`] that names the sample.
    #[default]
    Error,
    /// Let it contribute 0, and count it. The estimate is then biased by what is missing.
    CountAsZero,
}

/// A sample, as an estimator shows it.
#[derive(Debug, Clone, Copy)]
pub struct Sample<'a, P, V> {
    technique: usize,
    index: u64,
    x: &'a P,
    value: &'a V,
    /// One a component, `BLOCK` apart; times the number of samples.
    y: &'a [f64],
    total: f64,
}

impl<'a, P, V: Value> Sample<'a, P, V> {
    /// The technique that drew it.
    #[must_use]
    pub fn technique(&self) -> usize {
        self.technique
    }

    /// Its index, counted within the technique (multi-sample) or over all samples (one-sample).
    #[must_use]
    pub fn index(&self) -> u64 {
        self.index
    }

    /// The point x.
    #[must_use]
    pub fn x(&self) -> &'a P {
        self.x
    }

    /// f(x).
    #[must_use]
    pub fn value(&self) -> &'a V {
        self.value
    }

    /// w_i(x) f(x) / (n_i p_i(x)), or w_i(x) f(x) / (N P_i p_i(x)) in the one-sample model. The
    /// sum over all samples is the estimate.
    #[must_use]
    pub fn contribution(&self) -> V::Each<f64> {
        V::each(|c| self.y[c * BLOCK] / self.total)
    }
}

/// What all samples of an estimate have in common.
pub(super) struct Kernel<'a, P, W> {
    pub(super) techniques: &'a [Dyn<'a, P>],
    /// α_i: the share n_i / N of a technique in the samples, or the probability P_i of selecting it.
    pub(super) alpha: &'a [f64],
    /// a_k in the effective densities q_k = a_k p_k that the weights are made of; α_k but for the
    /// one-sample weights that ignore the probabilities.
    pub(super) density_factors: &'a [f64],
    pub(super) weighting: &'a W,
    pub(super) on_fault: OnFault,
    /// N.
    pub(super) total: u64,
}

/// Buffers, used again from block to block.
#[derive(Debug)]
pub(super) struct Buffers<P, V> {
    pub(super) xi: Vec<f64>,
    xs: Vec<P>,
    values: Vec<V>,
    /// A row of pdfs for each technique.
    pdfs: Vec<f64>,
    /// w_i / q_i, times a_i / α_i.
    factors: Vec<f64>,
    /// A row of `BLOCK` contributions times N for each component.
    y: Vec<f64>,
    /// The block's moments of each component.
    blocks: Vec<Moments>,
    ratios: Ratios,
}

/// Room for the ratios r_k at one point, and their logarithms.
#[derive(Debug)]
struct Ratios {
    r: Vec<f64>,
    ln_r: Vec<f64>,
}

/// What is known of the samples so far.
#[derive(Debug)]
pub(super) struct Sums {
    /// One for each component of each technique, a technique's side by side.
    pub(super) contributions: Vec<Accumulator>,
    pub(super) counts: Counts,
}

impl<P: Debug, W: Weighting> Kernel<'_, P, W> {
    pub(super) fn start<V: Value>(&self) -> (Buffers<P, V>, Sums) {
        let techniques = self.techniques.len();
        let buffers = Buffers {
            xi: Vec::new(),
            xs: Vec::new(),
            values: vec![V::zero(); BLOCK],
            pdfs: vec![0.0; BLOCK * techniques],
            factors: vec![0.0; BLOCK],
            y: vec![0.0; BLOCK * V::COMPONENTS],
            blocks: vec![Moments::default(); V::COMPONENTS],
            ratios: Ratios { r: vec![0.0; techniques], ln_r: vec![0.0; techniques] },
        };
        let contributions = vec![Accumulator::default(); V::COMPONENTS * techniques];
        (buffers, Sums { contributions, counts: Counts::default() })
    }

    /// Samples technique `i` at the rows of `buffers.xi`, at most `BLOCK` of them, and adds their
    /// contributions to `sums`. `index` numbers the samples.
    pub(super) fn block<F, I>(
        &self,
        i: usize,
        index: impl Fn(usize) -> u64,
        f: &F,
        buffers: &mut Buffers<P, F::Value>,
        sums: &mut Sums,
        inspect: &mut I,
    ) -> Result<(), EstimateError>
    where
        F: Integrand<P> + ?Sized,
        I: FnMut(&Sample<'_, P, F::Value>),
    {
        let Buffers { xi, xs, values, pdfs, factors, y, blocks, ratios } = buffers;
        self.techniques[i].sample_batch(xi, xs);
        let rows = xi.len() / self.techniques[i].dimension().max(1);
        let n = xs.len().min(rows).min(BLOCK);
        let (xs, values, factors) = (&xs[..n], &mut values[..n], &mut factors[..n]);
        let pdfs = &mut pdfs[..n * self.techniques.len()];
        f.eval_batch(xs, values);

        let constant = self.weighting.constant_weight(i, self.alpha);
        let sound = self.densities(i, constant.is_some(), xs, pdfs);
        if let Some(w) = constant {
            let a = self.density_factors[i];
            for (factor, p) in factors.iter_mut().zip(&pdfs[i * n..]) {
                let q = a * p;
                *factor = if SAFE.contains(&q) { w / q } else { f64::NAN };
            }
        } else {
            let q = Densities::new(self.density_factors, pdfs, n);
            self.weighting.weight_over_density_batch(i, &q, &mut ratios.r, factors);
        }
        let model = self.density_factors[i] / self.alpha[i];
        if model != 1.0 {
            for factor in factors.iter_mut() {
                *factor *= model;
            }
        }

        let mut zeros = 0;
        for (c, y) in y.chunks_exact_mut(BLOCK).enumerate() {
            zeros = 0;
            for ((y, value), factor) in y.iter_mut().zip(&*values).zip(&*factors) {
                *y = value.times(c, *factor);
                zeros += u64::from(*y == 0.0);
            }
            blocks[c] = Moments::of_block(&y[..n]);
        }
        // A factor that is not exact is NaN, and so is then its contribution.
        if !(sound && blocks.iter().all(|block| block.mean.is_finite())) {
            for j in 0..n {
                let fault = self.check(i, &xs[j], &values[j], y, j, ratios);
                if let Err(fault) = fault {
                    if self.on_fault == OnFault::Error {
                        return Err(EstimateError::new(i, index(j), &xs[j], fault));
                    }
                    sums.counts.count(&fault);
                    y.chunks_exact_mut(BLOCK).for_each(|y| y[j] = 0.0);
                }
            }
            for (block, y) in blocks.iter_mut().zip(y.chunks_exact(BLOCK)) {
                *block = Moments::of_block(&y[..n]);
                zeros = y[..n].iter().map(|y| u64::from(*y == 0.0)).sum();
            }
        }

        for (j, (x, value)) in xs.iter().zip(&*values).enumerate() {
            let total = self.total as f64;
            let y = y.get(j..).unwrap_or_default();
            inspect(&Sample { technique: i, index: index(j), x, value, y, total });
        }
        let rows = y.chunks_exact(BLOCK);
        if rows.len() > 1 {
            zeros = (0..n).map(|j| u64::from(rows.clone().all(|y| y[j] == 0.0))).sum();
        }
        sums.counts.zero += zeros;
        let contributions = &mut sums.contributions[i * F::Value::COMPONENTS..];
        for ((sum, y), block) in contributions.iter_mut().zip(rows).zip(&*blocks) {
            sum.push(&y[..n], *block, &index);
        }
        Ok(())
    }

    /// Fills the rows of `pdfs` that the weighting needs. False if one is negative, or technique
    /// `i`'s own is 0, so that every sample has to be looked at; infinity and NaN show in the
    /// factors.
    fn densities(&self, i: usize, own_only: bool, xs: &[P], pdfs: &mut [f64]) -> bool {
        let mut sound = true;
        for (k, row) in pdfs.chunks_exact_mut(xs.len().max(1)).enumerate() {
            if self.alpha[k] == 0.0 || (own_only && k != i) {
                row.fill(0.0);
                continue;
            }
            self.techniques[k].pdf_batch(xs, row);
            let least = lanes::least(row);
            sound &= least > 0.0 || (least == 0.0 && k != i);
        }
        sound
    }

    /// Looks at sample `j` of a block alone: turns to logarithms where densities leave the range,
    /// and finds what is wrong with it.
    fn check<V: Value>(
        &self,
        i: usize,
        x: &P,
        value: &V,
        y: &mut [f64],
        j: usize,
        Ratios { r, ln_r }: &mut Ratios,
    ) -> Result<(), Fault> {
        if !value.is_finite() {
            return Err(Fault::Value(format!("{value:?}")));
        }
        let constant = self.weighting.constant_weight(i, self.alpha);
        for (k, ln_q) in ln_r.iter_mut().enumerate() {
            *ln_q = f64::NEG_INFINITY;
            if self.alpha[k] == 0.0 || (constant.is_some() && k != i) {
                continue;
            }
            let pdf = self.techniques[k].pdf(x);
            let ln_pdf = self.techniques[k].ln_pdf(x);
            // A pdf of 0 may have underflowed; its logarithm knows. NaN and negative ones are wrong.
            let valid = pdf >= 0.0 && !ln_pdf.is_nan();
            let covers = ln_pdf > f64::NEG_INFINITY && ln_pdf < f64::INFINITY;
            if !valid || (k == i && !covers) {
                return Err(Fault::Density { of: k, pdf });
            }
            *ln_q = self.density_factors[k].ln() + ln_pdf;
        }
        let finite = (0..V::COMPONENTS).all(|c| y[c * BLOCK + j].is_finite());
        if finite {
            return Ok(());
        }
        let largest = ln_r.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let own = ln_r[i];
        let ln_weight_over_density = if let Some(w) = constant {
            w.ln() - own
        } else {
            for (r, ln_r) in r.iter_mut().zip(ln_r.iter_mut()) {
                // An infinite density takes the weight from all finite ones.
                *ln_r = if *ln_r == largest { 0.0 } else { *ln_r - largest };
                *r = ln_r.exp();
            }
            self.weighting.ln_weight_over_ratio(i, ln_r, r) - largest
        };
        let model = (self.density_factors[i] / self.alpha[i]).ln();
        for c in 0..V::COMPONENTS {
            let y = &mut y[c * BLOCK + j];
            *y = value.times_exp(c, ln_weight_over_density + model);
            if !y.is_finite() {
                return Err(Fault::Contribution(*y));
            }
        }
        Ok(())
    }
}

impl Counts {
    fn count(&mut self, fault: &Fault) {
        match fault {
            Fault::Density { .. } => self.uncovered += 1,
            Fault::Value(_) | Fault::Contribution(_) => self.non_finite += 1,
        }
    }
}
