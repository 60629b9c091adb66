//! Mixtures of techniques.

use super::{Technique, canonical};
use crate::discrete::Discrete;
use crate::error::ArgumentError;

/// The mixture of techniques: one of them, chosen at random, gives the point. With respect to the
/// measure that its components share.
///
/// p(x) = Σ Pₖ pₖ(x), k from 1 to K. The first canonical number selects the component, the
/// others go to it, so the dimension is 1 + the largest dimension of a component. Components of
/// probability 0 are never selected nor evaluated.
///
/// Components of different types go into one mixture as `Box<dyn Technique<Point = P>>` or
/// `&dyn Technique<Point = P>`.
///
/// ```
/// use mis::technique::{Mixture, Technique, Uniform};
/// # fn main() -> Result<(), mis::ArgumentError> {
/// let p = Mixture::new(vec![(Uniform::new(0.0, 4.0)?, 0.75), (Uniform::new(2.0, 3.0)?, 0.25)])?;
/// assert_eq!(p.pdf(&2.5), 0.4375);
/// assert_eq!(p.sample(&[0.5, 0.25]), 1.0);
/// assert_eq!(p.sample(&[0.8, 0.25]), 2.25);
/// # Ok(())
/// # }
/// ```
///
/// # Numerics
///
/// ln p is a log-sum-exp: ln Σ Pₖ pₖ = m + ln Σ exp(ln Pₖ + ln pₖ - m) with m the largest term, so
/// it is finite also where every pₖ underflows.
///
/// Source of the term and its use for importance sampling: T. Hesterberg, *Weighted average
/// importance sampling and defensive mixture distributions*, Technometrics 37 (1995) 185-194.
#[derive(Debug, Clone, PartialEq)]
pub struct Mixture<T> {
    components: Vec<T>,
    selection: Discrete,
    ln_probabilities: Vec<f64>,
    dimension: usize,
    point_len: Option<usize>,
}

impl<T: Technique> Mixture<T> {
    /// The mixture of these components, each with its probability.
    ///
    /// # Errors
    ///
    /// There must be at least one component. Probabilities must be finite and not negative, and
    /// sum to 1 to within 4 K ε for K components (ε = 2⁻⁵²). Lengths of points that the components
    /// state must be equal.
    pub fn new(components: Vec<(T, f64)>) -> Result<Self, ArgumentError> {
        let (components, probabilities): (Vec<T>, Vec<f64>) = components.into_iter().unzip();
        let selection = Discrete::new("Mixture", "probabilities", &probabilities)?;
        let mut point_len = None;
        for (k, component) in components.iter().enumerate() {
            let len = component.point_len();
            if let (Some(expected), Some(len)) = (point_len, len)
                && len != expected
            {
                let name = format!("point length of component {k}");
                let rule = format!("it must equal that of those before, {expected}");
                return Err(ArgumentError::new("Mixture", name, len, rule));
            }
            point_len = point_len.or(len);
        }
        let dimension = components.iter().map(T::dimension).max().unwrap_or(0).saturating_add(1);
        let ln_probabilities = probabilities.iter().map(|p| p.ln()).collect();
        Ok(Self { components, selection, ln_probabilities, dimension, point_len })
    }

    /// The components, those of probability 0 included.
    #[must_use]
    pub fn components(&self) -> &[T] {
        &self.components
    }

    /// The probabilities of the components.
    #[must_use]
    pub fn probabilities(&self) -> &[f64] {
        self.selection.probabilities()
    }

    /// The component that the first canonical number selects, and its own canonical numbers.
    fn selected<'a>(&self, xi: &'a [f64]) -> (&T, &'a [f64]) {
        let component = &self.components[self.selection.select(canonical(xi, 0))];
        let own = xi.get(1..).unwrap_or_default();
        (component, &own[..component.dimension().min(own.len())])
    }

    /// The components that can be selected, with their probabilities.
    fn weighted(&self) -> impl Iterator<Item = (&T, f64)> {
        let pairs = self.components.iter().zip(self.probabilities().iter().copied());
        pairs.filter(|(_, p)| *p > 0.0)
    }
}

impl<T: Technique> Technique for Mixture<T> {
    type Point = T::Point;

    fn dimension(&self) -> usize {
        self.dimension
    }

    fn sample(&self, xi: &[f64]) -> T::Point {
        let (component, own) = self.selected(xi);
        component.sample(own)
    }

    fn pdf(&self, x: &T::Point) -> f64 {
        let terms = self.weighted().map(|(component, p)| p * component.pdf(x));
        terms.fold(0.0, |sum, term| sum + term)
    }

    fn ln_pdf(&self, x: &T::Point) -> f64 {
        // One pass: `sum` is relative to exp(largest).
        let (mut largest, mut sum) = (f64::NEG_INFINITY, 0.0);
        for (component, ln_probability) in self.components.iter().zip(&self.ln_probabilities) {
            if *ln_probability == f64::NEG_INFINITY {
                continue;
            }
            let term = ln_probability + component.ln_pdf(x);
            if term.is_nan() || term == f64::INFINITY {
                return term;
            }
            if term > largest {
                sum = sum * (largest - term).exp() + 1.0;
                largest = term;
            } else if term > f64::NEG_INFINITY {
                sum += (term - largest).exp();
            }
        }
        // Outside every support, sum is 0.
        if sum > 0.0 { largest + f64::ln(sum) } else { f64::NEG_INFINITY }
    }

    fn point_len(&self) -> Option<usize> {
        self.point_len
    }

    fn sample_into(&self, xi: &[f64], x: &mut T::Point) {
        let (component, own) = self.selected(xi);
        component.sample_into(own, x);
    }

    fn pdf_batch(&self, xs: &[T::Point], out: &mut [f64]) {
        // By component, so that a virtual call serves a block; on the stack, so that nothing is
        // allocated. The sums are those of `pdf`, term by term.
        const BLOCK: usize = 64;
        let mut terms = [0.0; BLOCK];
        for (xs, out) in xs.chunks(BLOCK).zip(out.chunks_mut(BLOCK)) {
            out.fill(0.0);
            for (component, p) in self.weighted() {
                let terms = &mut terms[..xs.len()];
                component.pdf_batch(xs, terms);
                for (out, term) in out.iter_mut().zip(terms) {
                    *out += p * *term;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{FnTechnique, ProductVec, Statrs, Uniform, UniformBox};
    use super::*;

    type Boxed = Box<dyn Technique<Point = [f64; 2]>>;

    const LARGEST: f64 = 1.0 - f64::EPSILON / 2.0;

    fn unit(shift: f64) -> Uniform {
        Uniform::new(shift, shift + 1.0).unwrap()
    }

    #[test]
    fn the_first_number_selects_and_the_others_sample() {
        let p = Mixture::new(vec![(unit(0.0), 0.25), (unit(10.0), 0.75)]).unwrap();
        assert_eq!((p.dimension(), p.point_len()), (2, None));
        assert_eq!(p.sample(&[0.25_f64.next_down(), 0.5]), 0.5);
        assert_eq!(p.sample(&[0.25, 0.5]), 10.5);
        let mut x = 0.0;
        p.sample_into(&[0.1, 0.75], &mut x);
        assert_eq!(x, 0.75);
        assert_eq!((p.pdf(&0.5), p.pdf(&10.5), p.pdf(&5.0)), (0.25, 0.75, 0.0));
        assert_eq!(p.ln_pdf(&5.0), f64::NEG_INFINITY);
        assert!((p.ln_pdf(&0.5) - 0.25_f64.ln()).abs() < 1e-15);
        assert_eq!((p.components().len(), p.probabilities()), (2, &[0.25, 0.75][..]));
        // Missing numbers are NaN points, not panics.
        assert!(p.sample(&[]).is_nan() && p.sample(&[0.5]).is_nan());
    }

    #[test]
    fn probability_zero_is_never_selected() {
        let never = Uniform::new(100.0, 101.0).unwrap();
        let parts =
            vec![(never, 0.0), (unit(0.0), 0.5), (never, 0.0), (unit(5.0), 0.5), (never, 0.0)];
        let p = Mixture::new(parts).unwrap();
        for u in [0.0, 0.5_f64.next_down(), 0.5, LARGEST, 1.0] {
            let x = p.sample(&[u, 0.5]);
            assert!(x < 10.0 && p.pdf(&x) == 0.5, "u = {u}: {x}");
        }
        assert_eq!(p.pdf(&100.5), 0.0);
        // Ten times 0.1 sums to less than 1; the largest number still picks a component.
        let tenths: Vec<_> = (0..10).map(|k| (unit(f64::from(k)), 0.1)).collect();
        assert_eq!(Mixture::new(tenths).unwrap().sample(&[LARGEST, 0.5]), 9.5);
    }

    #[test]
    fn probability_zero_is_never_evaluated() {
        let poison = FnTechnique::new([-9.0, 9.0], |_| f64::NAN, |x| x, |u| u).unwrap();
        let unit = unit(0.0);
        let parts: Vec<(&dyn Technique<Point = f64>, f64)> = vec![(&poison, 0.0), (&unit, 1.0)];
        let p = Mixture::new(parts).unwrap();
        assert_eq!((p.pdf(&0.5), p.ln_pdf(&0.5)), (1.0, 0.0));
        let mut out = [0.0];
        p.pdf_batch(&[0.5], &mut out);
        assert_eq!(out, [1.0]);
    }

    #[test]
    fn a_logarithm_that_is_no_number_is_passed_on() {
        for value in [f64::NAN, f64::INFINITY] {
            let poison = FnTechnique::new([-9.0, 9.0], move |_| value, |x| x, |u| u).unwrap();
            let unit = unit(0.0);
            let parts: Vec<(&dyn Technique<Point = f64>, f64)> = vec![(&unit, 0.5), (&poison, 0.5)];
            let ln_pdf = Mixture::new(parts).unwrap().ln_pdf(&0.5);
            assert!(ln_pdf.is_nan() || ln_pdf == f64::INFINITY, "{ln_pdf}");
        }
    }

    #[test]
    fn logarithms_carry_densities_that_underflow() {
        let normal =
            |mean| Statrs::new(statrs::distribution::Normal::new(mean, 1.0).unwrap()).unwrap();
        let p = Mixture::new(vec![(normal(0.0), 0.5), (normal(1.0), 0.5)]).unwrap();
        assert_eq!(p.pdf(&100.0), 0.0);
        // ln(0.5 φ(100) + 0.5 φ(99)) with the first term e^-99.5 of the second.
        let expected = 0.5_f64.ln() - 0.5 * 99.0 * 99.0 - 0.918_938_533_204_672_8;
        assert!((p.ln_pdf(&100.0) - expected).abs() < 1e-11);
        // The order of the terms does not matter, and ln p is ln of p where p is a number.
        let q = Mixture::new(vec![(normal(1.0), 0.5), (normal(0.0), 0.5)]).unwrap();
        assert_eq!(p.ln_pdf(&100.0), q.ln_pdf(&100.0));
        for x in [-3.0, 0.0, 0.7, 5.0] {
            assert!((p.ln_pdf(&x) - p.pdf(&x).ln()).abs() < 1e-14 * p.ln_pdf(&x).abs().max(1.0));
        }
        let spikes = vec![Uniform::new(0.0, 1e-300).unwrap(); 2];
        let spikes = ProductVec::new(spikes).unwrap();
        let p = Mixture::new(vec![(spikes, 1.0)]).unwrap();
        assert!((p.ln_pdf(&vec![0.0, 0.0]) - 600.0 * 10.0_f64.ln()).abs() < 1e-11);
    }

    #[test]
    fn heterogeneous_components_of_different_dimensions() {
        let far = UniformBox::uniform([5.0, 5.0], [6.0, 7.0]).unwrap();
        let near =
            Mixture::new(vec![(UniformBox::uniform([0.0; 2], [1.0; 2]).unwrap(), 1.0)]).unwrap();
        let parts: Vec<(Boxed, f64)> = vec![(Box::new(far), 0.5), (Box::new(near), 0.5)];
        let p = Mixture::new(parts).unwrap();
        assert_eq!(p.dimension(), 4);
        assert_eq!(p.sample(&[0.1, 0.5, 0.5, 0.9]), [5.5, 6.0]);
        assert_eq!(p.sample(&[0.9, 0.9, 0.25, 0.75]), [0.25, 0.75]);
        assert_eq!(p.pdf(&[5.5, 6.0]), 0.25);
        let xs: Vec<[f64; 2]> = (0..200).map(|k| [0.005 * f64::from(k), 0.5]).collect();
        let mut out = vec![7.0; 200];
        p.pdf_batch(&xs, &mut out);
        assert!(xs.iter().zip(&out).all(|(x, out)| p.pdf(x).to_bits() == out.to_bits()));
    }

    #[test]
    fn points_keep_their_memory() {
        let part = |a| ProductVec::uniform(&[a, a], &[a + 1.0, a + 1.0]).unwrap();
        let p = Mixture::new(vec![(part(0.0), 0.5), (part(5.0), 0.5)]).unwrap();
        assert_eq!(p.point_len(), Some(2));
        let mut x = vec![0.0; 2];
        let memory = x.as_ptr();
        p.sample_into(&[0.9, 0.5, 0.5], &mut x);
        assert_eq!((x.as_ptr(), x), (memory, vec![5.5, 5.5]));
    }

    #[test]
    fn errors_name_argument_value_and_rule() {
        let message = |ps: &[f64]| {
            let parts = ps.iter().map(|&p| (Uniform::unit(), p)).collect();
            Mixture::new(parts).unwrap_err().to_string()
        };
        assert!(message(&[]).starts_with("Mixture: `probabilities` is [], but there must be"));
        assert!(
            message(&[0.5, 0.4])
                .starts_with("Mixture: `probabilities` is [0.5, 0.4], but their sum")
        );
        assert!(message(&[1.5, -0.5]).contains("`probabilities[1]` is -0.5"));
        assert!(message(&[f64::NAN]).contains("`probabilities[0]` is NaN"));
        let of_len = |n| (ProductVec::new(vec![Uniform::unit(); n]).unwrap(), 0.5);
        assert_eq!(
            Mixture::new(vec![of_len(2), of_len(3)]).unwrap_err().to_string(),
            "Mixture: `point length of component 1` is 3, but it must equal that of those before, 2"
        );
    }
}
