//! Quadrature as an oracle: independent of every technique and every estimator.

use std::f64::consts::{FRAC_PI_2, PI};

/// ∫ f over \[a, b\] by the double-exponential rule: tanh-sinh on finite intervals, exp-sinh on
/// half-infinite ones, with nodes counted from the nearest end.
///
/// Integrable singularities at the ends do no harm. `scale` is the unit of a half-infinite
/// interval, and unused on a finite one; an interval infinite at both ends must be split.
///
/// Source: H. Takahasi, M. Mori, *Double Exponential Formulas for Numerical Integration*,
/// Publ. RIMS 9 (1974).
pub(crate) fn integral(f: &dyn Fn(f64) -> f64, a: f64, b: f64, scale: f64) -> f64 {
    assert!(a.is_finite() || b.is_finite(), "[{a}, {b}] must be split");
    let node = |t: f64| -> f64 {
        if a.is_finite() && b.is_finite() {
            let q = (-PI * t.sinh().abs()).exp();
            let half = 0.5 * b - 0.5 * a; // b - a can overflow
            let distance = half * (2.0 * q / (1.0 + q));
            let weight = half * (2.0 * PI * t.cosh() * q / ((1.0 + q) * (1.0 + q)));
            let x = if t < 0.0 { a + distance } else { b - distance };
            term(f, x.clamp(a, b), weight)
        } else {
            let distance = scale * (FRAC_PI_2 * t.sinh()).exp();
            let weight = distance * FRAC_PI_2 * t.cosh();
            let x = if a.is_finite() { a + distance } else { b - distance };
            term(f, x, weight)
        }
    };
    // Beyond |t| = 6.75 the weights under- or overflow.
    let (mut last, mut step) = (27, 0.25);
    let mut previous = f64::NAN;
    loop {
        let nodes = (-last..=last).map(|k| node(step * f64::from(k)));
        let value = step * nodes.sum::<f64>();
        if (value - previous).abs() <= 1e-14 * value.abs() || last > 2000 {
            return value;
        }
        previous = value;
        (last, step) = (2 * last, 0.5 * step);
    }
}

/// f(x) times the weight of the node, 0 where the node has run out of the range of f64.
fn term(f: &dyn Fn(f64) -> f64, x: f64, weight: f64) -> f64 {
    if weight == 0.0 || !weight.is_finite() || !x.is_finite() {
        return 0.0;
    }
    let value = f(x);
    assert!(!value.is_nan(), "NaN at {x:?}");
    value * weight
}

/// Nodes and weights of the 4-point Gauss rule on `panels` equal parts of the unit interval.
pub(crate) fn gauss(panels: usize) -> Vec<(f64, f64)> {
    const RULE: [(f64, f64); 4] = [
        (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
        (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
        (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    ];
    let width = 1.0 / panels as f64;
    (0..panels)
        .flat_map(|k| RULE.map(|(x, w)| ((k as f64 + 0.5 + 0.5 * x) * width, 0.5 * w * width)))
        .collect()
}
