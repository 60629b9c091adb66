//! The shapes of lights and occluders, and the directions towards one.

use std::f64::consts::TAU;

use glam::DVec3;

use super::direction::Direction;
use super::placed::Placed;
use super::rectangle::{Rectangle, SphericalRectangle};
use super::sphere::{Cone, Sphere};
use crate::error::ArgumentError;
use crate::technique::Technique;

/// A surface that emits light or casts a shadow.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// A sphere.
    Sphere(Sphere),
    /// A rectangle.
    Rectangle(Rectangle),
}

impl Shape {
    /// The centre.
    #[must_use]
    pub fn centre(&self) -> DVec3 {
        match self {
            Self::Sphere(sphere) => sphere.centre(),
            Self::Rectangle(rectangle) => rectangle.centre(),
        }
    }

    /// The area of the surface; of both sides of a rectangle.
    #[must_use]
    pub fn area(&self) -> f64 {
        match self {
            Self::Sphere(sphere) => 2.0 * TAU * sphere.radius() * sphere.radius(),
            Self::Rectangle(rectangle) => 2.0 * rectangle.area(),
        }
    }

    /// What `point` sees of the shape, if it fills a solid angle.
    pub(super) fn outline_from(&self, point: DVec3) -> Option<Outline> {
        match self {
            Self::Sphere(sphere) => sphere.seen_from(point).ok().map(Outline::Sphere),
            Self::Rectangle(rectangle) => rectangle.outline_from(point).map(Outline::Rectangle),
        }
    }

    /// The directions from `point` towards the shape, as a technique.
    ///
    /// # Errors
    ///
    /// As [`Sphere::seen_from`] and [`Rectangle::seen_from`]: where the shape fills no solid
    /// angle, there is no density.
    pub fn seen_from(&self, point: DVec3) -> Result<SolidAngle, ArgumentError> {
        match self {
            Self::Sphere(sphere) => sphere.seen_from(point).map(SolidAngle::Sphere),
            Self::Rectangle(rectangle) => rectangle.seen_from(point).map(SolidAngle::Rectangle),
        }
    }
}

impl From<Sphere> for Shape {
    fn from(sphere: Sphere) -> Self {
        Self::Sphere(sphere)
    }
}

impl From<Rectangle> for Shape {
    fn from(rectangle: Rectangle) -> Self {
        Self::Rectangle(rectangle)
    }
}

/// Where a shape is, as a point sees it: no more than what hides others needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Outline {
    Sphere(Cone),
    Rectangle(Placed),
}

impl Outline {
    /// The distance to the shape in the direction `w`, or `None` where it misses.
    pub(super) fn hit(&self, w: &Direction) -> Option<f64> {
        match self {
            Self::Sphere(cone) => cone.hit(w),
            Self::Rectangle(placed) => placed.hit(w),
        }
    }
}

/// The uniform density on the directions from a point that meet a shape, per steradian.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum SolidAngle {
    /// A sphere's.
    Sphere(Cone),
    /// A rectangle's.
    Rectangle(SphericalRectangle),
}

impl SolidAngle {
    /// The solid angle in steradians.
    #[must_use]
    pub fn value(&self) -> f64 {
        match self {
            Self::Sphere(cone) => cone.solid_angle(),
            Self::Rectangle(rectangle) => rectangle.solid_angle(),
        }
    }

    /// The samples of pairs of canonical numbers.
    #[inline(always)]
    pub(super) fn fill(&self, xi: &[[f64; 2]], ws: &mut [Direction]) {
        let pairs = ws.iter_mut().zip(xi);
        match self {
            Self::Sphere(cone) => pairs.for_each(|(w, xi)| *w = cone.sample(xi)),
            Self::Rectangle(rectangle) => {
                let map = rectangle.map();
                pairs.for_each(|(w, xi)| *w = map.sample(xi));
            }
        }
    }

    /// Whether the direction `w` meets the shape.
    #[inline(always)]
    pub(super) fn contains(&self, w: &Direction) -> bool {
        match self {
            Self::Sphere(cone) => cone.contains(w),
            Self::Rectangle(rectangle) => rectangle.contains(w),
        }
    }

    /// The density within: 1 over the solid angle.
    pub(super) fn density(&self) -> f64 {
        match self {
            Self::Sphere(cone) => cone.density(),
            Self::Rectangle(rectangle) => rectangle.density(),
        }
    }

    /// The distance to the shape in the direction `w`, or `None` where it misses.
    ///
    /// It is a number exactly where [`pdf`](Technique::pdf) is positive.
    #[must_use]
    pub fn hit(&self, w: &Direction) -> Option<f64> {
        match self {
            Self::Sphere(cone) => cone.hit(w),
            Self::Rectangle(rectangle) => rectangle.hit(w),
        }
    }
}

impl Technique for SolidAngle {
    type Point = Direction;

    fn dimension(&self) -> usize {
        2
    }

    #[inline(always)]
    fn sample(&self, xi: &[f64]) -> Direction {
        match self {
            Self::Sphere(cone) => cone.sample(xi),
            Self::Rectangle(rectangle) => rectangle.sample(xi),
        }
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<Direction>) {
        match self {
            Self::Sphere(cone) => cone.sample_batch(xi, xs),
            Self::Rectangle(rectangle) => rectangle.sample_batch(xi, xs),
        }
    }

    fn pdf(&self, w: &Direction) -> f64 {
        match self {
            Self::Sphere(cone) => cone.pdf(w),
            Self::Rectangle(rectangle) => rectangle.pdf(w),
        }
    }
}
