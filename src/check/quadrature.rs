//! Quadrature, independent of every technique and every estimator.

use std::f64::consts::{FRAC_PI_2, PI};

/// ∫ f over \[a, b\] by the double-exponential rule: tanh-sinh on finite intervals, exp-sinh on
/// half-infinite ones, with nodes counted from the nearest end. NaN if f is.
///
/// Integrable singularities at the ends do no harm. `scale` is the unit of a half-infinite
/// interval, and unused on a finite one; an interval infinite at both ends must be split.
///
/// Source: H. Takahasi, M. Mori, *Double Exponential Formulas for Numerical Integration*,
/// Publ. RIMS 9 (1974).
pub(super) fn integral(f: &dyn Fn(f64) -> f64, a: f64, b: f64, scale: f64) -> f64 {
    if !(a.is_finite() || b.is_finite()) || a.is_nan() || b.is_nan() {
        return f64::NAN;
    }
    let node = |t: f64| -> f64 {
        if a.is_finite() && b.is_finite() {
            let q = (-PI * t.sinh().abs()).exp();
            let half = 0.5 * b - 0.5 * a; // b - a can overflow
            let distance = half * (2.0 * q / (1.0 + q));
            let weight = half * (2.0 * PI * t.cosh() * q / ((1.0 + q) * (1.0 + q)));
            let x = if t < 0.0 { a + distance } else { b - distance };
            term(f, x.max(a).min(b), weight)
        } else {
            let distance = scale * (FRAC_PI_2 * t.sinh()).exp();
            let weight = distance * FRAC_PI_2 * t.cosh();
            let x = if a.is_finite() { a + distance } else { b - distance };
            term(f, x, weight)
        }
    };
    // Beyond |t| = 6.75 the weights under- or overflow.
    let (mut last, mut step) = (27, 0.25);
    let mut sum: f64 = (-last..=last).map(|k| node(step * f64::from(k))).sum();
    let mut previous = f64::NAN;
    loop {
        let value = step * sum;
        if value.is_nan() || (value - previous).abs() <= 1e-14 * value.abs() || last > 2000 {
            return value;
        }
        previous = value;
        (last, step) = (2 * last, 0.5 * step);
        // Those between the nodes that there are.
        sum += (0..last).map(|k| node(step * f64::from(2 * k + 1 - last))).sum::<f64>();
    }
}

/// f(x) times the weight of the node, 0 where the node has run out of the range of f64.
fn term(f: &dyn Fn(f64) -> f64, x: f64, weight: f64) -> f64 {
    if weight == 0.0 || !weight.is_finite() || !x.is_finite() {
        return 0.0;
    }
    f(x) * weight
}

/// Nodes and weights of the Gauss rule of `order` points on the unit interval.
///
/// The nodes are the zeros of the Legendre polynomial, by Newton's iteration from the estimate
/// cos(π (k - 1/4) / (n + 1/2)).
pub(super) fn gauss(order: usize) -> Vec<(f64, f64)> {
    let n = order as f64;
    (1..=order)
        .map(|k| {
            let mut x = -(PI * (k as f64 - 0.25) / (n + 0.5)).cos();
            for _ in 0..8 {
                let (p, slope) = legendre(order, x);
                x -= p / slope;
            }
            let slope = legendre(order, x).1;
            (0.5 + 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// The Legendre polynomial of this degree at |x| < 1, and its derivative.
fn legendre(degree: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut p) = (0.0, 1.0);
    for k in 0..degree {
        let k = k as f64;
        (previous, p) = (p, ((2.0 * k + 1.0) * x * p - k * previous) / (k + 1.0));
    }
    (p, degree as f64 * (x * p - previous) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::{gauss, integral};
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn double_exponential_rule() {
        for (value, exact) in [
            (integral(&f64::cos, 0.0, FRAC_PI_2, 0.0), 1.0),
            (integral(&|x| x.sqrt().recip(), 0.0, 4.0, 0.0), 4.0),
            (integral(&|x| (-x).exp(), 0.0, f64::INFINITY, 1.0), 1.0),
            (integral(&|x| 1.0 / (1.0 + x * x), f64::NEG_INFINITY, 0.0, 1.0), FRAC_PI_2),
        ] {
            assert!((value / exact - 1.0).abs() < 1e-14, "{value} for {exact}");
        }
        assert!(integral(&|_| 1.0, f64::NEG_INFINITY, f64::INFINITY, 1.0).is_nan());
        assert!(integral(&|_| 1.0, 0.0, f64::NAN, 1.0).is_nan());
        assert!(integral(&|_| f64::NAN, 0.0, 1.0, 1.0).is_nan());
    }

    #[test]
    fn gauss_rules_are_exact_to_twice_their_order() {
        for order in 1..=16 {
            let rule = gauss(order);
            for power in 0..2 * i32::try_from(order).unwrap() {
                let value: f64 = rule.iter().map(|(x, w)| w * x.powi(power)).sum();
                assert!((value * f64::from(power + 1) - 1.0).abs() < 1e-13, "{order} {power}");
            }
        }
        let sine: f64 = gauss(12).iter().map(|(x, w)| w * (PI * x).sin()).sum();
        assert!((sine * FRAC_PI_2 - 1.0).abs() < 1e-14);
    }
}
