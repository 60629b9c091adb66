//! Settings that are wrong, and errors.

use std::sync::Mutex;

use super::{COMBINATIONS, Strategy, from_above};
use crate::support::{sphere_light, white};
use mis::lighting::{
    Bsdf, Combination, DVec3, Direction, Light, LightChoice, Rectangle, RenderError, Renderer,
    Scene, Surface,
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
        "Renderer: `of_bsdf` is 0, but it must be at least 1 where there are none of the lights"
    );
    assert_eq!(new().samples((1 << 32) + 1, 0).unwrap_err().argument(), "of_lights");
    assert_eq!(new().samples(0, (1 << 32) + 1).unwrap_err().argument(), "of_bsdf");
    assert!(new().samples(0, 1).is_ok() && new().samples(1, 0).is_ok());
    assert_eq!(
        message(new().window(1..5, 0..4)),
        "Renderer: `columns` is 1..5, but it must not be empty, nor end beyond 4"
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
