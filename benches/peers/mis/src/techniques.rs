//! Techniques of a user's own.

use mis::Technique;
use mis::technique::canonical;
use std::f64::consts::{PI, TAU};

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
        let r2 = self.radius * self.radius;
        // Samples at the rim may be rounded outwards, by as much as the centre is rounded.
        let rim = 4.0 * f64::EPSILON * self.radius * (self.centre[0].abs() + self.centre[1].abs());
        if dx * dx + dy * dy <= r2 + rim { (PI * r2).recip() } else { 0.0 }
    }
}
