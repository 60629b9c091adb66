//! Lights without size: no density, no technique, an exact sum.

use std::f64::consts::FRAC_1_PI;

use crate::support::{assert_close, direction, horizontal, sphere_light, white};
use mis::lighting::{
    Bsdf, DVec3, Lambert, Light, ModifiedPhong, PointLight, Rectangle, ReflectedRadiance, Scene,
    Sphere, Surface,
};
use mis::{Estimator, MultiSample};

fn lamp(position: DVec3, intensity: f64) -> PointLight<f64> {
    PointLight::new(position, intensity).unwrap()
}

/// What the point lights of the scene add at the origin, on a white floor.
fn exact(scene: &Scene<f64>) -> f64 {
    let (incident, bsdf) = (scene.seen_from(DVec3::ZERO).unwrap(), white());
    ReflectedRadiance::new(&incident, horizontal(), &bsdf).from_point_lights()
}

#[test]
fn intensity_over_squared_distance() {
    let towards = DVec3::new(0.48, 0.64, 0.6);
    for distance in [1e-150, 1e-8, 1.0, 1e8, 1e150] {
        let scene = Scene::new().point_light(lamp(distance * towards, 2.0));
        assert_close(exact(&scene), 2.0 * 0.6 * FRAC_1_PI / distance / distance, 1e-15);
    }
    // So far away that d² overflows, with I / d² in range.
    let scene = Scene::new().point_light(lamp(1e200 * towards, 1e300));
    assert_close(exact(&scene), 0.6 * FRAC_1_PI * 1e-100, 1e-15);
    let two = Scene::new().point_light(lamp(towards, 2.0)).point_light(lamp(2.0 * DVec3::Z, 8.0));
    assert_close(exact(&two), (2.0 * 0.6 + 2.0) * FRAC_1_PI, 1e-15);
}

#[test]
fn below_the_horizon_or_hidden_it_is_dark() {
    let at = DVec3::new(1.0, 1.0, 2.0);
    let lit = Scene::new().point_light(lamp(at, 2.0));
    assert!(exact(&lit) > 0.0);
    for position in [DVec3::new(1.0, 0.0, -1e-9), DVec3::X, -DVec3::Z] {
        assert_eq!(exact(&Scene::new().point_light(lamp(position, 2.0))), 0.0);
    }
    let ball = |part: f64| Sphere::new(part * at, 0.1).unwrap();
    assert_eq!(exact(&lit.clone().occluder(ball(0.5))), 0.0);
    assert_eq!(exact(&lit.clone().occluder(ball(1.5))), exact(&lit));
    // Another light hides it, dark or not, from its back too; in a light, it is hidden from outside.
    assert_eq!(exact(&lit.clone().light(sphere_light(0.5 * at, 0.1, 0.0))), 0.0);
    assert_eq!(exact(&lit.clone().light(sphere_light(at, 0.1, 1.0))), 0.0);
    let panel = Rectangle::new(0.5 * at, DVec3::X, DVec3::Y).unwrap();
    assert_eq!(exact(&lit.clone().light(Light::one_sided(panel, 1.0).unwrap())), 0.0);
    let surface = lit.clone().surface(panel, white());
    assert_eq!(exact(&surface), 0.0);
    let behind = lit.light(sphere_light(2.0 * at, 0.1, 0.0));
    assert_close(exact(&behind), 4.0 * FRAC_1_PI / 6f64.powf(1.5), 1e-15);
}

#[test]
fn it_is_no_technique_and_not_in_the_integral() {
    let scene = Scene::new().point_light(lamp(DVec3::new(0.0, 1.0, 2.0), 5.0)).light(sphere_light(
        DVec3::new(1.0, 0.0, 2.0),
        0.5,
        3.0,
    ));
    let incident = scene.seen_from(DVec3::ZERO).unwrap();
    assert_eq!((incident.lights().len(), scene.lights().len()), (1, 1));
    assert_eq!(incident.radiance(&direction(0.0, 1.0, 2.0)), 0.0);
    let bsdf = white();
    let f = ReflectedRadiance::new(&incident, horizontal(), &bsdf);
    let mis = MultiSample::new(&[(&incident.lights()[0], 4000)]).unwrap();
    let estimate = mis.estimate(&f, 1).unwrap();
    let sphere = 3.0 * 0.25 / 5.0 * 2.0 / 5f64.sqrt();
    let z = (estimate.value() - sphere) / estimate.standard_error().unwrap();
    assert!(z.abs() < 5.0, "{estimate} for {sphere}");
}

/// A sphere that shrinks, with the same π r² L, becomes the point light.
#[test]
fn it_is_the_limit_of_small_spheres() {
    let centre = DVec3::new(0.3, 0.1, 2.0);
    let (glossy, diffuse) = (ModifiedPhong::new(0.5, 20.0).unwrap(), Lambert::new(0.3).unwrap());
    let bsdf = (diffuse, glossy);
    let surface =
        Surface::new(DVec3::ZERO, direction(0.0, 0.0, 1.0), direction(-0.2, 0.3, 1.0)).unwrap();
    let point = Scene::new().point_light(lamp(centre, 4.0)).seen_from(DVec3::ZERO).unwrap();
    let limit = ReflectedRadiance::new(&point, surface, &bsdf).from_point_lights();
    for r in [1e-2, 1e-4, 1e-6] {
        let sphere = sphere_light(centre, r, 4.0 * FRAC_1_PI / (r * r));
        let incident = Scene::new().light(sphere).seen_from(DVec3::ZERO).unwrap();
        let radiance = crate::support::by_quadrature(&incident, surface, &bsdf, 4);
        assert_close(radiance, limit, 10.0 * r * r + 1e-13);
    }
    assert_eq!(bsdf.lobes(), 2);
}

#[test]
fn wrong_arguments_are_named() {
    for bad in [DVec3::NAN, DVec3::INFINITY] {
        assert_eq!(PointLight::new(bad, 1.0).unwrap_err().argument(), "position");
    }
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(PointLight::new(DVec3::Z, [1.0, bad]).unwrap_err().argument(), "intensity");
    }
    let light = lamp(DVec3::Z, 2.0);
    assert_eq!((light.position(), light.intensity()), (DVec3::Z, 2.0));
    let scene = Scene::new().point_light(light);
    assert_eq!(
        scene.seen_from(DVec3::Z).unwrap_err().to_string(),
        "Scene: `point` is DVec3(0.0, 0.0, 1.0), but it must not be the position of a point light"
    );
}
