//! Estimates: a value, its error, and where both come from.

mod combine;
mod display;
mod interval;
mod replicates;

pub(crate) use display::with_error;
pub use interval::Interval;

use std::marker::PhantomData;

use crate::error::ArgumentError;
use crate::integrand::Value;
use crate::part::{Counts, Part};

/// The result of an estimator.
///
/// `V` is the integrand's value type; what concerns a component is given once for each,
/// as a number for scalar integrands, as an array for arrays.
///
/// `Display` prints the value with its standard error in brackets, in units of the last digits:
/// `0.50012(21)` is 0.50012 ± 0.00021; `0.5(?)` has an unknown error. A precision sets the digits
/// of the error, but for those before its decimal point: `{:.1}` prints `0.5001(2)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate<V = f64> {
    design: Design,
    /// α_i: the share that a technique was to have of the samples. Where these were drawn in
    /// batches, of each batch in turn.
    shares: Vec<f64>,
    part: Part,
    /// K.
    techniques: usize,
    /// How many coefficients were fitted to the samples.
    fitted: u64,
    /// The counts of all techniques together.
    all: Counts,
    /// R: the contributions of a technique are those of its replicates, side by side.
    replicates: usize,
    /// Of the samples of all techniques, those of each replicate; empty without replicates, and
    /// where one has no value, as it lacks samples of a technique.
    dealt: Vec<u64>,
    results: Vec<Component>,
    value: PhantomData<V>,
}

/// What one component came to.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Component {
    value: f64,
    error: Option<f64>,
    /// The largest of the techniques' parts of the error, and the sum of the squares of all over
    /// its square.
    parts: (f64, f64),
}

/// What the numbers of samples were.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Design {
    /// Fixed for each technique: the variances within techniques add.
    Stratified,
    /// Random: all contributions are one sample of the same variable.
    Pooled,
}

/// What one technique did for an estimate.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TechniqueSummary<V: Value = f64> {
    /// How many samples it drew.
    pub samples: u64,
    /// The part of the value that its samples contribute; `None` where the value is 0.
    pub share_of_value: V::Each<Option<f64>>,
    /// The part of the variance that it is responsible for; `None` where the variance is unknown
    /// or 0.
    pub share_of_variance: V::Each<Option<f64>>,
}

/// The largest contribution to one component of an estimate.
///
/// If its share of the value is not small, the samples have hardly found what there is to find, and
/// neither the value nor its error is to be believed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Largest {
    /// The technique that drew the sample.
    pub technique: usize,
    /// The sample's index, counted within the technique (multi-sample) or over all samples
    /// (one-sample).
    pub sample: u64,
    /// The contribution; the estimate is the sum of all of them.
    pub contribution: f64,
    /// The contribution over the value; `None` where the value is 0.
    pub share_of_value: Option<f64>,
}

impl<V: Value> Estimate<V> {
    pub(crate) fn new(design: Design, shares: &[f64], part: Part) -> Self {
        Self::in_batches(design, shares.to_vec(), part, shares.len(), 0)
    }

    /// The estimate from batches, each with samples of its own from every one of `techniques`
    /// techniques: shares and parts are those of the first batch's techniques, then those of the
    /// second's, and so on. `fitted` coefficients were fitted to the very samples.
    pub(crate) fn in_batches(
        design: Design,
        shares: Vec<f64>,
        part: Part,
        techniques: usize,
        fitted: u64,
    ) -> Self {
        let (all, replicates) = (part.all(), part.replicates(V::COMPONENTS));
        let (dealt, results, value) = (Vec::new(), Vec::new(), PhantomData);
        let mut estimate = Self {
            design,
            shares,
            part,
            techniques,
            fitted,
            all,
            replicates,
            dealt,
            results,
            value,
        };
        estimate.dealt = estimate.samples_of_replicates().unwrap_or_default();
        for c in 0..V::COMPONENTS {
            let value = estimate.mean(c);
            let parts = estimate.sum_of_parts(c, value);
            let error = estimate.combined_error(c, parts);
            estimate.results.push(Component { value, error, parts });
        }
        estimate
    }

    /// What the samples came to.
    pub(crate) fn part(&self) -> &Part {
        &self.part
    }

    /// The estimate of ∫ f.
    #[must_use]
    pub fn value(&self) -> V::Each<f64> {
        V::each(|c| self.value_of(c))
    }

    /// The standard error: an estimate of the value's standard deviation.
    ///
    /// - Multi-sample: √(Σ α_i² s_i² / n_i), with α_i = n_i / N and s_i² the sample variance of
    ///   technique i's contributions times N.
    /// - One-sample: √(s² / N), over all contributions.
    /// - From R [replicates](Estimate::replicates): √(s² / R), with s² the sample variance of the R
    ///   values that they come to each; the value is the mean of these.
    ///
    /// `None` where it cannot be known: a technique drew a single sample, or none for some
    /// replicate, or every contribution is 0.
    #[must_use]
    pub fn standard_error(&self) -> V::Each<Option<f64>> {
        V::each(|c| self.error_of(c))
    }

    /// The variance of the value, the square of the [standard error](Estimate::standard_error);
    /// it may over- or underflow where the standard error does not.
    #[must_use]
    pub fn variance(&self) -> V::Each<Option<f64>> {
        V::each(|c| self.error_of(c).map(|e| e * e))
    }

    /// The confidence interval at `level`, such as 0.95: Student's t interval, its ends moved for
    /// the skewness of the contributions. The whole line where the standard error is unknown.
    ///
    /// With the value F, its standard error e, and its skewness g = Σ α_i³ μ_i / n_i² / e³ (one-sample:
    /// γ / √N), from the third central moments μ_i, it is the set of values for which
    /// |T + g T²/3 + g² T³/27 + g/6| ≤ t, where T = (F - value) / e. Rare large contributions make
    /// means that are low together with their errors; the t interval then misses on one side, this
    /// one much less. It equals the t interval where g = 0. [`kappa`](Estimate::kappa) says how far
    /// either can be trusted.
    ///
    /// The degrees of freedom of t are N - 1 (one-sample) or those of Welch and Satterthwaite,
    /// V² / Σ v_i² / (n_i - 1) for V = Σ v_i (multi-sample). Where a technique with two or three
    /// samples dominates the variance, even these are too many: from normal contributions with
    /// n = (2, 1000), 95 % t intervals cover 92 %.
    ///
    /// From R replicates, it is the t interval with R - 1 degrees of freedom, without a correction:
    /// it holds its level better than others do, as R values say little about their skewness.
    ///
    /// Sources: P. Hall, *On the Removal of Skewness by Transformation*, 1992; F. E. Satterthwaite,
    /// *An Approximate Distribution of Estimates of Variance Components*, 1946,
    /// doi:10.2307/3002019.
    ///
    /// # Errors
    ///
    /// `level` must be greater than 0 and less than 1.
    pub fn interval(&self, level: f64) -> Result<V::Each<Interval>, ArgumentError> {
        check_level("Estimate::interval", level)?;
        Ok(V::each(|c| self.interval_of(c, level)))
    }

    /// Student's t interval at `level`: the value ± t · standard error, with the degrees of freedom
    /// of [`interval`](Estimate::interval).
    ///
    /// # Errors
    ///
    /// `level` must be greater than 0 and less than 1.
    pub fn interval_t(&self, level: f64) -> Result<V::Each<Interval>, ArgumentError> {
        check_level("Estimate::interval_t", level)?;
        Ok(V::each(|c| Interval::student(self.value_of(c), self.error_with_freedom(c), level)))
    }

    /// The empirical Bernstein interval at `level`, for contributions
    /// y = w f / (α p) that are known to lie in `bounds`: it holds its level for any number of
    /// samples and however skewed they are. It is wider than the others.
    ///
    /// With the balance heuristic y = f / Σ α_k p_k, so bounds on y are bounds on the integrand over
    /// the mixture of the pdfs. With δ = (1 - `level`) / K, technique i adds
    /// α_i (s_i √(2 ln(4/δ) / n_i) + 7 (b - a) ln(4/δ) / (3 (n_i - 1))) to the half-width; one-sample,
    /// all contributions are of one kind, and K = 1.
    ///
    /// Source: A. Maurer and M. Pontil, *Empirical Bernstein Bounds and Sample Variance
    /// Penalization*, 2009, arXiv:0907.3740, theorem 4, used on either side.
    ///
    /// # Errors
    ///
    /// `level` must be greater than 0 and less than 1; the bounds must be finite and in order, and
    /// the contribution of the largest magnitude must lie between them (others are not looked at).
    pub fn interval_within(
        &self,
        level: f64,
        bounds: [f64; 2],
    ) -> Result<V::Each<Interval>, ArgumentError> {
        const OWNER: &str = "Estimate::interval_within";
        check_level(OWNER, level)?;
        let [a, b] = bounds;
        if !(a < b && (b - a).is_finite()) {
            let rule = "the first must be less than the second, and both finite";
            return Err(ArgumentError::new(OWNER, "bounds", bounds, rule));
        }
        for (i, c) in self.techniques_drawn().flat_map(|i| (0..V::COMPONENTS).map(move |c| (i, c)))
        {
            let y = self.of(i, c).extreme.y;
            if self.count(i) > 0 && !(a <= y && y <= b) {
                let i = i % self.techniques;
                let rule = format!("technique {i} has the contribution {y}");
                return Err(ArgumentError::new(OWNER, "bounds", bounds, rule));
            }
        }
        Ok(V::each(|c| Interval::bernstein(self.value_of(c), &self.bounded(c, (a, b)), level)))
    }

    /// κ, by which to judge whether an interval holds its level: the skewness of the value, each
    /// technique's part taken as positive, Σ |α_i³ μ_i / n_i²| / e³ (one-sample: |γ| / √N; from R
    /// replicates: |γ| / √R, with γ the sample skewness of their values). `None` where the standard
    /// error is unknown; 0 where it is 0.
    ///
    /// Up to 0.07, 95 % intervals cover 94 to 96 %, if the contributions have a light tail. Above,
    /// there are too few samples for so skewed contributions: the true value is found less often on
    /// one side. Of 16 replicates that are normal, κ is below 0.25 in 95 % of cases by chance, and no
    /// more than 0.9 whatever they are.
    #[must_use]
    pub fn kappa(&self) -> V::Each<Option<f64>> {
        V::each(|c| self.kappa_of(c))
    }

    /// How many samples were drawn in all.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.all.samples
    }

    /// R, the number of replicates that the samples were divided among, of which the standard error
    /// is estimated; 1 where samples are independent, and so are all of its own.
    #[must_use]
    pub fn replicates(&self) -> usize {
        self.replicates
    }

    /// What each technique did, in the order in which they were given.
    #[must_use]
    pub fn techniques(&self) -> impl ExactSizeIterator<Item = TechniqueSummary<V>> {
        (0..self.techniques).map(|i| {
            let batches = || self.techniques_drawn().skip(i).step_by(self.techniques);
            let sum = |shares: &dyn Fn(usize) -> Option<f64>| batches().map(shares).sum();
            TechniqueSummary {
                samples: batches().map(|s| self.count(s)).sum(),
                share_of_value: V::each(|c| sum(&|s| self.share_of_value(s, c))),
                share_of_variance: V::each(|c| sum(&|s| self.share_of_variance(s, c))),
            }
        })
    }

    /// How many contributions are 0 (in every component).
    #[must_use]
    pub fn zero(&self) -> u64 {
        self.all.zero
    }

    /// How many samples were at points that, by its pdf, their own technique does not cover, or
    /// where another fault of a pdf left no weight. They count as 0; by default, one is an error
    /// instead (see [`OnFault`](crate::OnFault)).
    #[must_use]
    pub fn uncovered(&self) -> u64 {
        self.all.uncovered
    }

    /// How many samples had a value or a contribution that is not finite. They count as 0; by
    /// default, one is an error instead (see [`OnFault`](crate::OnFault)).
    #[must_use]
    pub fn non_finite(&self) -> u64 {
        self.all.non_finite
    }

    /// The contribution of the largest magnitude; `None` if all are 0.
    #[must_use]
    pub fn largest(&self) -> V::Each<Option<Largest>> {
        V::each(|c| self.largest_of(c))
    }
}

fn check_level(owner: &'static str, level: f64) -> Result<(), ArgumentError> {
    if level > 0.0 && level < 1.0 {
        Ok(())
    } else {
        let rule = "it must be greater than 0 and less than 1";
        Err(ArgumentError::new(owner, "level", level, rule))
    }
}

#[cfg(test)]
mod tests {
    use super::{Design, Estimate};
    use crate::moments::Moments;
    use crate::part::{Contributions, Counts, Extreme, Part};

    fn contributions(ys: &[f64]) -> Contributions {
        let y = ys
            .iter()
            .copied()
            .fold(0.0, |most: f64, y| if y.abs() > most.abs() { y } else { most });
        Contributions { moments: Moments::of_block(ys), extreme: Extreme { y, index: 0 } }
    }

    /// Two batches of two techniques: shares and errors are those of four strata, and what is said of
    /// a technique is of both batches.
    #[test]
    fn batches_are_strata() {
        let ys: [&[f64]; 4] = [&[1.0, 3.0], &[2.0, 2.5, 3.0], &[4.0, 8.0, 6.0], &[1.0, 0.0]];
        let part = Part {
            contributions: ys.map(contributions).to_vec(),
            counts: ys.map(|ys| Counts { samples: ys.len() as u64, ..Counts::default() }).to_vec(),
        };
        let shares = vec![0.2, 0.3, 0.3, 0.2];
        let e = Estimate::<f64>::in_batches(Design::Stratified, shares, part, 2, 0);
        assert!((e.value() - (0.4 + 0.75 + 1.8 + 0.1)).abs() < 1e-15);
        let variance = 0.04 * 2.0 / 2.0 + 0.09 * 0.25 / 3.0 + 0.09 * 4.0 / 3.0 + 0.04 * 0.5 / 2.0;
        assert!((e.variance().unwrap() - variance).abs() < 1e-15);
        let all: Vec<_> = e.techniques().collect();
        assert_eq!((all.len(), all[0].samples, all[1].samples), (2, 5, 5));
        assert!((all[0].share_of_value.unwrap() - 2.2 / e.value()).abs() < 1e-15);
        let of_first = (0.04 + 0.12) / variance;
        assert!((all[0].share_of_variance.unwrap() - of_first).abs() < 1e-14);
        assert_eq!(e.largest().unwrap().technique, 0);
    }

    /// Coefficients that were fitted to the samples leave fewer degrees of freedom, and no error where
    /// they leave none.
    #[test]
    fn fitted_coefficients_take_degrees_of_freedom() {
        let of = |n: usize, fitted| {
            let ys: Vec<f64> = (0..n).map(|j| j as f64).collect();
            let part = Part {
                contributions: vec![contributions(&ys)],
                counts: vec![Counts { samples: n as u64, ..Counts::default() }],
            };
            Estimate::<f64>::in_batches(Design::Stratified, vec![1.0], part, 1, fitted)
        };
        let half = |e: &Estimate| {
            let interval = e.interval_t(0.95).unwrap();
            0.5 * (interval.upper - interval.lower) / e.standard_error().unwrap()
        };
        // Student's t of 9, 6 and 1 degrees of freedom.
        for (fitted, t) in [(0, 2.262_157), (3, 2.446_912), (8, 12.706_205)] {
            assert!(
                (half(&of(10, fitted)) - t).abs() < 1e-5,
                "{fitted}: {}",
                half(&of(10, fitted))
            );
        }
        assert_eq!(of(10, 9).standard_error(), None);
        assert_eq!(of(10, 10).standard_error(), None);
    }
}
