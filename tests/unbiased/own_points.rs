//! Points of a user's own types.

use std::f64::consts::PI;

use mis::Technique;
use mis::technique::{InverseCdf, Linear, Uniform, canonical};

use crate::battery::{Battery, Case, Size};

/// A direction, as a user's own type.
#[derive(Debug, Clone, Copy)]
struct Unit {
    z: f64,
    azimuth: f64,
}

/// Directions about the pole, per steradian: 1 / 4π, (1 + z) / 4π, or z / π above the horizon.
enum Polar {
    Sphere,
    Leaning,
    Lambert,
}

impl Technique for Polar {
    type Point = Unit;

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> Unit {
        let u = canonical(xi, 0);
        let z = match self {
            Self::Sphere => 2.0 * u - 1.0,
            Self::Leaning => 2.0 * u.sqrt() - 1.0,
            Self::Lambert => u.sqrt(),
        };
        Unit { z, azimuth: 2.0 * PI * canonical(xi, 1) }
    }

    fn pdf(&self, w: &Unit) -> f64 {
        match self {
            Self::Sphere => 0.25 / PI,
            Self::Leaning => 0.25 * (1.0 + w.z) / PI,
            Self::Lambert => w.z.max(0.0) / PI,
        }
    }
}

/// A number in one of three boxes; the measure counts boxes and is length within one.
#[derive(Debug, Clone, Copy)]
struct Boxed {
    which: usize,
    x: f64,
}

/// A box with these probabilities, then x by a density on the unit interval.
struct Boxes<T>([f64; 3], T);

impl<T: InverseCdf> Technique for Boxes<T> {
    type Point = Boxed;

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> Boxed {
        let u = canonical(xi, 0);
        let which = usize::from(u >= self.0[0]) + usize::from(u >= self.0[0] + self.0[1]);
        Boxed { which, x: self.1.sample(&[canonical(xi, 1)]) }
    }

    fn pdf(&self, at: &Boxed) -> f64 {
        self.0.get(at.which).map_or(0.0, |p| p * self.1.pdf(&at.x))
    }
}

pub(crate) fn own_points(size: Size) -> Battery {
    let mut battery = Battery::default();
    battery.check(
        size,
        &Case {
            name: "directions",
            f: |w: &Unit| w.z.max(0.0) * (1.0 + w.z * (1.0 + w.azimuth.cos())),
            integral: &[PI + 2.0 * PI / 3.0],
            techniques: &[&Polar::Sphere, &Polar::Leaning, &Polar::Lambert],
            covered: true,
            spread: 3.0,
        },
    );
    let even = Boxes([1.0 / 3.0; 3], Uniform::unit());
    let uneven = Boxes([0.2, 0.3, 0.5], Linear::new(0.0, 1.0, 1.0, 3.0).unwrap());
    battery.check(
        size,
        &Case {
            name: "numbers in boxes",
            f: |at: &Boxed| [1.0, 2.0 * at.x, 3.0 * at.x * at.x][at.which],
            integral: &[3.0],
            techniques: &[&even, &uneven],
            covered: true,
            spread: 2.0,
        },
    );
    battery
}
