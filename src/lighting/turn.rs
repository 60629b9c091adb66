//! Sines and cosines of parts of a turn, without branches.

use crate::technique::elementary::{SHIFT, tan_pi};

/// The sine and the cosine of 2π t, for |t| <= 2²⁰; the sine of a small angle is exact to its own
/// rounding.
///
/// The nearest quarter turns are left out; of what remains, r, they are made of tan(π r).
#[inline(always)]
pub(super) fn sin_cos_of_turn(t: f64) -> (f64, f64) {
    let shifted = 4.0 * t + SHIFT;
    let r = t - 0.25 * (shifted - SHIFT);
    let [s, c] = tan_pi(r);
    let (s2, c2) = (s * s, c * c);
    let scale = 1.0 / (s2 + c2);
    let (sine, cosine) = (2.0 * (s * c) * scale, (c2 - s2) * scale);
    let quarters = shifted.to_bits();
    let (a, b) = if quarters & 1 == 0 { (sine, cosine) } else { (cosine, sine) };
    // The sine is negative in the second half, the cosine in the second and third quarter.
    let sign = |negative: u64| (negative & 2) << 62;
    let flipped = |x: f64, negative: u64| f64::from_bits(x.to_bits() ^ sign(negative));
    (flipped(a, quarters), flipped(b, quarters.wrapping_add(1)))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::sin_cos_of_turn;

    /// sin 2πt and cos 2πt by libm, of what is left of t without the nearest quarters of a turn: 2π t itself
    /// would lose digits.
    fn reference(t: f64) -> (f64, f64) {
        let quarters = (4.0 * t).round();
        let (s, c) = (2.0 * PI * (t - 0.25 * quarters)).sin_cos();
        match quarters.rem_euclid(4.0) {
            0.0 => (s, c),
            1.0 => (c, -s),
            2.0 => (-s, -c),
            _ => (-c, s),
        }
    }

    #[test]
    fn turns_to_a_few_ulp() {
        for (a, b) in [(0.0, 1.0), (-1.0, 0.0), (1e-9, 1e-3), (0.2499, 0.2501), (1e5, 1e5 + 1.0)] {
            let (mut relative, mut absolute, mut norm) = (0.0_f64, 0.0_f64, 0.0_f64);
            for k in 0..=200_000 {
                let t = a + (b - a) * f64::from(k) / 2e5;
                let (s, c) = sin_cos_of_turn(t);
                let (sine, cosine) = reference(t);
                for (y, exact) in [(s, sine), (c, cosine)] {
                    absolute = absolute.max((y - exact).abs());
                    if exact != 0.0 {
                        relative = relative.max((y / exact - 1.0).abs());
                    }
                }
                norm = norm.max((s * s + c * c - 1.0).abs());
            }
            let worst = [relative, absolute, norm].map(|error| error / f64::EPSILON);
            let allowed = [4.0, 2.0, 3.0]; // of which 2π t has one
            let within = worst.iter().zip(allowed).all(|(error, allowed)| *error <= allowed);
            assert!(within, "{worst:?} in [{a}, {b}]");
        }
    }

    #[test]
    fn small_turns_keep_their_digits() {
        for k in 1..1000 {
            let t = 0.77_f64.powi(k);
            for t in [t, -t] {
                let (s, c) = sin_cos_of_turn(t);
                let (sine, cosine) = reference(t);
                assert!((s / sine - 1.0).abs() <= 4.0 * f64::EPSILON, "{t}: {s} for {sine}");
                assert!((c / cosine - 1.0).abs() <= 4.0 * f64::EPSILON, "{t}: {c}");
            }
        }
        // Below the rounding of 1.
        assert_eq!(sin_cos_of_turn(1e-300), (2e-300 * PI, 1.0));
    }

    #[test]
    fn quarters_of_a_turn_are_exact() {
        for turns in [0.0, 1.0, -1.0, 7.0, -1024.0, 1_048_575.0] {
            for (t, expected) in [
                (turns, (0.0, 1.0)),
                (turns + 0.25, (1.0, 0.0)),
                (turns + 0.5, (0.0, -1.0)),
                (turns + 0.75, (-1.0, 0.0)),
            ] {
                assert_eq!(sin_cos_of_turn(t), expected, "{t}"); // -0 equals 0
            }
        }
        let (s, c) = sin_cos_of_turn(0.125);
        assert!((s - c).abs() <= f64::EPSILON && s > 0.0, "{s} {c}");
        for t in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let (s, c) = sin_cos_of_turn(t);
            assert!(s.is_nan() && c.is_nan(), "{t}: {s} {c}");
        }
    }
}
