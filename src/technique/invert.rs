//! The numerical inversion of a CDF, shared by the techniques that need it.

/// Which tail the function measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    /// A CDF, which does not decrease.
    Lower,
    /// A survival function, which does not increase.
    Upper,
}

/// How many Newton steps may pass without halving the bracket.
const NEWTON_STEPS: u32 = 6;

/// The inverse CDF at u, from the CDF below the median and the survival function above it.
pub(super) fn inverse_cdf(
    u: f64,
    [a, b]: [f64; 2],
    cdf: impl Fn(f64) -> f64,
    survival: impl Fn(f64) -> f64,
    slope: impl Fn(f64) -> f64,
) -> f64 {
    if u == 0.0 {
        a
    } else if u == 1.0 {
        b
    } else if !(0.0..=1.0).contains(&u) {
        f64::NAN
    } else if u <= 0.5 {
        invert(Side::Lower, u, [a, b], cdf, slope)
    } else {
        invert(Side::Upper, 1.0 - u, [a, b], survival, slope)
    }
}

/// The inverse survival function at v, likewise.
pub(super) fn inverse_survival(
    v: f64,
    [a, b]: [f64; 2],
    cdf: impl Fn(f64) -> f64,
    survival: impl Fn(f64) -> f64,
    slope: impl Fn(f64) -> f64,
) -> f64 {
    if v == 0.0 {
        b
    } else if v == 1.0 {
        a
    } else if !(0.0..=1.0).contains(&v) {
        f64::NAN
    } else if v < 0.5 {
        invert(Side::Upper, v, [a, b], survival, slope)
    } else {
        invert(Side::Lower, 1.0 - v, [a, b], cdf, slope)
    }
}

/// The x in \[a, b\] where `tail(x)` passes `target`; `slope` is the density, |d tail / dx|.
///
/// On return one of two holds: `slope(x)` > 0 and |tail(x) - target| is at most `ε · target` or at
/// most `slope(x)` times the spacing of the floats at x; or x is one of two neighbouring floats
/// between which `tail` passes `target`, the one with positive slope if there is one (in a flat
/// stretch these are the floats at its end towards the tail, so x is not in the gap). x lies
/// strictly between a and b if a float does.
///
/// The method is Newton's on ln tail, which is nearly linear in x for the usual tails, kept within
/// a bracket. The bracket lives on the ordered bit patterns of the floats, so that halving it takes
/// at most 64 steps from any two ends, infinite ones included. It is halved when a Newton step is
/// not half as long as the one before, and after six that have not halved it. Hence at most 600
/// evaluations, whatever the functions return, NaN included.
pub(super) fn invert(
    side: Side,
    target: f64,
    [a, b]: [f64; 2],
    tail: impl Fn(f64) -> f64,
    slope: impl Fn(f64) -> f64,
) -> f64 {
    let mut bracket = Bracket::new(a, b);
    let mut x = start(side, target, a, b);
    let mut checkpoint = bracket.width();
    let mut newton_steps = 0;
    let mut last_step = f64::INFINITY;
    let mut nudge = 2_u64;
    while bracket.width() > 1 {
        if !bracket.contains(key(x)) {
            x = float(bracket.inner());
        }
        let k = key(x);
        let t = tail(x);
        let density = slope(x);
        let ratio = (t - target) / target;
        let grain = density * (x.abs().next_up() - x.abs());
        if density > 0.0
            && grain.is_finite()
            && (ratio.abs() <= f64::EPSILON || (t - target).abs() <= grain)
        {
            return x;
        }
        // Where tail = target in a flat stretch, keep the stretch's end towards the tail.
        let above = match side {
            Side::Lower => t >= target,
            Side::Upper => t < target,
        };
        bracket.cut(k, above);
        if bracket.width() <= checkpoint / 2 {
            checkpoint = bracket.width();
            newton_steps = 0;
        }
        // ln(t / target); ln_1p near 0, and not where t / target - 1 rounds to -1.
        let ln = if ratio.abs() < 0.5 { ratio.ln_1p() } else { (t / target).ln() };
        let step = ln * (t / density);
        let next = match side {
            Side::Lower => x - step,
            Side::Upper => x + step,
        };
        let moved = if next.is_finite() { key(next).abs_diff(k) } else { u64::MAX };
        if step.abs() <= 0.5 * last_step && newton_steps < NEWTON_STEPS && moved >= nudge {
            newton_steps += 1;
            last_step = step.abs();
            x = next;
            continue;
        }
        // Newton's method has arrived, or stalls in noise. If it is near, a longer step, and longer
        // each time, reaches the other side, so that the bracket closes; else the bracket is
        // halved.
        last_step = f64::INFINITY;
        newton_steps = 0;
        let reach = nudge.max(moved.saturating_mul(4));
        x = float(if reach < bracket.width() / 2 {
            nudge = reach.saturating_mul(4);
            if above { k.saturating_sub_unsigned(reach) } else { k.saturating_add_unsigned(reach) }
        } else {
            nudge = nudge.min(bracket.width() / 64).max(2);
            bracket.inner()
        });
    }
    let Bracket { low, high, .. } = bracket;
    // A neighbour of an end: prefer what lies strictly inside and has a density.
    let (l, h) = (float(low), float(high));
    let inside = |x: f64| x > a && x < b;
    let first = match side {
        Side::Lower => [h, l],
        Side::Upper => [l, h],
    };
    let candidates = first.into_iter().filter(|&x| inside(x));
    let mut best = f64::NAN;
    for x in candidates {
        if slope(x) > 0.0 {
            return x;
        }
        if best.is_nan() {
            best = x;
        }
    }
    if best.is_nan() { first[0].clamp(a, b) } else { best }
}

/// A first guess: the uniform density's answer on a finite interval, else one unit inside.
fn start(side: Side, target: f64, a: f64, b: f64) -> f64 {
    match (a.is_finite(), b.is_finite(), side) {
        (true, true, Side::Lower) => a + target * (b - a),
        (true, true, Side::Upper) => b - target * (b - a),
        (true, false, _) => a + 1.0,
        (false, true, _) => b - 1.0,
        (false, false, _) => 0.0,
    }
}

/// The position of `x` among the floats: an order-preserving map onto integers.
///
/// Both zeros map to 0; NaN maps beyond the infinities, outside every bracket.
fn key(x: f64) -> i64 {
    let bits = x.to_bits().cast_signed();
    if bits < 0 { i64::MIN.wrapping_sub(bits) } else { bits }
}

/// The inverse of [`key`].
fn float(key: i64) -> f64 {
    let bits = if key < 0 { i64::MIN.wrapping_sub(key) } else { key };
    f64::from_bits(bits.cast_unsigned())
}

/// A bracket of keys. Its first ends are never evaluated: at an infinite end, or at a pole, a
/// function may fail.
struct Bracket {
    low: i64,
    high: i64,
    low_seen: bool,
    high_seen: bool,
    /// How many powers of 2 the next step towards an end that is not yet evaluated may go.
    reach: i64,
}

impl Bracket {
    fn new(a: f64, b: f64) -> Self {
        Self { low: key(a), high: key(b), low_seen: false, high_seen: false, reach: 1 }
    }

    fn width(&self) -> u64 {
        if self.low < self.high { self.low.abs_diff(self.high) } else { 0 }
    }

    fn contains(&self, k: i64) -> bool {
        self.low < k && k < self.high
    }

    /// Makes k the upper end if it is `above` the root, else the lower one.
    fn cut(&mut self, k: i64, above: bool) {
        if above {
            (self.high, self.high_seen) = (k, true);
        } else {
            (self.low, self.low_seen) = (k, true);
        }
    }

    /// The middle of the bracket; while one end is not evaluated, not too far from the other, so
    /// that a function is not called with needlessly extreme arguments.
    fn inner(&mut self) -> i64 {
        let middle = self.low.saturating_add_unsigned(self.width() / 2);
        let reach = self.reach << 52;
        let limited = match (self.low_seen, self.high_seen) {
            (false, true) if self.high != 0 => middle.max(self.high.saturating_sub(reach)),
            (true, false) if self.low != 0 => middle.min(self.low.saturating_add(reach)),
            _ => return middle,
        };
        self.reach = (2 * self.reach).min(1 << 10);
        limited
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn keys_order_the_floats() {
        let xs = [f64::NEG_INFINITY, f64::MIN, -1.0, -5e-324, 0.0, 5e-324, 1.0, f64::INFINITY];
        for w in xs.windows(2) {
            assert!(key(w[0]) < key(w[1]));
        }
        for x in xs {
            assert_eq!(float(key(x)), x);
            assert_eq!(float(key(x.next_up())), x.next_up());
        }
        assert_eq!(key(-0.0), key(0.0));
        assert_eq!(key(1.0_f64.next_up()) - key(1.0), 1);
    }

    fn evaluations(
        side: Side,
        target: f64,
        ends: [f64; 2],
        tail: impl Fn(f64) -> f64,
        slope: impl Fn(f64) -> f64,
    ) -> (f64, u32) {
        let count = Cell::new(0);
        let counted = |x| {
            count.set(count.get() + 1);
            tail(x)
        };
        let x = invert(side, target, ends, counted, slope);
        (x, count.get())
    }

    #[test]
    fn exponential_tails_take_few_steps() {
        let whole = [0.0, f64::INFINITY];
        for v in [0.5, 0.1, 1e-10, 1e-100, 1e-300] {
            let (x, n) = evaluations(Side::Upper, v, whole, |x| (-x).exp(), |x| (-x).exp());
            assert!((x + v.ln()).abs() <= 2.0 * f64::EPSILON * x.max(1.0), "v = {v:e}: {x}");
            assert!(n <= 12, "v = {v:e}: {n} evaluations");
        }
    }

    #[test]
    fn a_jump_is_found_between_neighbours() {
        let jump = 0.3;
        let tail = |x: f64| if x < jump { 0.25 } else { 0.75 };
        let (x, n) = evaluations(Side::Lower, 0.5, [f64::NEG_INFINITY, 10.0], tail, |_| 0.0);
        assert_eq!(x, jump);
        assert!(n <= 600);
    }

    #[test]
    fn of_two_neighbours_the_one_with_a_density_is_taken() {
        let jump = 0.3;
        let tail = |x: f64| if x < jump { 0.25 } else { 0.75 };
        let below = |x: f64| f64::from(x < jump);
        let above = |x: f64| f64::from(x >= jump);
        let x = invert(Side::Lower, 0.5, [0.0, 1.0], tail, below);
        assert_eq!(x, jump.next_down());
        let x = invert(Side::Lower, 0.5, [0.0, 1.0], tail, above);
        assert_eq!(x, jump);
        let x = invert(Side::Upper, 0.5, [0.0, 1.0], |x| 1.0 - tail(x), above);
        assert_eq!(x, jump);
    }

    #[test]
    fn noise_costs_few_evaluations() {
        // Steps of 256 floats, on which Newton's method cannot settle.
        let tail = |x: f64| ((x * 2.0_f64.powi(45)).floor() + 0.5) * 2.0_f64.powi(-45);
        let mut worst = 0;
        for k in 0..100 {
            let u = 0.25 + 0.005 * f64::from(k) + 1e-15;
            let (x, n) = evaluations(Side::Lower, u, [0.0, 1.0], tail, |_| 1.0);
            assert!(tail(x.next_down()) <= u && u <= tail(x.next_up()));
            worst = worst.max(n);
        }
        assert!(worst <= 40, "{worst} evaluations");
    }

    #[test]
    fn functions_that_fail_end_the_search() {
        for value in [f64::NAN, 0.0, 1.0, f64::INFINITY, f64::NEG_INFINITY, 0.5] {
            for slope in [f64::NAN, 0.0, 1.0, -1.0, f64::INFINITY] {
                for ends in [[0.0, 1.0], [f64::NEG_INFINITY, f64::INFINITY], [0.0, f64::INFINITY]] {
                    for side in [Side::Lower, Side::Upper] {
                        let (x, n) = evaluations(side, 0.5, ends, |_| value, |_| slope);
                        assert!(n <= 600 && x >= ends[0] && x <= ends[1] && x.is_finite());
                    }
                }
            }
        }
    }
}
