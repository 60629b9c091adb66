//! The lighting integral: the radiance that leaves a point of a surface, from lights and a BSDF.
//!
//! L_r(p, ω_o) = ∫ f_r(p, ω, ω_o) L_i(p, ω) cos θ dω, over directions ω, can be sampled from each
//! factor: from a light, or from a lobe of the BSDF. Either alone is bad somewhere: the light where
//! the surface is shiny and the light large, the BSDF where the surface is rough and the light
//! small. All densities are per steradian, so that any weighting combines them.
//!
//! ```
//! use mis::lighting::{
//!     Bsdf, DVec3, Direction, Light, ModifiedPhong, ReflectedRadiance, Scene, Sphere, Surface,
//! };
//! use mis::{Estimator, MultiSample};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let lamp = Sphere::new(DVec3::new(1.0, 0.0, 1.0), 0.25)?;
//! let scene = Scene::new().light(Light::new(lamp, [9.0, 8.0, 5.0])?);
//!
//! let normal = Direction::new(DVec3::Z)?;
//! let eye = Direction::new(DVec3::new(-1.0, 0.1, 0.9))?;
//! let surface = Surface::new(DVec3::ZERO, normal, eye)?;
//! let bsdf = ModifiedPhong::new([0.8; 3], 50.0)?;
//!
//! let incident = scene.seen_from(surface.position())?;
//! let radiance = ReflectedRadiance::new(&incident, surface, &bsdf);
//! let light = &incident.lights()[0];
//! let lobe = &bsdf.techniques(&surface)[0];
//! let mis = MultiSample::new(&[(light, 512), (lobe, 512)])?;
//! let [red, green, blue] = mis.estimate(&radiance, 1)?.value();
//! assert!(red > green && green > blue);
//! # Ok(())
//! # }
//! ```
//!
//! # In a renderer's terms
//!
//! | line of a path tracer | here |
//! |---|---|
//! | `wi = light->Sample_L(p, xi, &pdf)` | `light.sample(xi)`, with `light` a [`SeenLight`] of [`Incident::lights`] |
//! | `light->Pdf(p, wi)` | `light.pdf(&wi)`; 0 where `wi` misses the light |
//! | `light->Le(p, wi)` | [`light.emitted(&wi)`](SeenLight::emitted) |
//! | visible `Li` along `wi` | [`incident.radiance(&wi)`](Incident::radiance) |
//! | `wi = bsdf->Sample_f(wo, xi, &pdf)` | `lobe.sample(xi)`, with `lobe` of [`Bsdf::techniques`] |
//! | `bsdf->Pdf(wo, wi)` | `lobe.pdf(&wi)` |
//! | `bsdf->f(wo, wi)` | [`bsdf.value(&surface, &wi)`](Bsdf::value) |
//! | `f * Li * AbsDot(wi, n)` | [`ReflectedRadiance`], the integrand |
//! | the weights, `/ pdf`, the loop over samples | [`MultiSample`](crate::MultiSample) or [`OneSample`](crate::OneSample) |
//!
//! Samples below the surface contribute 0 and count. A [`PointLight`] has no density, so it is not a
//! technique: what it adds is exact ([`ReflectedRadiance::from_point_lights`]). A [`Sphere`] has a
//! radius greater than 0.
//!
//! # Pictures
//!
//! A [`Renderer`] makes a picture of a [`Scene`] with a [`Camera`]. A pixel is an integral over its
//! square and over the directions of light: rays of the camera, and samples of the lights and of the BSDF
//! where each of them ends. [`Combination`] names the estimator, [`LightChoice`] how several lights are
//! sampled: by one technique that picks one of them, or by one for each.
//!
//! | strategy | how |
//! |---|---|
//! | lights only, BSDF only | [`samples(m, 0)`](Renderer::samples), `samples(0, m)` |
//! | constant weights | [`Combination::Constant`] |
//! | balance, power, maximum | [`Combination::Balance`] and so on |
//! | one sample, of a strategy by chance | [`Combination::OneSample`] |
//! | least variance, pixel by pixel | [`Combination::Optimal`] |
//!
//! `cargo run --release --example veach` renders E. Veach's figure of four plates under four lights by
//! all of them, and tells where each wins.
//!
#![doc = include_str!("veach.md")]
//!
//! # Speed
//!
//! `cargo bench --bench render` renders a floor of microfacets under a sphere and a rectangle, beside a
//! loop that is written for that scene alone; millions of samples a second on one thread of an AMD EPYC:
//!
//! | | by hand | [`Renderer`] | ratio |
//! |---|--:|--:|--:|
//! | one camera ray for each pixel, 16 samples of the lights and 16 of the BSDF | 28.5 | 22.8 | 0.80 |
//! | 16 rays, one sample of each for each ray | 16.2 | 5.9 | 0.37 |
//!
//! What a point sees is found out ray by ray, for any scene; by hand, it is known. Two threads are 1.97
//! times as fast as one.
//!
//! # Limits
//!
//! Light is reflected once, on its way from a light to the eye. Surfaces are rectangles. Directions are
//! `f64`: sizes and lobes below about 1e-12 radians are near their resolution (see
//! [`Direction`]). Lights emit the same radiance everywhere and reflect nothing; surfaces are opaque.

#![expect(
    clippy::inline_always,
    reason = "a call keeps a loop from being compiled for the processor's vectors"
)]

mod bsdf;
mod camera;
mod direction;
mod ggx;
mod incident;
mod lambert;
mod light;
mod phong;
mod piece;
mod placed;
mod rectangle;
mod reflected;
mod render;
mod scene;
mod shape;
mod spectrum;
mod sphere;
mod surface;
mod turn;

pub use bsdf::{Bsdf, Lobe};
pub use camera::Camera;
pub use direction::Direction;
pub use ggx::{GgxConductor, GgxLobe};
/// The vector of three `f64` by which positions are given, of the crate `glam`.
pub use glam::DVec3;
pub use incident::Incident;
pub use lambert::{CosineHemisphere, Lambert};
pub use light::{Light, PointLight, SeenLight};
pub use phong::{ModifiedPhong, PhongLobe};
pub use rectangle::{Rectangle, SphericalRectangle};
pub use reflected::ReflectedRadiance;
pub use render::{Combination, LightChoice, Picture, Pixel, RenderError, Renderer};
pub use scene::Scene;
pub use shape::{Shape, SolidAngle};
pub use spectrum::Spectrum;
pub use sphere::{Cone, Sphere};
pub use surface::Surface;
