//! Rectangles, and the directions towards one, uniform in solid angle.

use glam::DVec3;

use super::direction::Direction;
use super::piece::{Piece, solid_angle};
use super::placed::{InPlane, Placed};
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

    /// The centre.
    #[must_use]
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// The normal, x × y of the two vectors that it is made of.
    #[must_use]
    pub fn normal(&self) -> Direction {
        Direction::from_unit(self.x.vector().cross(self.y.vector()))
    }

    /// The area of one side.
    #[must_use]
    pub fn area(&self) -> f64 {
        let [x, y] = self.half;
        4.0 * x * y
    }

    /// The unit vectors along the edges, and half the lengths of these.
    pub(super) fn edges(&self) -> ([DVec3; 2], [f64; 2]) {
        ([self.x.vector(), self.y.vector()], self.half)
    }

    /// The nearest point of the rectangle's plane.
    pub(super) fn projected(&self, point: DVec3) -> DVec3 {
        let normal = self.normal().vector();
        point - normal * normal.dot(point - self.centre)
    }

    /// What `point` sees of the rectangle, if it is not in its plane.
    pub(super) fn outline_from(&self, point: DVec3) -> Option<Placed> {
        Placed::new(self, point).ok()
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
    placed: Placed,
    solid_angle: f64,
    /// 1 over the solid angle.
    density: f64,
}

impl SphericalRectangle {
    fn new(rectangle: &Rectangle, point: DVec3) -> Result<Self, ArgumentError> {
        let invalid = |rule: &'static str| ArgumentError::new(OWNER, "point", point, rule);
        let placed = Placed::new(rectangle, point)
            .map_err(|InPlane| invalid("it must be finite and outside the rectangle's plane"))?;
        let parts = placed.parts().map(|(x, y)| solid_angle(x, y, placed.height));
        let solid_angle: f64 = parts.sum();
        if !solid_angle.is_normal() {
            return Err(invalid("the rectangle's solid angle must be within the range of f64"));
        }
        Ok(Self { placed, solid_angle, density: solid_angle.recip() })
    }

    /// The solid angle Ω in steradians.
    #[must_use]
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    #[inline(always)]
    pub(super) fn contains(&self, w: &Direction) -> bool {
        self.placed.contains(w)
    }

    pub(super) fn density(&self) -> f64 {
        self.density
    }

    /// The distance to the rectangle in the direction `w`, or `None` where it misses.
    ///
    /// It is a number exactly where [`pdf`](Technique::pdf) is positive.
    #[must_use]
    pub fn hit(&self, w: &Direction) -> Option<f64> {
        self.placed.hit(w)
    }

    /// The map from canonical numbers to directions. It is made for every batch of samples: most points
    /// that see a rectangle have use for its density alone.
    pub(super) fn map(&self) -> Map<'_> {
        let mut pieces = [None; 4];
        for (piece, (x, y)) in pieces.iter_mut().zip(self.placed.parts()) {
            *piece = Some(Piece::new(x, y, self.placed.height));
        }
        Map { rectangle: self, pieces }
    }
}

/// The pieces of a rectangle's solid angle.
pub(super) struct Map<'a> {
    rectangle: &'a SphericalRectangle,
    pieces: [Option<Piece>; 4],
}

impl Map<'_> {
    #[inline(always)]
    pub(super) fn sample(&self, xi: &[f64]) -> Direction {
        let mut remaining = canonical(xi, 0) * self.rectangle.solid_angle;
        let mut pieces = self.pieces.iter().flatten().peekable();
        while let Some(piece) = pieces.next() {
            let omega = piece.solid_angle();
            if remaining < omega || pieces.peek().is_none() {
                let local = piece.point((remaining / omega).clamp(0.0, 1.0), canonical(xi, 1));
                return self.rectangle.placed.direction(local);
            }
            remaining -= omega;
        }
        Direction::from_unit(DVec3::NAN)
    }
}

impl Technique for SphericalRectangle {
    type Point = Direction;

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> Direction {
        self.map().sample(xi)
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<Direction>) {
        let map = self.map();
        xs.clear();
        xs.extend(xi.chunks_exact(2).map(|xi| map.sample(xi)));
    }

    fn pdf(&self, w: &Direction) -> f64 {
        if self.contains(w) { self.density } else { 0.0 }
    }
}
