//! The block kernel: every sample of every estimator passes through it.

use std::fmt::Debug;

use super::Dyn;
use super::controls::Controls;
use super::evidence::Evidence;
use super::sample::{DensitiesAt, OnFault, Sample};
use crate::error::{EstimateError, Fault};
use crate::integrand::{Integrand, Value};
use crate::lanes;
use crate::moments::{Accumulator, Moments};
use crate::part::{Counts, Part};
use crate::vectors::vectorised;
use crate::weighting::{Densities, SAFE, Weighting};

/// What all samples of an estimate have in common.
pub(super) struct Kernel<'a, P, W> {
    pub(super) techniques: &'a [Dyn<'a, P>],
    /// α_i: the share n_i / N of a technique in the samples, or the probability P_i of selecting
    /// it.
    pub(super) alpha: &'a [f64],
    /// a_k in the effective densities q_k = a_k p_k that the weights are made of; α_k but for the
    /// one-sample weights that ignore the probabilities.
    pub(super) density_factors: &'a [f64],
    pub(super) weighting: &'a W,
    /// What is subtracted from the contributions.
    pub(super) controls: Option<&'a Controls>,
    pub(super) on_fault: OnFault,
    /// How many replicates the samples of a technique are divided among.
    pub(super) replicates: usize,
    /// The most samples that a block has.
    pub(super) block: usize,
}

/// The samples of a block.
pub(super) struct Batch {
    pub(super) technique: usize,
    pub(super) replicate: usize,
    pub(super) samples: usize,
}

/// Buffers, used again from block to block, and from range to range.
#[derive(Debug)]
pub struct Buffers<P, V> {
    pub(super) block: BlockBuffers<P, V>,
    pub(super) selection: Selection,
}

/// Room for samples that select their techniques.
#[derive(Debug, Default)]
pub(super) struct Selection {
    /// The canonical numbers of all.
    pub(super) rows: Vec<f64>,
    /// The technique of each.
    pub(super) choices: Vec<usize>,
    /// The indices of those that have selected one technique.
    pub(super) selected: Vec<u64>,
}

/// Room for a block, and for the moments of the blocks before it.
#[derive(Debug)]
pub(super) struct BlockBuffers<P, V> {
    pub(super) xi: Vec<f64>,
    xs: Vec<P>,
    values: Vec<V>,
    /// A row of pdfs for each technique.
    pdfs: Vec<f64>,
    /// w_i / q_i, times a_i / α_i.
    factors: Vec<f64>,
    /// A row of contributions times N for each component, as long as a block.
    y: Vec<f64>,
    /// The block's moments of each component.
    blocks: Vec<Moments>,
    ratios: Ratios,
    /// 1 / Σ α_k p_k.
    mixture: Vec<f64>,
    /// In the order of [`Part::contributions`].
    accumulators: Vec<Accumulator>,
}

/// Room for the ratios r_k at one point, and their logarithms.
#[derive(Debug, Default)]
struct Ratios {
    r: Vec<f64>,
    ln_r: Vec<f64>,
}

impl<P, V> Buffers<P, V> {
    pub(crate) fn new() -> Self {
        let block = BlockBuffers {
            xi: Vec::new(),
            xs: Vec::new(),
            values: Vec::new(),
            pdfs: Vec::new(),
            factors: Vec::new(),
            y: Vec::new(),
            blocks: Vec::new(),
            ratios: Ratios::default(),
            mixture: Vec::new(),
            accumulators: Vec::new(),
        };
        Self { block, selection: Selection::default() }
    }
}

impl<P, V> BlockBuffers<P, V> {
    /// Adds the moments of all blocks to `part`.
    pub(super) fn finish(&self, part: &mut Part) {
        for (sum, blocks) in part.contributions.iter_mut().zip(&self.accumulators) {
            *sum = sum.merge(blocks.total());
        }
    }
}

/// What samples are added to.
#[derive(Debug)]
pub struct Sums<'a> {
    pub(crate) part: &'a mut Part,
    pub(crate) evidence: Option<Evidence<'a>>,
}

impl<P: Debug, W: Weighting> Kernel<'_, P, W> {
    /// Makes `buffers` fit, and forgets the blocks before.
    pub(super) fn start<V: Value>(&self, buffers: &mut BlockBuffers<P, V>) {
        let techniques = self.techniques.len();
        let BlockBuffers { values, pdfs, factors, y, blocks, ratios, mixture, .. } = buffers;
        values.resize(self.block, V::zero());
        pdfs.resize(self.block * techniques, 0.0);
        y.resize(self.block * V::COMPONENTS, 0.0);
        blocks.resize(V::COMPONENTS, Moments::default());
        for buffer in [factors, mixture] {
            buffer.resize(self.block, 0.0);
        }
        for buffer in [&mut ratios.r, &mut ratios.ln_r] {
            buffer.resize(techniques, 0.0);
        }
        let streams = techniques * self.replicates;
        buffers.accumulators.resize_with(V::COMPONENTS * streams, Accumulator::default);
        buffers.accumulators.iter_mut().for_each(Accumulator::clear);
    }

    /// Samples a technique at the rows of `buffers.xi`, at most a block, and adds them to `sums`, but
    /// for their moments, which [`finish`](BlockBuffers::finish) adds. `index` numbers the samples.
    pub(super) fn block<F, I>(
        &self,
        batch: &Batch,
        index: impl Fn(usize) -> u64,
        f: &F,
        buffers: &mut BlockBuffers<P, F::Value>,
        sums: &mut Sums<'_>,
        inspect: &mut I,
    ) -> Result<(), EstimateError>
    where
        F: Integrand<P> + ?Sized,
        I: FnMut(&Sample<'_, P, F::Value>),
    {
        let Batch { technique: i, replicate, samples: n } = *batch;
        let BlockBuffers {
            xi,
            xs,
            values,
            pdfs,
            factors,
            y,
            blocks,
            ratios,
            mixture,
            accumulators,
        } = buffers;
        let held = xs.len();
        self.techniques[i].sample_batch(xi, xs);
        // One that appends would leave the points of an earlier block in front.
        if xs.len() < n || xs.len() > n.max(held) {
            return Err(EstimateError::Batch { technique: i, asked: n, sampled: xs.len() });
        }
        let (xs, values, factors) = (&xs[..n], &mut values[..n], &mut factors[..n]);
        let pdfs = &mut pdfs[..n * self.techniques.len()];
        vectorised(
            #[inline(always)]
            || f.eval_batch(xs, values),
        );

        let constant = self.weighting.constant_weight(i, self.alpha);
        let own_only = constant.is_some() && self.controls.is_none();
        let sound = self.densities(i, own_only, xs, pdfs);
        self.factors(i, constant, pdfs, &mut ratios.r, factors);
        let (mut any_zero, mut changed) = (true, false);
        for (c, y) in y.chunks_exact_mut(self.block).enumerate() {
            let sums = lanes::products(values, c, factors, &mut y[..n]);
            blocks[c] = Moments::of_sums(&y[..n], &sums);
            any_zero &= sums.zeros;
        }
        // A factor that is not exact is NaN, and so is then its contribution.
        if !(sound && blocks.iter().all(|block| block.mean.is_finite())) {
            for j in 0..n {
                let checked = self.check(i, (&xs[j], &values[j]), pdfs, (n, j), y, ratios);
                let ln_factor = match checked {
                    Ok(ln_factor) => ln_factor,
                    Err(fault) if self.on_fault == OnFault::Error => {
                        return Err(EstimateError::new(i, index(j), &xs[j], &values[j], &fault));
                    }
                    Err(fault) => {
                        sums.part.counts[i].count(&fault);
                        y.chunks_exact_mut(self.block).for_each(|y| y[j] = 0.0);
                        Some(f64::NEG_INFINITY)
                    }
                };
                factors[j] = ln_factor.map_or(factors[j], f64::exp);
            }
            changed = true;
        }
        if let Some(controls) = self.controls {
            controls.subtract(self.alpha, pdfs, n, y.chunks_exact_mut(self.block));
            changed = true;
        }
        if changed {
            any_zero = true;
            for (block, y) in blocks.iter_mut().zip(y.chunks_exact(self.block)) {
                *block = Moments::of_block(&y[..n]);
            }
        }

        for (j, ((x, value), weight)) in xs.iter().zip(&*values).zip(&*factors).enumerate() {
            let (weight, y) = (*weight, y.get(j..).unwrap_or_default());
            let (index, stride) = (index(j), self.block);
            let rows = pdfs.get(j..).unwrap_or_default();
            let densities = DensitiesAt { alpha: self.alpha, rows, stride: n };
            inspect(&Sample {
                technique: i,
                replicate,
                index,
                x,
                value,
                weight,
                y,
                stride,
                densities,
            });
        }
        let rows = y.chunks_exact(self.block);
        let zero = |j: &usize| rows.clone().all(|y| y[*j] == 0.0);
        let zeros = if any_zero { (0..n).filter(zero).count() as u64 } else { 0 };
        sums.part.counts[i].samples += n as u64;
        sums.part.counts[i].zero += zeros;
        let stream = i * self.replicates + replicate;
        let accumulators = &mut accumulators[stream * F::Value::COMPONENTS..];
        for ((sum, y), block) in accumulators.iter_mut().zip(rows.clone()).zip(&*blocks) {
            sum.push(&y[..n], *block, &index);
        }
        if let Some(evidence) = &mut sums.evidence
            && let look @ 1.. = evidence.look(i, n)
        {
            evidence.contributions(i, rows.map(|y| &y[..look]), zeros, blocks);
            if constant.is_none() {
                evidence.densities(i, self.alpha, &pdfs.chunks_exact(n), &mut mixture[..look]);
            }
        }
        Ok(())
    }

    /// Fills the rows of `pdfs` that the weighting needs, only technique `i`'s if `own_only`. False if one is negative, or technique
    /// `i`'s own is 0, so that every sample has to be looked at; infinity and NaN show in the
    /// factors.
    fn densities(&self, i: usize, own_only: bool, xs: &[P], pdfs: &mut [f64]) -> bool {
        let mut sound = true;
        for (k, row) in pdfs.chunks_exact_mut(xs.len().max(1)).enumerate() {
            if own_only && k != i {
                continue;
            }
            if self.alpha[k] == 0.0 {
                row.fill(0.0);
                continue;
            }
            self.techniques[k].pdf_batch(xs, row);
            let least = lanes::least(row);
            sound &= least > 0.0 || (least == 0.0 && k != i);
        }
        sound
    }

    /// w_i / q_i at all points of a block, times a_i / α_i; NaN where it has not all its digits.
    fn factors(
        &self,
        i: usize,
        constant: Option<f64>,
        pdfs: &[f64],
        r: &mut [f64],
        factors: &mut [f64],
    ) {
        let n = factors.len();
        if let Some(w) = constant {
            let a = self.density_factors[i];
            for (factor, p) in factors.iter_mut().zip(&pdfs[i * n..]) {
                let q = a * p;
                *factor = if SAFE.contains(&q) { w / q } else { f64::NAN };
            }
        } else {
            let q = Densities::new(self.density_factors, pdfs, n);
            self.weighting.weight_over_density_batch(i, &q, r, factors);
        }
        let model = self.density_factors[i] / self.alpha[i];
        if model != 1.0 {
            for factor in factors {
                *factor *= model;
            }
        }
    }

    /// Looks at sample `j` of a block of `n` alone: turns to logarithms where densities leave the range,
    /// and finds what is wrong with it. `pdfs` holds a row for each technique. Returns the logarithm
    /// of the factor, where the factor itself is not what the contribution was made of; the pdfs then
    /// have only their ratios left.
    fn check<V: Value>(
        &self,
        i: usize,
        (x, value): (&P, &V),
        pdfs: &mut [f64],
        (n, j): (usize, usize),
        y: &mut [f64],
        Ratios { r, ln_r }: &mut Ratios,
    ) -> Result<Option<f64>, Fault> {
        if !value.is_finite() {
            return Err(Fault::Value);
        }
        let constant = self.weighting.constant_weight(i, self.alpha);
        let evaluated = |k: usize| constant.is_none() || self.controls.is_some() || k == i;
        for (of, row) in pdfs.chunks_exact(n).enumerate() {
            let pdf = row[j];
            if evaluated(of) && !(pdf >= 0.0) {
                return Err(Fault::Density { of, pdf });
            }
        }
        // A pdf of 0 may have underflowed, an infinite one overflowed; the logarithm knows.
        let underflowed = pdfs.chunks_exact(n).nth(i).is_none_or(|row| row[j] == 0.0);
        let finite = (0..V::COMPONENTS).all(|c| y[c * self.block + j].is_finite());
        if finite && !underflowed {
            return Ok(None);
        }
        for ((k, ln_q), row) in ln_r.iter_mut().enumerate().zip(pdfs.chunks_exact(n)) {
            *ln_q = f64::NEG_INFINITY;
            if self.alpha[k] == 0.0 || !evaluated(k) {
                continue;
            }
            let ln_pdf = self.techniques[k].ln_pdf(x);
            if ln_pdf.is_nan() || (k == i && ln_pdf.is_infinite()) {
                return Err(Fault::Density { of: k, pdf: row[j] });
            }
            *ln_q = self.density_factors[k].ln() + ln_pdf;
        }
        if finite {
            return Ok(None);
        }
        let largest = ln_r.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let own = ln_r[i];
        for (r, ln_r) in r.iter_mut().zip(ln_r.iter_mut()) {
            // An infinite density takes the weight from all finite ones.
            *ln_r = if *ln_r == largest { 0.0 } else { *ln_r - largest };
            *r = ln_r.exp();
        }
        let rows = pdfs.chunks_exact_mut(n).zip(self.density_factors);
        for ((row, a), r) in rows.zip(&*r).filter(|((_, a), _)| **a > 0.0) {
            row[j] = r / a;
        }
        let ln_weight_over_density = match constant {
            Some(w) => w.ln() - own,
            None if ln_r[i] == f64::NEG_INFINITY => f64::NEG_INFINITY,
            None => self.weighting.ln_weight_over_ratio(i, ln_r, r) - largest,
        };
        let ln_factor = ln_weight_over_density + (self.density_factors[i] / self.alpha[i]).ln();
        for c in 0..V::COMPONENTS {
            let y = &mut y[c * self.block + j];
            *y = value.times_exp(c, ln_factor);
            if !y.is_finite() {
                return Err(Fault::Contribution(*y));
            }
        }
        Ok(Some(ln_factor))
    }
}

impl Counts {
    fn count(&mut self, fault: &Fault) {
        match fault {
            Fault::Density { .. } => self.uncovered += 1,
            Fault::Value | Fault::Contribution(_) => self.non_finite += 1,
        }
    }
}
