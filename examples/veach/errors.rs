//! The errors of pictures, against the reference.

use mis::lighting::{DVec3, Picture, Pixel};

use crate::scene::{self, LAMPS, Rgb, grey};
use crate::strategies::Strategy;

/// A picture by a strategy, and how long it took.
pub(crate) struct Shot {
    pub(crate) strategy: &'static Strategy,
    pub(crate) picture: Picture<Rgb>,
    pub(crate) seconds: f64,
}

/// The reference, and which of its pixels are compared.
pub(crate) struct Reference {
    pub(crate) picture: Picture<Rgb>,
    /// Not those that see a light: nothing is sampled there, and its edge is where rays differ most.
    pub(crate) counted: Vec<bool>,
    /// 1 % of the mean radiance, which is added to radiances that errors are divided by.
    pub(crate) dark: f64,
}

impl Reference {
    pub(crate) fn new(picture: Picture<Rgb>, size: [u32; 2]) -> Self {
        let [width, height] = size;
        let places = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        let counted: Vec<bool> = places.map(|place| !sees_a_lamp(place, size)).collect();
        let some = picture.pixels().iter().zip(&counted).filter(|(_, counted)| **counted);
        let (sum, n) =
            some.fold((0.0, 0.0), |(sum, n), (pixel, _)| (sum + grey(&pixel.value()), n + 1.0));
        Self { picture, counted, dark: 0.01 * sum / n }
    }

    /// The pixels that are compared: of the reference, and of `picture`.
    pub(crate) fn pairs<'a>(
        &'a self,
        picture: &'a Picture<Rgb>,
    ) -> impl Iterator<Item = (&'a Pixel<Rgb>, &'a Pixel<Rgb>)> {
        let pairs = self.picture.pixels().iter().zip(picture.pixels());
        pairs.zip(&self.counted).filter_map(|(pair, counted)| counted.then_some(pair))
    }

    /// |x - r| / (r + dark), the mean over the channels.
    pub(crate) fn relative_error(&self, reference: &Pixel<Rgb>, pixel: &Pixel<Rgb>) -> f64 {
        let (r, x) = (reference.value(), pixel.value());
        let channel = |c: usize| (x[c] - r[c]).abs() / (r[c] + self.dark);
        (0..3).map(channel).sum::<f64>() / 3.0
    }

    pub(crate) fn errors(&self, picture: &Picture<Rgb>) -> Errors {
        let (mut absolute, mut squares) = (Mean::default(), Mean::default());
        for (reference, pixel) in self.pairs(picture) {
            absolute.push(self.relative_error(reference, pixel));
            let (r, x, s) = (reference.value(), pixel.value(), error_of(reference));
            // The reference has errors of its own.
            let square =
                |c: usize| ((x[c] - r[c]).powi(2) - s[c] * s[c]) / (r[c] + self.dark).powi(2);
            squares.push((0..3).map(square).sum::<f64>() / 3.0);
        }
        Errors { absolute, squares }
    }
}

/// The standard error of each channel; infinite where there is none.
pub(crate) fn error_of(pixel: &Pixel<Rgb>) -> Rgb {
    // Where all samples are 0, the place is dark, or they say nothing; its neighbours do.
    let unknown = if grey(&pixel.value()) == 0.0 { 0.0 } else { f64::INFINITY };
    pixel.standard_error().unwrap_or([unknown; 3])
}

/// Relative errors over a picture.
pub(crate) struct Errors {
    /// |x - r| / (r + dark).
    pub(crate) absolute: Mean,
    /// ((x - r)² - s²) / (r + dark)², with the standard error s of the reference.
    pub(crate) squares: Mean,
}

/// A mean with its standard error.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Mean {
    n: f64,
    value: f64,
    /// Of the deviations from it.
    squares: f64,
}

impl Mean {
    pub(crate) fn push(&mut self, x: f64) {
        self.n += 1.0;
        let delta = x - self.value;
        self.value += delta / self.n;
        self.squares += delta * (x - self.value);
    }

    pub(crate) fn value(&self) -> f64 {
        self.value
    }

    /// Of a single value.
    pub(crate) fn variance(&self) -> f64 {
        self.squares / (self.n - 1.0)
    }

    pub(crate) fn error(&self) -> f64 {
        (self.squares / (self.n * (self.n - 1.0))).sqrt()
    }
}

/// Whether a pixel sees one of the lights, or is next to one that does.
fn sees_a_lamp([x, y]: [u32; 2], size: [u32; 2]) -> bool {
    let [x, y] = [x, y].map(|side| f64::from(side) + 0.5);
    LAMPS.iter().any(|lamp| {
        let [cx, cy] = scene::project(lamp.centre, size);
        // Of the sphere's outline, at right angles to the ray to its centre, the lowest point.
        let to_centre = lamp.centre - scene::EYE;
        let distance = to_centre.length();
        let radius = lamp.radius / (1.0 - (lamp.radius / distance).powi(2)).sqrt();
        let down = to_centre.cross(DVec3::X).normalize();
        let [ex, ey] = scene::project(lamp.centre + radius * down, size);
        let [rx, ry] = scene::project(lamp.centre + radius * DVec3::X, size);
        let radius = (ex - cx).hypot(ey - cy).max((rx - cx).hypot(ry - cy));
        // A disc off the middle of a flat film is an ellipse, by less than 10 % here.
        (x - cx).hypot(y - cy) < 1.1 * radius + 1.5
    })
}
