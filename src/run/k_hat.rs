//! How heavy the tail of contributions is.

/// The largest number of exceedances that [`k_hat`] uses.
const LONGEST_TAIL: usize = 256;

/// Fewer exceedances than this say nothing about a shape.
const SHORTEST_TAIL: usize = 5;

/// How many exceedances [`k_hat`] uses of `n` non-zero contributions:
/// min(n / 5, 3 √n, 256), rounded down. One magnitude more, the threshold, has to be kept.
fn tail_length(n: u64) -> usize {
    let n = n as f64;
    let length = (n / 5.0).min(3.0 * n.sqrt()).min(LONGEST_TAIL as f64);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 256")]
    let length = length as usize;
    length
}

/// The shape k̂ of the generalised Pareto distribution that fits the largest of `n` magnitudes.
///
/// `largest` are the magnitudes of the largest contributions in any order, at least
/// [`tail_length`] + 1 of them, or all; `n` counts the contributions that are not 0. The magnitudes
/// beyond the threshold, the largest but M, are fitted by the density
/// (1/σ) (1 + k y/σ)^(-1/k - 1). Moments of order 1/k and above are infinite: the variance from
/// k = 1/2 on. Above 0.7, means of practical size are far from normal.
///
/// `None` where there is nothing to fit: less than 5 exceedances, a quarter of them 0 as with the
/// ties of an indicator, or magnitudes that are not finite. Also where k̂ ≥ 1/2 but Σ y² is more than
/// ten times the largest y²: a tail so heavy has few exceedances of the size of its largest (at
/// k = 1/2, Σ 1/i = 6 of them). Many of them, beyond more that are small, are a second cluster of
/// contributions, as when some samples of a technique fall on another's peak.
///
/// The estimate is a posterior mean over a data-driven prior, drawn to 1/2 by a prior worth ten
/// exceedances, (M k̂ + 5) / (M + 10), which steadies it where M is small.
///
/// Sources: J. Zhang and M. A. Stephens, *A New and Efficient Estimation Method for the
/// Generalized Pareto Distribution*, 2009, doi:10.1198/tech.2009.08017 (their k is -k); A.
/// Vehtari, D. Simpson, A. Gelman, Y. Yao and J. Gabry, *Pareto Smoothed Importance Sampling*,
/// 2024, for M, the prior and the bound 0.7.
pub(crate) fn k_hat(largest: &[f64], n: u64) -> Option<f64> {
    let length = tail_length(n).min(largest.len().saturating_sub(1));
    if length < SHORTEST_TAIL || largest.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let mut sorted: Vec<f64> = largest.iter().map(|x| x.abs()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let mut tail = sorted.split_off(sorted.len() - length);
    let threshold = sorted.last()?;
    let range = tail.last()? - threshold;
    // In units of the largest exceedance, nothing over- or underflows.
    for x in &mut tail {
        *x = (*x - threshold) / range;
    }
    let quartile = *tail.get((length + 2) / 4 - 1)?;
    // Not where the range is 0 either: 0 / 0 is NaN.
    if !(quartile > 0.0) {
        return None;
    }

    let count = length as f64;
    let grid = 30 + length.isqrt();
    // Candidates for θ = -k/σ; all are less than 1, the reciprocal of the largest exceedance.
    let theta = |j: usize| 1.0 + (1.0 - (grid as f64 / (j as f64 + 0.5)).sqrt()) / (3.0 * quartile);
    let profile: Vec<(f64, f64)> =
        (0..grid).map(theta).map(|theta| (theta, count * log_likelihood(theta, &tail))).collect();
    let best = profile.iter().fold(f64::NEG_INFINITY, |best, (_, l)| best.max(*l));
    let (mut weights, mut mean) = (0.0, 0.0);
    for (theta, l) in profile {
        let w = (l - best).exp();
        weights += w;
        mean += w * theta;
    }
    let k = shape(mean / weights, &tail);
    let k = (count * k + 5.0) / (count + 10.0);
    let of_the_largest_size: f64 = tail.iter().map(|x| x * x).sum();
    let clusters = k >= 0.5 && of_the_largest_size > 10.0;
    (k.is_finite() && !clusters).then_some(k)
}

/// The k that fits best for θ = -k/σ: the mean of ln(1 - θ x).
fn shape(theta: f64, tail: &[f64]) -> f64 {
    tail.iter().map(|x| (-theta * x).ln_1p()).sum::<f64>() / tail.len() as f64
}

/// The mean log-likelihood with that k, ln(1/σ) - k - 1.
fn log_likelihood(theta: f64, tail: &[f64]) -> f64 {
    let k = shape(theta, tail);
    // σ = -k/θ, towards θ = 0 the mean, as of an exponential distribution.
    let sigma =
        if theta == 0.0 { tail.iter().sum::<f64>() / tail.len() as f64 } else { -k / theta };
    -sigma.ln() - k - 1.0
}

#[cfg(test)]
mod tests {
    use super::{k_hat, tail_length};

    /// The (i + 1/2) / n quantiles of a distribution.
    fn quantiles(n: u32, inverse_cdf: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..n).map(|i| inverse_cdf((f64::from(i) + 0.5) / f64::from(n))).collect()
    }

    /// From an implementation in another language, written from the paper.
    #[test]
    fn agrees_with_reference_values() {
        let pareto = |a: f64| move |u: f64| (1.0 - u).powf(-1.0 / a);
        for (xs, expected) in [
            (quantiles(1000, pareto(1.5)), 0.641_017_670_862_118),
            (quantiles(400, |u| -(-u).ln_1p()), 0.093_622_891_498_921_46),
            (quantiles(100, |u| u), -0.404_621_480_355_222_8),
            (quantiles(25, pareto(0.5)), 0.882_875_415_861_884_4),
            (quantiles(100_000, pareto(4.0)), 0.261_978_435_121_978_6),
        ] {
            let n = xs.len() as u64;
            let k = k_hat(&xs, n).unwrap();
            assert!((k - expected).abs() < 1e-11, "{n}: {k} {expected}");
            // The largest, signed and in another order, are enough.
            let largest: Vec<f64> =
                xs[xs.len() - tail_length(n) - 1..].iter().map(|x| -x).collect();
            assert_eq!(k_hat(&largest, n), Some(k));
            assert_eq!(k_hat(&largest.into_iter().rev().collect::<Vec<_>>(), n), Some(k));
        }
    }

    #[test]
    fn a_second_cluster_is_no_tail() {
        // Every fiftieth contribution is 2, the others are spread over [0, 1].
        let clusters = |n: u32| -> Vec<f64> {
            let one = |k: u32| if k.is_multiple_of(50) { 2.0 } else { f64::from(k % 997) / 997.0 };
            (0..n).map(one).collect()
        };
        assert_eq!(k_hat(&clusters(4000), 4000), None);
        // Fewer than ten of them may be a tail.
        assert!(k_hat(&clusters(400), 400).is_some_and(|k| k > 0.5));
        // And a heavy tail is one, whatever its samples.
        for a in [1.0, 1.5, 2.0] {
            let xs = quantiles(4000, |u| (1.0 - u).powf(-1.0 / a));
            assert!(k_hat(&xs, 4000).is_some_and(|k| k > 0.45), "{a}");
        }
    }

    #[test]
    fn the_length_of_the_tail() {
        for (n, length) in
            [(0, 0), (24, 4), (25, 5), (224, 44), (225, 45), (226, 45), (400, 60), (1000, 94)]
        {
            assert_eq!(tail_length(n), length, "{n}");
        }
        assert_eq!((tail_length(7281), tail_length(7282), tail_length(u64::MAX)), (255, 256, 256));
    }

    #[test]
    fn scale_does_not_matter() {
        let xs = quantiles(200, |u| 1.0 / (1.0 - u));
        let k = k_hat(&xs, 200).unwrap();
        for power in [-1000, 1000] {
            let scaled: Vec<f64> = xs.iter().map(|x| libm::ldexp(*x, power)).collect();
            assert_eq!(k_hat(&scaled, 200), Some(k));
        }
    }

    #[test]
    fn a_candidate_at_exactly_0_is_exponential() {
        // 34 candidates; the ninth is 0 where the quartile is a third of the largest exceedance.
        let mut xs: Vec<f64> = (0..20).map(|i| 1.0 + 3.0 * f64::from(i + 1) / 20.0).collect();
        xs.push(1.0);
        xs[4] = 2.0;
        let k = k_hat(&xs, 100).unwrap();
        xs[4] = 2.0 + 1e-9;
        assert!((k / k_hat(&xs, 100).unwrap() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn nothing_to_fit() {
        let xs = quantiles(1000, |u| u);
        assert!(k_hat(&xs[995..], 1000).is_none());
        assert!(k_hat(&xs[994..], 1000).is_some());
        assert!(k_hat(&xs, 24).is_none());
        assert!(k_hat(&[], 1000).is_none());
        // An indicator; and a tail with a quarter of ties.
        assert!(k_hat(&[1.0; 257], 10_000).is_none());
        let mut ties = xs[979..].to_vec();
        ties[..6].fill(0.9);
        assert!(k_hat(&ties, 100).is_none());
        ties[5] = 0.95;
        assert!(k_hat(&ties, 100).is_some());
        for bad in [f64::NAN, f64::INFINITY] {
            let mut xs = xs.clone();
            xs[3] = bad;
            assert!(k_hat(&xs, 1000).is_none());
        }
        // So far apart that the ratio of two is beyond the range of f64.
        let far: Vec<f64> = (0..21).map(|i| libm::ldexp(1.0, 100 * i - 1050)).collect();
        assert!(k_hat(&far, 100).is_none_or(f64::is_finite));
    }
}
