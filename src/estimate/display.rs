//! `0.50012(21)`.

use std::fmt::{self, Display};

use super::Estimate;
use crate::integrand::Value;

impl<V: Value> Display for Estimate<V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = f.precision().unwrap_or(2).clamp(1, 17);
        let one = |c| with_error(self.value_of(c), self.error_of(c), digits);
        let text = if V::COMPONENTS == 1 {
            one(0)
        } else {
            let all: Vec<String> = (0..V::COMPONENTS).map(one).collect();
            format!("[{}]", all.join(", "))
        };
        match f.width() {
            Some(width) => write!(f, "{text:>width$}"),
            None => f.write_str(&text),
        }
    }
}

/// `value` with the first `digits` digits of `error` in brackets.
fn with_error(value: f64, error: Option<f64>, digits: usize) -> String {
    let Some(error) = error.filter(|error| error.is_finite() && value.is_finite()) else {
        return format!("{value}(?)");
    };
    if error == 0.0 {
        return format!("{value}(0)");
    }
    // The decimal exponent after rounding to that many digits: 0.0999 is 0.10.
    let exponent = |x: f64, digits: usize| -> i32 {
        let text = format!("{:.*e}", digits - 1, x);
        text.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0)
    };
    let digit = i32::try_from(digits).unwrap_or(2);
    let last = exponent(error, digits) - digit + 1;
    let lead = if value == 0.0 { last } else { exponent(value, 1) }.max(last);
    // Positional while that is short, else scientific with the error in units of the same power.
    let power = if (-5..=15).contains(&lead) { 0 } else { lead };
    let decimals = usize::try_from(power - last).unwrap_or(0);
    let scale = |x: f64| {
        let text = format!("{x:e}");
        match text.split_once('e').and_then(|(m, e)| Some((m, e.parse::<i32>().ok()?))) {
            Some((mantissa, e)) => format!("{mantissa}e{}", e - power).parse().unwrap_or(x),
            None => x,
        }
    };
    let (value, error): (f64, f64) = (scale(value), scale(error));
    let error = if last > power || (error >= 1.0 && decimals > 0) {
        format!("{error:.decimals$}")
    } else {
        // Only the digits, in units of the last decimal of the value.
        let text = format!("{error:.decimals$}");
        text.trim_start_matches(['0', '.']).to_string()
    };
    let suffix = if power == 0 { String::new() } else { format!("e{power}") };
    format!("{value:.decimals$}({error}){suffix}")
}

#[cfg(test)]
mod tests {
    use super::with_error;

    #[test]
    fn value_and_error_end_at_the_same_digit() {
        for (value, error, digits, text) in [
            (0.500_123, 0.000_207, 2, "0.50012(21)"),
            (0.500_123, 0.000_207, 1, "0.5001(2)"),
            (0.500_123, 0.000_999, 2, "0.5001(10)"),
            (-1.0, 0.25, 2, "-1.00(25)"),
            (12.345, 1.234, 2, "12.3(1.2)"),
            (1234.5, 12.34, 2, "1234(12)"),
            (1234.5, 456.7, 2, "1234(457)"),
            (0.0, 0.5, 2, "0.00(50)"),
            (1.0, 123.0, 2, "1(123)"),
            (1.234_567e200, 1.2e197, 2, "1.2346(12)e200"),
            (1.234_567e-200, 1.2e-203, 2, "1.2346(12)e-200"),
            (3e-9, 2e-7, 2, "0(20)e-8"),
            (2.0, 1e-12, 2, "2.0000000000000(10)"),
        ] {
            assert_eq!(with_error(value, Some(error), digits), text, "{value} {error}");
        }
    }

    #[test]
    fn an_unknown_error_is_a_question_mark_and_never_0() {
        assert_eq!(with_error(0.5, None, 2), "0.5(?)");
        assert_eq!(with_error(0.5, Some(f64::INFINITY), 2), "0.5(?)");
        assert_eq!(with_error(2.0, Some(0.0), 2), "2(0)");
    }
}
