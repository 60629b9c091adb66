//! The strategies, all with the same number of samples for each ray of the camera.

use mis::ArgumentError;
use mis::lighting::{Camera, Combination, Pixel, Renderer, Scene};

use crate::scene::Rgb;

#[derive(Debug, Clone, Copy)]
pub(crate) struct Strategy {
    /// On the command line and in the names of files.
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    combination: Combination,
    /// The halves of a ray's samples that are of the lights and of the BSDF.
    halves: [u64; 2],
}

const fn combined(name: &'static str, combination: Combination) -> Strategy {
    Strategy { name, title: name, combination, halves: [1, 1] }
}

const BALANCE: Combination = Combination::Balance;

pub(crate) const STRATEGIES: [Strategy; 8] = [
    Strategy { name: "light", title: "light only", combination: BALANCE, halves: [2, 0] },
    Strategy { name: "bsdf", title: "BSDF only", combination: BALANCE, halves: [0, 2] },
    combined("constant", Combination::Constant),
    combined("balance", BALANCE),
    combined("power", Combination::Power),
    combined("maximum", Combination::Maximum),
    combined("one-sample", Combination::OneSample),
    combined("optimal", Combination::Optimal),
];

/// What pictures are compared with: the balance heuristic, with more rays.
pub(crate) const REFERENCE: Strategy =
    Strategy { name: "reference", title: "reference", ..STRATEGIES[3] };

impl Strategy {
    /// With so many rays for each pixel, and samples, an even number, for each ray.
    pub(crate) fn renderer<'a>(
        &self,
        scene: &'a Scene<Rgb>,
        camera: &'a Camera,
        rays: u64,
        samples: u64,
    ) -> Result<Renderer<'a, Rgb>, ArgumentError> {
        let [of_lights, of_bsdf] = self.halves.map(|halves| halves * (samples / 2));
        let renderer = Renderer::new(scene, camera).combination(self.combination).rays(rays)?;
        renderer.samples(of_lights, of_bsdf)
    }

    /// The part of a pixel that this strategy is sure to see in as few samples as the reference.
    ///
    /// Samples of the lights alone are f / p = f / (p + q) + (f / p) q / (p + q), with the density q of the
    /// BSDF. The first part is as tame as under the balance heuristic, and its mean is the light share of
    /// the reference. The second has the mean of the rest, and may consist of rare large values.
    pub(crate) fn sure(&self, reference: &Pixel<Rgb>) -> f64 {
        let light = reference.light_share().unwrap_or(0.5);
        match (self.halves, self.combination) {
            ([_, 0], _) => light,
            ([0, _], _) => 1.0 - light,
            // Half of either.
            (_, Combination::Constant) => 0.5,
            _ => 1.0,
        }
    }
}
