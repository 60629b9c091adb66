//! Random numbers, one in each stratum.

use super::hash::{hash, word};
use super::{PointSource, PointsExhausted, Random, checked_replicates};
use crate::error::ArgumentError;

/// The most strata, which a `u16` numbers.
const MOST_STRATA: usize = 1 << 16;

/// Stratified points, in several dimensions a Latin hypercube: S consecutive samples of a stream
/// have one number in each of S equal parts of the unit interval, in every coordinate.
///
/// Coordinate c of sample j of a block of S samples is (π(j) + ξ) / S, with ξ uniform and π a random
/// permutation of 0 to S - 1, independent for each (stream, block, coordinate).
///
/// Of contributions that are a sum of functions g_c of one coordinate each, as all are in one
/// dimension, the variance from n samples is Σ ∫ g_c′² / (12 n S²) where the g_c are smooth: S² times
/// less, about. Of others, that sum's part of the variance falls so; the rest is that of random
/// numbers. Whatever they are, the variance is at most S / (S - 1) times that of random numbers.
///
/// The standard error comes from R independent replicates, 32 by default. Give every technique
/// R S k samples, so that each replicate has whole blocks; any other number is unbiased as well.
///
/// ```
/// use mis::points::Stratified;
/// use mis::{Estimator, MultiSample, technique::UniformBox};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let square = UniformBox::uniform([0.0; 2], [1.0; 2])?;
/// let mis = MultiSample::new(&[(&square, 64 * 32 * 10)])?;
/// let f = |x: &[f64; 2]| x[0].exp() + x[1].sin();
/// let random = mis.estimate(&f, 1)?;
/// let stratified = mis.estimate_from(&f, &Stratified::new(1, 64)?)?;
/// assert!(stratified.standard_error().unwrap() < 0.03 * random.standard_error().unwrap());
/// # Ok(())
/// # }
/// ```
///
/// # The numbers
///
/// They are in the open unit interval, each within its stratum. Part of a block costs the
/// permutations up to its last sample: with many more strata than the few hundred samples that are
/// asked for at a time, the numbers become dear. Of more strata, [`Sobol`](super::Sobol) points make
/// more, too.
///
/// Sources: M. D. McKay, R. J. Beckman and W. J. Conover, *A Comparison of Three Methods for
/// Selecting Values of Input Variables in the Analysis of Output from a Computer Code*, Technometrics
/// 21 (1979) 239-245, doi:10.2307/1268522; M. Stein, *Large Sample Properties of Simulations Using
/// Latin Hypercube Sampling*, Technometrics 29 (1987) 143-151, for the additive part; A. B. Owen,
/// *Monte Carlo Variance of Scrambled Net Quadrature*, SIAM Journal on Numerical Analysis 34 (1997)
/// 1884-1910, for the bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[doc(alias("Latin hypercube sampling", "lhs", "jittered", "strata"))]
pub struct Stratified {
    seed: u64,
    strata: usize,
    replicates: usize,
}

impl Stratified {
    /// The points that `seed` stands for, with S = `strata`, in 32 replicates.
    ///
    /// # Errors
    ///
    /// There must be at least 2 strata and at most 2¹⁶.
    pub fn new(seed: u64, strata: usize) -> Result<Self, ArgumentError> {
        if (2..=MOST_STRATA).contains(&strata) {
            Ok(Self { seed, strata, replicates: 32 })
        } else {
            let rule = "it must be at least 2 and at most 65536";
            Err(ArgumentError::new("Stratified", "strata", strata, rule))
        }
    }

    /// So many replicates.
    ///
    /// With fewer, the error is less known: the 95 % interval is ± 2.04 standard errors from 32
    /// replicates, 2.36 from 8. With more it is known better, at no cost as long as each replicate
    /// has whole blocks.
    ///
    /// # Errors
    ///
    /// There must be at least 2 and at most 4096.
    pub fn with_replicates(self, replicates: usize) -> Result<Self, ArgumentError> {
        Ok(Self { replicates: checked_replicates("Stratified", replicates)?, ..self })
    }

    /// Puts π into `order`, as far as sample `end` of a block.
    fn shuffle(&self, key: u64, end: usize, order: &mut Vec<u16>) {
        order.clear();
        order.extend((0..=u16::MAX).take(self.strata));
        for (j, k) in (0..end.min(self.strata)).zip(0..) {
            // One of the strata that are left, to 2⁻⁴⁸ all alike: the upper half of a product.
            let left = (self.strata - j) as u128;
            let other = j + usize::try_from((u128::from(word(key, k)) * left) >> 64).unwrap_or(0);
            order.swap(j, other);
        }
    }

    /// The number `u` within stratum `k`, also where the sum rounds up.
    fn place(&self, k: u16, u: f64) -> f64 {
        let (k, strata) = (f64::from(k), self.strata as f64);
        ((k + u) / strata).min(((k + 1.0) / strata).next_down())
    }
}

impl PointSource for Stratified {
    fn fill(
        &self,
        stream: usize,
        first: u64,
        dimension: usize,
        xi: &mut [f64],
    ) -> Result<(), PointsExhausted> {
        let dimension = dimension.max(1);
        Random::new(hash(6, &[self.seed])).fill(stream, first, dimension, xi)?;
        let size = self.strata as u64;
        let mut block = first / size;
        let mut skip = usize::try_from(first % size).unwrap_or(0);
        let mut order = Vec::with_capacity(self.strata);
        let mut rest = xi;
        while !rest.is_empty() {
            let length = (self.strata - skip).saturating_mul(dimension).min(rest.len());
            let (rows, tail) = rest.split_at_mut(length);
            for c in 0..dimension.min(length) {
                let key = hash(7, &[self.seed, stream as u64, block, c as u64]);
                self.shuffle(key, skip + length.div_ceil(dimension), &mut order);
                let column = rows.iter_mut().skip(c).step_by(dimension);
                for (u, k) in column.zip(order.iter().skip(skip)) {
                    *u = self.place(*k, *u);
                }
            }
            (rest, block, skip) = (tail, block.wrapping_add(1), 0);
        }
        Ok(())
    }

    fn replicates(&self) -> usize {
        self.replicates
    }
}

#[cfg(test)]
mod tests {
    use super::Stratified;

    /// The largest number rounds up to the next stratum, or to 1.
    #[test]
    fn numbers_stay_in_their_strata() {
        let most = 1.0 - f64::EPSILON / 2.0;
        for strata in [2, 3, 7, 1000, 1 << 16] {
            let points = Stratified::new(1, strata).unwrap();
            for k in [0, 1, strata / 2, strata - 1] {
                let [lower, upper] = [k, k + 1].map(|k| k as f64 / strata as f64);
                let k = u16::try_from(k).unwrap();
                assert!(points.place(k, most) < upper, "{strata} {k}");
                assert!(points.place(k, f64::EPSILON / 2.0) >= lower);
                assert!(points.place(k, f64::EPSILON / 2.0) > 0.0);
            }
        }
    }

    /// All orders of three, and of two of four, are equally frequent.
    #[test]
    fn permutations_are_uniform() {
        for (strata, end, orders) in [(3, 3, 6), (4, 2, 12)] {
            let points = Stratified::new(1, strata).unwrap();
            let mut counts = std::collections::BTreeMap::new();
            let (draws, mut order) = (24_000, Vec::new());
            for key in 0..draws {
                points.shuffle(super::hash(7, &[key]), end, &mut order);
                *counts.entry(order[..end].to_vec()).or_insert(0) += 1;
            }
            assert_eq!(counts.len(), orders);
            let expected = draws as f64 / orders as f64;
            let chi: f64 =
                counts.values().map(|n| (f64::from(*n) - expected).powi(2) / expected).sum();
            let freedom = (orders - 1) as f64;
            assert!((chi - freedom).abs() < 5.0 * (2.0 * freedom).sqrt(), "{counts:?}");
        }
    }
}
