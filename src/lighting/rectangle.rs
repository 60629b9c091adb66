//! Rectangles, and the directions towards one, uniform in solid angle.

use glam::DVec3;

use super::direction::Direction;
use super::piece::{Interval, Piece};
use crate::error::ArgumentError;
use crate::technique::{Technique, canonical};

/// A rectangle, by its centre and the two perpendicular vectors from there to the middle of an
/// edge. It has two sides: as a light it radiates from both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    centre: DVec3,
    x: Direction,
    y: Direction,
    half: [f64; 2],
}

const OWNER: &str = "Rectangle";

/// The least height above the plane, in units of the largest length: the product of three such
/// lengths is still a normal number.
const LOWEST: f64 = 1e-100;

/// The directions of two edges, made perpendicular to the rounding of a direction.
fn axes(
    names: [&'static str; 2],
    x: DVec3,
    y: DVec3,
) -> Result<(Direction, Direction), ArgumentError> {
    let edge = |name: &'static str, vector: DVec3| {
        Direction::new(vector)
            .map_err(|error| ArgumentError::new(OWNER, name, vector, error.rule().to_owned()))
    };
    let (along_x, along_y) = (edge(names[0], x)?, edge(names[1], y)?);
    let cos = along_x.cos(along_y);
    if !(cos.abs() <= 1e-12) {
        let rule = format!("it must be perpendicular to {} = {x}", names[0]);
        return Err(ArgumentError::new(OWNER, names[1], y, rule));
    }
    Ok((along_x, Direction::new(along_y.vector() - cos * along_x.vector())?))
}

impl Rectangle {
    /// The rectangle with the corners `centre` ± `half_x` ± `half_y`.
    ///
    /// # Errors
    ///
    /// All must be finite; `half_x` and `half_y` must not be 0, and must be perpendicular: the
    /// cosine of their angle at most 1e-12, which is left to their rounding. What there is of it
    /// is taken off `half_y`.
    pub fn new(centre: DVec3, half_x: DVec3, half_y: DVec3) -> Result<Self, ArgumentError> {
        if !centre.is_finite() {
            return Err(ArgumentError::new(OWNER, "centre", centre, "it must be finite"));
        }
        let (x, y) = axes(["half_x", "half_y"], half_x, half_y)?;
        Ok(Self { centre, x, y, half: [half_x.dot(x.vector()), half_y.dot(y.vector())] })
    }

    /// The rectangle with one corner at `corner`, from which the edges `x` and `y` lead.
    ///
    /// # Errors
    ///
    /// As [`new`](Rectangle::new), of `corner`, `x` and `y`; the centre must be finite, too.
    pub fn from_corner(corner: DVec3, x: DVec3, y: DVec3) -> Result<Self, ArgumentError> {
        axes(["x", "y"], x, y)?;
        let (half_x, half_y) = (0.5 * x, 0.5 * y);
        let centre = corner + half_x + half_y;
        if !centre.is_finite() {
            let rule = "it must be finite, and so must the centre of the rectangle";
            return Err(ArgumentError::new(OWNER, "corner", corner, rule));
        }
        Self::new(centre, half_x, half_y)
    }

    /// The directions from `point` towards the rectangle, as a technique.
    ///
    /// # Errors
    ///
    /// `point` must be finite and outside the rectangle's plane, where its solid angle is 0; the
    /// solid angle must be within the range of `f64`.
    pub fn seen_from(&self, point: DVec3) -> Result<SphericalRectangle, ArgumentError> {
        SphericalRectangle::new(self, point)
    }
}

/// The uniform density on the directions from a point that meet a rectangle, per steradian.
///
/// p(ω) = 1 / Ω within the rectangle's solid angle Ω, else 0.
///
/// ```
/// use mis::lighting::{DVec3, Rectangle};
/// use mis::technique::Technique;
/// # fn main() -> Result<(), mis::ArgumentError> {
/// // One face of a cube, seen from the cube's centre: a sixth of all directions.
/// let face = Rectangle::new(DVec3::Z, DVec3::X, DVec3::Y)?.seen_from(DVec3::ZERO)?;
/// let sphere = 4.0 * std::f64::consts::PI;
/// assert!((face.solid_angle() / sphere - 1.0 / 6.0).abs() < 1e-16);
/// let w = face.sample(&[0.9, 0.2]);
/// assert_eq!(face.pdf(&w), 1.0 / face.solid_angle());
/// # Ok(())
/// # }
/// ```
///
/// # Numerics
///
/// The rectangle is cut at the foot of the perpendicular from the point into at most four pieces,
/// in whose coordinates every term of the solid angle and of its inverse is positive, so that
/// nothing cancels. The first canonical number selects the piece; the map is smooth within each.
///
/// A direction meets the rectangle if it is on the inner side of the four planes
/// through the point and an edge, each moved outwards by the rounding of a direction, 4ε.
///
/// A point counts as in the plane if its distance from it is within the rounding of the positions
/// or 1e-100 of the largest length, or if the whole rectangle is less than 8ε radians above its
/// horizon.
///
/// Source of the idea: C. Ureña, M. Fajardo and A. King, *An Area-Preserving Parametrization for
/// Spherical Rectangles*, Computer Graphics Forum 32(4), 2013. The form is this crate's.
#[derive(Debug, Clone, PartialEq)]
pub struct SphericalRectangle {
    /// The axes of the rectangle, and its normal away from the point.
    axes: [DVec3; 3],
    /// What lengths are given in.
    unit: f64,
    /// The distance of the plane.
    height: f64,
    pieces: Vec<Piece>,
    solid_angle: f64,
    /// Normals, inwards, of the planes through the point and an edge; then of the plane through
    /// the point and parallel to the rectangle.
    planes: [DVec3; 5],
    nearest: f64,
    farthest: f64,
}

impl SphericalRectangle {
    fn new(rectangle: &Rectangle, point: DVec3) -> Result<Self, ArgumentError> {
        let invalid = |rule: &'static str| ArgumentError::new(OWNER, "point", point, rule);
        let (x, y) = (rectangle.x.vector(), rectangle.y.vector());
        let z = x.cross(y);
        let to_centre = rectangle.centre - point;
        // What rounding of the positions and of z can make of a height of 0.
        let [ax, ay] = [x.abs(), y.abs()];
        let terms = DVec3::new(
            ax.y * ay.z + ax.z * ay.y,
            ax.z * ay.x + ax.x * ay.z,
            ax.x * ay.y + ax.y * ay.x,
        );
        let rounding =
            4.0 * f64::EPSILON * terms.dot(to_centre.abs() + point.abs() + rectangle.centre.abs());
        // In a unit near the largest length, a power of 2, products of lengths stay in range.
        let [half_x, half_y] = rectangle.half;
        let largest = to_centre.abs().max_element().max(half_x).max(half_y);
        let unit = f64::from_bits(largest.to_bits() & f64::INFINITY.to_bits());
        let (to_centre, rounding) = (to_centre / unit, rounding / unit);
        let offset = to_centre.dot(z);
        let height = offset.abs();
        let [u, v] = [
            Interval::around(to_centre.dot(x), half_x / unit),
            Interval::around(to_centre.dot(y), half_y / unit),
        ];
        let nearest = DVec3::new(u.nearest(), v.nearest(), height).length();
        if !(height > rounding.max(8.0 * f64::EPSILON * nearest).max(LOWEST)) {
            return Err(invalid("it must be finite and outside the rectangle's plane"));
        }
        let mut pieces = Vec::with_capacity(4);
        for u in u.same_signed() {
            pieces.extend(v.same_signed().map(|v| Piece::new(u, v, height)));
        }
        let solid_angle: f64 = pieces.iter().map(Piece::solid_angle).sum();
        if !solid_angle.is_normal() {
            return Err(invalid("the rectangle's solid angle must be within the range of f64"));
        }
        let axes = [x, y, z * offset.signum()];
        let plane = |axis: DVec3, edge: f64, inwards: f64| {
            inwards * (height * axis - edge * axes[2]) / height.hypot(edge)
        };
        Ok(Self {
            axes,
            unit,
            height,
            pieces,
            solid_angle,
            planes: [
                plane(x, u.low, 1.0),
                plane(x, u.high, -1.0),
                plane(y, v.low, 1.0),
                plane(y, v.high, -1.0),
                axes[2],
            ],
            nearest,
            farthest: DVec3::new(u.farthest(), v.farthest(), height).length(),
        })
    }

    /// The solid angle Ω in steradians.
    #[must_use]
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    fn contains(&self, w: &Direction) -> bool {
        self.planes.iter().all(|n| n.dot(w.vector()) >= -4.0 * f64::EPSILON)
    }

    /// The distance to the rectangle in the direction `w`, or `None` where it misses.
    ///
    /// It is a number exactly where [`pdf`](Technique::pdf) is positive.
    #[must_use]
    pub fn hit(&self, w: &Direction) -> Option<f64> {
        self.contains(w).then(|| {
            // At a grazing angle the cosine is mostly rounding; the distance stays in its range.
            let cos = w.vector().dot(self.axes[2]).max(f64::MIN_POSITIVE);
            self.unit * (self.height / cos).clamp(self.nearest, self.farthest)
        })
    }
}

impl Technique for SphericalRectangle {
    type Point = Direction;

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> Direction {
        let mut remaining = canonical(xi, 0) * self.solid_angle;
        let mut pieces = self.pieces.iter().peekable();
        while let Some(piece) = pieces.next() {
            let omega = piece.solid_angle();
            if remaining < omega || pieces.peek().is_none() {
                let local = piece.point((remaining / omega).clamp(0.0, 1.0), canonical(xi, 1));
                let local = local / local.length();
                let [x, y, z] = self.axes;
                return Direction::from_unit(local.x * x + local.y * y + local.z * z);
            }
            remaining -= omega;
        }
        Direction::from_unit(DVec3::NAN)
    }

    fn pdf(&self, w: &Direction) -> f64 {
        if self.contains(w) { self.solid_angle.recip() } else { 0.0 }
    }
}
