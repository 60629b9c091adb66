//! Directions: the points of the lighting integral.

use glam::DVec3;

use super::turn::sin_cos_of_turn;
use crate::error::ArgumentError;

/// A unit vector: a point of the lighting integral, whose measure is the solid angle.
///
/// In `f64`, two directions less than about 2.2e-16 radians apart cannot be told apart. The
/// densities of this module allow for a few of these in their support's boundary, so that a
/// direction that a technique returns is always within the technique's support.
///
/// ```
/// use mis::lighting::{DVec3, Direction};
/// # fn main() -> Result<(), mis::ArgumentError> {
/// let up = Direction::new(DVec3::new(0.0, 0.0, 2.0))?;
/// assert_eq!(up.vector(), DVec3::Z);
/// assert_eq!(up.cos(Direction::new(DVec3::ONE)?), 3.0_f64.sqrt().recip());
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction(DVec3);

impl Direction {
    /// The direction of `vector`, of any length.
    ///
    /// # Errors
    ///
    /// `vector` must be finite and not 0.
    pub fn new(vector: DVec3) -> Result<Self, ArgumentError> {
        let unit = scaled(vector).0.normalize();
        if unit.is_finite() {
            Ok(Self(unit))
        } else {
            let rule = "it must be finite and not 0";
            Err(ArgumentError::new("Direction", "vector", vector, rule))
        }
    }

    /// A vector that is of unit length by its construction.
    pub(super) const fn from_unit(vector: DVec3) -> Self {
        Self(vector)
    }

    /// The unit vector.
    #[must_use]
    pub fn vector(self) -> DVec3 {
        self.0
    }

    /// The cosine of the angle to `other`.
    #[must_use]
    pub fn cos(self, other: Self) -> f64 {
        self.0.dot(other.0)
    }

    /// 1 - cos of the angle to `other`, as half the squared distance of the unit vectors.
    ///
    /// It keeps its relative accuracy for small angles, where `1.0 - self.cos(other)` is 0.
    #[must_use]
    pub fn one_minus_cos(self, other: Self) -> f64 {
        0.5 * self.0.distance_squared(other.0)
    }

    /// The direction the other way.
    pub(super) fn opposite(self) -> Self {
        Self(-self.0)
    }

    /// The mirror image of this direction about `normal`: 2 cos(θ) n - ω.
    #[must_use]
    pub fn reflected(self, normal: Self) -> Self {
        Self(2.0 * self.cos(normal) * normal.0 - self.0)
    }
}

/// The length of `vector`, whose squares may leave the range of `f64`.
pub(super) fn length(vector: DVec3) -> f64 {
    let (scaled, exponent) = scaled(vector);
    exponent * scaled.length()
}

/// `vector` divided by a power of 2 that is near its largest coordinate, and the power: its squares
/// neither overflow nor underflow.
fn scaled(vector: DVec3) -> (DVec3, f64) {
    let largest = vector.abs().max_element();
    // The inverse of the largest powers would be subnormal, and that of the smallest infinite.
    let power = f64::from_bits(largest.to_bits() & f64::INFINITY.to_bits());
    let power = power.clamp(f64::MIN_POSITIVE, 2f64.powi(1022));
    (vector * power.recip(), power)
}

/// An axis with two directions that make it an orthonormal basis.
///
/// Source: T. Duff, J. Burgess, P. Christensen, C. Hery, A. Kensler, M. Liani and R. Villemin,
/// *Building an Orthonormal Basis, Revisited*, Journal of Computer Graphics Techniques 6(1),
/// 2017; the form is glam's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    pub(super) axis: Direction,
    s: DVec3,
    t: DVec3,
}

impl Frame {
    pub(super) fn new(axis: Direction) -> Self {
        let (s, t) = axis.0.any_orthonormal_pair();
        Self { axis, s, t }
    }

    /// The coordinates of a direction: along the two others, and along the axis.
    pub(super) fn local(&self, w: Direction) -> DVec3 {
        DVec3::new(self.s.dot(w.0), self.t.dot(w.0), self.axis.0.dot(w.0))
    }

    /// The direction with these coordinates, which are of a unit vector.
    #[inline(always)]
    pub(super) fn world(&self, w: DVec3) -> Direction {
        Direction(w.x * self.s + w.y * self.t + w.z * self.axis.0)
    }

    /// The direction at an angle θ from the axis, 1 - cos θ = `q`, turned by `turn` of a full
    /// circle.
    #[inline(always)]
    pub(super) fn around(&self, q: f64, turn: f64) -> Direction {
        let sin = (q * (2.0 - q)).sqrt();
        let (sin_phi, cos_phi) = sin_cos_of_turn(turn);
        Direction((1.0 - q) * self.axis.0 + sin * (cos_phi * self.s + sin_phi * self.t))
    }
}

#[cfg(test)]
mod tests {
    use super::{DVec3, Direction, Frame};

    #[test]
    fn any_length_gives_a_unit_vector() {
        for scale in [1e-300, 1e-160, 1.0, 1e160, 1e300] {
            let w = Direction::new(scale * DVec3::new(1.0, -2.0, 2.0)).unwrap();
            assert!((w.vector() - DVec3::new(1.0, -2.0, 2.0) / 3.0).length() < 4e-16);
        }
        for bad in [
            DVec3::ZERO,
            DVec3::NAN,
            DVec3::new(f64::INFINITY, 0.0, 1.0),
            DVec3::new(0.0, f64::NAN, 1.0),
        ] {
            assert!(Direction::new(bad).is_err());
        }
    }

    #[test]
    fn small_angles_keep_their_cosine_complement() {
        for angle in [1e-1_f64, 1e-5, 1e-9, 1e-12] {
            let w = Direction::new(DVec3::new(angle.sin(), 0.0, angle.cos())).unwrap();
            let q = w.one_minus_cos(Direction::new(DVec3::Z).unwrap());
            let exact = 2.0 * (0.5 * angle).sin().powi(2);
            assert!((q / exact - 1.0).abs() < 1e-15 + 1e-16 / angle, "{angle}: {q}");
        }
    }

    #[test]
    fn the_frame_is_orthonormal_at_the_poles_too() {
        for axis in [DVec3::Z, -DVec3::Z, DVec3::new(1e-9, 0.0, -1.0), DVec3::new(0.0, 1.0, -0.0)] {
            let frame = Frame::new(Direction::new(axis).unwrap());
            assert!((frame.s.cross(frame.t) - frame.axis.0).length() < 4e-16, "{axis}");
            assert!((frame.s.length() - 1.0).abs() < 4e-16);
            let w = frame.around(0.3, 0.9);
            assert!((w.one_minus_cos(frame.axis) - 0.3).abs() < 4e-16);
        }
    }

    #[test]
    fn reflection_keeps_the_angle_and_is_its_own_inverse() {
        let n = Direction::new(DVec3::new(0.3, -0.2, 0.9)).unwrap();
        let w = Direction::new(DVec3::new(0.5, 0.1, 0.4)).unwrap();
        let r = w.reflected(n);
        assert!((r.cos(n) - w.cos(n)).abs() < 4e-16);
        assert!(r.reflected(n).one_minus_cos(w) < 1e-30);
    }
}
