//! Techniques of a user's own.

use mis::Technique;
use mis::technique::canonical;
use std::f64::consts::{PI, TAU};
use wide::f64x4;

/// A point x of the unit interval by the sine and the cosine of b x, which the integrand and both
/// densities share.
#[derive(Debug, Clone, Copy)]
pub struct SinCos {
    pub sin: f64,
    pub cos: f64,
}

/// b cos(b x) on the unit interval, for b = π/2.
pub struct Cosine(pub f64);

impl Technique for Cosine {
    type Point = SinCos;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> SinCos {
        let sin = canonical(xi, 0);
        SinCos { sin, cos: ((1.0 - sin) * (1.0 + sin)).sqrt() }
    }

    fn pdf(&self, x: &SinCos) -> f64 {
        self.0 * x.cos
    }
}

/// b sin(b x) on the unit interval, for b = π/2.
pub struct Sine(pub f64);

impl Technique for Sine {
    type Point = SinCos;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> SinCos {
        let cos = canonical(xi, 0);
        SinCos { sin: ((1.0 - cos) * (1.0 + cos)).sqrt(), cos }
    }

    fn pdf(&self, x: &SinCos) -> f64 {
        self.0 * x.sin
    }
}

/// The uniform density on a disk, with respect to area.
pub struct Disk {
    pub centre: [f64; 2],
    pub radius: f64,
}

impl Disk {
    /// Samples at the rim are rounded outwards at times, by as much as the centre is rounded.
    fn largest_r2(&self) -> f64 {
        let rounding = f64::EPSILON * (self.centre[0].abs() + self.centre[1].abs());
        self.radius * (self.radius + 4.0 * rounding)
    }
}

impl Technique for Disk {
    type Point = [f64; 2];

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> [f64; 2] {
        let r = self.radius * canonical(xi, 0).sqrt();
        let (sin, cos) = (TAU * canonical(xi, 1)).sin_cos();
        [self.centre[0] + r * cos, self.centre[1] + r * sin]
    }

    fn pdf(&self, x: &[f64; 2]) -> f64 {
        let (dx, dy) = (x[0] - self.centre[0], x[1] - self.centre[1]);
        let inside = dx * dx + dy * dy <= self.largest_r2();
        if inside { (PI * self.radius * self.radius).recip() } else { 0.0 }
    }

    /// Four at once.
    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<[f64; 2]>) {
        let (rows, _) = xi.as_chunks::<2>();
        if xs.len() < rows.len() {
            xs.resize(rows.len(), [0.0; 2]);
        }
        let (fours, rest) = rows.as_chunks::<4>();
        let (xs_of_fours, xs_of_rest) = xs[..rows.len()].as_chunks_mut::<4>();
        for (xs, four) in xs_of_fours.iter_mut().zip(fours) {
            let [r, turn] = [0, 1].map(|d| f64x4::new(four.map(|row| canonical(&row, d))));
            let r = r.sqrt() * self.radius;
            let (sin, cos) = (turn * TAU).sin_cos();
            let x = (r * cos + self.centre[0]).to_array();
            let y = (r * sin + self.centre[1]).to_array();
            *xs = std::array::from_fn(|i| [x[i], y[i]]);
        }
        for (x, row) in xs_of_rest.iter_mut().zip(rest) {
            *x = self.sample(row);
        }
    }

    fn pdf_batch(&self, xs: &[[f64; 2]], out: &mut [f64]) {
        let (r2, pdf) = (self.largest_r2(), (PI * self.radius * self.radius).recip());
        for (out, x) in out.iter_mut().zip(xs) {
            let (dx, dy) = (x[0] - self.centre[0], x[1] - self.centre[1]);
            *out = if dx * dx + dy * dy <= r2 { pdf } else { 0.0 };
        }
    }
}
