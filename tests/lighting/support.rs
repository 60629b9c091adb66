//! What the tests of the lighting integral share.

use crate::common::quadrature::gauss;
use mis::lighting::{
    Bsdf, DVec3, Direction, Incident, Lambert, Light, Rectangle, ReflectedRadiance, Scene, Sphere,
    Surface,
};
use mis::{Estimate, Integrand, Technique};

pub(crate) fn direction(x: f64, y: f64, z: f64) -> Direction {
    Direction::new(DVec3::new(x, y, z)).unwrap()
}

/// A surface at the origin with the normal along z, seen from the normal's direction.
pub(crate) fn horizontal() -> Surface {
    Surface::new(DVec3::ZERO, direction(0.0, 0.0, 1.0), direction(0.0, 0.0, 1.0)).unwrap()
}

/// A Lambert surface that reflects all: the reflected radiance is the irradiance over π.
pub(crate) fn white() -> Lambert<f64> {
    Lambert::new(1.0).unwrap()
}

pub(crate) fn sphere_light(centre: DVec3, radius: f64, radiance: f64) -> Light<f64> {
    Light::new(Sphere::new(centre, radius).unwrap(), radiance).unwrap()
}

/// Corners are low and high ends of x and y at a height z.
pub(crate) fn ceiling(x: [f64; 2], y: [f64; 2], z: f64) -> Rectangle {
    Rectangle::from_corner(
        DVec3::new(x[0], y[0], z),
        (x[1] - x[0]) * DVec3::X,
        (y[1] - y[0]) * DVec3::Y,
    )
    .unwrap()
}

/// ∫ g dω over the support of `p`, by a product rule in ξ: exact for what is smooth in ξ.
pub(crate) fn over(
    p: &dyn Technique<Point = Direction>,
    panels: usize,
    g: &dyn Fn(&Direction) -> f64,
) -> f64 {
    let rule = gauss(panels);
    let mut sum = 0.0;
    for &(u, wu) in &rule {
        for &(v, wv) in &rule {
            let w = p.sample(&[u, v]);
            sum += wu * wv * g(&w) / p.pdf(&w);
        }
    }
    sum
}

/// The reflected radiance by quadrature over the first light.
pub(crate) fn by_quadrature(
    incident: &Incident<f64>,
    surface: Surface,
    bsdf: &impl Bsdf<Value = f64>,
    panels: usize,
) -> f64 {
    let f = ReflectedRadiance::new(incident, surface, bsdf);
    over(&incident.lights()[0], panels, &|w| f.eval(w))
}

/// What arrives at the origin from a single light.
pub(crate) fn alone(light: Light<f64>) -> Incident<f64> {
    Scene::new().light(light).seen_from(DVec3::ZERO).unwrap()
}

/// E / L for a polygon that is wholly above the horizon of the normal, seen from the origin:
/// ½ Σ γ_k n·(v_k × v_k+1) / |v_k × v_k+1|, with the angles γ_k between vertices.
///
/// Source: J. H. Lambert, *Photometria*, 1760.
pub(crate) fn polygon_irradiance(normal: Direction, vertices: &[DVec3]) -> f64 {
    let next = vertices.iter().cycle().skip(1);
    let edges = vertices.iter().zip(next).map(|(v, w)| {
        let cross = v.cross(*w);
        let gamma = cross.length().atan2(v.dot(*w));
        gamma * normal.vector().dot(cross) / cross.length()
    });
    0.5 * edges.sum::<f64>().abs()
}

pub(crate) fn corners(x: [f64; 2], y: [f64; 2], z: f64) -> [DVec3; 4] {
    [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])].map(|(x, y)| DVec3::new(x, y, z))
}

pub(crate) fn assert_close(value: f64, exact: f64, relative: f64) {
    let error = (value / exact - 1.0).abs();
    assert!(error <= relative, "{value} for {exact}: off by {error:e}, allowed {relative:e}");
}

/// |z| < 5, and a standard error of at most `relative` times the exact value.
pub(crate) fn assert_unbiased(estimate: &Estimate, exact: f64, relative: f64, what: &str) {
    let error = estimate.standard_error().expect("a known error");
    let z = (estimate.value() - exact) / error;
    assert!(z.abs() < 5.0, "{what}: {estimate} for {exact}: z = {z}");
    assert!(error <= relative * exact, "{what}: {estimate} for {exact}: error too large");
}
