//! Colours of radiances, errors and shares.

use crate::canvas::Colour;
use crate::scene::Rgb;

/// What a radiance is multiplied by before it is shown.
const EXPOSURE: f64 = 1.0;

/// A radiance, tone-mapped by 1 - e^(-exposure x), in each channel.
pub(crate) fn radiance(rgb: &Rgb) -> Colour {
    rgb.map(|x| encoded(-(-EXPOSURE * x).exp_m1()))
}

/// The sRGB encoding of a linear value.
///
/// Source: IEC 61966-2-1.
fn encoded(x: f64) -> u8 {
    let x = x.clamp(0.0, 1.0);
    byte(if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 })
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // It is from 0 to 255.
fn byte(x: f64) -> u8 {
    (255.0 * x).round() as u8
}

/// The relative errors that are black and that are white.
pub(crate) const ERRORS: [f64; 2] = [0.003, 10.0];

/// A relative error: from black through red and yellow to white, by its logarithm.
pub(crate) fn error(relative: f64) -> Colour {
    const STOPS: [Rgb; 6] = [
        [0.0, 0.0, 0.05],
        [0.25, 0.05, 0.45],
        [0.65, 0.15, 0.4],
        [0.93, 0.4, 0.15],
        [0.98, 0.78, 0.2],
        [1.0, 1.0, 1.0],
    ];
    let [low, high] = ERRORS;
    let place = (relative / low).ln() / (high / low).ln();
    mixed(&STOPS, place)
}

/// The share of the lights: blue where samples of the BSDF make the pixel, orange where those of the
/// lights do, grey where no sample says.
pub(crate) fn share(light: Option<f64>) -> Colour {
    const STOPS: [Rgb; 3] = [[0.1, 0.35, 0.75], [0.93, 0.93, 0.9], [0.9, 0.45, 0.05]];
    light.map_or([120; 3], |light| mixed(&STOPS, light))
}

/// The colour at a place from 0 to 1 on a straight line through the stops.
fn mixed(stops: &[Rgb], place: f64) -> Colour {
    let last = stops.len().saturating_sub(1);
    let place = place.clamp(0.0, 1.0) * last as f64;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // It is from 0 to `last`.
    let from = (place.floor() as usize).min(last.saturating_sub(1));
    let part = place - from as f64;
    match stops.get(from..from + 2) {
        Some([a, b]) => std::array::from_fn(|c| byte(a[c] + part * (b[c] - a[c]))),
        _ => [0; 3],
    }
}
