//! Products of independent coordinates: arrays of fixed length, vectors of run-time length, boxes.

use super::columns::{density, ln_density};
use super::{InverseCdf, Technique, Uniform};
use crate::error::{ArgumentError, finite, greater};

/// The density of D independent coordinates, with respect to Lebesgue measure on R^D.
///
/// p(x) = p₁(x₁) p₂(x₂) ...; each coordinate is sampled by its own inverse CDF from its own
/// canonical number. ln p is the sum of their logarithms, which is finite where the product of many
/// small densities is 0 in f64.
///
/// Coordinates of different types go into one product as `Box<dyn InverseCdf>` or
/// `&dyn InverseCdf`.
///
/// ```
/// use mis::technique::{Affine, InverseCdf, Product, Technique, Uniform};
/// # fn main() -> Result<(), mis::ArgumentError> {
/// let stretched = Affine::new(Uniform::unit(), -1.0, 2.0)?;
/// let coordinates: [&dyn InverseCdf; 2] = [&Uniform::unit(), &stretched];
/// let p = Product::new(coordinates)?;
/// assert_eq!(p.sample(&[0.25, 0.75]), [0.25, 0.5]);
/// assert_eq!(p.pdf(&[0.25, 0.5]), 0.5);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Product<T, const D: usize> {
    coordinates: [T; D],
}

/// The uniform density on a box in D dimensions; see [`Product::uniform`].
pub type UniformBox<const D: usize> = Product<Uniform, D>;

impl<T: InverseCdf, const D: usize> Product<T, D> {
    /// The product of the densities of the `coordinates`.
    ///
    /// # Errors
    ///
    /// D must be at least 1.
    pub fn new(coordinates: [T; D]) -> Result<Self, ArgumentError> {
        not_empty("Product", D)?;
        Ok(Self { coordinates })
    }

    /// The densities of the coordinates.
    #[must_use]
    pub fn coordinates(&self) -> &[T; D] {
        &self.coordinates
    }
}

impl<const D: usize> Product<Uniform, D> {
    /// The uniform density on the box from `lower` to `upper`: p(x) = Π 1 / (upper\[d\] -
    /// lower\[d\]).
    ///
    /// ```
    /// use mis::technique::{Technique, UniformBox};
    /// # fn main() -> Result<(), mis::ArgumentError> {
    /// let p = UniformBox::uniform([0.0, -1.0], [2.0, 1.0])?;
    /// assert_eq!(p.pdf(&[1.0, 0.0]), 0.25);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// D must be at least 1. Bounds must be finite, each upper one greater than the lower one, and
    /// their difference must neither overflow nor be subnormal.
    pub fn uniform(lower: [f64; D], upper: [f64; D]) -> Result<Self, ArgumentError> {
        not_empty("Product", D)?;
        let mut coordinates = [Uniform::unit(); D];
        for (d, coordinate) in coordinates.iter_mut().enumerate() {
            *coordinate = side("Product", d, lower[d], upper[d])?;
        }
        Ok(Self { coordinates })
    }
}

impl<T: InverseCdf, const D: usize> Technique for Product<T, D> {
    type Point = [f64; D];

    fn dimension(&self) -> usize {
        D
    }

    fn sample(&self, xi: &[f64]) -> [f64; D] {
        let mut x = [0.0; D];
        fill(&self.coordinates, xi, &mut x);
        x
    }

    fn pdf(&self, x: &[f64; D]) -> f64 {
        density(&self.coordinates, x)
    }

    fn ln_pdf(&self, x: &[f64; D]) -> f64 {
        ln_density(&self.coordinates, x)
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<[f64; D]>) {
        let n = xi.len() / D.max(1);
        if xs.len() < n {
            xs.resize(n, [0.0; D]);
        }
        T::sample_rows(&self.coordinates, xi, &mut xs[..n]);
    }

    fn pdf_batch(&self, xs: &[[f64; D]], out: &mut [f64]) {
        T::pdf_rows(&self.coordinates, xs, out);
    }
}

/// The density of independent coordinates whose number is known at run time, with respect to
/// Lebesgue measure; otherwise as [`Product`].
///
/// The density of a point of another length is NaN. [`sample_into`](Technique::sample_into) writes
/// over the point's memory and does not allocate.
///
/// ```
/// use mis::technique::{ProductVec, Technique, Uniform};
/// # fn main() -> Result<(), mis::ArgumentError> {
/// let p = ProductVec::new(vec![Uniform::new(0.0, 10.0)?; 1000])?;
/// let x = p.sample(&[0.5; 1000]);
/// assert_eq!(p.pdf(&x), 0.0);
/// assert!((p.ln_pdf(&x) + 1000.0 * 10.0_f64.ln()).abs() < 1e-9);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ProductVec<T> {
    coordinates: Vec<T>,
}

impl<T: InverseCdf> ProductVec<T> {
    /// The product of the densities of the `coordinates`.
    ///
    /// # Errors
    ///
    /// There must be at least one coordinate.
    pub fn new(coordinates: Vec<T>) -> Result<Self, ArgumentError> {
        not_empty("ProductVec", coordinates.len())?;
        Ok(Self { coordinates })
    }

    /// The densities of the coordinates.
    #[must_use]
    pub fn coordinates(&self) -> &[T] {
        &self.coordinates
    }
}

impl ProductVec<Uniform> {
    /// The uniform density on the box from `lower` to `upper`: p(x) = Π 1 / (upper\[d\] -
    /// lower\[d\]).
    ///
    /// # Errors
    ///
    /// There must be as many upper as lower bounds, and at least one. They must be finite, each
    /// upper one greater than the lower one, and their difference must neither overflow nor be
    /// subnormal.
    pub fn uniform(lower: &[f64], upper: &[f64]) -> Result<Self, ArgumentError> {
        not_empty("ProductVec", lower.len())?;
        if upper.len() != lower.len() {
            let rule = format!("it must equal the length of lower = {}", lower.len());
            return Err(ArgumentError::new("ProductVec", "length of upper", upper.len(), rule));
        }
        let sides = lower.iter().zip(upper).enumerate();
        let coordinates: Result<_, _> =
            sides.map(|(d, (&a, &b))| side("ProductVec", d, a, b)).collect();
        Ok(Self { coordinates: coordinates? })
    }
}

impl<T: InverseCdf> Technique for ProductVec<T> {
    type Point = Vec<f64>;

    fn dimension(&self) -> usize {
        self.coordinates.len()
    }

    fn sample(&self, xi: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; self.coordinates.len()];
        fill(&self.coordinates, xi, &mut x);
        x
    }

    fn pdf(&self, x: &Vec<f64>) -> f64 {
        if x.len() == self.coordinates.len() { density(&self.coordinates, x) } else { f64::NAN }
    }

    fn ln_pdf(&self, x: &Vec<f64>) -> f64 {
        if x.len() == self.coordinates.len() { ln_density(&self.coordinates, x) } else { f64::NAN }
    }

    fn point_len(&self) -> Option<usize> {
        Some(self.coordinates.len())
    }

    fn sample_into(&self, xi: &[f64], x: &mut Vec<f64>) {
        x.resize(self.coordinates.len(), 0.0);
        fill(&self.coordinates, xi, x);
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<Vec<f64>>) {
        let n = xi.len() / self.coordinates.len();
        if xs.len() < n {
            xs.resize_with(n, Vec::new);
        }
        for x in &mut xs[..n] {
            x.resize(self.coordinates.len(), 0.0);
        }
        T::sample_rows(&self.coordinates, xi, &mut xs[..n]);
    }

    fn pdf_batch(&self, xs: &[Vec<f64>], out: &mut [f64]) {
        if xs.iter().all(|x| x.len() == self.coordinates.len()) {
            T::pdf_rows(&self.coordinates, xs, out);
        } else {
            for (p, x) in out.iter_mut().zip(xs) {
                *p = self.pdf(x);
            }
        }
    }
}

fn not_empty(owner: &'static str, len: usize) -> Result<(), ArgumentError> {
    if len == 0 {
        let rule = "it must be at least 1";
        return Err(ArgumentError::new(owner, "number of coordinates", len, rule));
    }
    Ok(())
}

/// One side of a box.
fn side(owner: &'static str, d: usize, a: f64, b: f64) -> Result<Uniform, ArgumentError> {
    finite(owner, format!("lower[{d}]"), a)?;
    finite(owner, format!("upper[{d}]"), b)?;
    greater(owner, format!("upper[{d}]"), b, format!("lower[{d}]"), a)?;
    Uniform::new(a, b).map_err(|_| {
        let rule = "it must be within the range of normal numbers";
        ArgumentError::new(owner, format!("upper[{d}] - lower[{d}]"), b - a, rule)
    })
}

fn fill<T: InverseCdf>(coordinates: &[T], xi: &[f64], x: &mut [f64]) {
    for (d, (x, t)) in x.iter_mut().zip(coordinates).enumerate() {
        *x = t.sample(xi.get(d..=d).unwrap_or_default());
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Affine, FnTechnique, Technique};
    use super::*;

    #[test]
    fn coordinates_use_their_own_numbers() {
        let p = UniformBox::uniform([0.0, 10.0, -4.0], [1.0, 20.0, 0.0]).unwrap();
        let x = p.sample(&[0.5, 0.25, 0.75]);
        assert_eq!(x, [0.5, 12.5, -1.0]);
        assert_eq!(p.pdf(&x), 1.0 / 40.0);
        assert_eq!((p.dimension(), p.point_len()), (3, None));
        assert_eq!(p.pdf(&[0.5, 9.0, -1.0]), 0.0);
        assert_eq!(p.ln_pdf(&[0.5, 9.0, -1.0]), f64::NEG_INFINITY);
        let v = ProductVec::uniform(&[0.0, 10.0, -4.0], &[1.0, 20.0, 0.0]).unwrap();
        assert_eq!(v.sample(&[0.5, 0.25, 0.75]), x);
        assert_eq!(v.pdf(&x.to_vec()), p.pdf(&x));
        assert_eq!((v.dimension(), v.point_len()), (3, Some(3)));
    }

    #[test]
    fn heterogeneous_coordinates() {
        let wide = Affine::new(Uniform::unit(), 0.0, -4.0).unwrap();
        let boxed: Vec<Box<dyn InverseCdf>> = vec![Box::new(wide), Box::new(Uniform::unit())];
        let p = ProductVec::new(boxed).unwrap();
        assert_eq!(p.sample(&[0.25, 0.25]), [-3.0, 0.25]);
        assert_eq!(p.pdf(&vec![-3.0, 0.25]), 0.25);
    }

    #[test]
    fn logarithms_carry_what_the_product_cannot() {
        let p = ProductVec::new(vec![Uniform::new(0.0, 10.0).unwrap(); 1000]).unwrap();
        let x = p.sample(&vec![0.3; 1000]);
        assert_eq!(p.pdf(&x), 0.0);
        assert!((p.ln_pdf(&x) + 2_302.585_092_994_045_7).abs() < 1e-10);
        // Underflow and overflow on the way to a density of 1.
        let (small, large) =
            (Uniform::new(0.0, 1e200).unwrap(), Uniform::new(0.0, 1e-200).unwrap());
        for sides in [[small, small, large, large], [large, large, small, small]] {
            let p = Product::new(sides).unwrap();
            let x = p.sample(&[0.5; 4]);
            assert!((p.pdf(&x) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn outside_one_support_is_outside_whatever_the_others() {
        let pole = FnTechnique::new([0.0, 1.0], |x| 0.5 / x.sqrt(), f64::sqrt, |u| u * u).unwrap();
        let unit = Uniform::unit();
        let coordinates: [&dyn InverseCdf; 2] = [&pole, &unit];
        let p = Product::new(coordinates).unwrap();
        assert_eq!((p.pdf(&[0.0, 2.0]), p.ln_pdf(&[0.0, 2.0])), (0.0, f64::NEG_INFINITY));
    }

    #[test]
    fn points_keep_their_memory() {
        let p = ProductVec::new(vec![Uniform::unit(); 5]).unwrap();
        let mut x = Vec::with_capacity(5);
        let memory = x.as_ptr();
        p.sample_into(&[0.5; 5], &mut x);
        p.sample_into(&[0.25; 5], &mut x);
        assert_eq!((x.as_ptr(), x), (memory, vec![0.25; 5]));
        let mut longer = vec![9.0; 7];
        p.sample_into(&[0.5; 5], &mut longer);
        assert_eq!(longer, [0.5; 5]);
    }

    #[test]
    fn wrong_lengths_give_nan() {
        let p = ProductVec::new(vec![Uniform::unit(); 2]).unwrap();
        for x in [vec![], vec![0.5], vec![0.5; 3]] {
            assert!(p.pdf(&x).is_nan() && p.ln_pdf(&x).is_nan());
        }
        let x = p.sample(&[0.5]);
        assert!(x[0] == 0.5 && x[1].is_nan());
        assert!(p.sample(&[])[0].is_nan());
        assert_eq!(p.pdf(&vec![0.5, f64::NAN]), 0.0);
    }

    #[test]
    fn errors_name_argument_value_and_rule() {
        let message = |e: ArgumentError| e.to_string();
        let none: [Uniform; 0] = [];
        assert!(message(Product::new(none).unwrap_err()).contains("`number of coordinates` is 0"));
        assert!(message(UniformBox::uniform([], []).unwrap_err()).contains("is 0"));
        assert!(message(ProductVec::new(Vec::<Uniform>::new()).unwrap_err()).contains("is 0"));
        assert!(message(ProductVec::uniform(&[], &[]).unwrap_err()).contains("is 0"));
        assert_eq!(
            message(ProductVec::uniform(&[0.0], &[1.0, 2.0]).unwrap_err()),
            "ProductVec: `length of upper` is 2, but it must equal the length of lower = 1"
        );
        assert_eq!(
            message(UniformBox::uniform([0.0, 3.0], [1.0, 2.0]).unwrap_err()),
            "Product: `upper[1]` is 2.0, but it must be greater than lower[1] = 3"
        );
        let e = UniformBox::uniform([0.0, f64::NAN], [1.0, 2.0]).unwrap_err();
        assert!(message(e).contains("`lower[1]` is NaN"));
        let e = ProductVec::uniform(&[-1e308], &[1e308]).unwrap_err();
        assert!(message(e).contains("`upper[0] - lower[0]` is inf"));
    }
}
