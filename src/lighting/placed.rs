//! A rectangle as it lies before a point.

use glam::DVec3;

use super::direction::Direction;
use super::piece::Interval;
use super::rectangle::Rectangle;

/// The least height above the plane, in units of the largest length: the product of three such
/// lengths is still a normal number.
const LOWEST: f64 = 1e-100;

/// How far outwards an edge is moved, in radians: the rounding of a direction.
const RIM: f64 = 4.0 * f64::EPSILON;

/// A rectangle in its own axes, with the point that sees it as the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placed {
    /// The axes of the rectangle, and its normal away from the point.
    axes: [DVec3; 3],
    /// What lengths are given in.
    unit: f64,
    /// The distance of the plane.
    pub(super) height: f64,
    x: Interval,
    y: Interval,
    /// Normals, inwards, of the planes through the point and an edge; their lengths are 1 to a factor
    /// of √2.
    planes: [DVec3; 4],
}

/// The point is in the plane of the rectangle, or is not finite.
#[derive(Debug)]
pub(super) struct InPlane;

impl Placed {
    pub(super) fn new(rectangle: &Rectangle, point: DVec3) -> Result<Self, InPlane> {
        let ([x, y], [half_x, half_y]) = rectangle.edges();
        let z = x.cross(y);
        let to_centre = rectangle.centre() - point;
        // What rounding of the positions and of z can make of a height of 0.
        let [ax, ay] = [x.abs(), y.abs()];
        let terms = DVec3::new(
            ax.y * ay.z + ax.z * ay.y,
            ax.z * ay.x + ax.x * ay.z,
            ax.x * ay.y + ax.y * ay.x,
        );
        let positions = to_centre.abs() + point.abs() + rectangle.centre().abs();
        let rounding = 4.0 * f64::EPSILON * terms.dot(positions);
        // In a unit near the largest length, a power of 2, products of lengths stay in range.
        let largest = to_centre.abs().max_element().max(half_x).max(half_y);
        let unit = f64::from_bits(largest.to_bits() & f64::INFINITY.to_bits());
        let (to_centre, rounding) = (to_centre / unit, rounding / unit);
        let offset = to_centre.dot(z);
        let height = offset.abs();
        let z = z * offset.signum();
        let along_x = Interval::around(to_centre.dot(x), half_x / unit);
        let along_y = Interval::around(to_centre.dot(y), half_y / unit);
        let plane = |axis: DVec3, edge: f64, inwards: f64| {
            (height * axis - edge * z) * (inwards / (height + edge.abs()))
        };
        let planes = [
            plane(x, along_x.low, 1.0),
            plane(x, along_x.high, -1.0),
            plane(y, along_y.low, 1.0),
            plane(y, along_y.high, -1.0),
        ];
        let placed = Self { axes: [x, y, z], unit, height, x: along_x, y: along_y, planes };
        // Not where the whole rectangle is within the rounding of the horizon.
        let lowest = rounding.max(8.0 * f64::EPSILON * placed.nearest()).max(LOWEST);
        if height > lowest { Ok(placed) } else { Err(InPlane) }
    }

    /// The parts of the rectangle whose coordinates do not change sign, mirrored to be positive.
    pub(super) fn parts(&self) -> impl Iterator<Item = (Interval, Interval)> {
        self.x.same_signed().flat_map(|x| self.y.same_signed().map(move |y| (x, y)))
    }

    fn nearest(&self) -> f64 {
        DVec3::new(self.x.nearest(), self.y.nearest(), self.height).length()
    }

    fn farthest(&self) -> f64 {
        DVec3::new(self.x.farthest(), self.y.farthest(), self.height).length()
    }

    /// The direction towards the point with these coordinates.
    #[inline(always)]
    pub(super) fn direction(&self, local: DVec3) -> Direction {
        let local = local.normalize();
        let [x, y, z] = self.axes;
        Direction::from_unit(local.x * x + local.y * y + local.z * z)
    }

    /// Whether `w` is on the inner side of the planes through the point and an edge, each moved
    /// outwards by the rounding of a direction.
    #[inline(always)]
    pub(super) fn contains(&self, w: &Direction) -> bool {
        let [_, _, z] = self.axes;
        let w = w.vector();
        let [a, b, c, d] = &self.planes;
        let within = |normal: &DVec3| normal.dot(w) >= -RIM;
        within(a) && within(b) && within(c) && within(d) && within(&z)
    }

    /// The distance to the rectangle in the direction `w`, or `None` where it misses.
    pub(super) fn hit(&self, w: &Direction) -> Option<f64> {
        self.contains(w).then(|| {
            // At a grazing angle the cosine is mostly rounding; the distance stays in its range.
            let [_, _, z] = self.axes;
            let cos = w.vector().dot(z).max(f64::MIN_POSITIVE);
            self.unit * (self.height / cos).clamp(self.nearest(), self.farthest())
        })
    }
}
