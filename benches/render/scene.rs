//! A floor of microfacets under a sphere and a rectangle.

use mis::lighting::{Camera, DVec3, GgxConductor, Light, Rectangle, Scene, Sphere};

pub(crate) fn scene() -> Scene<f64> {
    let sphere = Sphere::new(DVec3::new(0.9, 0.8, 0.9), 0.25).unwrap();
    // Its normal points down.
    let (half_x, half_y) = (-0.35 * DVec3::X, 0.25 * DVec3::Y);
    let ceiling = Rectangle::new(DVec3::new(-0.8, 0.7, 1.1), half_x, half_y).unwrap();
    let floor = Rectangle::new(DVec3::ZERO, 2.0 * DVec3::X, 2.0 * DVec3::Y).unwrap();
    Scene::new()
        .light(Light::new(sphere, 5.0).unwrap())
        .light(Light::one_sided(ceiling, 8.0).unwrap())
        .surface(floor, GgxConductor::new(1.0, 0.1).unwrap())
}

/// With a film of `size` by `size` pixels.
pub(crate) fn camera(size: u32) -> Camera {
    let (eye, target) = (DVec3::new(0.0, -3.2, 1.6), DVec3::new(0.0, 0.3, 0.0));
    Camera::new(eye, target, DVec3::Z, 40_f64.to_radians(), size, size).unwrap()
}
