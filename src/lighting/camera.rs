//! The camera.

use glam::DVec3;

use super::direction::Direction;
use crate::error::ArgumentError;

/// A pinhole camera with a film of square pixels.
///
/// Positions on the film are in pixels: x from the left, y from the top. The pixel in column i and row
/// j is the square \[i, i + 1\] × \[j, j + 1\].
///
/// ```
/// use mis::lighting::{Camera, DVec3};
/// # fn main() -> Result<(), mis::ArgumentError> {
/// let camera = Camera::new(DVec3::ZERO, -DVec3::Z, DVec3::Y, 90_f64.to_radians(), 400, 200)?;
/// assert!((camera.direction(200.0, 100.0).vector() + DVec3::Z).length() < 1e-15);
/// // The middle of the upper edge is half of 90° above.
/// let up = camera.direction(200.0, 0.0).vector();
/// assert!((up - DVec3::new(0.0, 0.5, -0.5).normalize()).length() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    eye: DVec3,
    /// Towards the upper left corner of the film, at a distance where a pixel is 1 wide.
    corner: DVec3,
    right: DVec3,
    down: DVec3,
    width: u32,
    height: u32,
}

const OWNER: &str = "Camera";

impl Camera {
    /// The camera at `eye` that looks at `target`, with a film of `width` × `height` pixels.
    ///
    /// `up` is a vector that is upright in the picture. `field_of_view` is the angle from the upper to
    /// the lower edge, in radians.
    ///
    /// # Errors
    ///
    /// All must be finite; `target` must not be `eye`; `up` must not be 0 nor along the view;
    /// `field_of_view` must be in (0, π), and `width` and `height` in \[1, 65536\].
    pub fn new(
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        field_of_view: f64,
        width: u32,
        height: u32,
    ) -> Result<Self, ArgumentError> {
        if !eye.is_finite() {
            return Err(ArgumentError::new(OWNER, "eye", eye, "it must be finite"));
        }
        let forward = Direction::new(target - eye).map_err(|_| {
            ArgumentError::new(OWNER, "target", target, "it must be finite and not the eye")
        })?;
        let across = Direction::new(up).map(|up| forward.vector().cross(up.vector()));
        let right = across.and_then(Direction::new).map_err(|_| {
            let rule = "it must be finite, not 0, and not along the view";
            ArgumentError::new(OWNER, "up", up, rule)
        })?;
        if !(field_of_view > 0.0 && field_of_view < std::f64::consts::PI) {
            let rule = "it must be greater than 0 and less than π";
            return Err(ArgumentError::new(OWNER, "field_of_view", field_of_view, rule));
        }
        for (name, size) in [("width", width), ("height", height)] {
            if !(1..=1 << 16).contains(&size) {
                let rule = "it must be at least 1 and at most 65536";
                return Err(ArgumentError::new(OWNER, name, size, rule));
            }
        }
        let (right, down) = (right.vector(), forward.vector().cross(right.vector()));
        let [half_width, half_height] = [width, height].map(|size| 0.5 * f64::from(size));
        let distance = half_height / (0.5 * field_of_view).tan();
        let corner = distance * forward.vector() - half_width * right - half_height * down;
        Ok(Self { eye, corner, right, down, width, height })
    }

    /// The position of the pinhole.
    #[must_use]
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// The pixels in a row.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// The rows of pixels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The direction from the eye that a position on the film shows, in pixels from the left and from
    /// the top. Positions beside the film are shown too.
    #[must_use]
    pub fn direction(&self, x: f64, y: f64) -> Direction {
        let ray = self.corner + x * self.right + y * self.down;
        Direction::from_unit(ray.normalize())
    }
}

#[cfg(test)]
mod tests {
    use super::{Camera, DVec3};

    #[test]
    fn corners_of_a_wide_film() {
        // 28° high and 3 : 2 is 41.0108° wide.
        let camera =
            Camera::new(DVec3::ZERO, -DVec3::Z, 5.0 * DVec3::Y, 28_f64.to_radians(), 768, 512);
        let camera = camera.unwrap();
        let slope = |x, y| {
            let w = camera.direction(x, y).vector();
            (w.x / -w.z, w.y / -w.z)
        };
        let (half_width, half_height) =
            ((41.010_8_f64 / 2.0).to_radians().tan(), 14_f64.to_radians().tan());
        for (x, y, sx, sy) in
            [(0.0, 0.0, -1.0, 1.0), (768.0, 0.0, 1.0, 1.0), (0.0, 512.0, -1.0, -1.0)]
        {
            let (a, b) = slope(x, y);
            assert!((a - sx * half_width).abs() < 1e-6, "{a}");
            assert!((b - sy * half_height).abs() < 1e-15, "{b}");
        }
    }

    #[test]
    fn wrong_arguments_are_named() {
        let new = |eye, target, up, angle, width| {
            Camera::new(eye, target, up, angle, width, 1).map_err(|e| e.argument().to_owned())
        };
        let (o, z, y) = (DVec3::ZERO, DVec3::Z, DVec3::Y);
        assert!(new(o, z, y, 1.0, 1).is_ok());
        assert_eq!(new(DVec3::NAN, z, y, 1.0, 1).unwrap_err(), "eye");
        assert_eq!(new(o, o, y, 1.0, 1).unwrap_err(), "target");
        assert_eq!(new(o, z, z, 1.0, 1).unwrap_err(), "up");
        assert_eq!(new(o, z, o, 1.0, 1).unwrap_err(), "up");
        for angle in [0.0, std::f64::consts::PI, f64::NAN] {
            assert_eq!(new(o, z, y, angle, 1).unwrap_err(), "field_of_view");
        }
        assert_eq!(new(o, z, y, 1.0, 0).unwrap_err(), "width");
        assert_eq!(new(o, z, y, 1.0, 65_537).unwrap_err(), "width");
    }
}
