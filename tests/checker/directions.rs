//! Directions, as a user's own type, in wrong measures.

use std::f64::consts::{PI, TAU};

use mis::check::{self, Law, Options, Report};
use mis::technique::{Technique, canonical};

use crate::assert_size;

/// A direction of a user's own.
#[derive(Debug, Clone, Copy)]
struct Unit {
    z: f64,
    azimuth: f64,
}

/// Directions about the pole with the density `pdf` in z.
struct Polar {
    z: fn(f64) -> f64,
    pdf: fn(f64) -> f64,
}

impl Technique for Polar {
    type Point = Unit;

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> Unit {
        Unit { z: (self.z)(canonical(xi, 0)), azimuth: TAU * canonical(xi, 1) }
    }

    fn pdf(&self, w: &Unit) -> f64 {
        (self.pdf)(w.z)
    }
}

/// Of the disc seen at 45°, to rounding.
const RIM: f64 = std::f64::consts::FRAC_1_SQRT_2 * (1.0 - 1e-15);

const SPHERE: Polar = Polar { z: |u| 1.0 - 2.0 * u, pdf: |_| 0.25 / PI };

fn on_the_sphere(p: &Polar) -> Report {
    let coordinates = |w: &Unit| [0.5 * (1.0 - w.z), w.azimuth / TAU];
    check::technique(p, &SPHERE, coordinates, &Options::default())
}

#[test]
fn directions_with_a_wrong_jacobian() {
    let lambert = Polar { z: f64::sqrt, pdf: |z| z.max(0.0) / PI };
    let report = on_the_sphere(&lambert);
    assert!(report.passed(), "{report}");
    // Uniform per steradian above the horizon, without the cosine in the sampler.
    let report = on_the_sphere(&Polar { z: |u| u, pdf: |z| z.max(0.0) / PI });
    assert!(report.get(Law::Integral).unwrap().passed(), "{report}");
    assert!(!report.get(Law::ChiSquared(0)).unwrap().passed(), "{report}");
    assert!(report.get(Law::ChiSquared(1)).unwrap().passed(), "{report}");
    // A disc of radius 1 at the height 1: its pdf per area, not per steradian.
    let z = |u: f64| (1.0 + u).sqrt().recip();
    let per_area = |z: f64| if z >= RIM { 1.0 / PI } else { 0.0 };
    let report = on_the_sphere(&Polar { z, pdf: per_area });
    // ∫ dω / π = 2 (1 - √½).
    assert_size(&report, Law::Integral, 1.0 - 2.0 * (1.0 - 0.5_f64.sqrt()), 0.02, "% too little");
    assert!(!report.get(Law::ChiSquared(0)).unwrap().passed(), "{report}");
    let per_steradian = |z: f64| if z >= RIM { 1.0 / (PI * z.powi(3)) } else { 0.0 };
    let report = on_the_sphere(&Polar { z, pdf: per_steradian });
    assert!(report.passed(), "{report}");
}
