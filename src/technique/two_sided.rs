//! Densities whose masses are known on both sides of a point, without subtracting from 1.

use super::batch;

/// A density on the line of which both tails keep their precision.
///
/// [`inverse_cdf_by_sides`] makes it an [`InverseCdf`](super::InverseCdf).
pub(super) trait TwoSided {
    /// The ends of the support.
    fn ends(&self) -> (f64, f64);

    /// The masses below and above `x`, of sum 1.
    fn masses(&self, x: f64) -> (f64, f64);

    /// The x with the mass `below` under it and `above` = 1 - `below` over it, neither of them 0.
    fn place(&self, below: f64, above: f64) -> f64;

    /// [`place`](Self::place) of each canonical number and what it lacks to 1.
    fn places(&self, xi: &[f64], xs: &mut [f64]) {
        batch::places(xi, xs, |u| self.place(u, 1.0 - u));
    }

    /// The same for any masses: an end where one is 0, NaN where they are none.
    fn inverse(&self, below: f64, above: f64) -> f64 {
        // Both: 1 - v of a tiny negative v rounds into the unit interval.
        if !(0.0..=1.0).contains(&below) || !(0.0..=1.0).contains(&above) {
            f64::NAN
        } else if below == 0.0 {
            self.ends().0
        } else if above == 0.0 {
            self.ends().1
        } else {
            self.place(below, above)
        }
    }
}

/// Two masses of sum 1 from roundings of both, whose errors partly cancel in the quotients.
pub(super) fn split(below: f64, above: f64) -> (f64, f64) {
    let sum = below + above;
    if below < above {
        let below = below / sum;
        (below, 1.0 - below)
    } else {
        let above = above / sum;
        (1.0 - above, above)
    }
}

/// Implements [`InverseCdf`](super::InverseCdf) for a [`TwoSided`] density.
macro_rules! inverse_cdf_by_sides {
    ($technique:ty) => {
        impl $crate::technique::InverseCdf for $technique {
            fn cdf(&self, x: f64) -> f64 {
                self.masses(x).0
            }

            fn inverse_cdf(&self, u: f64) -> f64 {
                self.inverse(u, 1.0 - u)
            }

            fn survival(&self, x: f64) -> f64 {
                self.masses(x).1
            }

            fn inverse_survival(&self, v: f64) -> f64 {
                self.inverse(1.0 - v, v)
            }

            fn sample_slice(&self, xi: &[f64], xs: &mut [f64]) {
                self.places(xi, xs);
            }
        }
    };
}
pub(super) use inverse_cdf_by_sides;
