//! Integrands of the suite as integrands of `mis`, in batches.

use crate::integrand::{Integrand, Shape};
use crate::techniques::SinCos;
use wide::f64x4;

/// An integrand of the suite at points with their coordinates.
pub struct Batched<'a>(pub &'a Integrand);

impl<const D: usize> mis::Integrand<[f64; D]> for Batched<'_> {
    type Value = f64;

    fn eval(&self, x: &[f64; D]) -> f64 {
        self.0.eval(x)
    }

    fn eval_batch(&self, xs: &[[f64; D]], out: &mut [f64]) {
        let (fours, rest) = xs.as_chunks::<4>();
        let (out_of_fours, out_of_rest) = out.as_chunks_mut::<4>();
        for (out, x) in out_of_fours.iter_mut().zip(fours) {
            let rows: [f64x4; D] = std::array::from_fn(|d| f64x4::new(x.map(|x| x[d])));
            *out = self.0.eval4(&rows).to_array();
        }
        for (out, x) in out_of_rest.iter_mut().zip(rest) {
            *out = self.0.eval(x);
        }
    }
}

impl mis::Integrand<SinCos> for Batched<'_> {
    type Value = f64;

    fn eval(&self, x: &SinCos) -> f64 {
        match self.0.shape {
            Shape::SinCos { b } => b * x.sin * x.cos,
            _ => f64::NAN,
        }
    }
}
