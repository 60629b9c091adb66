//! Integrands of the suite as integrands of `mis`: a batch at once, four points in the lanes of a
//! vector.

use crate::integrand::{Integrand, LARGEST, LobeAndDisk, Shape};
use crate::techniques::SinCos;
use wide::f64x4;

/// An integrand of the suite.
pub struct Batched<'a>(pub &'a Integrand);

impl<const D: usize> mis::Integrand<[f64; D]> for Batched<'_> {
    type Value = f64;

    fn eval(&self, x: &[f64; D]) -> f64 {
        self.0.eval(x)
    }

    fn eval_batch(&self, xs: &[[f64; D]], out: &mut [f64]) {
        // The formula is chosen once for the batch.
        match &self.0.shape {
            Shape::SinCos { b } => self.by_fours(xs, out, |x| {
                let (sin, cos) = (x[0] * *b).sin_cos();
                sin * cos * *b
            }),
            Shape::Oscillatory { a, shift } => self.by_fours(xs, out, |x| {
                let phase = x.iter().zip(a).map(|(x, a)| *x * *a);
                (sum(phase) + *shift).cos()
            }),
            Shape::ProductPeak { c, u } => self.by_fours(xs, out, |x| {
                let factors = squares(x, u).zip(c).map(|(square, c)| square + *c);
                f64x4::splat(1.0)
                    / factors.fold(f64x4::splat(1.0), |product, factor| product * factor)
            }),
            Shape::Gaussian { c, u } => self.by_fours(xs, out, |x| {
                (-sum(squares(x, u).zip(c).map(|(square, c)| square * *c))).exp()
            }),
            Shape::C0 { a, u } => self.by_fours(xs, out, |x| {
                let terms = x.iter().zip(u).zip(a).map(|((x, u), a)| (*x - *u).abs() * *a);
                (-sum(terms)).exp()
            }),
            Shape::Peaks(peaks) => self.by_fours(xs, out, |x| {
                sum(peaks.iter().map(|peak| {
                    let r2 = sum(squares(x, &[peak.centre; LARGEST]));
                    (r2 * peak.rate).exp() * peak.factor
                }))
            }),
            Shape::LobeAndDisk(LobeAndDisk { centre, disk, factor, rate, r2, .. }) => self
                .by_fours(xs, out, |x| {
                    let distances = sum(squares(x, disk)).to_array();
                    let factors = distances.map(|d| if d < *r2 { *factor } else { 0.0 });
                    if factors.iter().all(|factor| *factor == 0.0) {
                        return f64x4::splat(0.0);
                    }
                    (sum(squares(x, centre)) * *rate).exp() * f64x4::new(factors)
                }),
        }
    }
}

impl Batched<'_> {
    /// Calls `f` with rows of four points' coordinates, and the scalar formula with the rest.
    #[inline]
    fn by_fours<const D: usize>(
        &self,
        xs: &[[f64; D]],
        out: &mut [f64],
        f: impl Fn(&[f64x4; D]) -> f64x4,
    ) {
        let (fours, rest) = xs.as_chunks::<4>();
        let (out_of_fours, out_of_rest) = out.as_chunks_mut::<4>();
        for (out, x) in out_of_fours.iter_mut().zip(fours) {
            let rows = std::array::from_fn(|d| f64x4::new(x.map(|x| x[d])));
            *out = f(&rows).to_array();
        }
        for (out, x) in out_of_rest.iter_mut().zip(rest) {
            *out = self.0.eval(x);
        }
    }
}

#[inline]
fn sum(terms: impl Iterator<Item = f64x4>) -> f64x4 {
    terms.fold(f64x4::splat(0.0), |sum, term| sum + term)
}

/// (x - u)² for each coordinate.
#[inline]
fn squares(x: &[f64x4], u: &[f64]) -> impl Iterator<Item = f64x4> {
    x.iter().zip(u).map(|(x, u)| {
        let dx = *x - *u;
        dx * dx
    })
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
