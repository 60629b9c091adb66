//! Settings that are wrong, and degenerate scenes.

use std::sync::Mutex;

use super::{CHOICES, COMBINATIONS, Strategy, from_above, strategies};
use crate::support::{sphere_light, white};
use mis::lighting::{
    Bsdf, Camera, Combination, DVec3, Direction, Lambert, Light, LightChoice, Picture, PointLight,
    Rectangle, RenderError, Renderer, Scene, Sphere, Surface,
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

#[test]
fn wrong_settings_are_named() {
    let (scene, camera) = (lit_floor(), from_above(4));
    let new = || Renderer::new(&scene, &camera);
    let message = |result: Result<Renderer<'_, f64>, mis::ArgumentError>| {
        result.map(|_| ()).unwrap_err().to_string()
    };
    assert_eq!(
        message(new().rays(0)),
        "Renderer: `rays` is 0, but it must be at least 1 and at most 2^32"
    );
    assert!(new().rays(1 << 32).is_ok());
    assert_eq!(new().rays((1 << 32) + 1).unwrap_err().argument(), "rays");
    assert_eq!(
        message(new().samples(0, 0)),
        "Renderer: `of_bsdf` is 0, but it must be at least 1 and at most 2^32"
    );
    assert_eq!(new().samples((1 << 32) + 1, 0).unwrap_err().argument(), "of_lights");
    assert_eq!(new().samples(0, (1 << 32) + 1).unwrap_err().argument(), "of_bsdf");
    assert!(new().samples(0, 1).is_ok() && new().samples(1, 0).is_ok());
    assert_eq!(
        message(new().window(1..5, 0..4)),
        "Renderer: `columns` is 1..5, but it must not be empty, and within the 4 of the film"
    );
    assert_eq!(new().window(0..4, 4..5).unwrap_err().argument(), "rows");
    assert_eq!(new().window(0..4, 2..2).unwrap_err().argument(), "rows");
    #[expect(clippy::reversed_empty_ranges, reason = "it is wrong")]
    let backwards = new().window(3..2, 0..4);
    assert_eq!(backwards.unwrap_err().argument(), "columns");
    assert_eq!(message(new().threads(0)), "Renderer: `threads` is 0, but it must be at least 1");
}

#[test]
fn constant_weights_need_one_technique_for_all_lights() {
    let (scene, camera) = (lit_floor(), from_above(2));
    let each = Renderer::new(&scene, &camera).light_choice(LightChoice::Each);
    let error = each.clone().combination(Combination::Constant).render(1).unwrap_err();
    assert_eq!(
        error.to_string(),
        "Renderer: `light_choice` is Each, but constant weights need one technique for all lights"
    );
    assert!(matches!(&error, RenderError::Argument(error) if error.argument() == "light_choice"));
    assert!(each.render(1).is_ok());
    // Where the BSDF has no samples, the lights have all the weight.
    let lights = |combination| {
        let strategy = Strategy { combination, choice: LightChoice::Power, samples: [2, 0] };
        strategy.renderer(&scene, &camera, 4).render(3).unwrap()
    };
    assert_eq!(lights(Combination::Constant), lights(Combination::Balance));
}

#[test]
fn errors_and_renderers_are_told_in_words() {
    let (scene, camera) = (lit_floor(), from_above(2));
    let renderer = Renderer::new(&scene, &camera);
    let debug = format!("{renderer:?}");
    let told = "Renderer { combination: Balance, light_choice: Uniform, rays: 16, samples: [1, 1], \
                columns: 0..2, rows: 0..2, threads: None, .. }";
    assert_eq!(debug, told);
    let error = RenderError::Threads { threads: 7, message: "no more".to_owned() };
    assert_eq!(error.to_string(), "7 threads could not be started: no more");
}

/// A BSDF without a value.
#[derive(Debug)]
struct Unknown;

impl Bsdf for Unknown {
    type Value = f64;

    fn value(&self, _: &Surface, _: &Direction) -> f64 {
        f64::NAN
    }

    fn sample(&self, _: usize, surface: &Surface, _: &[f64]) -> Direction {
        surface.normal()
    }

    fn pdf(&self, _: usize, _: &Surface, _: &Direction) -> f64 {
        1.0
    }
}

#[test]
fn a_value_that_is_not_finite_is_an_error() {
    let scene = Scene::new().light(lamp()).surface(floor(), Unknown);
    let camera = from_above(2);
    for combination in COMBINATIONS {
        let error = Renderer::new(&scene, &camera).combination(combination).render(1).unwrap_err();
        assert!(matches!(&error, RenderError::Estimate(_)), "{combination:?}: {error}");
        assert!(error.to_string().contains("NaN"), "{error}");
    }
}

#[test]
fn a_picture_reports_how_much_of_it_is_done() {
    let (scene, camera) = (lit_floor(), from_above(9));
    let seen = Mutex::new(Vec::new());
    let watch = |part| seen.lock().unwrap().push(part);
    let renderer = Renderer::new(&scene, &camera).watch(&watch).threads(1).unwrap();
    let watched = renderer.render(1).unwrap();
    let seen = seen.lock().unwrap();
    assert!(seen.len() >= 9 && seen.is_sorted(), "{seen:?}");
    assert!(seen[0] > 0.0 && seen.last() == Some(&1.0));
    assert_eq!(watched, Renderer::new(&scene, &camera).render(1).unwrap());
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
    for scene in [
        Scene::new(),
        Scene::new().surface(floor(), white()),
        Scene::new().light(lamp()),
        Scene::new().light(dark).surface(floor(), white()),
        Scene::new().light(dark).light(dark).surface(floor(), white()),
    ] {
        for picture in pictures(&scene, &camera) {
            assert_eq!((picture.mean(), picture.standard_error_of_mean()), (0.0, Some(0.0)));
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
