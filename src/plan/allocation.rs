//! How many samples each technique gets.

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

/// Steps at most.
const STEPS: usize = 40;

/// A step that gains less than this is the last.
const GAIN: f64 = 1e-4;

/// A share falls by a factor of ten a step at most.
const LEAST: f64 = 0.01;

/// Minimises J(α) = V(α) · Σ α_k c_k from `shares`, over those that are at least `floor` / K.
///
/// `evaluate` gives V, -∂V/∂α and the costs c. V(α) is N times a variance from α_k N samples, so
/// that V falls as 1/s if all α_k grow by s, and at the optimum m_k / c_k = V / C for every technique
/// with samples, where m_k = -∂V/∂α_k and C = Σ α_k c_k. A step is
/// α_k ← α_k (m_k C / (c_k V))^d. For Σ σ_k² / α_k, d = 1/2 is J. Neyman's allocation in one step; for
/// ∫ f² / Σ α_k p_k, d = 1/2 is the step of R. Kleiss and R. Pittau, *Weight Optimization in Multichannel
/// Monte Carlo*, 1994, arXiv:hep-ph/9405257, which minimises a majorant (Jensen's inequality) and so
/// never rises. d is doubled as long as steps of that size do not rise either, and halved where they do.
pub(super) fn optimise(
    shares: &[f64],
    floor: f64,
    mut evaluate: impl FnMut(&[f64]) -> Option<(f64, Vec<f64>, Vec<f64>)>,
) -> Allocation {
    let mut best = floored(shares, floor);
    let Some((mut v, mut m, mut c)) = evaluate(&best) else {
        return Allocation { shares: best, objective: Vec::new() };
    };
    let total = |shares: &[f64], c: &[f64]| -> f64 {
        shares.iter().zip(c).map(|(alpha, c)| alpha * c).sum()
    };
    let mut objective = vec![v * total(&best, &c)];
    let mut d = 0.5;
    while objective.len() <= STEPS && v > 0.0 && d >= 1.0 / 64.0 {
        let ratio = total(&best, &c) / v;
        let step: Vec<f64> = best
            .iter()
            .zip(m.iter().zip(&c))
            .map(|(alpha, (m, c))| alpha * (m * ratio / c).max(0.0).powf(d).clamp(LEAST, 1.0 / LEAST))
            .collect();
        let next = floored(&step, floor);
        let Some(found) = evaluate(&next) else { break };
        let (before, after) = (v * total(&best, &c), found.0 * total(&next, &found.2));
        if after <= before {
            (v, m, c) = found;
            best = next;
            objective.push(after);
            if after > before * (1.0 - GAIN) {
                break;
            }
            d = (2.0 * d).min(4.0);
        } else {
            d /= 2.0;
        }
    }
    Allocation { shares: best, objective }
}

/// The same shares, none below `floor` / K, summing to 1.
fn floored(shares: &[f64], floor: f64) -> Vec<f64> {
    let floor = floor / shares.len().max(1) as f64;
    let sum: f64 = shares.iter().sum();
    let mut shares: Vec<f64> = shares.iter().map(|share| share / sum).collect();
    // What is raised to the floor is taken from the others, which may bring more of them there.
    for _ in 0..shares.len() {
        let low = shares.iter().filter(|share| **share <= floor).count() as f64;
        let rest: f64 = shares.iter().filter(|share| **share > floor).sum();
        let scale = (1.0 - low * floor) / rest;
        for share in &mut shares {
            *share = if *share > floor { *share * scale } else { floor };
        }
        if shares.iter().all(|share| *share >= floor) {
            break;
        }
    }
    shares
}

/// Whole numbers in proportion to the shares, which sum to `total`: the largest remainders are rounded
/// up. A technique with a share gets at least one, if there are enough.
pub(super) fn counts(shares: &[f64], total: u64) -> Vec<u64> {
    let sum: f64 = shares.iter().sum();
    let exact: Vec<f64> = shares.iter().map(|share| share / sum * total as f64).collect();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 2^53")]
    let mut counts: Vec<u64> = exact.iter().map(|x| x.floor() as u64).collect();
    let mut order: Vec<usize> = (0..shares.len()).filter(|k| shares[*k] > 0.0).collect();
    order.sort_by(|a, b| (exact[*b] % 1.0).total_cmp(&(exact[*a] % 1.0)));
    let left = total.saturating_sub(counts.iter().sum());
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

#[cfg(test)]
mod tests {
    use super::{counts, floored, optimise};

    #[test]
    fn neyman_in_one_step() {
        let (sigma, cost) = ([3.0_f64, 1.0, 0.5], [1.0, 4.0, 0.25]);
        let mut evaluations = 0;
        let found = optimise(&[1.0 / 3.0; 3], 0.0, |alpha| {
            evaluations += 1;
            let v = alpha.iter().zip(sigma).map(|(a, s)| s * s / a).sum();
            let m = alpha.iter().zip(sigma).map(|(a, s)| s * s / a / a).collect();
            Some((v, m, cost.to_vec()))
        });
        // α_k ∝ σ_k / √c_k: 3, 1/2, 1.
        for (alpha, expected) in found.shares.iter().zip([3.0 / 4.5, 0.5 / 4.5, 1.0 / 4.5]) {
            assert!((alpha - expected).abs() < 1e-12, "{alpha} {expected}");
        }
        assert!(evaluations <= 4, "{evaluations}");
        let best = (3.0_f64 + 2.0 + 0.25).powi(2);
        assert!((found.objective[1] / best - 1.0).abs() < 1e-12, "{:?}", found.objective);
    }

    #[test]
    fn floors_hold_and_shares_sum_to_1() {
        for (shares, floor, expected) in [
            (vec![0.5, 0.5], 0.1, vec![0.5, 0.5]),
            (vec![1.0, 0.0], 0.1, vec![0.95, 0.05]),
            (vec![2.0, 0.0, 0.0, 2.0], 0.4, vec![0.4, 0.1, 0.1, 0.4]),
            // Taking from the third brings it below as well.
            (vec![0.85, 0.0, 0.15], 0.45, vec![0.7, 0.15, 0.15]),
        ] {
            let found = floored(&shares, floor);
            for (a, b) in found.iter().zip(&expected) {
                assert!((a - b).abs() < 1e-15, "{found:?} {expected:?}");
            }
        }
    }

    #[test]
    fn counts_are_whole_and_complete() {
        assert_eq!(counts(&[0.5, 0.3, 0.2], 10), [5, 3, 2]);
        assert_eq!(counts(&[1.0, 1.0, 1.0], 10).iter().sum::<u64>(), 10);
        assert_eq!(counts(&[0.55, 0.25, 0.2], 10), [5, 3, 2]);
        assert_eq!(counts(&[1.0, 1e-9, 0.0], 10), [9, 1, 0]);
        assert_eq!(counts(&[1.0, 1e-9], 1), [1, 0]);
        assert_eq!(counts(&[0.25, 0.75], 1 << 53), [1 << 51, 3 << 51]);
    }
}
