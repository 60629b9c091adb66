//! A point that reflects light.

use glam::DVec3;

use super::direction::{Direction, Frame};
use crate::error::ArgumentError;

/// A point of a surface, with the direction in which its light is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    position: DVec3,
    frame: Frame,
    outgoing: Direction,
    mirror: Direction,
    /// ω_o in the frame.
    local_outgoing: DVec3,
}

impl Surface {
    /// The surface at `position` with this `normal`, seen from the direction `outgoing`.
    ///
    /// # Errors
    ///
    /// `position` must be finite, and `outgoing` on the side of the normal: surfaces are opaque.
    pub fn new(
        position: DVec3,
        normal: Direction,
        outgoing: Direction,
    ) -> Result<Self, ArgumentError> {
        if !position.is_finite() {
            return Err(ArgumentError::new("Surface", "position", position, "it must be finite"));
        }
        if !(outgoing.cos(normal) > 0.0) {
            let rule = "it must be on the side of the normal";
            return Err(ArgumentError::new("Surface", "outgoing", outgoing, rule));
        }
        Ok(Self::seen(position, normal, outgoing))
    }

    /// What is known to be valid.
    pub(super) fn seen(position: DVec3, normal: Direction, outgoing: Direction) -> Self {
        let mirror = outgoing.reflected(normal);
        let frame = Frame::new(normal);
        let local_outgoing = frame.local(outgoing);
        Self { position, frame, outgoing, mirror, local_outgoing }
    }

    /// The point p.
    #[must_use]
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// The normal.
    #[must_use]
    pub fn normal(&self) -> Direction {
        self.frame.axis
    }

    /// The normal, with two directions in the surface.
    pub(super) fn frame(&self) -> &Frame {
        &self.frame
    }

    /// ω_o in the frame.
    pub(super) fn local_outgoing(&self) -> DVec3 {
        self.local_outgoing
    }

    /// The direction ω_o towards the eye.
    #[must_use]
    pub fn outgoing(&self) -> Direction {
        self.outgoing
    }

    /// The mirror direction of ω_o.
    #[must_use]
    pub fn mirror(&self) -> Direction {
        self.mirror
    }
}
