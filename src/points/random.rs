//! Seeded random numbers, by random access.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Dxsm;

use super::hash::hash;
use super::{PointSource, PointsExhausted};
use crate::vectors::vectorised;

/// How many samples share a generator. Part of the values that a seed stands for.
const SAMPLES_PER_GENERATOR: u64 = 256;

/// Independent uniform numbers in the open unit interval, a pure function of (seed, stream,
/// sample, coordinate).
///
/// Every 256 samples of a stream have a generator of their own, `Pcg64Dxsm`, whose 256 bits of
/// seed are hashed from (seed, stream, number of the 256). Neither jumps along one generator nor
/// consecutive seeds would do: both leave correlations between the streams.
///
/// The numbers are multiples of 2⁻⁵² plus 2⁻⁵³: never 0, never 1, symmetric about 1/2.
///
/// Sources: M. E. O'Neill, *PCG: A Family of Simple Fast Space-Efficient Statistically Good
/// Algorithms for Random Number Generation*, 2014; the hash is the output function of G. L.
/// Steele, D. Lea and C. H. Flood, *Fast Splittable Pseudorandom Number Generators*, 2014,
/// doi:10.1145/2660193.2660195.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Random {
    seed: u64,
}

impl Random {
    /// The numbers that `seed` stands for.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self { seed }
    }

    fn generator(self, stream: u64, number: u64) -> Pcg64Dxsm {
        let mut bytes = [0; 32];
        for (word, lane) in bytes.chunks_exact_mut(8).zip(1..) {
            word.copy_from_slice(&hash(lane, &[self.seed, stream, number]).to_le_bytes());
        }
        Pcg64Dxsm::from_seed(bytes)
    }
}

impl PointSource for Random {
    fn fill(
        &self,
        stream: usize,
        first: u64,
        dimension: usize,
        xi: &mut [f64],
    ) -> Result<(), PointsExhausted> {
        let dimension = dimension.max(1);
        let mut sample = first;
        let mut rest = xi;
        while !rest.is_empty() {
            let (number, row) = (sample / SAMPLES_PER_GENERATOR, sample % SAMPLES_PER_GENERATOR);
            let rows = usize::try_from(SAMPLES_PER_GENERATOR - row).unwrap_or(usize::MAX);
            let length = rows.saturating_mul(dimension).min(rest.len());
            let (block, tail) = rest.split_at_mut(length);
            let mut generator = self.generator(stream as u64, number);
            if row > 0 {
                generator.advance(u128::from(row) * dimension as u128);
            }
            vectorised(
                #[inline(always)]
                || {
                    // In registers, not behind a reference.
                    let mut generator = generator;
                    let (fours, last) = block.as_chunks_mut::<4>();
                    for four in fours {
                        *four = std::array::from_fn(|_| open_unit(generator.next_u64()));
                    }
                    for u in last {
                        *u = open_unit(generator.next_u64());
                    }
                },
            );
            rest = tail;
            sample = sample.saturating_add(SAMPLES_PER_GENERATOR - row);
        }
        Ok(())
    }
}

/// The 52 upper bits k as (k + 1/2) 2⁻⁵², a number in (0, 1). With 53 bits, the largest would round
/// to 1. They are the mantissa of a number in \[1, 2), from which 1 - 2⁻⁵³ is subtracted exactly.
fn open_unit(bits: u64) -> f64 {
    f64::from_bits(bits >> 12 | 1_f64.to_bits()) - (1.0 - f64::EPSILON / 2.0)
}

#[cfg(test)]
mod tests {
    use super::{PointSource, Random, open_unit};

    fn numbers(seed: u64, stream: usize, first: u64, dimension: usize, rows: usize) -> Vec<f64> {
        let mut xi = vec![f64::NAN; rows * dimension];
        Random::new(seed).fill(stream, first, dimension, &mut xi).unwrap();
        xi
    }

    #[test]
    fn the_interval_is_open() {
        assert_eq!(open_unit(0), 2f64.powi(-53));
        assert_eq!(open_unit(u64::MAX), 1.0 - 2f64.powi(-53));
    }

    #[test]
    fn any_block_can_be_had_in_any_order() {
        let whole = numbers(1, 0, 0, 3, 1000);
        for (first, rows) in [(0, 1), (255, 2), (256, 256), (700, 300), (999, 1)] {
            assert_eq!(
                numbers(1, 0, first, 3, rows),
                whole[usize::try_from(first).unwrap() * 3..][..rows * 3],
                "{first}"
            );
        }
    }

    #[test]
    fn seeds_streams_and_generators_differ() {
        let first = numbers(1, 0, 0, 1, 256);
        for other in
            [numbers(2, 0, 0, 1, 256), numbers(1, 1, 0, 1, 256), numbers(1, 0, 256, 1, 256)]
        {
            assert!(first.iter().zip(&other).all(|(a, b)| a != b));
        }
    }

    #[test]
    fn the_numbers_of_a_seed_are_frozen() {
        let bits: Vec<u64> = numbers(7, 3, 255, 1, 3).iter().map(|u| u.to_bits()).collect();
        assert_eq!(bits, [0x3fbe_3209_35aa_33e8, 0x3fc7_5177_7450_186c, 0x3fd5_12f5_e421_cdd2]);
    }

    /// The t-th numbers of 256 generators side by side: the variance of their sum over what
    /// independence gives. Jumps along one generator make it 1.4 to 11.
    #[test]
    fn generators_are_independent_of_each_other() {
        for (name, at) in [
            ("stream", |k: u64, t: u64| (0, k, t)),
            ("number", |k, t| (0, 0, k * 256 + t)),
            ("seed", |k, t| (k, 0, t)),
        ] as [(&str, fn(u64, u64) -> (u64, u64, u64)); 3]
        {
            let draws = 256;
            let sums: Vec<f64> = (0..draws)
                .map(|t| {
                    (0..256)
                        .map(|k| {
                            let (seed, stream, sample) = at(k, t);
                            numbers(seed, usize::try_from(stream).unwrap(), sample, 1, 1)[0] - 0.5
                        })
                        .sum()
                })
                .collect();
            let ratio = sums.iter().map(|s| s * s).sum::<f64>() / draws as f64 / (256.0 / 12.0);
            // Five standard deviations of a variance from 256 draws.
            assert!((ratio - 1.0).abs() < 5.0 * (2.0 / draws as f64).sqrt(), "{name}: {ratio}");
        }
    }
}
