//! `0.50012(21)`.

use std::fmt::{self, Alignment, Display, Write};
use std::ops::RangeInclusive;

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
        // `Formatter::pad` would cut the text at the precision.
        let padding = f.width().unwrap_or(0).saturating_sub(text.chars().count());
        let before = match f.align() {
            Some(Alignment::Left) => 0,
            Some(Alignment::Center) => padding / 2,
            _ => padding,
        };
        let fill = |f: &mut fmt::Formatter<'_>, n: usize| {
            let fill = f.fill();
            (0..n).try_for_each(|_| f.write_char(fill))
        };
        fill(f, before)?;
        f.write_str(&text)?;
        fill(f, padding - before)
    }
}

/// Decimal exponents between which numbers are printed without an exponent.
const POSITIONAL: RangeInclusive<i32> = -5..=15;

/// `value` with the first `digits` digits of `error` in brackets.
pub(crate) fn with_error(value: f64, error: Option<f64>, digits: usize) -> String {
    let positional = |x: f64| x == 0.0 || POSITIONAL.contains(&exponent(x, 1));
    let alone = if positional(value) { format!("{value}") } else { format!("{value:e}") };
    let Some(error) = error.filter(|error| error.is_finite() && value.is_finite()) else {
        return format!("{alone}(?)");
    };
    if error == 0.0 {
        return format!("{alone}(0)");
    }
    let digit = i32::try_from(digits).unwrap_or(2);
    let mut last = exponent(error, digits) - digit + 1;
    if value != 0.0 {
        // Digits that f64 does not have are not printed.
        last = last.max(exponent(value, 1) - 16);
    }
    let lead = if value == 0.0 { last } else { exponent(value, 1) }.max(last);
    // Positional while that is short, else scientific with the error in units of the same power.
    let power = if POSITIONAL.contains(&lead) { 0 } else { lead };
    let decimals = usize::try_from(power - last).unwrap_or(0);
    let (value, error) = (times_power_of_ten(value, -power), times_power_of_ten(error, -power));
    let text = format!("{error:.decimals$}");
    let error = if error >= 1.0 && decimals > 0 {
        text.as_str()
    } else {
        // Only the digits, in units of the last decimal of the value; an error below that is one.
        match text.trim_start_matches(['0', '.']) {
            "" => "1",
            digits => digits,
        }
    };
    let suffix = if power == 0 { String::new() } else { format!("e{power}") };
    format!("{value:.decimals$}({error}){suffix}")
}

/// The decimal exponent of x ≠ 0 rounded to that many digits: 0.0999 to two is 0.10.
fn exponent(x: f64, digits: usize) -> i32 {
    let text = format!("{:.*e}", digits - 1, x);
    text.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0)
}

/// x · 10^power, to the nearest number.
fn times_power_of_ten(x: f64, power: i32) -> f64 {
    let text = format!("{x:e}");
    let parts = text.split_once('e').and_then(|(m, e)| Some((m, e.parse::<i32>().ok()?)));
    parts.and_then(|(m, e)| format!("{m}e{}", e + power).parse().ok()).unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::with_error;
    use crate::points::Replay;
    use crate::technique::Uniform;
    use crate::{Estimator, MultiSample};

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
        assert_eq!(with_error(1e300, None, 2), "1e300(?)");
        assert_eq!(with_error(2.5e-300, Some(0.0), 2), "2.5e-300(0)");
    }

    #[test]
    fn digits_beyond_those_of_the_value_are_not_printed() {
        assert_eq!(with_error(1.5, Some(3.9e-18), 2), "1.5000000000000000(1)");
        assert_eq!(with_error(1.5, Some(3.9e-16), 2), "1.5000000000000000(4)");
    }

    #[test]
    fn width_alignment_and_precision() {
        let p = Uniform::unit();
        let points = Replay::new([vec![0.25, 0.75]]).unwrap();
        let mis = MultiSample::new(&[(&p, 2)]).unwrap();
        let e = mis.estimate_from(&|x: &f64| *x, &points).unwrap();
        assert_eq!(
            format!("{e:.1}|{e:10}|{e:<10}|{e:*^11}|{e:3}"),
            "0.5(2)|  0.50(25)|0.50(25)  |*0.50(25)**|0.50(25)"
        );
        let e = mis.estimate_from(&|x: &f64| [*x, 2.0], &points).unwrap();
        assert_eq!(e.to_string(), "[0.50(25), 2(0)]");
    }
}
