//! The renderer: pixels, strategies, errors, closed forms, degenerate scenes.

mod arguments;
mod closed_forms;
mod degenerate;
mod errors;
mod extremes;
mod pixels;
mod reproducible;
mod strategies;

use mis::lighting::{
    Camera, Combination, DVec3, LightChoice, Picture, Pixel, Renderer, Scene, Spectrum,
};

pub(crate) const COMBINATIONS: [Combination; 6] = [
    Combination::Constant,
    Combination::Balance,
    Combination::Power,
    Combination::Maximum,
    Combination::OneSample,
    Combination::Optimal,
];

pub(crate) const CHOICES: [LightChoice; 3] =
    [LightChoice::Uniform, LightChoice::Power, LightChoice::Each];

/// How a picture is made: everything but its scene, its rays and its seed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Strategy {
    pub(crate) combination: Combination,
    pub(crate) choice: LightChoice,
    /// Of the lights and of the BSDF.
    pub(crate) samples: [u64; 2],
}

impl Strategy {
    pub(crate) const BSDF: Self =
        Self { combination: Combination::Balance, choice: LightChoice::Uniform, samples: [0, 1] };

    pub(crate) fn renderer<'a, V: Spectrum>(
        &self,
        scene: &'a Scene<V>,
        camera: &'a Camera,
        rays: u64,
    ) -> Renderer<'a, V> {
        let [of_lights, of_bsdf] = self.samples;
        Renderer::new(scene, camera)
            .combination(self.combination)
            .light_choice(self.choice)
            .rays(rays)
            .unwrap()
            .samples(of_lights, of_bsdf)
            .unwrap()
            .threads(1)
            .unwrap()
    }
}

/// Every combination of one sample each with every choice of lights; the lights alone, by every
/// choice; the BSDF alone.
pub(crate) fn strategies() -> Vec<Strategy> {
    let pairs = COMBINATIONS.iter().flat_map(|a| CHOICES.map(|b| (*a, b)));
    let fits = |(a, b): &(_, _)| (*a, *b) != (Combination::Constant, LightChoice::Each);
    let with = |samples| move |(combination, choice)| Strategy { combination, choice, samples };
    let lights = CHOICES.map(|choice| with([1, 0])((Combination::Balance, choice)));
    let mut all: Vec<_> = pairs.filter(fits).map(with([1, 1])).collect();
    all.extend(lights);
    all.push(Strategy::BSDF);
    all
}

/// A camera above the origin that looks down on it; y is up in its picture, half a unit of the floor
/// z = 0 from the middle to the edge.
pub(crate) fn from_above(size: u32) -> Camera {
    let eye = DVec3::new(0.0, 0.0, 5.0);
    Camera::new(eye, DVec3::ZERO, DVec3::Y, 2.0 * 0.1_f64.atan(), size, size).unwrap()
}

/// One pixel that shows the point `target` from `eye`, as good as nothing beside it.
pub(crate) fn spot(eye: DVec3, target: DVec3) -> Camera {
    let up = (target - eye).any_orthogonal_vector();
    Camera::new(eye, target, up, 1e-9, 1, 1).unwrap()
}

/// A single grey pixel: value and standard error.
pub(crate) fn only(picture: &Picture<f64>) -> (f64, f64) {
    assert_eq!(picture.pixels().len(), 1);
    let pixel = picture.pixels()[0];
    (pixel.value(), error_of(&pixel))
}

/// The standard error; 0 where every sample was 0, and nothing is known of it.
pub(crate) fn error_of(pixel: &Pixel<f64>) -> f64 {
    pixel.standard_error().unwrap_or_else(|| {
        assert!(pixel.rays() > 1 && pixel.value() == 0.0, "{pixel:?}");
        0.0
    })
}
