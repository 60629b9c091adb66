//! The scene: five sphere lights above four glossy plates, a floor and a wall.
//!
//! Source: E. Veach and L. J. Guibas, *Optimally Combining Sampling Techniques for Monte Carlo Rendering*,
//! SIGGRAPH 1995, as public descriptions of the figure agree on it.

use mis::ArgumentError;
use mis::lighting::{
    Camera, DVec3, Lambert, Light, ModifiedPhong, Rectangle, Scene, Spectrum, Sphere,
};

/// Red, green and blue.
pub(crate) type Rgb = [f64; 3];

/// The film that the cells are pixels of, wherever a picture has its own size.
pub(crate) const FILM: [u32; 2] = [768, 512];

pub(crate) const EYE: DVec3 = DVec3::new(0.0, 2.0, 15.0);
const TARGET: DVec3 = DVec3::new(0.0, -2.0, 2.5);
/// From the upper to the lower edge, in degrees.
const FIELD_OF_VIEW: f64 = 28.0;

/// A sphere that emits the same radiance in every direction and channel.
pub(crate) struct Lamp {
    pub(crate) centre: DVec3,
    pub(crate) radius: f64,
    pub(crate) radiance: f64,
}

const fn lamp(centre: [f64; 3], radius: f64, radiance: f64) -> Lamp {
    Lamp { centre: DVec3::from_array(centre), radius, radiance }
}

/// Four of equal power, from a speck to a ball, and one overhead, out of the picture.
pub(crate) const LAMPS: [Lamp; 5] = [
    lamp([-3.75, 0.0, 0.0], 0.033_33, 901.803),
    lamp([-1.25, 0.0, 0.0], 0.1, 100.0),
    lamp([1.25, 0.0, 0.0], 0.3, 11.111_1),
    lamp([3.75, 0.0, 0.0], 0.9, 1.234_57),
    lamp([10.0, 10.0, 4.0], 0.5, 800.0),
];

/// How many lights are seen in the plates.
pub(crate) const SMALL: usize = 4;

/// A plate with x from -4 to 4, and its glossy lobe.
pub(crate) struct Plate {
    /// y and z of the lower and of the upper edge.
    lower: [f64; 2],
    upper: [f64; 2],
    pub(crate) exponent: f64,
}

/// From the far and shiny one to the near and rough one.
pub(crate) const PLATES: [Plate; 4] = [
    plate([-2.706_51, 0.256_09], [-2.083_75, -0.526_323], 30_000.0),
    plate([-3.288_25, 1.369_72], [-2.838_56, 0.476_536], 5000.0),
    plate([-3.730_96, 2.700_46], [-3.433_78, 1.745_64], 1500.0),
    plate([-3.996_15, 4.066_7], [-3.820_69, 3.082_21], 100.0),
];

const fn plate(lower: [f64; 2], upper: [f64; 2], exponent: f64) -> Plate {
    Plate { lower, upper, exponent }
}

impl Plate {
    pub(crate) fn rectangle(&self) -> Result<Rectangle, ArgumentError> {
        let [[y, z], [to_y, to_z]] = [self.lower, self.upper];
        let up = DVec3::new(0.0, to_y - y, to_z - z);
        Rectangle::from_corner(DVec3::new(-4.0, y, z), 8.0 * DVec3::X, up)
    }
}

const DIFFUSE: Rgb = [0.07, 0.09, 0.13];
/// The descriptions leave it open; with the diffuse part, it reflects at most 63 %.
const GLOSSY: Rgb = [0.5; 3];
/// Of the floor and the wall.
const GREY: Rgb = [0.4; 3];

pub(crate) fn scene() -> Result<Scene<Rgb>, ArgumentError> {
    let mut scene = Scene::new();
    for lamp in &LAMPS {
        scene = scene.light(Light::new(lamp.sphere()?, [lamp.radiance; 3])?);
    }
    for plate in &PLATES {
        let glossy = ModifiedPhong::new(GLOSSY, plate.exponent)?;
        scene = scene.surface(plate.rectangle()?, (Lambert::new(DIFFUSE)?, glossy));
    }
    let (x, y, z) = (10.0 * DVec3::X, 10.0 * DVec3::Y, 10.0 * DVec3::Z);
    let floor = Rectangle::new(DVec3::new(0.0, -4.146_15, 0.0), x, z)?;
    let wall = Rectangle::new(DVec3::new(0.0, 0.0, -2.0), x, y)?;
    Ok(scene.surface(floor, Lambert::new(GREY)?).surface(wall, Lambert::new(GREY)?))
}

impl Lamp {
    fn sphere(&self) -> Result<Sphere, ArgumentError> {
        Sphere::new(self.centre, self.radius)
    }
}

pub(crate) fn camera([width, height]: [u32; 2]) -> Result<Camera, ArgumentError> {
    Camera::new(EYE, TARGET, DVec3::Y, FIELD_OF_VIEW.to_radians(), width, height)
}

/// The position on a film of this size where a point is seen.
pub(crate) fn project(point: DVec3, size: [u32; 2]) -> [f64; 2] {
    let forward = (TARGET - EYE).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let [half_width, half_height] = size.map(|side| 0.5 * f64::from(side));
    let d = point - EYE;
    let scale = half_height / (0.5 * FIELD_OF_VIEW.to_radians()).tan() / d.dot(forward);
    [half_width + scale * d.dot(right), half_height - scale * d.dot(up)]
}

/// The mean of the channels.
pub(crate) fn grey(rgb: &Rgb) -> f64 {
    rgb.total() / 3.0
}
