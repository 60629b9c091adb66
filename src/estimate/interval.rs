//! Confidence intervals.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// A confidence interval.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Interval {
    /// The lower end.
    pub lower: f64,
    /// The upper end.
    pub upper: f64,
}

impl Interval {
    /// Whether `x` lies in the interval, ends included.
    #[must_use]
    pub fn contains(&self, x: f64) -> bool {
        self.lower <= x && x <= self.upper
    }

    /// `value` ± t · error; the whole line without an error. `error` comes with its degrees of
    /// freedom.
    pub(super) fn student(value: f64, error: Option<(f64, f64)>, level: f64) -> Self {
        let half_width = match error {
            Some((0.0, _)) => 0.0,
            Some((error, freedom)) => error * quantile(freedom, level),
            None => f64::INFINITY,
        };
        Self { lower: value - half_width, upper: value + half_width }
    }
}

/// The t with P(|T| ≤ t) = `level`.
///
/// Accurate to 1e-9 relative for levels from 0.1 to 0.999999. From 1000 degrees of freedom on,
/// statrs loses digits (6e-5 relative at 1e6), and an expansion about the normal quantile z takes
/// over: M. Abramowitz and I. A. Stegun, *Handbook of
/// Mathematical Functions*, 1964, formula 26.7.5.
fn quantile(freedom: f64, level: f64) -> f64 {
    let u = 0.5 + 0.5 * level;
    if freedom < 1000.0 {
        return StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |t| t.inverse_cdf(u));
    }
    let z = Normal::standard().inverse_cdf(u);
    let (z2, n) = (z * z, freedom);
    let g1 = (z2 + 1.0) / 4.0;
    let g2 = ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0;
    let g3 = (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0;
    z * (1.0 + (g1 + (g2 + g3 / n) / n) / n)
}

#[cfg(test)]
mod tests {
    use super::{Interval, quantile};

    /// Printed tables of Student's t.
    #[test]
    fn quantiles_agree_with_tables() {
        for (freedom, level, t) in [
            (1.0, 0.5, 1.0),
            (1.0, 0.95, 12.706_204_736_432_1),
            (2.0, 0.95, 4.302_652_729_911_28),
            (5.0, 0.95, 2.570_581_835_636_31),
            (30.0, 0.99, 2.749_995_653_567_23),
            (999.0, 0.95, 1.962_341_461_133_45),
            (1000.0, 0.95, 1.962_339_080_826_41),
            (1e6, 0.95, 1.959_966_356_814_11),
            (1e9, 0.95, 1.959_963_986_912_33),
            (f64::INFINITY, 0.682_689_492_137_086, 1.0),
        ] {
            let q = quantile(freedom, level);
            assert!((q / t - 1.0).abs() < 1e-9, "{freedom} {level}: {q} {t}");
        }
    }

    #[test]
    fn an_unknown_error_leaves_the_whole_line() {
        let interval = Interval::student(1.0, None, 0.95);
        assert!(interval.contains(-1e300) && interval.contains(1e300));
    }
}
