//! Techniques: sampleable pdfs.
//!
//! A technique maps canonical numbers ξ, uniform in the unit cube, to a point x, and knows the
//! density p that the map produces. In other fields it is called a strategy, channel, proposal or
//! importance distribution.

#![expect(
    clippy::inline_always,
    clippy::needless_bitwise_bool,
    reason = "a call or a branch keeps a loop from becoming vector instructions"
)]

mod affine;
mod batch;
mod cauchy;
mod columns;
mod compensated;
pub(crate) mod elementary;
mod exponential;
mod fn_technique;
mod invert;
mod linear;
mod mixture;
mod normal;
mod normal_tail;
mod numeric_inverse;
mod piecewise;
mod power_law;
mod product;
mod rows;
mod statrs;
mod tabulate;
mod truncated;
mod truncated_cauchy;
mod truncated_normal;
mod two_sided;
mod uniform;

pub use affine::Affine;
pub use cauchy::Cauchy;
pub use exponential::Exponential;
pub use fn_technique::FnTechnique;
pub use linear::Linear;
pub use mixture::Mixture;
pub use normal::Normal;
pub use numeric_inverse::NumericInverse;
pub use piecewise::PiecewiseConstant;
pub use power_law::PowerLaw;
pub use product::{Product, ProductVec, UniformBox};
pub use statrs::Statrs;
pub use truncated::Truncated;
pub use truncated_cauchy::TruncatedCauchy;
pub use truncated_normal::TruncatedNormal;
pub use uniform::Uniform;

use crate::vectors::vectorised;

/// A sampleable pdf: a map from canonical numbers to points, and the density that the map
/// produces.
///
/// Laws, for ξ uniform in the open unit cube:
///
/// - [`sample`](Technique::sample) is a pure function: the same ξ give the same x, on every call.
/// - x = `sample(ξ)` has the density [`pdf`](Technique::pdf), in the measure that the type
///   documents, and `pdf` integrates to 1.
/// - `pdf(x)` is finite and positive at every point that `sample` returns, and 0 outside the
///   support. Where it would underflow, [`ln_pdf`](Technique::ln_pdf) is finite.
/// - `sample` and `pdf` do not panic, at ξ = 0 and at ξ = 1 - 2⁻⁵³ either.
///
/// The estimators call the batch methods, once for a few hundred samples, so a
/// `&dyn Technique<Point = P>` costs next to nothing. A point's bits are the same in any batch and
/// alone. Those of this crate's uniform, linear, exponential, power-law, normal and Cauchy densities,
/// truncated or in a product, compile to vector instructions: two numbers at a time on any x86-64,
/// four or eight where `-C target-cpu` allows it, with the same bits.
///
/// # A technique of your own
///
/// ```
/// use mis::technique::Technique;
///
/// /// p(x) = 2x on the unit interval.
/// struct Ramp;
///
/// impl Technique for Ramp {
///     type Point = f64;
///     fn dimension(&self) -> usize {
///         1
///     }
///     fn sample(&self, xi: &[f64]) -> f64 {
///         mis::technique::canonical(xi, 0).sqrt()
///     }
///     fn pdf(&self, x: &f64) -> f64 {
///         if (0.0..=1.0).contains(x) { 2.0 * x } else { 0.0 }
///     }
/// }
/// assert_eq!(Ramp.sample(&[0.25]), 0.5);
/// ```
///
/// Source of the term: E. Veach, *Robust Monte Carlo Methods for Light Transport Simulation*,
/// PhD thesis, Stanford University, 1997, chapter 9.
#[doc(alias("strategy", "channel", "proposal", "distribution"))]
pub trait Technique: Sync {
    /// What is sampled: a number, an array, a direction, any type of yours. Estimators ask that it
    /// is `Debug`, to name a point in their errors.
    type Point;

    /// How many canonical numbers one sample uses; at least 1.
    fn dimension(&self) -> usize;

    /// The point that the canonical numbers `xi` map to.
    ///
    /// `xi` holds [`dimension`](Technique::dimension) numbers; [`canonical`] reads one of them so
    /// that 0, 1 and a missing number do no harm.
    fn sample(&self, xi: &[f64]) -> Self::Point;

    /// p(x), the density of the samples at `x`; 0 outside the support.
    fn pdf(&self, x: &Self::Point) -> f64;

    /// ln p(x); negative infinity outside the support.
    ///
    /// Override it where p can underflow: in many dimensions, far out in a tail, for a narrow
    /// lobe. The estimators turn to it when a density leaves the range of `f64`.
    fn ln_pdf(&self, x: &Self::Point) -> f64 {
        self.pdf(x).ln()
    }

    /// The number of coordinates of a point, where it is known only at run time (a `Vec<f64>`).
    ///
    /// Estimators refuse techniques whose answers differ. `None`, the default, makes no claim.
    fn point_len(&self) -> Option<usize> {
        None
    }

    /// [`sample`](Technique::sample), writing over a point that is already there.
    ///
    /// Override it for points that own memory, so that sampling does not allocate.
    fn sample_into(&self, xi: &[f64], x: &mut Self::Point) {
        *x = self.sample(xi);
    }

    /// Makes the first points of `xs` those of the rows of [`dimension`](Technique::dimension)
    /// numbers in `xi`, one for each row.
    ///
    /// Points that `xs` holds already are written over, in place; further ones may stay.
    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<Self::Point>) {
        let dimension = self.dimension().max(1);
        let old = xs.len().min(xi.len() / dimension);
        let (old, new) = xi.split_at(old * dimension);
        if dimension == 1 {
            // The common case, without the bookkeeping of rows.
            vectorised(
                #[inline(always)]
                || {
                    for (x, u) in xs.iter_mut().zip(old) {
                        self.sample_into(std::slice::from_ref(u), x);
                    }
                },
            );
        } else {
            for (x, row) in xs.iter_mut().zip(old.chunks_exact(dimension)) {
                self.sample_into(row, x);
            }
        }
        xs.extend(new.chunks_exact(dimension).map(|row| self.sample(row)));
    }

    /// [`pdf`](Technique::pdf) of every point of `xs`, into `out` of the same length.
    fn pdf_batch(&self, xs: &[Self::Point], out: &mut [f64]) {
        vectorised(
            #[inline(always)]
            || {
                for (p, x) in out.iter_mut().zip(xs) {
                    *p = self.pdf(x);
                }
            },
        );
    }
}

/// A technique on the real line whose [`sample`](Technique::sample) is the inverse CDF.
///
/// Laws, to rounding: `cdf` and `inverse_cdf` do not decrease; `cdf` goes from 0 to 1;
/// `cdf(inverse_cdf(u)) = u` and `survival(inverse_survival(v)) = v`.
pub trait InverseCdf: Technique<Point = f64> {
    /// P(x) = ∫ p from the lower end of the support to `x`.
    fn cdf(&self, x: f64) -> f64;

    /// The x where `cdf(x) = u`, for u in \[0, 1\]: the ends of the support, which may be infinite,
    /// at 0 and 1; NaN for any other u.
    #[doc(alias("quantile", "ppf"))]
    fn inverse_cdf(&self, u: f64) -> f64;

    /// 1 - P(x), the mass above `x`. Override it where it is known without that cancellation.
    #[doc(alias = "sf")]
    fn survival(&self, x: f64) -> f64 {
        1.0 - self.cdf(x)
    }

    /// The x where `survival(x) = v`, for v in \[0, 1\]; NaN for any other v. Override it where it
    /// is known without computing 1 - v.
    #[doc(alias = "isf")]
    fn inverse_survival(&self, v: f64) -> f64 {
        if (0.0..=1.0).contains(&v) { self.inverse_cdf(1.0 - v) } else { f64::NAN }
    }

    /// The ends of the support, `(inverse_cdf(0), inverse_cdf(1))`.
    fn support(&self) -> (f64, f64) {
        (self.inverse_cdf(0.0), self.inverse_cdf(1.0))
    }

    /// [`sample`](Technique::sample) of each number of `xi`, over the number at its place in `xs`.
    ///
    /// What [`sample_batch`](Technique::sample_batch) is for a block of points, this is for one
    /// coordinate of them: products call it.
    fn sample_slice(&self, xi: &[f64], xs: &mut [f64]) {
        for (x, u) in xs.iter_mut().zip(xi) {
            *x = self.sample(std::slice::from_ref(u));
        }
    }

    /// The points of independent coordinates, from as many rows of `xi`.
    #[doc(hidden)]
    fn sample_rows<P: AsMut<[f64]>>(coordinates: &[Self], xi: &[f64], xs: &mut [P])
    where
        Self: Sized,
    {
        columns::fill_columns(coordinates, xi, xs);
    }

    /// The densities of points of independent coordinates, each as long as `coordinates`.
    #[doc(hidden)]
    fn pdf_rows<P: AsRef<[f64]>>(coordinates: &[Self], xs: &[P], out: &mut [f64])
    where
        Self: Sized,
    {
        columns::densities(coordinates, xs, out);
    }
}

/// Canonical number `d` of `xi`, moved into the open unit interval.
///
/// 0 becomes 2⁻⁵⁴ and 1 becomes 1 - 2⁻⁵³, so that an inverse CDF stays within an infinite
/// support. A missing number is NaN, and so will be the point, which an estimator reports.
///
/// ```
/// use mis::technique::canonical;
/// assert_eq!(canonical(&[0.25], 0), 0.25);
/// assert!(canonical(&[0.0], 0) > 0.0);
/// assert!(canonical(&[1.0], 0) < 1.0);
/// ```
#[must_use]
#[inline]
pub fn canonical(xi: &[f64], d: usize) -> f64 {
    xi.get(d).map_or(f64::NAN, |u| open(*u))
}

/// The smallest canonical number.
const SMALLEST: f64 = f64::EPSILON / 4.0;

/// The largest canonical number.
const LARGEST: f64 = 1.0 - f64::EPSILON / 2.0;

/// `u`, moved into the open unit interval.
#[inline]
fn open(u: f64) -> f64 {
    u.clamp(SMALLEST, LARGEST)
}

macro_rules! forward {
    ($([$($lifetime:lifetime)?] $pointer:ty),*) => {$(
        impl<$($lifetime,)? T: Technique + ?Sized> Technique for $pointer where $pointer: Sync {
            type Point = T::Point;
            fn dimension(&self) -> usize {
                (**self).dimension()
            }
            fn sample(&self, xi: &[f64]) -> Self::Point {
                (**self).sample(xi)
            }
            fn pdf(&self, x: &Self::Point) -> f64 {
                (**self).pdf(x)
            }
            fn ln_pdf(&self, x: &Self::Point) -> f64 {
                (**self).ln_pdf(x)
            }
            fn point_len(&self) -> Option<usize> {
                (**self).point_len()
            }
            fn sample_into(&self, xi: &[f64], x: &mut Self::Point) {
                (**self).sample_into(xi, x);
            }
            fn sample_batch(&self, xi: &[f64], xs: &mut Vec<Self::Point>) {
                (**self).sample_batch(xi, xs);
            }
            fn pdf_batch(&self, xs: &[Self::Point], out: &mut [f64]) {
                (**self).pdf_batch(xs, out);
            }
        }

        impl<$($lifetime,)? T: InverseCdf + ?Sized> InverseCdf for $pointer where $pointer: Sync {
            fn cdf(&self, x: f64) -> f64 {
                (**self).cdf(x)
            }
            fn inverse_cdf(&self, u: f64) -> f64 {
                (**self).inverse_cdf(u)
            }
            fn survival(&self, x: f64) -> f64 {
                (**self).survival(x)
            }
            fn inverse_survival(&self, v: f64) -> f64 {
                (**self).inverse_survival(v)
            }
            fn support(&self) -> (f64, f64) {
                (**self).support()
            }
            fn sample_slice(&self, xi: &[f64], xs: &mut [f64]) {
                (**self).sample_slice(xi, xs);
            }
        }
    )*};
}
forward!(['a] &'a T, [] Box<T>, [] std::sync::Arc<T>);
