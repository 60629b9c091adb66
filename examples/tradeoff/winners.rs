//! Who wins, where, and by how much.

use crate::bars::number;
use crate::entries::Points;
use crate::measure::{Results, Series};

/// A row of the table, in words.
pub(crate) struct Row {
    pub(crate) cells: [String; 7],
}

/// What the columns are.
pub(crate) const HEAD: [&str; 7] = [
    "problem",
    "least error at equal samples (variance below balance)",
    "best at equal time, random points (over balance; over the best single technique)",
    "best at equal time, any points (over balance)",
    "recommended plan ▸",
    "its efficiency over the best with random points",
    "with Sobol’ points, over the best of all",
];

/// Instead of a factor.
const EXACT: &str = "exact";

pub(crate) fn rows(all: &[Results]) -> Vec<Row> {
    all.iter().map(row).collect()
}

fn row(results: &Results) -> Row {
    let balance = results.named("balance");
    let samples = results.series.iter().min_by(|a, b| {
        // Of those that are exact, the fastest.
        let key = |s: &Series| if s.is_exact() { -s.worth() } else { s.error() };
        key(a).total_cmp(&key(b))
    });
    let random = results.best(Series::is_random);
    let any = results.best(|_| true);
    let over = |best: Option<&Series>, other: Option<&Series>, what: fn(&Series) -> f64| match (
        best, other,
    ) {
        (Some(best), Some(_)) if best.is_exact() => EXACT.into(),
        (Some(best), Some(other)) => factor(what(best) / what(other)),
        _ => "none".to_string(),
    };
    let named = |series: Option<&Series>, factor: String| {
        let name = series.map_or("", |series| series.entry.name.as_str());
        format!("{name} ({factor})")
    };
    let variance: fn(&Series) -> f64 = |s| s.error().powi(-2);
    let efficiency: fn(&Series) -> f64 = |s| s.efficiency().0;
    let plan = results.plan();
    let sobol = results.find(|entry| entry.plan && entry.points == Points::Sobol);
    Row {
        cells: [
            results.name.into(),
            named(samples, over(samples, balance, variance)),
            named(
                random,
                match over(random, results.best(Series::is_single), efficiency) {
                    single if single == EXACT => single,
                    single => format!("{}; {single}", over(random, balance, efficiency)),
                },
            ),
            named(any, over(any, balance, efficiency)),
            plan.map_or(String::new(), |plan| plan.entry.name.clone()),
            compared(plan, random),
            compared(sobol, any),
        ],
    }
}

/// A plan's efficiency over the best, unless that is exact and the plan is not.
fn compared(plan: Option<&Series>, best: Option<&Series>) -> String {
    match (plan, best) {
        (Some(plan), Some(best)) if plan.is_exact() == best.is_exact() => {
            number(plan.worth() / best.worth())
        }
        _ => "not exact, the best is".into(),
    }
}

/// "× 12".
fn factor(value: f64) -> String {
    if value < 10.0 {
        format!("×\u{a0}{value:.2}")
    } else if value < 9999.5 {
        format!("×\u{a0}{value:.0}")
    } else {
        format!("×\u{a0}{}", number_large(value))
    }
}

fn number_large(value: f64) -> String {
    let text = format!("{value:.1e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let superscript: String = exponent
        .chars()
        .filter_map(|c| c.to_digit(10))
        .filter_map(|d| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(d as usize))
        .collect();
    format!("{digits}·10{superscript}")
}

/// The columns, in a terminal.
const SHORT: [&str; 6] = [
    "least error, equal samples",
    "best, equal time, random points",
    "best, equal time, any points",
    "recommended plan",
    "  over the best, random points",
    "  with Sobol’, over the best of all",
];

/// The table as text: factors are over balance; the second, over the best single technique.
pub(crate) fn print(rows: &[Row]) {
    println!("Who wins, and by how much\n");
    for row in rows {
        let [problem, rest @ ..] = &row.cells;
        println!("{problem}");
        for (head, cell) in SHORT.iter().zip(rest) {
            // A superscript of a picture is none in a terminal.
            let cell =
                cell.replace("<tspan class='exponent' dy='-4'>", "^").replace("</tspan>", "");
            println!("  {head:<35} {cell}");
        }
    }
}
