//! The power heuristic.

use super::{Densities, SAFE, Weighting, at, by_point};
use crate::error::ArgumentError;
use crate::lanes::LANES;

/// The power heuristic, w_i = q_i^β / Σ q_k^β.
///
/// β = 1 is the balance heuristic, β = ∞ the maximum heuristic; β = 0 shares equally among the
/// techniques that cover the point. A larger β helps where one technique is nearly exact, and
/// hurts elsewhere: with K techniques and β = 2 the second moment is at most (1 + √K) / 2 times
/// that of the balance heuristic.
///
/// Source: Veach and Guibas 1995; the bound from Veach 1997, section 9.2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Power {
    beta: f64,
}

impl Power {
    /// The power heuristic with exponent β.
    ///
    /// # Errors
    ///
    /// `beta` must be in \[0, ∞\].
    pub fn new(beta: f64) -> Result<Self, ArgumentError> {
        if beta >= 0.0 {
            Ok(Self { beta })
        } else {
            Err(ArgumentError::new("Power", "beta", beta, "it must be at least 0"))
        }
    }

    /// β = 2, the usual choice.
    #[must_use]
    pub fn squared() -> Self {
        Self { beta: 2.0 }
    }

    /// r^β.
    fn power(self, r: f64) -> f64 {
        if self.beta == 2.0 { r * r } else { r.powf(self.beta) }
    }
}

impl Weighting for Power {
    fn weight_over_ratio(&self, i: usize, r: &[f64]) -> f64 {
        // With β < 1 even a ratio that underflowed, wholly or in part, may have weight.
        if self.beta < 1.0 && r.iter().any(|r| *r < f64::MIN_POSITIVE) {
            return f64::NAN;
        }
        let sum = r.iter().map(|r| self.power(*r)).sum::<f64>();
        let own = at(r, i);
        if self.beta == 2.0 { own / sum } else { own.powf(self.beta - 1.0) / sum }
    }

    fn weight_over_density_batch(
        &self,
        i: usize,
        q: &Densities<'_>,
        r: &mut [f64],
        out: &mut [f64],
    ) {
        if self.beta != 2.0 {
            return by_point(self, i, q, r, out);
        }
        // Squares without powf, several points at a time.
        for (chunk, out) in out.chunks_mut(LANES).enumerate() {
            let rows = || q.rows().map(|(a, p)| (a, &p[chunk * LANES..][..out.len()]));
            let mut largest = [0.0_f64; LANES];
            for (a, p) in rows() {
                for (largest, p) in largest.iter_mut().zip(p) {
                    *largest = if *largest > a * p { *largest } else { a * p };
                }
            }
            let mut sum = [0.0; LANES];
            let mut own = [0.0; LANES];
            for (k, (a, p)) in rows().enumerate() {
                for (((sum, own), largest), p) in sum.iter_mut().zip(&mut own).zip(&largest).zip(p)
                {
                    let r = a * p / largest;
                    *sum += r * r;
                    *own = if k == i { r } else { *own };
                }
            }
            for (((out, sum), own), largest) in out.iter_mut().zip(sum).zip(own).zip(largest) {
                *out = if SAFE.contains(&largest) { own / sum / largest } else { f64::NAN };
            }
        }
    }

    fn ln_weight_over_ratio(&self, i: usize, ln_r: &[f64], r: &[f64]) -> f64 {
        if self.beta >= 1.0 {
            return self.weight_over_ratio(i, r).ln();
        }
        // exp(0 · -∞) would be NaN: what does not cover the point has no weight at β = 0 either.
        let covering = ln_r.iter().filter(|l| **l > f64::NEG_INFINITY);
        let sum: f64 = covering.map(|l| (self.beta * l).exp()).sum();
        (self.beta - 1.0) * at(ln_r, i) - sum.ln()
    }
}
