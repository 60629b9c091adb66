//! Piecewise constant densities for use beside other techniques.

use super::PiecewiseConstant;
use super::piecewise::OWNER;
use crate::error::ArgumentError;

impl PiecewiseConstant {
    /// The density less `strength` times its mean, where that is positive: MIS compensation.
    ///
    /// On the support \[a, b\], p' is in proportion to max(0, p - s / (b - a)), s being the strength.
    /// In a mixture, the other techniques already sample what is low and wide, and p' leaves that to
    /// them: beside a uniform technique on \[a, b\] that has the share s of the samples, the mixture is p
    /// again, wherever p is at least s / (b - a). Strength 0 is the table itself, 1 the usual choice.
    /// A table that has nothing above the mean, a constant one, is returned unchanged.
    ///
    /// **The result is 0 where p is low, so alone it does not cover f**, and the constant that
    /// [`tabulate`](PiecewiseConstant::tabulate) adds is gone. Use it only together with techniques that
    /// cover f, and under weights that look at all densities: balance, power, and their like. Alone, or
    /// under [`Constant`](crate::weighting::Constant) weights, the estimate is wrong, and nothing in the
    /// samples tells.
    ///
    /// ```
    /// use mis::technique::{PiecewiseConstant, Technique, Uniform};
    /// use mis::{Estimator, MultiSample};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let f = |x: f64| 1.0 + (-50.0 * (x - 0.4).powi(2)).exp();
    /// let table = PiecewiseConstant::tabulate(0.0, 1.0, 64, f)?;
    /// let peak = table.compensated(1.0)?;
    /// assert_eq!(peak.pdf(&0.9), 0.0);
    ///
    /// let flat = Uniform::unit();
    /// let error = |table: &PiecewiseConstant| {
    ///     let mis = MultiSample::new(&[(table, 4000), (&flat, 4000)])?;
    ///     Ok::<_, Box<dyn std::error::Error>>(mis.estimate(&|x: &f64| f(*x), 1)?.standard_error().unwrap())
    /// };
    /// assert!(error(&table.compensated(0.5)?)? < 0.5 * error(&table)?);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// Source: O. Karlík, M. Šik, P. Vévoda, T. Skřivan and J. Křivánek, *MIS Compensation: Optimizing
    /// Sampling Techniques in Multiple Importance Sampling*, ACM Transactions on Graphics 38(6), 2019.
    ///
    /// # Errors
    ///
    /// `strength` must be in \[0, 1\].
    pub fn compensated(&self, strength: f64) -> Result<Self, ArgumentError> {
        if !(0.0..=1.0).contains(&strength) {
            let rule = "it must be in [0, 1]";
            return Err(ArgumentError::new(OWNER, "strength", strength, rule));
        }
        let edges = self.edges();
        let length = edges[edges.len() - 1] - edges[0];
        let excess = |(probability, [lower, upper]): (f64, [f64; 2])| {
            let excess = probability - strength * ((upper - lower) / length);
            // What the rounding of edges and probabilities can make is none: of a constant table,
            // nothing but that would be left.
            let edge = lower.abs().max(upper.abs()) / length;
            let rounding = 4.0 * f64::EPSILON * (probability + strength * edge);
            if excess > rounding { excess } else { 0.0 }
        };
        let weights: Vec<f64> = self.bins().map(excess).collect();
        if strength == 0.0 || weights.iter().all(|w| *w == 0.0) {
            return Ok(self.clone());
        }
        Self::new(edges, &weights)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{InverseCdf, Technique, Uniform};
    use super::*;
    use crate::points::Random;
    use crate::{Estimator, MultiSample};

    fn table() -> PiecewiseConstant {
        PiecewiseConstant::new(&[0.0, 1.0, 2.0, 4.0], &[1.0, 5.0, 2.0]).unwrap()
    }

    #[test]
    fn what_is_below_the_mean_is_0() {
        // Densities 1/8, 5/8, 1/8 and the mean 1/4.
        let p = table().compensated(1.0).unwrap();
        assert_eq!((p.pdf(&0.5), p.pdf(&1.5), p.pdf(&3.0)), (0.0, 1.0, 0.0));
        assert_eq!(p.support(), (1.0, 2.0));
        let p = PiecewiseConstant::new(&[0.0, 1.0, 2.0, 3.0, 4.0], &[3.0, 0.5, 2.0, 0.5]).unwrap();
        let p = p.compensated(1.0).unwrap();
        // Excesses 3/2, 0, 1/2, 0 over 6.
        for (x, expected) in [(0.5, 0.75), (1.5, 0.0), (2.5, 0.25), (3.5, 0.0)] {
            assert!((p.pdf(&x) - expected).abs() <= 4.0 * f64::EPSILON, "{x}");
        }
    }

    #[test]
    fn constant_tables_stay_as_they_are() {
        let unequal = PiecewiseConstant::new(&[0.0, 0.1, 0.7, 1.0], &[0.1, 0.6, 0.3]).unwrap();
        let tabulated = |a: f64, b: f64| PiecewiseConstant::tabulate(a, b, 97, |_| 0.7).unwrap();
        // Far from 0, edges are rounded and bins are not equally wide.
        for p in [unequal, tabulated(0.0, 1.0), tabulated(-1e9, -1e9 + 1.0), tabulated(3.0, 3.1)] {
            for strength in [0.0, 1.0] {
                assert_eq!(p.compensated(strength).unwrap(), p);
            }
        }
        // Less than the mean of a constant leaves all of it.
        let p = tabulated(0.0, 1.0).compensated(0.5).unwrap();
        assert!((p.pdf(&0.4) - 1.0).abs() <= 1e-14);
        assert_eq!(table().compensated(0.0).unwrap(), table());
    }

    /// With the share s of uniform samples, the mixture is the table: f = p has no variance.
    #[test]
    fn the_mixture_is_the_table() {
        let p = table();
        let compensated = p.compensated(0.25).unwrap();
        let flat = Uniform::new(0.0, 4.0).unwrap();
        for x in [0.5, 1.5, 3.0] {
            let mixture = 0.75 * compensated.pdf(&x) + 0.25 * flat.pdf(&x);
            assert!((mixture / p.pdf(&x) - 1.0).abs() <= 8.0 * f64::EPSILON, "{x}");
        }
        let error = |table: &PiecewiseConstant| {
            let mis = MultiSample::new(&[(table, 750), (&flat, 250)]).unwrap();
            mis.estimate(&|x: &f64| p.pdf(x), 1).unwrap().standard_error().unwrap()
        };
        assert!(error(&compensated) <= 1e-15 && error(&p) > 1e-3);
    }

    /// The trap: alone, and under constant weights, what is 0 in the table is missing.
    #[test]
    fn alone_it_misses_what_it_leaves_to_others() {
        let (peak, flat) = (table().compensated(1.0).unwrap(), Uniform::new(0.0, 4.0).unwrap());
        let one = |_: &f64| 1.0;
        assert_eq!(
            MultiSample::new(&[(&peak, 100)]).unwrap().estimate(&one, 1).unwrap().value(),
            1.0
        );
        let both = MultiSample::new(&[(&peak, 100), (&flat, 100)]).unwrap();
        let constant = both.weighting(crate::weighting::Constant::equal()).unwrap();
        assert_eq!(constant.estimate_from(&one, &Random::new(1)).unwrap().value(), 2.5);
    }

    #[test]
    fn strengths_outside_0_to_1_are_refused() {
        for strength in [f64::NAN, -0.1, 1.1] {
            let error = table().compensated(strength).unwrap_err();
            assert_eq!((error.owner(), error.argument()), ("PiecewiseConstant", "strength"));
        }
    }
}
