//! Plans as tables, and in words.

use std::fmt::{self, Display};

use super::prediction::Prediction;
use super::{Integral, Plan};
use crate::integrand::Value;

/// Rows of the table, at most.
const ROWS: usize = 24;

/// The reasons in words, then a table of all methods, the best first.
impl Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write_reasons(f)?;
        writeln!(
            f,
            "\n{:<28} {:>10} {:>7} {:>10} {:>10}  shares",
            "method", "N·variance", "±", "cost", "efficiency"
        )?;
        let best = self.predictions.iter().map(|p| p.efficiency).fold(0.0, f64::max);
        for p in self.predictions.iter().take(ROWS) {
            let name = format!("{}{}", p.method, if p.optimised { ", opt." } else { "" });
            write!(f, "{name:<28} ")?;
            let variance = p.variance.first().copied().unwrap_or(f64::NAN);
            let uncertainty = p.uncertainty.first().copied().unwrap_or(f64::NAN);
            write!(f, "{variance:>10.3e} {:>6.1}% {:>10.3e} ", 100.0 * uncertainty, p.cost)?;
            let relative = p.efficiency / best;
            if relative.is_nan() {
                write!(f, "{:>10}", "best")?;
            } else {
                write!(f, "{:>9.2}%", 100.0 * relative)?;
            }
            write!(f, "  {}", shares(&p.shares))?;
            match p.caution {
                Some(caution) => writeln!(f, "  ({caution})")?,
                None => writeln!(f)?,
            }
        }
        if let Some(more) = self.predictions.len().checked_sub(ROWS).filter(|more| *more > 0) {
            writeln!(f, "and {more} more")?;
        }
        write!(f, "from {} samples of a pilot", self.pilot_samples)
    }
}

impl Plan {
    fn write_reasons(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "plan: {}", self.method)?;
        let total: u64 = self.counts.iter().sum();
        let own: Vec<f64> = self.counts.iter().map(|n| *n as f64 / total as f64).collect();
        writeln!(f, ", shares of the samples {}", shares(&own))?;
        let Some(chosen) = self.prediction() else {
            return writeln!(f, "  it is not one of those that were predicted");
        };
        let against = |name: &str, other: Option<&Prediction>, f: &mut fmt::Formatter<'_>| {
            let Some(other) = other.filter(|other| *other != chosen) else { return Ok(()) };
            let times = chosen.efficiency / other.efficiency;
            if times.is_nan() {
                return Ok(());
            }
            writeln!(f, "  {times:.3} times the efficiency of {name}")
        };
        use super::Method::{Balance, Single};
        let find = |is: &dyn Fn(&&Prediction) -> bool| self.predictions.iter().find(is);
        let single = find(&|p| matches!(p.method, Single(_)));
        if let Some(Single(i)) = single.map(|p| &p.method) {
            against(&format!("the best technique alone, {i}"), single, f)?;
        }
        let balance = find(&|p| p.method == Balance && !p.optimised);
        against("the balance heuristic with equal samples", balance, f)?;
        if let Some(caution) = chosen.caution {
            writeln!(f, "  caution: {caution}")?;
        }
        Ok(())
    }
}

/// "0.25, 0.75", and how many more.
fn shares(shares: &[f64]) -> String {
    let mut words: Vec<String> = shares.iter().take(8).map(|share| format!("{share:.3}")).collect();
    if shares.len() > 8 {
        words.push(format!("and {} more", shares.len() - 8));
    }
    words.join(", ")
}

impl<V: Value> Display for Integral<V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { plan, target, report } = self;
        plan.write_reasons(f)?;
        if let Some(prediction) = plan.prediction() {
            let samples = prediction.samples_for(target, &plan.pilot_value);
            if samples.is_finite() && samples > 0.0 {
                writeln!(
                    f,
                    "  predicted: {samples:.2e} samples for the tolerance, before they are confirmed"
                )?;
            }
        }
        write!(f, "\n{report}")
    }
}
