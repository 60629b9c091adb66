//! Piecewise constant densities made from a function.

use super::PiecewiseConstant;
use super::piecewise::OWNER;
use crate::error::{ArgumentError, finite, greater};

impl PiecewiseConstant {
    /// A table of `f` on `bins` equal bins of \[a, b\], made to be a safe proposal for f.
    ///
    /// In each bin the density is proportional to the root mean square of f at the middles of the
    /// four quarters of the bin: the constant that minimises the second moment of f/p. To this
    /// every bin adds 1/100 of the average over all bins, so p is positive on all of \[a, b\], also
    /// where f vanishes at every one of these points and yet not everywhere; and f/p never exceeds
    /// 101 (b - a) sup f. The ends of \[a, b\] are not evaluated.
    ///
    /// Source of the added constant: T. Hesterberg, *Weighted average importance sampling and
    /// defensive mixture distributions*, Technometrics 37 (1995) 185-194.
    ///
    /// # Errors
    ///
    /// `a` and `b` must be finite and b > a; `bins` at least 1, and the bins wider than the
    /// spacing of the floats there. `f` must be finite and not negative, and positive somewhere;
    /// the error names the bin and the point.
    pub fn tabulate(
        a: f64,
        b: f64,
        bins: usize,
        f: impl Fn(f64) -> f64,
    ) -> Result<Self, ArgumentError> {
        finite(OWNER, "a", a)?;
        finite(OWNER, "b", b)?;
        greater(OWNER, "b", b, "a", a)?;
        finite(OWNER, "b - a", b - a)?;
        if bins == 0 {
            return Err(ArgumentError::new(OWNER, "bins", bins, "it must be at least 1"));
        }
        let edge = |k: f64| {
            if k == bins as f64 { b } else { a + (b - a) * (k / bins as f64) }
        };
        let edges: Vec<f64> = (0..=bins).map(|k| edge(k as f64)).collect();
        let mut heights = Vec::with_capacity(bins);
        for (k, pair) in edges.windows(2).enumerate() {
            let mut values = [0.0; 4];
            for (value, part) in values.iter_mut().zip([0.125, 0.375, 0.625, 0.875]) {
                let x = pair[0] + (pair[1] - pair[0]) * part;
                *value = f(x);
                if !(value.is_finite() && *value >= 0.0) {
                    let name = format!("f({x:?}), in bin {k},");
                    let rule = "it must be finite and not negative";
                    return Err(ArgumentError::new(OWNER, name, *value, rule));
                }
            }
            // Relative to the largest, so that the squares neither over- nor underflow.
            let largest = values.into_iter().fold(0.0, f64::max);
            let squares: f64 = values.iter().map(|v| (v / largest).powi(2)).sum();
            heights.push(if largest > 0.0 { largest * (squares / 4.0).sqrt() } else { 0.0 });
        }
        let largest = heights.iter().copied().fold(0.0, f64::max);
        if largest == 0.0 {
            let rule = "it must be positive in some bin";
            return Err(ArgumentError::new(OWNER, "f", 0.0, rule));
        }
        let average = heights.iter().map(|h| h / largest).sum::<f64>() / bins as f64;
        let weights: Vec<f64> = heights.iter().map(|h| h / largest + 0.01 * average).collect();
        Self::new(&edges, &weights)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Technique;
    use super::*;

    #[test]
    fn a_table_follows_the_function_and_stays_positive() {
        let p = PiecewiseConstant::tabulate(0.0, 1.0, 64, |x| x).unwrap();
        for x in [0.3, 0.6, 0.9] {
            assert!((p.pdf(&x) / (2.0 * x) - 1.0).abs() < 0.05);
        }
        // A spike between the points of one bin, beside a plateau.
        let f = |x: f64| {
            if x < 0.5 { 1.0 } else { f64::from((x - 0.75).abs() < 1e-4) }
        };
        let p = PiecewiseConstant::tabulate(0.0, 1.0, 4, f).unwrap();
        assert!(p.pdf(&0.75) > 0.0099 && f(0.75) / p.pdf(&0.75) <= 101.0);
        // An integrable pole at the end is not evaluated.
        let p = PiecewiseConstant::tabulate(0.0, 1.0, 8, |x| x.sqrt().recip()).unwrap();
        assert!(p.pdf(&0.01) > p.pdf(&0.9));
        // Squares of these values over- and underflow.
        for scale in [1e-300, 1e300] {
            let q = PiecewiseConstant::tabulate(0.0, 1.0, 8, |x| scale * x.sqrt().recip()).unwrap();
            assert!((q.pdf(&0.3) / p.pdf(&0.3) - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn errors_name_argument_value_and_rule() {
        let table = |a, b, bins, f: fn(f64) -> f64| {
            PiecewiseConstant::tabulate(a, b, bins, f).unwrap_err().to_string()
        };
        assert!(table(0.0, 1.0, 2, |x| 0.7 - x).contains("`f(0.8125), in bin 1,` is -0.1125"));
        assert!(table(0.0, 1.0, 2, |_| f64::NAN).contains("in bin 0,` is NaN"));
        assert!(table(0.0, 1.0, 0, |x| x).contains("`bins` is 0"));
        assert!(table(0.0, 1.0, 3, |_| 0.0).contains("`f` is 0.0"));
        assert!(table(1.0, 0.0, 3, |x| x).contains("`b` is 0.0"));
        assert!(table(f64::NAN, 0.0, 3, |x| x).contains("`a` is NaN"));
        assert!(table(1.0, 1.0 + 1e-15, 100, |x| x).contains("must be greater than edges["));
    }
}
