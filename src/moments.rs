//! Running means and variances of contributions.

use serde::{Deserialize, Serialize};

use crate::lanes::{self, Sums};
use crate::part::{Contributions, Extreme};

/// Count, mean, squared and cubed deviations of the contributions y of one technique, one component.
///
/// A block of n is summed about its first element y_0, in lanes: M2 = Σ d² - (Σ d)² / n with
/// d = y - y_0. As y_0 is one of the block, M2 is at least 1 / (n - 1) of what is subtracted, so
/// that at most the digits of n are lost, and the difference is never negative; blocks merge by the
/// update of T. F. Chan, G. H. Golub and R. J. LeVeque, *Algorithms for Computing the Sample
/// Variance*, 1983, doi:10.1080/00031305.1983.10483115. Equal numbers so have a variance of exactly
/// 0, and a large offset costs no digits. Sums are not compensated: an error of a few ULP of the
/// largest contribution is far below the sampling error.
///
/// M3 = Σ d³ - 3 m Σ d² + 2 n m³, with m = Σ d / n, merges by the formula of P. Pébay, *Formulas for
/// Robust, One-Pass Parallel Computation of Covariances and Arbitrary-Order Statistical Moments*,
/// 2008; it loses up to the digits of n, which a diagnostic can spare.
///
/// M2 is held in units of 4^`exponent`, M3 in units of 8^`exponent`, so that contributions near the
/// ends of the range of `f64` have a standard error although their variance is not representable.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Moments {
    pub(crate) count: u64,
    pub(crate) mean: f64,
    m2: f64,
    m3: f64,
    exponent: i32,
    /// The largest |y|.
    pub(crate) largest: f64,
}

impl Moments {
    /// The moments of a block. The mean is finite if and only if every y is.
    pub(crate) fn of_block(ys: &[f64]) -> Self {
        Self::of_sums(ys, &lanes::sums_about(ys, ys.first().copied().unwrap_or(0.0)))
    }

    /// The moments of a block, given its sums about its first element.
    pub(crate) fn of_sums(ys: &[f64], sums: &Sums) -> Self {
        let Some(origin) = ys.first().copied() else { return Self::default() };
        let Sums { powers, largest, .. } = *sums;
        let [mut sum, mut squares, mut cubes] = powers;
        // Within these bounds cubes neither overflow nor lose a digit that matters.
        let exponent = if largest == 0.0 || (1e-80..1e80).contains(&largest) {
            0
        } else {
            libm::frexp(largest).1.clamp(-1020, 1020)
        };
        let unit = inverse_unit(exponent);
        if exponent != 0 {
            cubes = lanes::sum_of_cubes(ys, origin, unit);
            (sum, squares) = lanes::sum_and_squares(ys, origin, unit);
        }
        let n = ys.len() as f64;
        let m = sum / n;
        let mean = (origin * unit + m) / unit;
        let m2 = squares - sum * sum / n;
        let m3 = cubes - m * (3.0 * squares - 2.0 * m * sum);
        Self { count: ys.len() as u64, mean, m2, m3, exponent, largest }
    }

    /// Whether its units are among those that [`of_block`](Self::of_block) takes.
    pub(crate) fn is_sound(&self) -> bool {
        (-1020..=1020).contains(&self.exponent)
    }

    /// The moments of both sets of contributions together.
    pub(crate) fn merge(self, other: Self) -> Self {
        if self.count == 0 {
            return other;
        }
        if other.count == 0 {
            return self;
        }
        let (a, b) = (self.count as f64, other.count as f64);
        let n = a + b;
        // A set whose contributions are all 0 fits any unit.
        let exponent = match (self.largest == 0.0, other.largest == 0.0) {
            (true, _) => other.exponent,
            (_, true) => self.exponent,
            _ => self.exponent.max(other.exponent),
        };
        let unit = inverse_unit(exponent);
        let delta = other.mean * unit - self.mean * unit;
        let rescaled = |m: &Self| {
            let shift = m.exponent - exponent;
            if shift == 0 {
                (m.m2, m.m3)
            } else {
                (libm::ldexp(m.m2, 2 * shift), libm::ldexp(m.m3, 3 * shift))
            }
        };
        let ((m2_a, m3_a), (m2_b, m3_b)) = (rescaled(&self), rescaled(&other));
        let square = delta * delta * (a * b / n);
        let cross = a / n * m2_b - b / n * m2_a;
        Self {
            count: self.count + other.count,
            mean: (self.mean * unit + delta * (b / n)) / unit,
            m2: m2_a + m2_b + square,
            m3: m3_a + m3_b + delta * (square * ((a - b) / n) + 3.0 * cross),
            exponent,
            largest: self.largest.max(other.largest),
        }
    }

    /// The skewness of the mean, γ / √n with γ = (M3 / n) / (M2 / n)^(3/2); 0 if all y are equal.
    pub(crate) fn skewness_of_mean(&self) -> f64 {
        if self.m2 > 0.0 { self.m3 / self.m2 / self.m2.sqrt() } else { 0.0 }
    }

    /// s / √n, the standard error of the mean; unknown from fewer than two contributions.
    pub(crate) fn standard_error(&self) -> Option<f64> {
        if self.count < 2 {
            return None;
        }
        let n = self.count as f64;
        Some(libm::ldexp((self.m2 / (n - 1.0) / n).sqrt(), self.exponent))
    }

    /// √(Σ (y - m)²) / `divisor`, from the squared deviations from a given m.
    pub(crate) fn deviation_from(&self, m: f64, divisor: f64) -> f64 {
        // Divided first: the root alone may overflow.
        let own = libm::ldexp(self.m2.sqrt() / divisor, self.exponent);
        own.hypot((self.count as f64).sqrt() / divisor * (self.mean - m))
    }
}

/// 2^-exponent; mostly 1, which takes no call.
#[inline]
fn inverse_unit(exponent: i32) -> f64 {
    if exponent == 0 { 1.0 } else { libm::ldexp(1.0, -exponent) }
}

/// The contributions of one technique, one component.
///
/// Merges blocks in a fixed binary tree over their order, so that rounding errors grow with the
/// logarithm of the number of blocks, and the bits depend on the blocks alone.
#[derive(Debug, Clone, Default)]
pub(crate) struct Accumulator {
    /// Complete subtrees, the largest first, with their levels.
    nodes: Vec<(u32, Moments)>,
    /// The first of the largest magnitude.
    extreme: Extreme,
}

impl Accumulator {
    /// Forgets all blocks.
    pub(crate) fn clear(&mut self) {
        self.nodes.clear();
        self.extreme = Extreme::default();
    }

    /// Adds a block of contributions with its moments; `index` numbers its samples.
    pub(crate) fn push(&mut self, ys: &[f64], block: Moments, index: impl Fn(usize) -> u64) {
        if block.largest > self.extreme.y.abs()
            && let Some(j) = lanes::position_of_magnitude(ys, block.largest)
        {
            self.extreme = Extreme { y: ys[j], index: index(j) };
        }
        let (mut level, mut merged) = (0, block);
        while let Some(&(_, left)) = self.nodes.last().filter(|node| node.0 == level) {
            self.nodes.pop();
            merged = left.merge(merged);
            level += 1;
        }
        self.nodes.push((level, merged));
    }

    pub(crate) fn total(&self) -> Contributions {
        let nodes = self.nodes.iter().rev();
        let moments = nodes.fold(Moments::default(), |right, node| node.1.merge(right));
        Contributions { moments, extreme: self.extreme }
    }
}

#[cfg(test)]
mod tests {
    use super::{Accumulator, Moments};
    use crate::part::Extreme;

    fn of(ys: &[f64]) -> Moments {
        Moments::of_block(ys)
    }

    /// The sample variance, where it is representable.
    fn variance(m: &Moments) -> f64 {
        m.standard_error().unwrap().powi(2) * m.count as f64
    }

    #[test]
    fn equal_numbers_have_variance_zero_and_their_own_mean() {
        for y in [0.1, -0.1, 1e-320, 1e300, 1.0 / 3.0] {
            let block = of(&vec![y; 250]);
            assert_eq!((block.mean, block.standard_error()), (y, Some(0.0)));
            let mut twice = block;
            for _ in 0..24 {
                twice = twice.merge(twice);
            }
            assert_eq!((twice.mean, twice.standard_error()), (y, Some(0.0)));
            assert_eq!(twice.count, 250 << 24); // 4.2e9, beyond 2^32
        }
    }

    #[test]
    fn a_large_offset_costs_no_digits() {
        let ys = [4.0, 7.0, 13.0, 16.0].map(|y| 1e9 + y);
        assert_eq!(of(&ys).mean, 1e9 + 10.0);
        assert_eq!(variance(&of(&ys)), 30.0);
        let merged = of(&ys[..1]).merge(of(&ys[1..]));
        assert!((variance(&merged) - 30.0).abs() < 1e-13);
    }

    #[test]
    fn merging_equals_a_single_pass() {
        let ys: Vec<f64> = (0..1000).map(|k| f64::from(k * k % 997) - 300.0).collect();
        let whole = of(&ys);
        for cut in [1, 8, 500, 999] {
            let merged = of(&ys[..cut]).merge(of(&ys[cut..]));
            assert!((merged.mean - whole.mean).abs() <= 1e-13 * 400.0);
            assert!((variance(&merged) / variance(&whole) - 1.0).abs() < 1e-13);
            assert_eq!(merged.largest, whole.largest);
        }
        let exact_mean = ys.iter().sum::<f64>() / 1000.0; // integers: exact
        assert!((whole.mean - exact_mean).abs() < 1e-13 * 400.0);
    }

    #[test]
    fn skewness_is_that_of_all_however_they_are_divided() {
        let ys: Vec<f64> = (0..1000).map(|k| f64::from(k * k % 997).powi(3) / 1e6).collect();
        let mean = ys.iter().sum::<f64>() / 1000.0;
        let [m2, m3] = [2, 3].map(|k| ys.iter().map(|y| (y - mean).powi(k)).sum::<f64>());
        let exact = m3 / m2.powf(1.5);
        for scale in [1.0, -1.0, 1e200, 1e-200] {
            let ys: Vec<f64> = ys.iter().map(|y| scale * y).collect();
            for cut in [1, 8, 500, 999, 1000] {
                let m = of(&ys[..cut]).merge(of(&ys[cut..]));
                let ratio = m.skewness_of_mean() / (exact * scale.signum());
                assert!((ratio - 1.0).abs() < 1e-11, "{scale} {cut}: {ratio}");
            }
        }
        assert_eq!(of(&[3.0, 3.0, 3.0]).skewness_of_mean(), 0.0);
    }

    #[test]
    fn the_standard_error_survives_a_variance_beyond_the_range() {
        for scale in [1e200, 1e-200, 1e300, 1e-300] {
            let ys = [1.0, 2.0, 3.0, 4.0].map(|y| y * scale);
            let expected = (5.0_f64 / 3.0 / 4.0).sqrt() * scale;
            for m in [of(&ys), of(&ys[..2]).merge(of(&ys[2..]))] {
                let error = m.standard_error().unwrap();
                assert!((error / expected - 1.0).abs() < 1e-14, "{scale}: {error}");
                assert!((m.mean / (2.5 * scale) - 1.0).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn zeros_fit_any_unit() {
        let tiny = of(&[1e-200, 3e-200]);
        // The squared deviations of (0, 0, 1, 3) from their mean, 1, sum to 6.
        let exact = (6.0_f64 / 3.0 / 4.0).sqrt() * 1e-200;
        for merged in [of(&[0.0, 0.0]).merge(tiny), tiny.merge(of(&[0.0, 0.0]))] {
            assert!((merged.standard_error().unwrap() / exact - 1.0).abs() < 1e-14);
        }
        assert_eq!(tiny.merge(of(&[0.0])).count, 3);
    }

    #[test]
    fn scales_far_apart_merge_in_the_larger_unit() {
        let exact = (6.0_f64 / 3.0 / 4.0).sqrt() * 1e200; // (0, 0, 1, 3)
        for m in [
            of(&[1e-200, 3e-200]).merge(of(&[1e200, 3e200])),
            of(&[1e200, 3e200]).merge(of(&[1e-200, 3e-200])),
        ] {
            assert!((m.standard_error().unwrap() / exact - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn cancellation_stays_below_the_standard_error() {
        let m = of(&[1.0, 1e100, 1.0, -1e100]);
        assert!((m.mean - 0.5).abs() <= 1e-15 * m.standard_error().unwrap());
    }

    #[test]
    fn one_contribution_has_no_standard_error() {
        assert_eq!(of(&[3.0]).standard_error(), None);
        assert_eq!(Moments::default().standard_error(), None);
    }

    #[test]
    fn equal_terms_sum_to_rounding_error() {
        let mut sum = Accumulator::default();
        for _ in 0..1_000_000 / 250 {
            sum.push(&[0.1; 250], of(&[0.1; 250]), |_| 0);
        }
        let total = sum.total().moments;
        assert_eq!((total.mean, total.count), (0.1, 1_000_000));
    }

    #[test]
    fn the_first_of_the_largest_is_kept() {
        let mut sum = Accumulator::default();
        for k in 0..7_u64 {
            let ys = [1.0, if k % 2 == 1 { -5.0 } else { 2.0 }];
            sum.push(&ys, of(&ys), |j| 2 * k + j as u64);
        }
        let total = sum.total();
        assert_eq!(total.extreme, Extreme { y: -5.0, index: 3 });
        assert_eq!((total.moments.largest, total.moments.count), (5.0, 14));
    }

    #[test]
    fn what_is_not_finite_shows_in_the_mean() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for n in [1, 8, 13, 250] {
                for at in 0..n {
                    let mut ys = vec![1.0; n];
                    ys[at] = bad;
                    assert!(!of(&ys).mean.is_finite(), "{bad} at {at} of {n}");
                }
            }
        }
        assert!(of(&[f64::MAX, -f64::MAX, 5e-324]).mean.is_finite());
    }
}
