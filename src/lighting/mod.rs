//! The lighting integral.

mod bsdf;
mod direction;
mod lambert;
mod phong;
mod piece;
mod rectangle;
mod reflected;
mod scene;
mod shape;
mod sphere;

pub use bsdf::{Bsdf, Surface};
pub use direction::Direction;
pub use glam::DVec3;
pub use lambert::{CosineHemisphere, Lambert};
pub use phong::{ModifiedPhong, PhongLobe};
pub use rectangle::{Rectangle, SphericalRectangle};
pub use reflected::ReflectedRadiance;
pub use scene::{Incident, Light, Scene, SeenLight, Spectrum};
pub use shape::{Shape, SolidAngle};
pub use sphere::{Cone, Sphere};
