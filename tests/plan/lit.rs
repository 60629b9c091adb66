//! Points of Veach's plates: a light and a lobe.

use mis::Integrand;
use mis::lighting::{
    DVec3, Direction, Light, ModifiedPhong, PhongLobe, ReflectedRadiance, Scene, Sphere, Surface,
};

use crate::problems::{Problem, one, problem};

const EYE: DVec3 = DVec3::new(0.0, 2.0, 15.0);

/// The mirror point of a light on a plate: the light by x, radius and radiance; the plate by its lower
/// and upper edge, and its exponent.
fn point(
    name: &'static str,
    integral: f64,
    (x, radius, radiance): (f64, f64, f64),
    (lower, upper, exponent): ([f64; 2], [f64; 2], f64),
) -> Problem {
    let edge = DVec3::new(0.0, upper[0] - lower[0], upper[1] - lower[1]);
    let normal = Direction::new(DVec3::X.cross(edge)).unwrap();
    let corner = DVec3::new(0.0, lower[0], lower[1]);
    let centre = DVec3::new(x, 0.0, 0.0);
    let height = |v: DVec3| (v - corner).dot(normal.vector());
    let mirrored = centre - 2.0 * height(centre) * normal.vector();
    let position = EYE.lerp(mirrored, height(EYE) / (height(EYE) + height(centre)));
    let outgoing = Direction::new(EYE - position).unwrap();
    let light = Light::new(Sphere::new(centre, radius).unwrap(), radiance).unwrap();
    let surface = Surface::new(position, normal, outgoing).unwrap();
    let incident = Scene::new().light(light).seen_from(position).unwrap();
    let bsdf = ModifiedPhong::new(1.0, exponent).unwrap();
    let seen = incident.lights()[0].clone();
    let lobe = PhongLobe::new(surface.mirror(), exponent).unwrap();
    problem(name, vec![one(seen), one(lobe)], Some(vec![integral]), move |w: &Direction| {
        ReflectedRadiance::new(&incident, surface, &bsdf).eval(w)
    })
}

pub(crate) fn problems() -> Vec<Problem> {
    let shiny = ([-2.70651, 0.25609], [-2.08375, -0.526_323], 30_000.0);
    let rough = ([-3.99615, 4.0667], [-3.82069, 3.08221], 100.0);
    vec![
        point("shiny plate, small light", 676.050, (-3.75, 0.03333, 901.803), shiny),
        point("shiny plate, large light", 9.0480, (1.25, 0.3, 11.1111), shiny),
        point("rough plate, large light", 0.55966, (3.75, 0.9, 1.23457), rough),
    ]
}
