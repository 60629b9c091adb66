//! The report as a table.

use std::fmt::{self, Display};

use super::report::Report;
use super::status::{Status, Stop};
use crate::estimate::{Estimate, with_error};
use crate::integrand::Value;

impl<V: Value> Display for Report<V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let estimate = self.estimate();
        let level = self.settings.target.level();
        writeln!(f, "{estimate}, {}; {}", word(&self.status), self.stop)?;
        if let Status::Suspect(doubts) = &self.status {
            doubts.iter().try_for_each(|doubt| writeln!(f, "  doubt: {doubt}"))?;
        }
        if let Status::NoSignal { .. } = self.status {
            writeln!(f, "  {}", self.status)?;
        }
        if let Some(error) = &self.checkpoint_error {
            writeln!(f, "  a checkpoint failed: {error}")?;
        }
        for c in 0..V::COMPONENTS {
            let name = if V::COMPONENTS == 1 { String::new() } else { format!(", component {c}") };
            let interval = estimate.interval_of(c, level);
            writeln!(
                f,
                "{} % interval{name}: [{}, {}]",
                short(100.0 * level),
                interval.lower,
                interval.upper
            )?;
        }
        let seconds = self.elapsed.as_secs_f64();
        let rate = self.drawn as f64 / seconds.max(1e-9);
        write!(f, "{} samples", self.samples)?;
        if self.stop == Stop::Tolerance {
            write!(f, ", of which {} confirm and are reported", estimate.samples())?;
        }
        writeln!(f, "; {} in {seconds:.3} s, {rate:.3e} per second", self.drawn)?;
        self.write_rounds(f)?;
        self.write_techniques(f)?;
        self.write_diagnostics(f)?;
        writeln!(f, "\ntarget: {}", self.settings.target)?;
        write!(f, "estimator: {}", self.settings.estimator)?;
        self.settings.others.iter().try_for_each(|(name, value)| write!(f, "\n{name}: {value}"))
    }
}

impl<V: Value> Report<V> {
    fn write_rounds(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let component = if V::COMPONENTS == 1 { "" } else { " (component 0)" };
        writeln!(f, "\nround      samples  {:>22}  {:>22}   chi2/dof{component}", "own", "all")?;
        let own: Vec<(f64, Option<f64>)> =
            self.rounds.iter().map(|round| value_of(&round.estimate)).collect();
        for (number, round) in self.rounds.iter().enumerate() {
            let (value, error) = value_of(&round.estimate);
            let (all, error_of_all) = value_of(&round.cumulative);
            writeln!(
                f,
                "{number:>5} {:>12}  {:>22}  {:>22}   {}",
                round.estimate.samples(),
                with_error(value, error, 2),
                with_error(all, error_of_all, 2),
                chi_squared(own.get(..=number).unwrap_or_default(), all),
            )?;
        }
        Ok(())
    }

    fn write_techniques(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "\ntechnique      samples    value  variance   p agrees, z")?;
        for (i, technique) in self.estimate().techniques().enumerate() {
            let z = self.density_scores().get(i).copied().flatten();
            let per_cent = |share: Option<f64>| or_dash(share.map(|share| 100.0 * share), 1, " %");
            writeln!(
                f,
                "{i:>9} {:>12} {:>8} {:>9}   {:>11}",
                technique.samples,
                per_cent(self.estimate().share_of_value(i, 0)),
                per_cent(self.estimate().share_of_variance(i, 0)),
                or_dash(z, 2, ""),
            )?;
        }
        Ok(())
    }

    fn write_diagnostics(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let estimate = self.estimate();
        writeln!(f, "\ncomponent   kappa   k-hat   largest contribution")?;
        for c in 0..V::COMPONENTS {
            let largest = estimate.largest_of(c).map_or_else(
                || "none".to_owned(),
                |largest| {
                    let share = largest.share_of_value.map(|share| 100.0 * share);
                    format!(
                        "{} of the value, technique {}, sample {}",
                        or_dash(share, 3, " %"),
                        largest.technique,
                        largest.sample
                    )
                },
            );
            writeln!(
                f,
                "{c:>9} {:>7} {:>7}   {largest}",
                or_dash(estimate.kappa_of(c), 3, ""),
                or_dash(self.judged.k_hat(c).map(|(_, k)| k), 2, ""),
            )?;
        }
        writeln!(
            f,
            "\ncontributions that are 0: {}; samples not covered: {}; not finite: {}",
            estimate.zero(),
            estimate.uncovered(),
            estimate.non_finite()
        )
    }
}

fn word(status: &Status) -> &'static str {
    match status {
        Status::Converged => "converged",
        Status::BudgetSpent => "budget spent",
        Status::Cancelled => "cancelled",
        Status::Suspect(_) => "SUSPECT",
        Status::NoSignal { .. } => "NO SIGNAL",
    }
}

/// Of the first component.
fn value_of<V: Value>(estimate: &Estimate<V>) -> (f64, Option<f64>) {
    (estimate.value_of(0), estimate.error_of(0))
}

/// Σ (F_r - F)² / e_r² over the rounds so far, over their number less one.
fn chi_squared(rounds: &[(f64, Option<f64>)], all: f64) -> String {
    let terms = rounds.iter().map(|(value, error)| Some(((value - all) / (*error)?).powi(2)));
    let sum: Option<f64> = terms.sum();
    let freedom = rounds.len().saturating_sub(1);
    or_dash(sum.filter(|_| freedom > 0).map(|sum| sum / freedom as f64), 2, "")
}

fn or_dash(x: Option<f64>, digits: usize, unit: &str) -> String {
    x.filter(|x| !x.is_nan()).map_or_else(|| "-".into(), |x| format!("{x:.digits$}{unit}"))
}

/// Without the digits that are not there: 95, 68.27.
fn short(x: f64) -> String {
    let text = format!("{x:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::{chi_squared, or_dash, short};

    #[test]
    fn numbers_without_digits_that_are_not_there() {
        for (x, text) in [(95.0, "95"), (68.27, "68.27"), (100.0, "100"), (99.9999, "99.9999")] {
            assert_eq!(short(x), text);
        }
        assert_eq!(
            (or_dash(Some(1.256), 2, " %").as_str(), or_dash(None, 2, "")),
            ("1.26 %", "-".into())
        );
        assert_eq!(or_dash(Some(f64::NAN), 2, ""), "-");
    }

    #[test]
    fn chi_squared_over_the_degrees_of_freedom() {
        // (1/0.5)² + (3/1)² + 0, over 2.
        let rounds = [(11.0, Some(0.5)), (7.0, Some(1.0)), (10.0, Some(2.0))];
        assert_eq!(chi_squared(&rounds, 10.0), "6.50");
        assert_eq!(chi_squared(&rounds[..1], 10.0), "-");
        assert_eq!(chi_squared(&[(1.0, None), (2.0, Some(1.0))], 1.0), "-");
        assert_eq!(chi_squared(&[], 1.0), "-");
    }
}
