//! Pixels of a small scene, against quadrature and an independent renderer.
//!
//! A floor of microfacets, a sphere and a rectangle as lights, and a pinhole camera. A pixel is the
//! integral over its square and over the directions of the light at the point that it shows; the
//! techniques sample a point of the square and then a light or the floor's lobe.

use crate::support::direction;
use mis::lighting::{
    Bsdf, DVec3, Direction, GgxConductor, GgxLobe, Light, Rectangle, ReflectedRadiance, Scene,
    Shape, Sphere, Surface,
};
use mis::points::Sobol;
use mis::technique::canonical;
use mis::{Estimator, MultiSample, Technique};

const SIZE: f64 = 256.0;
const ROUGHNESS: f64 = 0.1;

/// Column and row, the value by quadrature, and Mitsuba 3.9.1's with its standard error.
const PIXELS: [(u32, u32, f64, f64, f64); 10] = [
    (195, 173, 2.375_750_230_898_3, 2.375_870_4, 3.3e-4),
    (191, 159, 2.095_655_176_5, 2.095_383_8, 3.5e-4),
    (216, 173, 0.959_383_106_791_08, 0.959_208_87, 2.3e-4),
    (183, 135, 0.278_337_166_881_48, 0.278_412_68, 7.6e-5),
    (64, 203, 1.800_077_828_942, 1.800_059_9, 3.3e-4),
    (96, 190, 1.102_811_358_818_7, 1.102_687_3, 2.8e-4),
    (55, 235, 0.332_012_806_737_81, 0.332_010_17, 7.1e-5),
    (128, 181, 0.063_897_317_258_776, 0.063_897_975, 1.5e-5),
    (128, 216, 0.060_297_482_295_293, 0.060_289_944, 1.2e-5),
    (34, 149, 0.255_583_257_295_25, 0.255_624_48, 6.8e-5),
];

/// A point of the floor that a pixel shows, and a direction of light.
#[derive(Debug, Clone)]
struct Path {
    surface: Surface,
    w: Direction,
}

struct Camera {
    eye: DVec3,
    forward: DVec3,
    left: DVec3,
    up: DVec3,
}

impl Camera {
    fn new() -> Self {
        let eye = DVec3::new(0.0, -3.2, 1.6);
        let forward = (DVec3::new(0.0, 0.3, 0.0) - eye).normalize();
        let left = DVec3::Z.cross(forward).normalize();
        Self { eye, forward, left, up: forward.cross(left) }
    }

    /// The point of the floor at a position on the film, in pixels.
    fn surface(&self, x: f64, y: f64) -> Surface {
        let t = 20_f64.to_radians().tan();
        let ray = self.forward
            + t * (1.0 - 2.0 * x / SIZE) * self.left
            + t * (1.0 - 2.0 * y / SIZE) * self.up;
        let position = self.eye + ray * (self.eye.z / -ray.z);
        let to_eye = Direction::new(-ray).unwrap();
        Surface::new(DVec3::new(position.x, position.y, 0.0), direction(0.0, 0.0, 1.0), to_eye)
            .unwrap()
    }
}

enum Towards {
    Light(Shape),
    Lobe,
}

/// A position in a pixel, then a direction from the point that it shows.
struct FromPixel<'a> {
    camera: &'a Camera,
    pixel: (u32, u32),
    towards: Towards,
}

impl FromPixel<'_> {
    fn directions(&self, surface: &Surface) -> Box<dyn Technique<Point = Direction>> {
        match &self.towards {
            Towards::Light(shape) => Box::new(shape.seen_from(surface.position()).unwrap()),
            Towards::Lobe => Box::new(GgxLobe::new(surface, ROUGHNESS).unwrap()),
        }
    }
}

impl Technique for FromPixel<'_> {
    type Point = Path;

    fn dimension(&self) -> usize {
        4
    }

    fn sample(&self, xi: &[f64]) -> Path {
        let (column, row) = self.pixel;
        let at = (f64::from(column) + canonical(xi, 0), f64::from(row) + canonical(xi, 1));
        let surface = self.camera.surface(at.0, at.1);
        Path { surface, w: self.directions(&surface).sample(&xi[2..]) }
    }

    /// Per pixel and steradian.
    fn pdf(&self, path: &Path) -> f64 {
        self.directions(&path.surface).pdf(&path.w)
    }
}

#[test]
fn pixels_agree_with_quadrature_and_with_an_independent_renderer() {
    agree(1 << 13, 4e-3);
}

#[test]
#[ignore = "ten seconds in an optimised build"]
fn pixels_agree_to_a_part_in_a_thousand() {
    agree(1 << 18, 1e-3);
}

/// With so many samples of each technique, and at most this standard error, over the value.
fn agree(samples: u64, relative: f64) {
    let sphere = Sphere::new(DVec3::new(0.9, 0.8, 0.9), 0.25).unwrap();
    let corner = DVec3::new(-0.8 - 0.35, 0.7 - 0.25, 1.1);
    let ceiling = Rectangle::from_corner(corner, 0.7 * DVec3::X, 0.5 * DVec3::Y).unwrap();
    let scene = Scene::new()
        .light(Light::new(sphere, 5.0).unwrap())
        .light(Light::new(ceiling, 8.0).unwrap());
    let bsdf = GgxConductor::new(1.0, ROUGHNESS).unwrap();
    let radiance = |path: &Path| {
        let incident = scene.seen_from(path.surface.position()).unwrap();
        let f = ReflectedRadiance::new(&incident, path.surface, &bsdf);
        mis::Integrand::eval(&f, &path.w)
    };
    // f cos θ does not depend on the lobe's technique.
    assert_eq!(bsdf.techniques(&Camera::new().surface(128.0, 200.0)).len(), 1);
    let camera = Camera::new();
    for (column, row, exact, rendered, its_error) in PIXELS {
        let pixel = (column, row);
        let towards = |towards| FromPixel { camera: &camera, pixel, towards };
        let techniques =
            [Towards::Light(sphere.into()), Towards::Light(ceiling.into()), Towards::Lobe]
                .map(towards);
        let [a, b, lobe] = &techniques;
        let mis = MultiSample::new(&[(a, samples), (b, samples), (lobe, samples)]).unwrap();
        let estimate = mis.estimate_from(&radiance, &Sobol::new(1)).unwrap();
        let (value, error) = (estimate.value(), estimate.standard_error().unwrap());
        assert!(error < relative * exact, "{pixel:?}: {estimate}");
        // Students' t with 15 degrees of freedom: all ten by chance in 2e-4 of cases.
        assert!((value - exact).abs() < 6.0 * error, "{pixel:?}: {estimate} for {exact}");
        let both = error.hypot(its_error);
        assert!((value - rendered).abs() < 6.0 * both, "{pixel:?}: {estimate} for {rendered}");
    }
}
