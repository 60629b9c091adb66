//! Plans as tables, and in words.

use std::fmt::{self, Display};

use super::Method::{Balance, Single};
use super::prediction::{Caution, Prediction};
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
            "\n{:<38} {:>11} {:>7} {:>10} {:>10}  {:<10}  shares",
            "method", "N·variance", "±", "cost", "efficiency", "caution"
        )?;
        let best = self.predictions.iter().map(|p| p.efficiency).fold(0.0, f64::max);
        let mut cautions: Vec<Caution> = Vec::new();
        for p in self.predictions.iter().take(ROWS) {
            let name = format!("{}{}", p.method, if p.optimised { ", optimised" } else { "" });
            let variance = p.variance.first().copied().unwrap_or(f64::NAN);
            let uncertainty = 100.0 * p.uncertainty.first().copied().unwrap_or(f64::NAN);
            let relative = p.efficiency / best;
            let relative = match relative {
                r if r.is_nan() => "-".into(),
                r if r < 1e-3 => format!("{r:.1e}"),
                r => format!("{r:.3}"),
            };
            let caution = p.caution.map_or("", Caution::word);
            cautions.extend(p.caution.filter(|c| cautions.iter().all(|k| k.word() != c.word())));
            writeln!(
                f,
                "{name:<38} {variance:>11.3e} {uncertainty:>6.1}% {:>10.3e} {relative:>10}  {caution:<10}  {}",
                p.cost,
                shares(&p.shares)
            )?;
        }
        if let Some(more) = self.predictions.len().checked_sub(ROWS).filter(|more| *more > 0) {
            writeln!(f, "and {more} more")?;
        }
        for caution in cautions {
            let words = match caution {
                Caution::Biased { .. } => {
                    "it relies on a technique that does not reach all of f".into()
                }
                _ => caution.to_string(),
            };
            writeln!(f, "{}: {words}", caution.word())?;
        }
        f.write_str(
            "±: standard error of the variance, in the pilot\n\
             cost: of a sample; in seconds of one core, unless costs were declared\n\
             efficiency: 1 / (variance · cost), over the best\n",
        )?;
        write!(f, "from {} samples of a pilot", self.pilot_samples)
    }
}

impl Plan {
    fn write_reasons(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "plan: {}", self.method)?;
        let total: f64 = self.counts.iter().map(|n| *n as f64).sum();
        let own: Vec<f64> = self.counts.iter().map(|n| *n as f64 / total).collect();
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
            let times = if times < 1e4 { format!("{times:.2}") } else { format!("{times:.1e}") };
            writeln!(f, "  {times} times the efficiency of {name}")
        };
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
