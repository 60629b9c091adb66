//! Standard errors are what they say.

use super::{COMBINATIONS, Strategy, error_of, from_above, strategies};
use crate::ensemble::{Spread, Z};
use crate::support::sphere_light;
use mis::lighting::{
    Camera, Combination, DVec3, Lambert, LightChoice, ModifiedPhong, PointLight, Rectangle, Scene,
    Sphere,
};

/// Two lights, two lobes, and the edge of a shadow in every pixel.
fn scene() -> Scene<f64> {
    let floor = Rectangle::new(DVec3::ZERO, 2.0 * DVec3::X, 2.0 * DVec3::Y).unwrap();
    let bsdf = (Lambert::new(0.4).unwrap(), ModifiedPhong::new(0.5, 20.0).unwrap());
    Scene::new()
        .light(sphere_light(DVec3::new(1.0, 0.5, 2.0), 0.5, 4.0))
        .light(sphere_light(DVec3::new(-1.2, 0.0, 1.5), 0.2, 10.0))
        .surface(floor, bsdf)
        .occluder(Sphere::new(DVec3::new(0.5, 0.2, 1.0), 0.15).unwrap())
}

/// What an ensemble of pictures says of the errors of its members.
struct Ensemble {
    /// The variance among the values, over the mean of the squared standard errors: the mean over the
    /// pixels, and its standard error.
    ratio: (f64, f64),
    /// How often the ensemble's mean is within the interval of 95 %.
    coverage: f64,
}

fn ensemble(
    (scene, camera): (&Scene<f64>, &Camera),
    strategy: &Strategy,
    rays: u64,
    seeds: u64,
) -> Ensemble {
    let renderer = strategy.renderer(scene, camera, rays);
    let pictures: Vec<_> = (0..seeds).map(|seed| renderer.render(seed).unwrap()).collect();
    // Of 95 %; Student's t where groups of rays tell the error: eight of 64, 40 of 1000.
    let quantile = match (strategy.combination, rays) {
        (Combination::Optimal, ..=64) => 2.365,
        (Combination::Optimal, _) => 2.023,
        _ => 1.960,
    };
    let (mut ratio, mut error2, mut covered) = (0.0, 0.0, 0.0);
    for pixel in 0..4 {
        let of = |g: &dyn Fn(&mis::lighting::Pixel<f64>) -> f64| -> Vec<f64> {
            pictures.iter().map(|picture| g(&picture.pixels()[pixel])).collect()
        };
        let values = of(&|pixel| pixel.value());
        let squares = of(&|pixel| error_of(pixel).powi(2));
        let (spread, told) = (Spread::of(&values), Spread::of(&squares));
        ratio += 0.25 * spread.variance / told.mean;
        // Of a variance, and of what it is divided by.
        error2 +=
            ((spread.kurtosis - 1.0) / spread.count + (told.error() / told.mean).powi(2)) / 16.0;
        let within = |(v, s): (&f64, &f64)| (v - spread.mean).abs() < quantile * s.sqrt();
        covered += values.iter().zip(&squares).filter(|pair| within(*pair)).count() as f64;
    }
    Ensemble { ratio: (ratio, error2.sqrt()), coverage: covered / (4 * seeds) as f64 }
}

/// The ratio is 1 to within 4.42 of its standard errors, and that is small; the interval covers about
/// as often as it says: less often where few rays carry the value.
fn assert_told(strategy: &Strategy, rays: u64, seeds: u64, coverage: f64) {
    let told = ensemble((&scene(), &from_above(2)), strategy, rays, seeds);
    let (ratio, error) = told.ratio;
    let what = format!("{strategy:?}, {rays} rays: {ratio:.3} ± {error:.3}, {:.3}", told.coverage);
    assert!((ratio - 1.0).abs() < Z * error && error < 1.0 / (seeds as f64).sqrt(), "{what}");
    assert!((coverage..0.975).contains(&told.coverage), "{what}");
}

#[test]
fn errors_are_those_of_an_ensemble() {
    for (combination, choice, samples) in [
        (Combination::Balance, LightChoice::Each, [1, 1]),
        (Combination::Power, LightChoice::Uniform, [3, 2]),
        (Combination::OneSample, LightChoice::Each, [1, 1]),
        (Combination::Optimal, LightChoice::Power, [1, 1]),
    ] {
        assert_told(&Strategy { combination, choice, samples }, 32, 100, 0.89);
    }
}

#[test]
#[ignore = "a minute in an optimised build"]
fn errors_of_every_strategy_are_those_of_an_ensemble() {
    for strategy in strategies() {
        // Few samples of the BSDF meet a light.
        let rare = strategy.samples == [0, 1] || strategy.combination == Combination::Constant;
        assert_told(&strategy, 64, 1000, if rare { 0.82 } else { 0.9 });
        assert_told(&strategy, 1000, 1000, 0.93);
    }
}

/// Rays of a pixel differ by more than their samples do: a ray's samples of both techniques go together.
#[test]
fn errors_of_pixels_with_an_edge() {
    // The edge of the floor in the middle of all pixels.
    let floor = Rectangle::new(DVec3::ZERO, 0.3 * DVec3::X, 2.0 * DVec3::Y).unwrap();
    let scene = Scene::new()
        .light(sphere_light(DVec3::new(0.0, 0.0, 8.0), 2.0, 1.0))
        .surface(floor, Lambert::new(0.5).unwrap());
    let eye = DVec3::new(0.3, 0.0, 5.0);
    let camera = Camera::new(eye, eye - DVec3::Z, DVec3::X, 0.01, 4, 1).unwrap();
    for combination in COMBINATIONS {
        let strategy = Strategy { combination, choice: LightChoice::Uniform, samples: [4, 4] };
        let told = ensemble((&scene, &camera), &strategy, 32, 100);
        let (ratio, error) = told.ratio;
        assert!((ratio - 1.0).abs() < Z * error && error < 0.1, "{combination:?}: {ratio}");
    }
}

/// Errors of what is sampled and of what is exact are added, as if they went together.
#[test]
fn optimal_errors_with_point_lights_are_not_too_small() {
    let lamp = PointLight::new(DVec3::new(0.0, -0.4, 4.0), 8.0).unwrap();
    let scene = scene().point_light(lamp);
    let (combination, choice) = (Combination::Optimal, LightChoice::Power);
    let strategy = Strategy { combination, choice, samples: [1, 1] };
    let Ensemble { ratio: (ratio, error), coverage } =
        ensemble((&scene, &from_above(2)), &strategy, 32, 100);
    assert!((0.25..1.0 + Z * error).contains(&ratio) && coverage > 0.93, "{ratio} {coverage}");
}
