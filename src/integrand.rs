//! Integrands, and the values that they take.

use std::fmt::Debug;
use std::marker::PhantomData;

/// A function f of a point, to be integrated.
///
/// Closures `|x: &P| value` are integrands. Write the argument's type out: the compiler cannot
/// infer it ("implementation of `FnOnce` is not general enough"). A boxed integrand is passed as
/// `&*boxed`.
///
/// [`batch`] makes one from a closure that evaluates many points at once. A type of your own can
/// implement the trait:
///
/// ```
/// use mis::Integrand;
///
/// struct Tabulated(Vec<f64>);
///
/// impl Integrand<f64> for Tabulated {
///     type Value = f64;
///     fn eval(&self, x: &f64) -> f64 {
///         self.0.get((x * self.0.len() as f64) as usize).copied().unwrap_or(0.0)
///     }
/// }
/// ```
pub trait Integrand<P> {
    /// A number, or several that are integrated on the same samples.
    type Value: Value;

    /// f(x).
    fn eval(&self, x: &P) -> Self::Value;

    /// f at every point of `xs`, into every place of `out`, which has the same length and may hold
    /// the values of other points.
    #[inline]
    fn eval_batch(&self, xs: &[P], out: &mut [Self::Value]) {
        for (f, x) in out.iter_mut().zip(xs) {
            *f = self.eval(x);
        }
    }
}

impl<P, V: Value, F: Fn(&P) -> V> Integrand<P> for F {
    type Value = V;

    fn eval(&self, x: &P) -> V {
        self(x)
    }
}

/// The integrand that `f` evaluates a batch at a time, made by [`batch`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Batch<F, V = f64> {
    f: F,
    value: PhantomData<fn() -> V>,
}

/// An integrand from a closure `|xs: &[P], ys: &mut [V]|` that writes f(x) of each point of `xs` to
/// its place in `ys`, which is as long and holds zeros.
///
/// It is called with up to 512 points, so that it can use vector instructions, or share what its
/// points have in common. What f is at a point must not depend on the others.
///
/// ```
/// use mis::{Estimator, MultiSample, integrand, technique::Uniform};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let p = Uniform::new(0.0, 2.0)?;
/// let f = integrand::batch(|xs: &[f64], ys: &mut [f64]| {
///     for (x, y) in xs.iter().zip(ys) {
///         *y = x * x;
///     }
/// });
/// let estimate = MultiSample::new(&[(&p, 10_000)])?.estimate(&f, 1)?;
/// assert!(estimate.interval(0.999)?.contains(8.0 / 3.0));
/// # Ok(())
/// # }
/// ```
pub fn batch<P, V: Value, F: Fn(&[P], &mut [V])>(f: F) -> Batch<F, V> {
    Batch { f, value: PhantomData }
}

impl<P, V: Value, F: Fn(&[P], &mut [V])> Integrand<P> for Batch<F, V> {
    type Value = V;

    fn eval(&self, x: &P) -> V {
        let mut out = [V::zero()];
        (self.f)(std::slice::from_ref(x), &mut out);
        let [value] = out;
        value
    }

    #[inline]
    fn eval_batch(&self, xs: &[P], out: &mut [V]) {
        // A place that is left out would keep the value of some earlier point.
        clear(out);
        (self.f)(xs, out);
    }
}

/// Makes values 0, by so few at a time that vectors are stored: the C library clears longer ranges
/// by an instruction that is counted once for each byte.
fn clear<V: Value>(values: &mut [V]) {
    for values in values.chunks_mut(64) {
        values.fill(V::zero());
    }
}

/// What an integrand returns: `f64`, `[f64; K]` (a colour, several integrals), or [`LnValue`].
///
/// A value has components; each gets an estimate and an error of its own. A type of your own can
/// be a value as well:
///
/// ```
/// use mis::{Estimator, MultiSample, Value, technique::Uniform};
///
/// #[derive(Debug, Clone)]
/// struct Complex {
///     re: f64,
///     im: f64,
/// }
///
/// impl Value for Complex {
///     const COMPONENTS: usize = 2;
///     type Each<U> = [U; 2]; // re, im
///     fn each<U>(of: impl FnMut(usize) -> U) -> [U; 2] {
///         std::array::from_fn(of)
///     }
///     fn zero() -> Self {
///         Complex { re: 0.0, im: 0.0 }
///     }
///     fn is_finite(&self) -> bool {
///         self.re.is_finite() && self.im.is_finite()
///     }
///     fn times(&self, component: usize, factor: f64) -> f64 {
///         [self.re, self.im].times(component, factor)
///     }
///     fn times_exp(&self, component: usize, ln_factor: f64) -> f64 {
///         [self.re, self.im].times_exp(component, ln_factor)
///     }
/// }
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let p = Uniform::new(0.0, std::f64::consts::PI)?;
/// let f = |t: &f64| Complex { re: t.cos(), im: t.sin() };
/// let [re, im] = MultiSample::new(&[(&p, 10_000)])?.estimate(&f, 1)?.value();
/// assert!(re.abs() < 0.1 && (im - 2.0).abs() < 0.1);
/// # Ok(())
/// # }
/// ```
pub trait Value: Clone + Debug {
    /// How many components a value has.
    const COMPONENTS: usize;

    /// One `U` a component: `U` for a scalar, `[U; K]` for an array.
    type Each<U>;

    /// Collects what `of` says of the components 0, 1, … up to `COMPONENTS` - 1, called in that
    /// order.
    fn each<U>(of: impl FnMut(usize) -> U) -> Self::Each<U>;

    /// The value 0.
    fn zero() -> Self;

    /// Whether every component is finite.
    fn is_finite(&self) -> bool;

    /// A component times `factor`.
    fn times(&self, component: usize, factor: f64) -> f64;

    /// A component times exp(`ln_factor`), where the factor alone may leave the range of `f64`.
    fn times_exp(&self, component: usize, ln_factor: f64) -> f64;
}

impl Value for f64 {
    const COMPONENTS: usize = 1;
    type Each<U> = U;

    fn each<U>(mut of: impl FnMut(usize) -> U) -> U {
        of(0)
    }

    fn zero() -> Self {
        0.0
    }

    fn is_finite(&self) -> bool {
        f64::is_finite(*self)
    }

    fn times(&self, _: usize, factor: f64) -> f64 {
        self * factor
    }

    fn times_exp(&self, _: usize, ln_factor: f64) -> f64 {
        if *self == 0.0 { 0.0 } else { (self.abs().ln() + ln_factor).exp().copysign(*self) }
    }
}

impl<const K: usize> Value for [f64; K] {
    const COMPONENTS: usize = K;
    type Each<U> = [U; K];

    fn each<U>(of: impl FnMut(usize) -> U) -> [U; K] {
        std::array::from_fn(of)
    }

    fn zero() -> Self {
        [0.0; K]
    }

    fn is_finite(&self) -> bool {
        self.iter().all(Value::is_finite)
    }

    fn times(&self, component: usize, factor: f64) -> f64 {
        self[component] * factor
    }

    fn times_exp(&self, component: usize, ln_factor: f64) -> f64 {
        self[component].times_exp(0, ln_factor)
    }
}

/// A number given by its sign and the logarithm of its magnitude, where the number itself would
/// leave the range of `f64`.
///
/// A product of 1000 densities of about 0.1 is 10⁻¹⁰⁰⁰, which is 0 in `f64`; its logarithm is
/// -2302.585. Together with techniques that give [`ln_pdf`](crate::Technique::ln_pdf), such an
/// integrand is estimated like any other.
///
/// ```
/// use mis::LnValue;
/// let f = LnValue::positive(-2302.585);
/// assert_eq!(f.ln_abs(), -2302.585);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LnValue {
    sign: f64,
    ln_abs: f64,
}

impl LnValue {
    /// The positive number exp(`ln_abs`); negative infinity gives 0.
    #[must_use]
    pub fn positive(ln_abs: f64) -> Self {
        Self { sign: 1.0, ln_abs }
    }

    /// The negative number -exp(`ln_abs`).
    #[must_use]
    pub fn negative(ln_abs: f64) -> Self {
        Self { sign: -1.0, ln_abs }
    }

    /// The logarithm of the magnitude.
    #[must_use]
    pub fn ln_abs(&self) -> f64 {
        self.ln_abs
    }
}

impl Value for LnValue {
    const COMPONENTS: usize = 1;
    type Each<U> = U;

    fn each<U>(mut of: impl FnMut(usize) -> U) -> U {
        of(0)
    }

    fn zero() -> Self {
        Self::positive(f64::NEG_INFINITY)
    }

    fn is_finite(&self) -> bool {
        self.ln_abs < f64::INFINITY
    }

    fn times(&self, component: usize, factor: f64) -> f64 {
        self.times_exp(component, factor.abs().ln()) * factor.signum()
    }

    fn times_exp(&self, _: usize, ln_factor: f64) -> f64 {
        if self.ln_abs == f64::NEG_INFINITY {
            0.0
        } else {
            self.sign * (self.ln_abs + ln_factor).exp()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Integrand, LnValue, Value, batch};

    #[test]
    fn closures_of_scalars_and_arrays_are_integrands() {
        fn eval<F: Integrand<f64>>(f: &F, x: f64) -> F::Value {
            let mut out = [F::Value::zero()];
            f.eval_batch(&[x], &mut out);
            let [value] = out;
            value
        }
        assert_eq!(eval(&|x: &f64| x + 1.0, 2.0), 3.0);
        assert_eq!(eval(&|x: &f64| [*x, x * x], 3.0), [3.0, 9.0]);
    }

    #[test]
    fn batches_are_integrands() {
        let f = batch(|xs: &[f64], ys: &mut [[f64; 2]]| {
            ys.iter_mut().zip(xs).for_each(|(y, x)| *y = [*x, x * x]);
        });
        assert_eq!(f.eval(&3.0), [3.0, 9.0]);
        let mut out = [[0.0; 2]; 3];
        f.eval_batch(&[1.0, 2.0, 3.0], &mut out);
        assert_eq!(out, [[1.0, 1.0], [2.0, 4.0], [3.0, 9.0]]);
    }

    #[test]
    fn what_a_batch_leaves_out_is_0() {
        let f = batch(|xs: &[f64], ys: &mut [f64]| {
            ys.iter_mut().zip(xs).filter(|(_, x)| **x > 1.5).for_each(|(y, x)| *y = *x);
        });
        let mut out = [7.0; 3];
        f.eval_batch(&[1.0, 2.0, 3.0], &mut out);
        assert_eq!((out, f.eval(&1.0)), ([0.0, 2.0, 3.0], 0.0));
    }

    #[test]
    fn a_factor_beyond_the_range_is_applied_through_its_logarithm() {
        let x = (1e-200_f64).times_exp(0, 1000.0 * std::f64::consts::LN_10 / 4.0);
        assert!((x / 1e50 - 1.0).abs() < 1e-12, "{x}");
        assert_eq!((-1e-200_f64).times_exp(0, 460.0).signum(), -1.0);
        assert_eq!(0.0_f64.times_exp(0, f64::INFINITY), 0.0);
        assert_eq!([2.0, 0.0].times_exp(1, f64::INFINITY), 0.0);
        assert_eq!(LnValue::zero().times_exp(0, f64::INFINITY), 0.0);
    }

    #[test]
    fn logarithmic_values_keep_their_sign() {
        assert_eq!(LnValue::negative(0.0).times(0, 2.0), -2.0);
        assert_eq!(LnValue::negative(0.0).times(0, -2.0), 2.0);
        assert!((LnValue::positive(-2302.0).times_exp(0, 2302.0) - 1.0).abs() < 1e-15);
        assert!(!LnValue::positive(f64::NAN).is_finite());
        assert!(!LnValue::positive(f64::INFINITY).is_finite());
        assert!(LnValue::positive(f64::NEG_INFINITY).is_finite());
    }
}
