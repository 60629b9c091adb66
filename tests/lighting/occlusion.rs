//! Shadows.

use crate::support::{
    assert_close, assert_unbiased, ceiling, corners, direction, horizontal, polygon_irradiance,
    sphere_light, white,
};
use mis::lighting::{
    Bsdf, DVec3, Incident, Light, Rectangle, ReflectedRadiance, Scene, Sphere, Surface,
};
use mis::{Estimator, MultiSample};

/// The irradiance over π by the light and the lobe, and by each alone.
fn assert_radiance(incident: &Incident<f64>, exact: f64) {
    let bsdf = white();
    let f = ReflectedRadiance::new(incident, horizontal(), &bsdf);
    let lobe = &bsdf.techniques(&horizontal())[0];
    let light = &incident.lights()[0];
    for (set, what) in [
        (vec![(light as _, 40_000)], "light"),
        (vec![(lobe as _, 100_000)], "BSDF"),
        (vec![(light as _, 20_000), (lobe as _, 20_000)], "both"),
    ] {
        let estimate = MultiSample::new(&set).unwrap().estimate(&f, 9).unwrap();
        assert_unbiased(&estimate, exact, 0.03, what);
    }
}

#[test]
fn a_rectangle_shadows_half_of_a_rectangle() {
    let light = Light::new(ceiling([-2.0, 2.0], [-2.0, 2.0], 2.0), 1.0).unwrap();
    // Halfway up, and half as large as what it hides.
    let scene = Scene::new().light(light).occluder(ceiling([0.0, 1.0], [-1.0, 1.0], 1.0));
    let visible = corners([-2.0, 0.0], [-2.0, 2.0], 2.0);
    let exact = polygon_irradiance(direction(0.0, 0.0, 1.0), &visible) / std::f64::consts::PI;
    assert_radiance(&scene.seen_from(DVec3::ZERO).unwrap(), exact);
    // Behind the light it hides nothing.
    let behind = Scene::new().light(light).occluder(ceiling([0.0, 1.0], [-1.0, 1.0], 2.1));
    let all = corners([-2.0, 2.0], [-2.0, 2.0], 2.0);
    let exact = polygon_irradiance(direction(0.0, 0.0, 1.0), &all) / std::f64::consts::PI;
    assert_radiance(&behind.seen_from(DVec3::ZERO).unwrap(), exact);
}

#[test]
fn a_sphere_shadows_the_middle_of_a_sphere() {
    let towards = DVec3::new(0.3, 0.1, (1.0_f64 - 0.1).sqrt());
    let scene = Scene::new()
        .light(sphere_light(4.0 * towards, 2.0, 3.0))
        .occluder(Sphere::new(1.5 * towards, 0.375).unwrap());
    let exact = 3.0 * (0.25 - 0.0625) * towards.z;
    assert_radiance(&scene.seen_from(DVec3::ZERO).unwrap(), exact);
}

#[test]
fn the_nearest_light_wins() {
    let towards = DVec3::new(0.0, 0.6, 0.8);
    let far = sphere_light(4.0 * towards, 2.0, 3.0);
    let near = sphere_light(1.5 * towards, 0.375, 10.0);
    for scene in [Scene::new().light(far).light(near), Scene::new().light(near).light(far)] {
        let incident = scene.seen_from(DVec3::ZERO).unwrap();
        let axis = direction(0.0, 0.6, 0.8);
        assert_eq!(incident.radiance(&axis), 10.0);
        assert_eq!(incident.radiance(&direction(0.35, 0.6, 0.8)), 3.0);
        assert_eq!(incident.radiance(&direction(0.0, 0.0, -1.0)), 0.0);
        let bsdf = white();
        let f = ReflectedRadiance::new(&incident, horizontal(), &bsdf);
        let [a, b] = incident.lights() else { panic!("two lights") };
        let mis = MultiSample::new(&[(a, 40_000), (b, 40_000)]).unwrap();
        let exact = 0.8 * (3.0 * (0.25 - 0.0625) + 10.0 * 0.0625);
        assert_unbiased(&mis.estimate(&f, 4).unwrap(), exact, 0.02, "two lights");
    }
}

#[test]
fn a_surface_does_not_shadow_itself() {
    // Points of a tilted plate and of a ball, both occluders, given to rounding.
    let tilt = DVec3::new(0.0, 0.62276, -0.782_413);
    let corner = DVec3::new(-4.0, -2.70651, 0.25609);
    let plate = Rectangle::from_corner(corner, 8.0 * DVec3::X, tilt).unwrap();
    let normal = direction(0.0, 0.782_413, 0.62276);
    let ball = Sphere::new(DVec3::new(7.0, -3.0, 2.0), 1.7).unwrap();
    for k in 1..100 {
        let at = f64::from(k) / 100.0;
        let point = corner + 8.0 * at * DVec3::X + (1.0 - at) * tilt;
        let outwards = direction(at - 0.5, 0.3, 1.1 * at);
        let on_ball = ball.centre() + ball.radius() * outwards.vector();
        for (point, normal, occluder) in
            [(point, normal, plate.into()), (on_ball, outwards, mis::lighting::Shape::from(ball))]
        {
            let surface = Surface::new(point, normal, normal).unwrap();
            let light = sphere_light(point + 5.0 * normal.vector(), 1.0, 1.0);
            let scene = Scene::new().light(light).occluder(occluder);
            let incident = scene.seen_from(surface.position()).unwrap();
            assert_eq!(incident.radiance(&normal), 1.0, "{at}");
            let bsdf = white();
            let f = ReflectedRadiance::new(&incident, surface, &bsdf);
            let mis = MultiSample::new(&[(&incident.lights()[0], 100)]).unwrap();
            assert_eq!(mis.estimate(&f, 1).unwrap().zero(), 0);
        }
        // But a ball does hide what is behind it.
        let inwards = mis::lighting::Direction::new(-outwards.vector()).unwrap();
        let light = sphere_light(on_ball + 5.0 * inwards.vector(), 1.0, 1.0);
        let scene = Scene::new().light(light).occluder(ball);
        assert_eq!(scene.seen_from(on_ball).unwrap().radiance(&inwards), 0.0);
    }
}

#[test]
fn a_small_ball_far_from_the_origin_does_not_shadow_itself() {
    let ball = Sphere::new(DVec3::new(7e3, -3e3, 2e3), 1e-3).unwrap();
    for k in 1..100 {
        let at = f64::from(k) / 100.0;
        let outwards = direction(at - 0.5, 0.3, 1.1 * at);
        let point = ball.centre() + ball.radius() * outwards.vector();
        let light = sphere_light(point + 5.0 * outwards.vector(), 1.0, 1.0);
        let scene = Scene::new().light(light).occluder(ball);
        assert_eq!(scene.seen_from(point).unwrap().radiance(&outwards), 1.0, "{at}");
    }
}

#[test]
fn a_light_on_a_wall_is_not_shadowed_by_the_wall() {
    for k in 0..20 {
        let turn = f64::from(k);
        let tilt = direction(0.3 * turn.sin(), 0.2 * turn.cos(), 0.9).vector();
        let (s, t) = tilt.any_orthonormal_pair();
        let centre = DVec3::new(0.1, 0.02 * turn, 3.0);
        let light = Light::new(Rectangle::new(centre, s, 0.5 * t).unwrap(), 1.0).unwrap();
        let wall = Rectangle::new(centre + 0.3 * s - 0.1 * turn * t, 7.0 * s, 5.0 * t).unwrap();
        let scene = Scene::new().light(light).occluder(wall);
        let incident = scene.seen_from(DVec3::ZERO).unwrap();
        let bsdf = white();
        let f = ReflectedRadiance::new(&incident, horizontal(), &bsdf);
        let mis = MultiSample::new(&[(&incident.lights()[0], 1000)]).unwrap();
        assert_eq!(mis.estimate(&f, 1).unwrap().zero(), 0, "{k}");
    }
}

#[test]
fn occluders_at_a_grazing_angle() {
    // A ball that the ray just touches or just misses, at a distance of 1e3 radii.
    let light = sphere_light(DVec3::new(0.0, 0.0, 1e6), 1e5, 1.0);
    let up = direction(0.0, 0.0, 1.0);
    for (offset, visible) in [(1.0 + 1e-9, 1.0), (1.0 - 1e-9, 0.0)] {
        let ball = Sphere::new(DVec3::new(offset, 0.0, 1e3), 1.0).unwrap();
        let scene = Scene::new().light(light).occluder(ball);
        assert_eq!(scene.seen_from(DVec3::ZERO).unwrap().radiance(&up), visible);
        // A wall edge on, whose rim the ray passes.
        let wall = ceiling([offset - 1.0, 5.0], [-1.0, 1.0], 2.0);
        let scene = Scene::new().light(light).occluder(wall);
        assert_eq!(scene.seen_from(DVec3::ZERO).unwrap().radiance(&up), visible);
    }
    // A sheet 1e-12 beside the ray, and along it, hides nothing; and the distances are right.
    let sheet = Rectangle::new(DVec3::new(1e-12, 0.0, 5.0), DVec3::Y, 2.0 * DVec3::Z).unwrap();
    let scene = Scene::new().light(light).occluder(sheet);
    let incident = scene.seen_from(DVec3::ZERO).unwrap();
    assert_eq!(incident.radiance(&up), 1.0);
    let across = direction(1e-12 / 4.0, 0.0, 1.0);
    assert_eq!(incident.radiance(&across), 0.0);
    assert!(incident.occluded(&across, 5.0) && !incident.occluded(&across, 2.9));
    let hit = sheet.seen_from(DVec3::ZERO).unwrap().hit(&across).unwrap();
    assert_close(hit, 4.0, 1e-3);
}
