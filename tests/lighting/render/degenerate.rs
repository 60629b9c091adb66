//! Scenes with nothing in them or nothing to see, cameras in odd places, single rays.

use super::{CHOICES, COMBINATIONS, Strategy, error_of, from_above, strategies};
use crate::support::{sphere_light, white};
use mis::lighting::{
    Camera, Combination, DVec3, Lambert, Light, LightChoice, Picture, PointLight, Rectangle, Scene,
    Sphere,
};

fn floor() -> Rectangle {
    Rectangle::new(DVec3::ZERO, 3.0 * DVec3::X, 3.0 * DVec3::Y).unwrap()
}

fn lamp() -> Light<f64> {
    // Not in view from above.
    sphere_light(DVec3::new(1.5, 0.0, 2.0), 0.25, 3.0)
}

fn lit_floor() -> Scene<f64> {
    Scene::new().light(lamp()).surface(floor(), white())
}

/// Every strategy's picture of the scene, two pixels wide.
fn pictures(scene: &Scene<f64>, camera: &Camera) -> Vec<Picture<f64>> {
    let picture = |strategy: &Strategy| strategy.renderer(scene, camera, 8).render(1).unwrap();
    strategies().iter().map(picture).collect()
}

#[test]
fn scenes_with_nothing_to_see() {
    let camera = from_above(2);
    let dark = sphere_light(DVec3::new(1.5, 0.0, 2.0), 0.25, 0.0);
    // That nothing is seen is known; that samples of a surface are all 0 does not tell an error.
    for (scene, error) in [
        (Scene::new(), Some(0.0)),
        (Scene::new().light(lamp()), Some(0.0)),
        (Scene::new().surface(floor(), white()), None),
        (Scene::new().light(dark).surface(floor(), white()), None),
        (Scene::new().light(dark).light(dark).surface(floor(), white()), None),
    ] {
        for picture in pictures(&scene, &camera) {
            assert_eq!((picture.mean(), picture.standard_error_of_mean()), (0.0, error));
            assert!(picture.pixels().iter().all(|pixel| pixel.standard_error() == error));
            assert!(picture.pixels().iter().all(|pixel| pixel.light_share().is_none()));
        }
    }
}

#[test]
fn a_dark_light_beside_a_bright_one_is_never_picked_by_power() {
    let dark = sphere_light(DVec3::new(-0.5, 0.0, 2.0), 0.25, 0.0);
    let two = lit_floor().light(dark);
    let (one, camera) = (lit_floor(), from_above(2));
    for combination in COMBINATIONS {
        let strategy = Strategy { combination, choice: LightChoice::Power, samples: [2, 1] };
        let of = |scene| strategy.renderer(scene, &camera, 4).render(2).unwrap();
        for (a, b) in of(&one).pixels().iter().zip(of(&two).pixels()) {
            let (a, b) = (a.value(), b.value());
            assert!((a - b).abs() <= 1e-12 * a, "{combination:?}: {a} {b}");
        }
    }
}

#[test]
fn the_inside_of_a_light_is_its_radiance() {
    // The camera is in the light, and so is the floor.
    let scene = Scene::new().light(sphere_light(DVec3::Z, 20.0, 2.5)).surface(
        Rectangle::new(DVec3::ZERO, DVec3::X, DVec3::Y).unwrap(),
        Lambert::new(0.5).unwrap(),
    );
    let away = Camera::new(5.0 * DVec3::Z, 6.0 * DVec3::Z, DVec3::Y, 1.0, 2, 2).unwrap();
    for picture in pictures(&scene, &away) {
        assert!(picture.pixels().iter().all(|pixel| pixel.value() == 2.5));
    }
}

#[test]
fn a_surface_edge_on_is_not_seen() {
    let scene = lit_floor();
    // The camera is in the plane of the floor; the light is to its side.
    for height in [0.0, 1e-17] {
        let eye = DVec3::new(0.0, -5.0, height);
        let camera = Camera::new(eye, DVec3::ZERO, DVec3::Z, 0.1, 4, 4).unwrap();
        for picture in pictures(&scene, &camera) {
            assert_eq!(picture.mean(), 0.0);
        }
    }
}

#[test]
fn a_single_ray_has_no_error() {
    let (scene, camera) = (lit_floor(), from_above(1));
    for strategy in strategies() {
        let picture = strategy.renderer(&scene, &camera, 1).render(1).unwrap();
        assert_eq!((picture.width(), picture.height()), (1, 1));
        let pixel = picture.pixel(0, 0).unwrap();
        assert_eq!((pixel.rays(), pixel.standard_error()), (1, None), "{strategy:?}");
        assert!(pixel.value() >= 0.0 && pixel.value().is_finite());
        assert_eq!((picture.mean(), picture.standard_error_of_mean()), (pixel.value(), None));
        assert_eq!(picture.pixel(0, 1), None);
        assert_eq!(picture.pixel(1, 0), None);
    }
}

#[test]
fn a_scene_of_every_kind_in_colour() {
    let sphere = Sphere::new(DVec3::new(1.5, 0.0, 2.0), 0.25).unwrap();
    let bright = Light::new(sphere, [3.0, 0.0, 1.0]);
    let point = PointLight::new(DVec3::new(0.0, 1.0, 2.0), [0.0, 1.0, 0.0]).unwrap();
    let scene = Scene::new()
        .light(bright.unwrap())
        .point_light(point)
        .surface(floor(), Lambert::new([0.5, 0.25, 0.0]).unwrap());
    let camera = from_above(2);
    for combination in COMBINATIONS {
        for choice in CHOICES {
            if (combination, choice) == (Combination::Constant, LightChoice::Each) {
                continue;
            }
            let strategy = Strategy { combination, choice, samples: [1, 1] };
            let picture = strategy.renderer(&scene, &camera, 8).render(1).unwrap();
            let [red, green, blue] = picture.mean();
            assert!(red > 0.0 && green > 0.0 && blue == 0.0, "{strategy:?}");
            assert_eq!(picture.standard_error_of_mean().unwrap()[2], 0.0);
        }
    }
}

#[test]
fn a_light_edge_on_is_not_seen_and_still_lights() {
    // The eye is in the plane of a panel that lights the floor from 2 above, and of an occluder.
    let panel = Rectangle::new(DVec3::new(0.0, 0.0, 2.0), 0.5 * DVec3::Y, 0.5 * DVec3::X).unwrap();
    let sheet = Rectangle::new(DVec3::new(0.0, -2.0, 2.0), DVec3::X, 0.5 * DVec3::Y).unwrap();
    let scene = Scene::new()
        .light(Light::one_sided(panel, 3.0).unwrap())
        .surface(floor(), white())
        .occluder(sheet);
    let eye = DVec3::new(0.0, -4.0, 2.0);
    let along = Camera::new(eye, DVec3::new(0.0, 0.0, 2.0), DVec3::Z, 1e-3, 2, 2).unwrap();
    let down = Camera::new(eye, DVec3::ZERO, DVec3::Z, 0.1, 2, 2).unwrap();
    for picture in pictures(&scene, &along) {
        assert_eq!(picture.mean(), 0.0);
    }
    for (picture, strategy) in pictures(&scene, &down).iter().zip(strategies()) {
        assert!(picture.mean() > 0.0 || strategy == Strategy::BSDF, "{strategy:?}");
    }
}

#[test]
fn more_samples_or_lights_than_rays() {
    let scene = (0..40).fold(Scene::new().surface(floor(), white()), |scene, k| {
        scene.light(sphere_light(DVec3::new(1.5, f64::from(k), 2.0), 0.25, 3.0))
    });
    let camera = from_above(1);
    for mut strategy in strategies() {
        strategy.samples = strategy.samples.map(|n| 7 * n);
        let picture = strategy.renderer(&scene, &camera, 3).render(1).unwrap();
        assert!(picture.mean().is_finite() && picture.mean() >= 0.0, "{strategy:?}");
    }
}

#[test]
fn surfaces_in_one_plane_do_not_shadow_each_other() {
    // Tiles of a tilted plane that overlap, from far away: digits of the point are lost along the ray.
    let normal = DVec3::new(0.3, -0.5, 0.8).normalize();
    let (x, y) = normal.any_orthonormal_pair();
    let tile = |at: f64| Rectangle::new(at * x, 2.0 * x, 2.0 * y).unwrap();
    // A speck in the middle above lights all points of a small view alike.
    let r = 1e-6;
    let scene = Scene::new()
        .light(sphere_light(2.0 * normal, r, 1.0 / (r * r)))
        .surface(tile(-1.0), white())
        .surface(tile(1.0), white());
    for distance in [10.0, 1e4, 1e7] {
        for eye in [normal, (normal + x).normalize(), (normal + 3.0 * y).normalize()] {
            let camera = Camera::new(distance * eye, DVec3::ZERO, DVec3::Y, 1e-4 / distance, 4, 4);
            let camera = camera.unwrap();
            let strategy = Strategy { samples: [1, 0], ..Strategy::BSDF };
            let picture = strategy.renderer(&scene, &camera, 32).render(1).unwrap();
            for pixel in picture.pixels() {
                let (value, error) = (pixel.value(), error_of(pixel));
                let all = (value - 0.25).abs() < 1e-7 && error < 1e-7;
                assert!(all, "{distance}: {value} ± {error}");
            }
        }
    }
}

#[test]
fn optimal_weights_have_no_shares_however_few_the_rays() {
    let (scene, camera) = (lit_floor(), from_above(2));
    let combination = mis::lighting::Combination::Optimal;
    let strategy = Strategy { combination, choice: LightChoice::Uniform, samples: [1, 1] };
    for rays in [4, 16, 4099] {
        let picture = strategy.renderer(&scene, &camera, rays).render(1).unwrap();
        assert!(picture.pixels().iter().all(|pixel| pixel.light_share().is_none()), "{rays}");
    }
}
