//! Spheres, and the cone of directions that one fills.

use std::f64::consts::TAU;

use glam::DVec3;

use super::direction::{Direction, Frame, length};
use crate::error::{ArgumentError, positive};
use crate::technique::{Technique, canonical};

/// A sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    centre: DVec3,
    radius: f64,
}

impl Sphere {
    /// The sphere around `centre` with this `radius`.
    ///
    /// # Errors
    ///
    /// `centre` must be finite; `radius` must be finite and greater than 0. A light of radius 0
    /// is a point light: its directions have no density, so that no technique can sample it.
    pub fn new(centre: DVec3, radius: f64) -> Result<Self, ArgumentError> {
        if !centre.is_finite() {
            return Err(ArgumentError::new("Sphere", "centre", centre, "it must be finite"));
        }
        Ok(Self { centre, radius: positive("Sphere", "radius", radius)? })
    }

    /// The centre.
    #[must_use]
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// The radius.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The directions from `point` towards the sphere, as a technique.
    ///
    /// # Errors
    ///
    /// `point` must be finite, and the sphere's solid angle within the range of `f64`.
    pub fn seen_from(&self, point: DVec3) -> Result<Cone, ArgumentError> {
        Cone::new(self, point)
    }
}

/// The uniform density on the directions from a point that meet a sphere, per steradian.
///
/// With the radius r, the distance d of the centre and the half-angle θ of the cone, sin θ = r / d:
///
/// p(ω) = 1 / (2π (1 - cos θ)) within the cone, else 0. A sample has 1 - cos α = ξ₀ (1 - cos θ)
/// from the axis and the azimuth 2π ξ₁.
///
/// From inside, the sphere is in every direction: p = 1 / (4π). From a point on the surface, to
/// rounding, it fills the half-space towards the centre.
///
/// ```
/// use mis::lighting::{DVec3, Sphere};
/// use mis::technique::Technique;
/// # fn main() -> Result<(), mis::ArgumentError> {
/// let cone = Sphere::new(DVec3::new(0.0, 0.0, 5.0), 3.0)?.seen_from(DVec3::ZERO)?;
/// let w = cone.sample(&[0.5, 0.25]);
/// assert!((w.vector().z - 0.9).abs() < 1e-15);
/// assert!((cone.pdf(&w) * std::f64::consts::TAU - 5.0).abs() < 1e-14);
/// assert!(cone.hit(&w).is_some_and(|t| (2.0..4.0).contains(&t)));
/// # Ok(())
/// # }
/// ```
///
/// # Numerics
///
/// 1 - cos θ = s / (1 + √((d - r)(d + r)) / d), s = (r / d)², is exact to rounding at every
/// angle. Whether a direction meets the sphere is decided by its distance to the axis, 2 sin(α/2),
/// widened by the rounding of a direction. For r / d below about 1e-12 that widening is no longer
/// small beside the cone: the density of own samples stays exact, a foreign technique hits the
/// sphere up to 2e-15 d / r too often.
///
/// Source: P. Shirley, C. Wang and K. Zimmerman, *Monte Carlo Techniques for Direct Lighting
/// Calculations*, ACM Transactions on Graphics 15(1), 1996.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    frame: Frame,
    /// 1 - cos θ; 2 from inside.
    width: f64,
    /// 1 over the solid angle.
    density: f64,
    /// The square of the largest distance from the axis, as unit vectors, that counts as a hit.
    reach2: f64,
    /// The larger of distance and radius: the unit of what follows.
    unit: f64,
    distance: f64,
    radius: f64,
    /// (d - r)(d + r): negative inside, 0 on the surface.
    power: f64,
}

impl Cone {
    fn new(sphere: &Sphere, point: DVec3) -> Result<Self, ArgumentError> {
        let to_centre = sphere.centre - point;
        let (d, r) = (length(to_centre), sphere.radius);
        let unit = d.max(r);
        // What rounding of the three positions can make of d - r when the point is on the surface.
        let rounding = 4.0
            * f64::EPSILON
            * (point.abs().max_element() + sphere.centre.abs().max_element() + r);
        let inside = d < r - rounding;
        let gap = if inside { d - r } else { (d - r).max(0.0) };
        let power = (gap / unit) * (d / unit + r / unit);
        let width = if inside {
            2.0
        } else {
            // On the surface, or in a sphere that is smaller than the rounding of the positions.
            let sin = (r / d).min(1.0);
            sin * sin / (1.0 + power.sqrt())
        };
        if !width.is_normal() {
            let rule = "it must be finite, and the sphere's solid angle within the range of f64";
            return Err(ArgumentError::new("Sphere", "point", point, rule));
        }
        let axis = Direction::new(to_centre).unwrap_or(Direction::from_unit(DVec3::Z));
        let tolerance = 4.0 * f64::EPSILON;
        let reach = (2.0 * width).sqrt() * (1.0 + tolerance) + tolerance;
        Ok(Self {
            frame: Frame::new(axis),
            width,
            density: (TAU * width).recip(),
            reach2: reach * reach,
            unit,
            distance: d / unit,
            radius: r / unit,
            power,
        })
    }

    /// The solid angle in steradians, 2π (1 - cos θ).
    #[must_use]
    pub fn solid_angle(&self) -> f64 {
        TAU * self.width
    }

    #[inline(always)]
    pub(super) fn contains(&self, w: &Direction) -> bool {
        2.0 * w.one_minus_cos(self.frame.axis) <= self.reach2
    }

    pub(super) fn density(&self) -> f64 {
        self.density
    }

    /// The distance to the sphere in the direction `w`, or `None` where it misses.
    ///
    /// It is a number exactly where [`pdf`](Technique::pdf) is positive.
    #[must_use]
    pub fn hit(&self, w: &Direction) -> Option<f64> {
        let q = w.one_minus_cos(self.frame.axis);
        if !(2.0 * q <= self.reach2) {
            return None;
        }
        let along = self.distance * (1.0 - q);
        // Half the chord: sqrt(r^2 - d^2 sin^2).
        let chord2 = self.radius * self.radius - self.distance * self.distance * q * (2.0 - q);
        let chord = chord2.max(0.0).sqrt();
        if self.power < 0.0 && along > 0.0 {
            return Some(self.unit * (along + chord));
        }
        // The conjugate form of the near root (of the far root behind the centre, from inside),
        // which does not cancel.
        let sum = along.abs() + chord;
        Some(if sum > 0.0 { self.unit * (self.power.abs() / sum) } else { 0.0 })
    }
}

impl Technique for Cone {
    type Point = Direction;

    fn dimension(&self) -> usize {
        2
    }

    #[inline(always)]
    fn sample(&self, xi: &[f64]) -> Direction {
        self.frame.around(canonical(xi, 0) * self.width, canonical(xi, 1))
    }

    fn pdf(&self, w: &Direction) -> f64 {
        if self.contains(w) { self.density } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::{Cone, DVec3, Direction, Sphere, TAU, Technique};

    fn cone(distance: f64, radius: f64) -> Cone {
        let axis = DVec3::new(0.48, -0.6, 0.64);
        Sphere::new(distance * axis, radius).unwrap().seen_from(DVec3::ZERO).unwrap()
    }

    #[test]
    fn solid_angle_is_exact_from_grazing_distance_to_a_speck() {
        for exponent in 1..=12 {
            let s = 10.0_f64.powi(-exponent);
            let exact = 2.0 * TAU * (0.5 * s.asin()).sin().powi(2);
            assert!((cone(1.0, s).solid_angle() / exact - 1.0).abs() < 2e-15, "r/d = {s}");
        }
        // Just above the surface.
        let d = 1.0 + 1e-12;
        let above = Sphere::new(d * DVec3::Z, 1.0).unwrap().seen_from(DVec3::ZERO).unwrap();
        let cos = ((d - 1.0) * (d + 1.0)).sqrt() / d;
        assert!((above.solid_angle() / TAU - (1.0 - cos)).abs() < 4e-16, "{cos}");
        // On the surface, to rounding on either side: the half-space.
        for d in [1.0, 1.0 - f64::EPSILON] {
            assert!((cone(d, 1.0).solid_angle() / TAU - 1.0).abs() < 4e-8, "{d}");
        }
        assert_eq!(cone(0.5, 1.0).solid_angle(), 2.0 * TAU);
        assert_eq!(cone(0.0, 1.0).solid_angle(), 2.0 * TAU);
    }

    #[test]
    fn own_samples_hit_at_the_right_distance() {
        for (d, r) in [(1.0, 0.1), (1.0, 1e-6), (1.0, 1e-12), (1.0, 1e-20), (1.0 + 1e-12, 1.0)] {
            let cone = cone(d, r);
            for i in 0..=1000 {
                let w = cone.sample(&[f64::from(i) / 1000.0, f64::from(i * 7 % 11) / 11.0]);
                assert!((cone.pdf(&w) * cone.solid_angle() - 1.0).abs() < 1e-15);
                let t = cone.hit(&w).unwrap();
                let nearest = (d - r).max(0.0);
                let tangent = ((d - r) * (d + r)).sqrt();
                assert!(
                    t >= nearest * (1.0 - 1e-15) && t <= tangent * (1.0 + 1e-15),
                    "{d} {r} {t}"
                );
            }
        }
    }

    #[test]
    fn from_inside_every_direction_hits_the_far_side() {
        let centre = DVec3::new(0.0, 0.0, 0.5);
        let cone = Sphere::new(centre, 2.0).unwrap().seen_from(DVec3::ZERO).unwrap();
        for i in 0..100 {
            let w = cone.sample(&[f64::from(i) / 100.0, 0.3]);
            let t = cone.hit(&w).unwrap();
            assert!(((t * w.vector() - centre).length() - 2.0).abs() < 4e-15);
            assert_eq!(cone.pdf(&w), 1.0 / (2.0 * TAU));
        }
    }

    #[test]
    fn from_just_inside_the_near_side_keeps_its_distance() {
        let depth = 2f64.powi(-30);
        let cone = Sphere::new((1.0 - depth) * DVec3::Z, 1.0).unwrap().seen_from(DVec3::ZERO);
        let t = cone.unwrap().hit(&Direction::from_unit(DVec3::new(0.6, 0.0, -0.8))).unwrap();
        // (r - d)(r + d) over the sum of 0.8 d and half the chord.
        let d = 1.0 - depth;
        let exact = depth * (2.0 - depth) / (0.8 * d + (1.0 - 0.36 * d * d).sqrt());
        assert!((t / exact - 1.0).abs() < 1e-14, "{t}");
    }

    #[test]
    fn a_sphere_below_the_rounding_of_its_position_fills_at_most_a_half_space() {
        let centre = DVec3::new(1e12, 0.0, 0.0);
        for (offset, radius) in [(0.0, 1e-6), (5e-4, 6e-4)] {
            let point = centre + offset * DVec3::Y;
            let cone = Sphere::new(centre, radius).unwrap().seen_from(point).unwrap();
            assert_eq!(cone.solid_angle(), TAU);
            assert!(cone.hit(&cone.sample(&[0.5, 0.5])).is_some());
        }
    }

    #[test]
    fn a_tangent_at_the_surface_hits_at_once() {
        let on = Sphere::new(DVec3::Z, 1.0).unwrap().seen_from(DVec3::ZERO).unwrap();
        assert_eq!(on.hit(&Direction::from_unit(DVec3::X)), Some(0.0));
    }

    #[test]
    fn directions_that_miss_have_no_density() {
        let cone = cone(1.0, 1e-3);
        let away = Direction::from_unit(-cone.frame.axis.vector());
        assert_eq!(cone.pdf(&away), 0.0);
        assert_eq!(cone.hit(&away), None);
        let beside = cone.frame.around(cone.width * 1.001, 0.2);
        assert_eq!(cone.pdf(&beside), 0.0);
        assert_eq!(cone.pdf(&Direction::from_unit(DVec3::NAN)), 0.0);
    }

    #[test]
    fn bad_spheres_name_the_argument() {
        let error = Sphere::new(DVec3::ZERO, 0.0).unwrap_err();
        assert_eq!(error.argument(), "radius");
        assert!(Sphere::new(DVec3::ZERO, f64::NAN).is_err());
        assert!(Sphere::new(DVec3::NAN, 1.0).is_err());
        let far = Sphere::new(DVec3::new(1e200, 0.0, 0.0), 1e-200).unwrap();
        assert_eq!(far.seen_from(DVec3::ZERO).unwrap_err().argument(), "point");
        for point in [DVec3::NAN, DVec3::INFINITY, DVec3::new(0.0, f64::NAN, 0.0)] {
            assert!(Sphere::new(DVec3::Z, 1.0).unwrap().seen_from(point).is_err());
        }
    }
}
