//! The choice of one of K alternatives by a canonical number.

use crate::error::ArgumentError;

/// So many alternatives are looked through faster than a search finds one.
const FEW: usize = 8;

/// K probabilities and their running sums.
///
/// `select(u)` is k for u from P₀ + ... + Pₖ₋₁, included, to P₀ + ... + Pₖ, excluded, so it is k
/// with probability Pₖ. Where rounding lets the sums end below 1, the last alternative with P > 0
/// takes the rest.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Discrete {
    probabilities: Vec<f64>,
    cumulative: Vec<f64>,
    first: usize,
    last: usize,
}

impl Discrete {
    /// The choice with these `probabilities`; errors name `owner` and `argument`.
    ///
    /// # Errors
    ///
    /// There must be at least one probability; each must be finite and not negative, and their
    /// sum must be 1 to within 4 K ε (ε = 2⁻⁵²): what K roundings and their sum can cost, and
    /// little more.
    pub(crate) fn new(
        owner: &'static str,
        argument: &'static str,
        probabilities: &[f64],
    ) -> Result<Self, ArgumentError> {
        for (k, &p) in probabilities.iter().enumerate() {
            if !(p.is_finite() && p >= 0.0) {
                let rule = "it must be finite and not negative";
                return Err(ArgumentError::new(owner, format!("{argument}[{k}]"), p, rule));
            }
        }
        let mut sum = 0.0;
        let cumulative: Vec<f64> = probabilities
            .iter()
            .map(|p| {
                sum += p;
                sum
            })
            .collect();
        let positive = |&p: &f64| p > 0.0;
        let first = probabilities.iter().position(positive);
        let last = probabilities.iter().rposition(positive);
        let tolerance = 4.0 * probabilities.len() as f64 * f64::EPSILON;
        match (first, last) {
            (Some(first), Some(last)) if (sum - 1.0).abs() <= tolerance => {
                Ok(Self { probabilities: probabilities.to_vec(), cumulative, first, last })
            }
            _ if probabilities.is_empty() => {
                let rule = "there must be at least one";
                Err(ArgumentError::new(owner, argument, probabilities, rule))
            }
            _ => {
                let rule =
                    format!("their sum must be 1 to within {tolerance:e}, and it is {sum:?}");
                Err(ArgumentError::new(owner, argument, probabilities, rule))
            }
        }
    }

    /// P₀, P₁, ...
    pub(crate) fn probabilities(&self) -> &[f64] {
        &self.probabilities
    }

    /// The alternative that `u` picks; never one with P = 0, for any `u`.
    #[inline]
    pub(crate) fn select(&self, u: f64) -> usize {
        // A sum equal to u belongs to the next alternative, so an alternative of probability 0,
        // whose sum equals the one before it, is never the first whose sum exceeds u.
        let k = if self.cumulative.len() <= FEW {
            self.cumulative.iter().filter(|&&c| c <= u).count()
        } else {
            self.cumulative.partition_point(|&c| c <= u)
        };
        k.clamp(self.first, self.last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LARGEST: f64 = 1.0 - f64::EPSILON / 2.0;

    fn discrete(p: &[f64]) -> Discrete {
        Discrete::new("Test", "probabilities", p).unwrap()
    }

    #[test]
    fn selects_by_running_sums() {
        let d = discrete(&[0.25, 0.5, 0.25]);
        assert_eq!(d.probabilities(), [0.25, 0.5, 0.25]);
        for (u, k) in [
            (0.0, 0),
            (0.25_f64.next_down(), 0),
            (0.25, 1),
            (0.75_f64.next_down(), 1),
            (0.75, 2),
            (LARGEST, 2),
            (1.0, 2),
        ] {
            assert_eq!(d.select(u), k, "u = {u:e}");
        }
    }

    #[test]
    fn zero_probabilities_are_never_selected() {
        let p = [0.0, 0.0, 0.5, 0.0, 0.5, 0.0, 0.0];
        let d = discrete(&p);
        for u in [-1.0, 0.0, 5e-324, 0.5_f64.next_down(), 0.5, LARGEST, 1.0, 2.0, f64::NAN] {
            assert!(p[d.select(u)] > 0.0, "u = {u:e}");
        }
        assert_eq!(d.select(0.0), 2);
        assert_eq!(d.select(0.5), 4);
    }

    #[test]
    fn sums_that_round_below_one_end_in_the_last_positive() {
        let mut p = vec![0.1; 10];
        p.push(0.0);
        let d = discrete(&p);
        // Ten times 0.1 sums to 1 - 2⁻⁵³, which is also the largest canonical number.
        assert_eq!(d.cumulative[9], LARGEST);
        assert_eq!(d.select(LARGEST), 9);
    }

    #[test]
    fn a_sum_off_by_rounding_is_accepted_and_more_is_not() {
        for k in [2_usize, 3, 1000] {
            let mut p = vec![1.0 / k as f64; k];
            p[0] += k as f64 * f64::EPSILON;
            assert!(Discrete::new("Test", "p", &p).is_ok());
            p[0] += 20.0 * k as f64 * f64::EPSILON;
            let error = Discrete::new("Test", "p", &p).unwrap_err();
            assert_eq!((error.owner(), error.argument()), ("Test", "p"));
            assert!(error.rule().starts_with("their sum must be 1 to within "));
        }
    }

    #[test]
    fn errors_name_argument_value_and_rule() {
        let message = |p: &[f64]| Discrete::new("Test", "p", p).unwrap_err().to_string();
        assert_eq!(message(&[]), "Test: `p` is [], but there must be at least one");
        assert_eq!(
            message(&[0.5, -0.5, 1.0]),
            "Test: `p[1]` is -0.5, but it must be finite and not negative"
        );
        assert!(message(&[0.5, f64::NAN]).contains("`p[1]` is NaN"));
        assert!(message(&[f64::INFINITY]).contains("`p[0]` is inf"));
        assert!(message(&[0.0, 0.0]).contains("and it is 0.0"));
        assert!(message(&[0.5, 0.25]).contains("and it is 0.75"));
    }
}
