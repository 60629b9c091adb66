//! The slides' three tables through the public estimators.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "../examples/slides/tables.rs"]
mod tables;

use tables::{PRINTED, XI, table};

/// Half a unit of the last digit that the slides print.
const HALF: f64 = 0.000_5 + 1e-9;

#[test]
fn the_estimates_are_the_printed_ones() {
    for ((number, printed), exact) in
        PRINTED.iter().enumerate().zip([0.4035, 0.5965, 0.527_312_825_874_479])
    {
        let (_, estimate) = table(number, &XI).unwrap();
        assert!((estimate - printed.estimate).abs() <= HALF, "{}: {estimate}", printed.title);
        assert!((estimate - exact).abs() < 1e-12, "{}: {estimate}", printed.title);
    }
}

/// The slides computed their entries from more digits of ξ than they print: each entry must be
/// reached, to the printed rounding, within the rounding of ξ. One entry is cut off, not rounded:
/// 0.99999 is printed as 0.999.
#[test]
fn every_row_agrees_within_the_rounding_of_xi() {
    for (number, printed) in PRINTED.iter().enumerate() {
        let at = |shift: f64| table(number, &XI.map(|xi| xi + shift)).unwrap().0;
        let around = [at(-0.000_5), at(0.0), at(0.000_5)];
        for (r, row) in printed.rows.iter().enumerate() {
            for (column, printed_entry) in row.iter().enumerate() {
                let entries = around.each_ref().map(|rows| rows[r][column]);
                let least = entries.iter().copied().fold(f64::INFINITY, f64::min);
                let most = entries.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let cut_off = (number, r, column) == (0, 0, 2);
                let least = if cut_off { (least * 1000.0).floor() / 1000.0 } else { least };
                assert!(
                    least - HALF <= *printed_entry && *printed_entry <= most + HALF,
                    "{}, row {r}, {}: {entries:?}, printed {printed_entry}",
                    printed.title,
                    printed.columns[column],
                );
            }
        }
    }
}

/// The sums of densities and the contributions do not depend on the missing digits.
#[test]
fn the_combined_contributions_agree_to_the_last_digit() {
    let (rows, _) = table(2, &XI).unwrap();
    for (row, printed) in rows.iter().zip(PRINTED[2].rows) {
        for column in [4, 5] {
            let (entry, printed) = (row[column], printed[column]);
            assert!((entry - printed).abs() <= HALF, "{entry} {printed}");
        }
    }
}
