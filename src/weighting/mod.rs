//! Weightings: how samples of several techniques share the integrand.
//!
//! At a point x, technique k has the effective density q_k = α_k p_k(x), α_k being its share of
//! the samples. A weighting gives w_i(x), with Σ w_i = 1 wherever any q_k is positive, and
//! w_i = 0 where q_i = 0 (but for constant weights, which rely on every technique covering f). A
//! sample of technique i contributes w_i f / q_i.
//!
//! Everything is computed from ratios r_k = q_k / max q, which lie in \[0, 1\]: no power or product
//! of densities over- or underflows. Where a density itself leaves the range of `f64`, the
//! estimators form the ratios from logarithms.
//!
//! | weighting | w_i | use |
//! |---|---|---|
//! | [`Balance`] | q_i / Σ q_k | the default; no other is much better |
//! | [`Power`] | q_i^β / Σ q_k^β | one technique is nearly exact somewhere |
//! | [`Cutoff`] | q_i / Σ q_k of those with q_k ≥ a max q | the same |
//! | [`Maximum`] | 1 for the largest q | the limit of the three above |
//! | [`VarianceAware`] | v_i q_i / Σ v_k q_k | a technique is known to be nearly exact, from earlier samples |
//! | [`Constant`] | the same for every x | the cheapest: no other pdf is evaluated; every technique must cover f |
//!
//! Source: E. Veach and L. J. Guibas, *Optimally Combining Sampling Techniques for Monte Carlo
//! Rendering*, SIGGRAPH 1995, doi:10.1145/218380.218498.

mod balance;
mod constant;
mod cutoff;
mod maximum;
mod power;
mod variance_aware;

pub use balance::Balance;
pub use constant::Constant;
pub use cutoff::Cutoff;
pub use maximum::Maximum;
pub use power::Power;
pub use variance_aware::VarianceAware;

use std::fmt::Debug;

use crate::error::ArgumentError;

/// A weighting heuristic.
///
/// The one required method works on the ratios at one point; [`weights`] shows the weights
/// themselves.
///
/// ```
/// use mis::weighting::{Weighting, weights};
///
/// /// The balance heuristic with a confidence v_i in each technique: w_i = v_i q_i / Σ v_k q_k.
/// #[derive(Debug)]
/// struct Confidence(Vec<f64>);
///
/// impl Weighting for Confidence {
///     fn weight_over_ratio(&self, i: usize, r: &[f64]) -> f64 {
///         self.0[i] / self.0.iter().zip(r).map(|(v, r)| v * r).sum::<f64>()
///     }
/// }
/// assert_eq!(weights(&Confidence(vec![3.0, 1.0]), &[1.0, 1.0]), Some(vec![0.75, 0.25]));
/// ```
#[doc(alias("heuristic", "combination"))]
pub trait Weighting: Sync + Debug {
    /// w_i / r_i at a point where technique `i` has just drawn a sample, from all the ratios
    /// r_k = q_k / max q (the largest is exactly 1).
    ///
    /// r_i may have underflowed to 0; the quotient is then the limit, if that is finite. NaN makes
    /// the estimators ask for the logarithm instead.
    fn weight_over_ratio(&self, i: usize, r: &[f64]) -> f64;

    /// ln(w_i / r_i), where r_i may have underflowed but `ln_r`\[i\] has not.
    ///
    /// Override it where the quotient grows without bound as r_i goes to 0.
    fn ln_weight_over_ratio(&self, i: usize, ln_r: &[f64], r: &[f64]) -> f64 {
        let _ = ln_r;
        self.weight_over_ratio(i, r).ln()
    }

    /// w_i / q_i at every point of a block, into `out`; infinite or NaN where q leaves the range in
    /// which the quotient has all its digits, for the estimator to turn to logarithms.
    ///
    /// `r` has room for the ratios at one point.
    fn weight_over_density_batch(
        &self,
        i: usize,
        q: &Densities<'_>,
        r: &mut [f64],
        out: &mut [f64],
    ) {
        by_point(self, i, q, r, out);
    }

    /// w_i, if the weights are the same at every point. Only p_i is then evaluated.
    ///
    /// `alpha` holds the techniques' shares of the samples; one with share 0 takes no part.
    fn constant_weight(&self, i: usize, alpha: &[f64]) -> Option<f64> {
        let _ = (i, alpha);
        None
    }

    /// Whether the weighting fits techniques with these shares of the samples.
    ///
    /// # Errors
    ///
    /// It does not; a list of weights of another length, say.
    fn check(&self, alpha: &[f64]) -> Result<(), ArgumentError> {
        let _ = alpha;
        Ok(())
    }
}

macro_rules! forward {
    ($([$($lifetime:lifetime)?] $pointer:ty),*) => {$(
        impl<$($lifetime,)? W: Weighting + ?Sized> Weighting for $pointer where $pointer: Sync {
            fn weight_over_ratio(&self, i: usize, r: &[f64]) -> f64 {
                (**self).weight_over_ratio(i, r)
            }
            fn ln_weight_over_ratio(&self, i: usize, ln_r: &[f64], r: &[f64]) -> f64 {
                (**self).ln_weight_over_ratio(i, ln_r, r)
            }
            fn weight_over_density_batch(
                &self,
                i: usize,
                q: &Densities<'_>,
                r: &mut [f64],
                out: &mut [f64],
            ) {
                (**self).weight_over_density_batch(i, q, r, out);
            }
            fn constant_weight(&self, i: usize, alpha: &[f64]) -> Option<f64> {
                (**self).constant_weight(i, alpha)
            }
            fn check(&self, alpha: &[f64]) -> Result<(), ArgumentError> {
                (**self).check(alpha)
            }
        }
    )*};
}
forward!(['a] &'a W, [] Box<W>);

/// [`Weighting::weight_over_density_batch`], point by point.
fn by_point<W: Weighting + ?Sized>(
    weighting: &W,
    i: usize,
    q: &Densities<'_>,
    r: &mut [f64],
    out: &mut [f64],
) {
    for (j, out) in out.iter_mut().enumerate() {
        let largest = q.ratios(j, r);
        *out = if SAFE.contains(&largest) {
            weighting.weight_over_ratio(i, r) / largest
        } else {
            f64::NAN
        };
    }
}

/// `xs[i]`; 0 for a technique that there is not.
fn at(xs: &[f64], i: usize) -> f64 {
    xs.get(i).copied().unwrap_or(0.0)
}

/// Where the largest density has a reciprocal that is a normal number with room to spare.
pub(crate) const SAFE: std::ops::Range<f64> = 1e-290..1e290;

/// The effective densities q_k = a_k p_k of all techniques at the points of a block.
#[derive(Debug, Clone, Copy)]
pub struct Densities<'a> {
    factors: &'a [f64],
    pdfs: &'a [f64],
    points: usize,
}

impl<'a> Densities<'a> {
    /// `pdfs` holds a row of `points` densities for each technique.
    pub(crate) fn new(factors: &'a [f64], pdfs: &'a [f64], points: usize) -> Self {
        Self { factors, pdfs, points: points.max(1) }
    }

    /// For each technique, its factor a_k and its pdf at all points of the block.
    pub fn rows(&self) -> impl Iterator<Item = (f64, &'a [f64])> + Clone {
        self.factors.iter().copied().zip(self.pdfs.chunks_exact(self.points))
    }

    /// Puts the ratios q_k / max q at point `j` into `r`; returns max q, NaN if any q is.
    fn ratios(&self, j: usize, r: &mut [f64]) -> f64 {
        let mut largest = 0.0_f64;
        for (r, (a, p)) in r.iter_mut().zip(self.rows()) {
            *r = a * p[j];
            largest = if largest.is_nan() || *r <= largest { largest } else { *r };
        }
        for r in r {
            *r /= largest;
        }
        largest
    }
}

/// The weights w_i of a weighting at a point with effective densities `q`, or `None` if no
/// technique covers the point (all q are 0) or a q is negative or NaN.
///
/// An infinite density takes all the weight; several share it as ties do.
///
/// ```
/// use mis::weighting::{Balance, Power, weights};
/// # fn main() -> Result<(), mis::ArgumentError> {
/// assert_eq!(weights(&Balance, &[1.0, 3.0]), Some(vec![0.25, 0.75]));
/// assert_eq!(weights(&Power::new(2.0)?, &[1e-170, 2e-170]), Some(vec![0.2, 0.8]));
/// assert_eq!(weights(&Balance, &[0.0, 0.0]), None);
/// # Ok(())
/// # }
/// ```
#[must_use]
pub fn weights<W: Weighting + ?Sized>(weighting: &W, q: &[f64]) -> Option<Vec<f64>> {
    let largest = q.iter().try_fold(0.0, |m: f64, q| (*q >= 0.0).then(|| m.max(*q)))?;
    if largest == 0.0 {
        return None;
    }
    let r: Vec<f64> = q
        .iter()
        .map(|q| if largest.is_finite() { q / largest } else { f64::from(*q == largest) })
        .collect();
    let ln_r: Vec<f64> = q
        .iter()
        .zip(&r)
        .map(|(q, r)| if largest.is_finite() { q.ln() - largest.ln() } else { r.ln() })
        .collect();
    let present = vec![1.0; q.len()];
    let weight = |i: usize| {
        if let Some(w) = weighting.constant_weight(i, &present) {
            w
        } else if r[i] == 0.0 && (q[i] == 0.0 || largest.is_infinite()) {
            0.0
        } else {
            let w = weighting.weight_over_ratio(i, &r) * r[i];
            if w.is_nan() {
                (weighting.ln_weight_over_ratio(i, &ln_r, &r) + ln_r[i]).exp()
            } else {
                w
            }
        }
    };
    Some((0..q.len()).map(weight).collect())
}
