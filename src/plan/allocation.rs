//! How many samples each technique gets.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// The shares of the samples that an optimisation has come to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Allocation {
    /// α_i, which sum to 1.
    pub shares: Vec<f64>,
    /// The predicted variance times cost of a sample before the first step, and after each; it never
    /// rises.
    pub objective: Vec<f64>,
}

/// A step that promises less than this is not taken.
const NOTHING: f64 = 1e-5;

/// A step is halved so often at most.
const HALVINGS: i32 = 12;

/// Steps that gain less than this, twice in a row, are the last.
const GAIN: f64 = 1e-3;

/// Minimises J(α) = V(α) · Σ α_k c_k from `shares`, over those that are at least `floor` / K.
///
/// `evaluate` gives V, m = -∂V/∂α and the costs c. V(α) is N times a variance from α_k N samples, so
/// that V falls as 1/s if all α_k grow by s; at the optimum m_k / c_k = V / C for every technique
/// with samples, where C = Σ α_k c_k.
///
/// For methods whose weights change with the shares, so that curvature is not to be had; for others see
/// [`newton`](super::newton::newton).
///
/// The first step is α_k ← α_k √(m_k C / (c_k V)). For Σ σ_k² / α_k, that is J. Neyman's allocation; for
/// ∫ f² / Σ α_k p_k, it is the step of R. Kleiss and R. Pittau, *Weight Optimization in Multichannel
/// Monte Carlo*, 1994, arXiv:hep-ph/9405257, which minimises a majorant (by Jensen's inequality). Alone
/// such steps take thousands to an optimum where V is small beside μ². So from the second on, the
/// curvature that they show is made use of: BFGS (J. Nocedal and S. J. Wright, *Numerical Optimization*,
/// 2006, chapter 6) in θ, with α = (1 - floor) softmax θ + floor / K. A step that would let J rise is
/// shortened until it does not. There are no further steps after `most` evaluations.
pub(super) fn optimise(
    shares: &[f64],
    floor: f64,
    most: usize,
    mut evaluate: impl FnMut(&[f64]) -> Option<(f64, Vec<f64>, Vec<f64>)>,
) -> Allocation {
    let k = shares.len();
    let uniform = floor / k.max(1) as f64;
    let softmax = |theta: &DVector<f64>| {
        let powers = theta.map(|t| (t - theta.max()).exp());
        &powers / powers.sum()
    };
    let alpha = |theta: &DVector<f64>| softmax(theta).map(|s| (1.0 - floor) * s + uniform);
    // J and ∂J/∂θ; and the first step.
    let mut look = |theta: &DVector<f64>| {
        let (soft, alpha) = (softmax(theta), alpha(theta));
        let (v, m, c) = evaluate(alpha.as_slice())?;
        let (m, c) = (DVector::from(m), DVector::from(c));
        let total = alpha.dot(&c);
        let slope = &c * v - &m * total;
        let gradient = soft.component_mul(&slope.add_scalar(-soft.dot(&slope))) * (1.0 - floor);
        let step = m.zip_map(&c, |m, c| 0.5 * (m * total / (c * v)).clamp(1e-4, 1e4).ln());
        (v * total).is_finite().then_some((v * total, gradient, step))
    };
    let mut theta = DVector::from_iterator(
        k,
        shares.iter().map(|share| (share - uniform).max(1e-3 * uniform).ln()),
    );
    let Some((mut j, mut gradient, mut step)) = look(&theta) else {
        return Allocation { shares: shares.to_vec(), objective: Vec::new() };
    };
    let mut objective = vec![j];
    let mut evaluations = 1;
    let mut inverse: Option<DMatrix<f64>> = None;
    let mut small = 0;
    while evaluations < most && j > 0.0 && small < 2 {
        // No further than a factor of e⁴ for any share.
        step *= (4.0 / step.amax()).min(1.0);
        if step.dot(&gradient) > -NOTHING * j {
            break;
        }
        let found = (0..HALVINGS).find_map(|halvings| {
            evaluations += 1;
            let next = &theta + &step * 0.5_f64.powi(halvings);
            look(&next).filter(|found| found.0 < j).map(|found| (next, found))
        });
        let Some((next, (lower, slope, own))) = found else {
            // Not along the curvature, then along the slope.
            match inverse.take() {
                Some(_) => step = own_step(&gradient, j),
                None => break,
            }
            continue;
        };
        let (moved, bent) = (&next - &theta, &slope - &gradient);
        let product = moved.dot(&bent);
        if product > 1e-12 * moved.norm() * bent.norm() {
            let scaled = || DMatrix::identity(k, k) * (product / bent.norm_squared());
            let old = inverse.take().unwrap_or_else(scaled);
            let left = DMatrix::identity(k, k) - &moved * bent.transpose() / product;
            inverse = Some(&left * old * left.transpose() + &moved * moved.transpose() / product);
        }
        small = if lower > j * (1.0 - GAIN) { small + 1 } else { 0 };
        (theta, j, gradient) = (next, lower, slope);
        objective.push(j);
        step = match &inverse {
            Some(inverse) => -(inverse * &gradient),
            None => own,
        };
    }
    Allocation { shares: alpha(&theta).as_slice().to_vec(), objective }
}

/// Down the slope, as far as would halve J if it went on like that.
fn own_step(gradient: &DVector<f64>, j: f64) -> DVector<f64> {
    gradient * (-0.5 * j / gradient.norm_squared().max(f64::MIN_POSITIVE))
}

/// Whole numbers in proportion to the shares, which sum to `total`: the largest remainders are rounded
/// up. A technique with a share gets at least one, if there are enough.
pub(super) fn counts(shares: &[f64], total: u64) -> Vec<u64> {
    // What is no share counts for nothing.
    let shares: Vec<f64> =
        shares.iter().map(|s| if s.is_finite() && *s > 0.0 { *s } else { 0.0 }).collect();
    let largest = shares.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let sum: f64 = shares.iter().map(|share| share / largest).sum();
    let exact: Vec<f64> = shares.iter().map(|share| share / largest / sum * total as f64).collect();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 2^53")]
    let mut counts: Vec<u64> = exact.iter().map(|x| x.floor() as u64).collect();
    let mut order: Vec<usize> = (0..shares.len()).filter(|k| shares[*k] > 0.0).collect();
    order.sort_by(|a, b| (exact[*b] % 1.0).total_cmp(&(exact[*a] % 1.0)));
    let left = total.saturating_sub(counts.iter().fold(0, |sum: u64, n| sum.saturating_add(*n)));
    for k in order.iter().cycle().take(usize::try_from(left).unwrap_or(0).min(order.len())) {
        counts[*k] += 1;
    }
    for k in order {
        let most = (0..counts.len()).max_by_key(|m| counts[*m]).unwrap_or(k);
        if counts[k] == 0 && counts[most] > 1 {
            counts[k] = 1;
            counts[most] -= 1;
        }
    }
    counts
}

/// Gives every technique at least so many samples, from those that have most, if there are enough.
pub(super) fn raise(counts: &mut [u64], least: u64) {
    let least = least.min(counts.iter().sum::<u64>() / counts.len().max(1) as u64);
    for k in 0..counts.len() {
        while counts[k] < least {
            let most = (0..counts.len()).max_by_key(|m| counts[*m]).unwrap_or(k);
            let moved = (least - counts[k]).min(counts[most] - least).max(1);
            counts[k] += moved;
            counts[most] -= moved;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{counts, optimise, raise};

    #[test]
    fn neyman_in_one_step() {
        let (sigma, cost) = ([3.0_f64, 1.0, 0.5], [1.0, 4.0, 0.25]);
        let mut evaluations = 0;
        let found = optimise(&[1.0 / 3.0; 3], 0.0, 40, |alpha| {
            evaluations += 1;
            let v = alpha.iter().zip(sigma).map(|(a, s)| s * s / a).sum();
            let m = alpha.iter().zip(sigma).map(|(a, s)| s * s / a / a).collect();
            Some((v, m, cost.to_vec()))
        });
        // α_k ∝ σ_k / √c_k: 3, 1/2, 1.
        for (alpha, expected) in found.shares.iter().zip([3.0 / 4.5, 0.5 / 4.5, 1.0 / 4.5]) {
            assert!((alpha - expected).abs() < 1e-7, "{alpha} {expected}");
        }
        assert!(evaluations <= 8, "{evaluations}");
        let best = (3.0_f64 + 2.0 + 0.25).powi(2);
        assert!((found.objective[1] / best - 1.0).abs() < 1e-12, "{:?}", found.objective);
    }

    #[test]
    fn counts_of_what_are_no_shares() {
        assert_eq!(counts(&[f64::NAN, 1.0], 10), [0, 10]);
        assert_eq!(counts(&[f64::INFINITY, -1.0, 2.0], 10), [0, 0, 10]);
        assert_eq!(counts(&[0.0, 0.0], 10), [0, 0]);
        assert_eq!(counts(&[1e308, 1e308], 10), [5, 5]);
        assert_eq!(counts(&[], 10), [0; 0]);
    }

    #[test]
    fn raised_to_the_least() {
        for (mut before, least, after) in [
            (vec![1, 99], 16, vec![16, 84]),
            (vec![0, 5, 95], 16, vec![16, 16, 68]),
            (vec![3, 4], 16, vec![3, 4]),
            (vec![50, 50], 16, vec![50, 50]),
        ] {
            raise(&mut before, least);
            assert_eq!(before, after);
        }
        raise(&mut [], 3);
    }

    #[test]
    fn counts_are_whole_and_complete() {
        assert_eq!(counts(&[0.5, 0.3, 0.2], 10), [5, 3, 2]);
        assert_eq!(counts(&[1.0, 1.0, 1.0], 10).iter().sum::<u64>(), 10);
        assert_eq!(counts(&[0.54, 0.26, 0.2], 10), [5, 3, 2]);
        assert_eq!(counts(&[1.0, 1e-9, 0.0], 10), [9, 1, 0]);
        assert_eq!(counts(&[1.0, 1e-9], 1), [1, 0]);
        assert_eq!(counts(&[0.25, 0.75], 1 << 53), [1 << 51, 3 << 51]);
    }
}
