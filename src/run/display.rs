//! The report as a table.

use std::fmt::{self, Display};

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::report::Report;
use super::status::{Status, Stop};
use crate::estimate::{Estimate, with_error};
use crate::integrand::Value;

impl<V: Value> Display for Report<V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let estimate = self.estimate();
        let level = self.settings.target.level();
        writeln!(f, "{estimate}, {}; {}", self.word(), self.stop)?;
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
            let [lower, upper] = [interval.lower, interval.upper].map(|end| {
                // Two digits of the half-width, as of the error.
                let digits = with_error(end, Some(0.5 * (interval.upper - interval.lower)), 2);
                digits.split('(').next().unwrap_or_default().to_owned()
            });
            let level = short(100.0 * level);
            let of = match estimate.replicates() {
                1 => String::new(),
                replicates => format!(", from {replicates} replicates"),
            };
            writeln!(f, "{level} % interval{name}: [{lower}, {upper}]{of}")?;
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
    fn word(&self) -> &'static str {
        match self.status {
            Status::Converged => "converged",
            Status::BudgetSpent => "budget spent",
            Status::Cancelled => "incomplete",
            Status::Suspect(_) => "SUSPECT",
            Status::NoSignal { .. } => "NO SIGNAL",
        }
    }

    fn write_rounds(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let component = if V::COMPONENTS == 1 { "" } else { " (component 0)" };
        writeln!(f, "\nround      samples  {:>22}  {:>22}{component}", "own", "all")?;
        for (number, round) in self.rounds.iter().enumerate() {
            let (value, error) = value_of(&round.estimate);
            let (all, error_of_all) = value_of(&round.cumulative);
            writeln!(
                f,
                "{number:>5} {:>12}  {:>22}  {:>22}",
                round.estimate.samples(),
                with_error(value, error, 2),
                with_error(all, error_of_all, 2),
            )?;
        }
        if let Some((chi2, freedom)) = self.agreement() {
            let q = ChiSquared::new(freedom).map_or(f64::NAN, |law| law.sf(chi2));
            writeln!(
                f,
                "rounds against each other: chi2/dof {:.2}, probability {q:.2}",
                chi2 / freedom
            )?;
        }
        Ok(())
    }

    /// Σ (F_r - F)² / e_r² over the rounds whose error is known, F their mean by numbers of samples,
    /// with their number less one. Not of replicates, whose rounds depend on each other.
    fn agreement(&self) -> Option<(f64, f64)> {
        if self.estimate().replicates() > 1 {
            return None;
        }
        let rounds = || {
            let all = self.rounds.iter().map(|round| {
                let (value, error) = value_of(&round.estimate);
                Some((value, error.filter(|error| *error > 0.0)?, round.estimate.samples() as f64))
            });
            all.flatten()
        };
        let (sum, samples) = rounds().fold((0.0, 0.0), |(s, n), (f, _, m)| (s + m * f, n + m));
        let freedom = rounds().count().checked_sub(1).filter(|freedom| *freedom > 0)?;
        let terms = rounds().map(|(value, error, _)| ((value - sum / samples) / error).powi(2));
        Some((terms.sum(), freedom as f64))
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
        )?;
        if !self.tallied.is_empty() {
            let (sums, misplaced) = (self.tallied.len(), self.misplaced);
            writeln!(f, "sums: {sums}; amounts for sums that there are not: {misplaced}")?;
        }
        Ok(())
    }
}

/// Of the first component.
fn value_of<V: Value>(estimate: &Estimate<V>) -> (f64, Option<f64>) {
    (estimate.value_of(0), estimate.error_of(0))
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
    use super::{or_dash, short};

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
}
