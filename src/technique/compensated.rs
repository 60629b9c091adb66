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
