//! The tables.

use crate::cells::{Cell, Measured};
use crate::checks::Deviations;
use crate::errors::{Errors, Shot};
use crate::strategies::Strategy;

/// The whole picture: time, errors, efficiency, deviations.
pub(crate) fn picture(shots: &[Shot], errors: &[Errors], deviations: &[Deviations]) {
    println!(
        "{:<11} {:>8} {:>9} {:>18} {:>10} {:>7} {:>18} {:>6} {:>6} {:>9}",
        "strategy",
        "seconds",
        "mean err",
        "RMS error",
        "efficiency",
        "z",
        "bias",
        "block",
        "pixel",
        "beyond 3"
    );
    let worth = |shot: &Shot, errors: &Errors| 1.0 / (errors.squares.value() * shot.seconds);
    let first = shots.iter().zip(errors).next().map_or(f64::NAN, |(s, e)| worth(s, e));
    for ((shot, errors), deviation) in shots.iter().zip(errors).zip(deviations) {
        let mse = errors.squares.value();
        let rmse = mse.max(0.0).sqrt();
        let (bias, error) = deviation.bias;
        println!(
            "{:<11} {:>8.2} {:>7.2} % {:>8.2} +- {:>4.2} % {:>10.2} {:>7.2} {:>7.3} +- {:>5.3} % \
             {:>6.2} {:>6.2} {:>7.2} %",
            shot.strategy.title,
            shot.seconds,
            100.0 * errors.absolute.value(),
            100.0 * rmse,
            100.0 * errors.squares.error() / (2.0 * rmse),
            worth(shot, errors) / first,
            deviation.mean,
            100.0 * bias,
            100.0 * error,
            deviation.block,
            deviation.pixel,
            100.0 * deviation.beyond_3,
        );
    }
}

/// The cells: errors at equal samples, and efficiencies.
pub(crate) fn cells(cells: &[Cell], measured: &[Vec<Measured>], strategies: &[&Strategy]) {
    println!("\nRMS error in %, at equal samples");
    heading(strategies, "least error");
    for (cell, row) in cells.iter().zip(measured) {
        let errors = row.iter().map(|m| significant(100.0 * m.rmse()));
        line(cell, errors, &best(strategies, row, |m| 1.0 / m.variance));
    }
    let base = strategies.iter().position(|s| s.name == "balance").unwrap_or(0);
    let name = strategies.get(base).map_or("", |strategy| strategy.title);
    println!("\nefficiency, 1 / (variance * seconds), relative to {name}");
    heading(strategies, "best at equal time");
    for (cell, row) in cells.iter().zip(measured) {
        let unit = row.get(base).map_or(f64::NAN, Measured::efficiency);
        let efficiencies = row.iter().map(|m| significant(m.efficiency() / unit));
        line(cell, efficiencies, &best(strategies, row, Measured::efficiency));
    }
}

/// The strategy of the most worth, then those that errors of variances do not tell from it.
fn best(strategies: &[&Strategy], row: &[Measured], worth: impl Fn(&Measured) -> f64) -> String {
    let mut ranks: Vec<(&str, f64, f64)> = strategies
        .iter()
        .zip(row)
        .map(|(strategy, m)| (strategy.title, worth(m), worth(m) * m.error / m.variance))
        .collect();
    ranks.sort_by(|(_, a, _), (_, b, _)| b.total_cmp(a));
    let Some(&(name, most, error)) = ranks.first() else { return String::new() };
    let close = |(_, worth, other): &&(&str, f64, f64)| most - worth < 2.0 * error.hypot(*other);
    let others: Vec<&str> = ranks.iter().skip(1).filter(close).map(|(name, ..)| *name).collect();
    if others.is_empty() { name.into() } else { format!("{name} ({})", others.join(", ")) }
}

fn heading(strategies: &[&Strategy], last: &str) {
    print!("{:>8} {:>7}", "exponent", "radius");
    for strategy in strategies {
        print!(" {:>10}", strategy.title);
    }
    println!("  {last}");
}

fn line(cell: &Cell, numbers: impl Iterator<Item = String>, last: &str) {
    print!("{:>8} {:>7.3}", cell.exponent, cell.radius);
    for number in numbers {
        print!(" {number:>10}");
    }
    println!("  {last}");
}

/// A number with three digits.
fn significant(x: f64) -> String {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // At most 5.
    let digits = (2.0 - x.abs().log10().floor()).clamp(0.0, 5.0) as usize;
    format!("{x:.digits$}")
}

/// The largest excess of the variance of optimal MIS over that of the balance heuristic that passes, in
/// standard errors.
const MOST: f64 = 4.0;

/// What the cells must show; an error if they do not.
pub(crate) fn assert_cells(
    cells: &[Cell],
    measured: &[Vec<Measured>],
    strategies: &[&Strategy],
) -> Result<Vec<String>, String> {
    let column = |name: &str| {
        let at = strategies.iter().position(|strategy| strategy.name == name)?;
        Some(measured.iter().filter_map(|row| row.get(at)).copied().collect::<Vec<_>>())
    };
    let mut lines = Vec::new();
    for alone in ["light", "bsdf"] {
        for mis in ["balance", "power", "optimal"] {
            let (Some(single), Some(combined)) = (column(alone), column(mis)) else { continue };
            let rows = cells.iter().zip(single.iter().zip(&combined));
            let worst = rows.max_by(|(_, (a, _)), (_, (b, _))| a.variance.total_cmp(&b.variance));
            let Some((cell, (single, combined))) = worst else { continue };
            let factor = single.rmse() / combined.rmse();
            let line = format!(
                "{mis} is {factor:.0} times better than {alone} alone where that is worst: exponent \
                 {}, radius {}",
                cell.exponent, cell.radius
            );
            if !(factor >= 10.0) {
                return Err(format!("{line}; it must be 10 times"));
            }
            lines.push(line);
        }
    }
    if let (Some(balance), Some(optimal)) = (column("balance"), column("optimal")) {
        let z = balance
            .iter()
            .zip(&optimal)
            .map(|(b, o)| (o.variance - b.variance) / o.error.hypot(b.error));
        let z = z.fold(f64::NEG_INFINITY, f64::max);
        let ratio = balance.iter().zip(&optimal).map(|(b, o)| o.rmse() / b.rmse());
        let ratio = ratio.fold(0.0, f64::max);
        let cost: f64 = optimal.iter().map(|o| o.seconds).sum::<f64>()
            / balance.iter().map(|b| b.seconds).sum::<f64>();
        let line = format!(
            "optimal has at most {ratio:.2} times the error of balance at equal samples ({z:.1} \
             standard errors), at {cost:.1} times its cost"
        );
        if !(z < MOST || ratio * ratio < cost) {
            return Err(format!("{line}; it must not lose more than it costs"));
        }
        lines.push(line);
    }
    Ok(lines)
}
