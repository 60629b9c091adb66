//! Pictures: the radiances of pixels, with their errors.

use crate::lighting::spectrum::Spectrum;

/// The radiance of a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pixel<V> {
    pub(super) rays: u64,
    /// Whether any of them met a surface.
    pub(super) sampled: bool,
    pub(super) mean: V,
    /// The sum of the squared deviations of single rays from the mean.
    pub(super) squares: V,
    /// Sums, over the rays and the channels, of what samples of the lights and of the BSDF contribute.
    pub(super) parts: [f64; 2],
}

impl<V: Spectrum> Pixel<V> {
    pub(super) fn empty() -> Self {
        Self { rays: 0, sampled: false, mean: V::zero(), squares: V::zero(), parts: [0.0; 2] }
    }

    /// Adds a ray that sees a light, or nothing.
    pub(super) fn push_emitted(&mut self, radiance: &V) {
        *self = self.merge(&Self { rays: 1, mean: *radiance, ..Self::empty() });
    }

    /// Adds a ray that sees a surface.
    pub(super) fn push(&mut self, radiance: &V, parts: [f64; 2]) {
        *self =
            self.merge(&Self { rays: 1, sampled: true, mean: *radiance, parts, ..Self::empty() });
    }

    /// This and the rays of `other`.
    ///
    /// Source: T. F. Chan, G. H. Golub and R. J. `LeVeque`, *Updating Formulae and a Pairwise Algorithm
    /// for Computing Sample Variances*, 1979.
    pub(super) fn merge(&self, other: &Self) -> Self {
        let (n, m) = (self.rays as f64, other.rays as f64);
        let rays = self.rays + other.rays;
        if self.rays == 0 || other.rays == 0 {
            return if self.rays == 0 { *other } else { *self };
        }
        let part = m / (n + m);
        let delta = V::each(|c| other.mean.times(c, 1.0) - self.mean.times(c, 1.0));
        let mean = self.mean.plus(&delta.scaled(part));
        let between = delta.scaled_product(&delta, n * part);
        let squares = self.squares.plus(&other.squares).plus(&between);
        let parts = [0, 1].map(|k| self.parts[k] + other.parts[k]);
        Self { rays, sampled: self.sampled || other.sampled, mean, squares, parts }
    }

    /// The mean radiance over the pixel.
    #[must_use]
    pub fn value(&self) -> V {
        self.mean
    }

    /// The standard error of each channel; `None` where it cannot be told: from a single ray, where
    /// surfaces were seen, but every sample was 0, and where squares leave the range of `f64`.
    ///
    /// It is 0 where all rays see the same light, or nothing; an edge that none of them has met is not in
    /// it.
    #[must_use]
    pub fn standard_error(&self) -> Option<V> {
        let n = self.rays as f64;
        let error = V::each(|c| (self.squares.times(c, 1.0) / (n * (n - 1.0))).sqrt());
        let dark = self.sampled && self.mean.total() == 0.0;
        (self.rays > 1 && !dark && error.is_finite()).then_some(error)
    }

    /// How many rays of the camera there were.
    #[must_use]
    pub fn rays(&self) -> u64 {
        self.rays
    }

    /// The part of the sampled radiance, over all channels, that samples of the lights contribute, under
    /// their weights; that of the BSDF is the rest. `None` where nothing was sampled but 0, and under
    /// optimal weights, which may be negative.
    #[must_use]
    pub fn light_share(&self) -> Option<f64> {
        let [light, bsdf] = self.parts;
        (light + bsdf > 0.0).then(|| light / (light + bsdf))
    }
}

/// A rectangle of pixels, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture<V> {
    width: usize,
    pixels: Vec<Pixel<V>>,
}

impl<V: Spectrum> Picture<V> {
    pub(super) fn new(width: usize, pixels: Vec<Pixel<V>>) -> Self {
        Self { width, pixels }
    }

    /// The pixels in a row.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// The rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.pixels.len() / self.width.max(1)
    }

    /// All pixels, row by row from the top, each from the left.
    #[must_use]
    pub fn pixels(&self) -> &[Pixel<V>] {
        &self.pixels
    }

    /// The pixel in a column and a row, counted from the left and from the top of the picture; `None`
    /// beyond its edges.
    #[must_use]
    pub fn pixel(&self, column: usize, row: usize) -> Option<&Pixel<V>> {
        let inside = column < self.width;
        inside.then(|| self.pixels.get(row * self.width + column)).flatten()
    }

    /// The mean radiance over the picture.
    #[must_use]
    pub fn mean(&self) -> V {
        let sum = self.pixels.iter().fold(V::zero(), |sum, pixel| sum.plus(&pixel.mean));
        sum.scaled(1.0 / self.pixels.len() as f64)
    }

    /// The standard error of [`mean`](Picture::mean), to which pixels add nothing whose samples are all
    /// 0; `None` where no surface's error can be told, and of pixels with a single ray.
    #[must_use]
    pub fn standard_error_of_mean(&self) -> Option<V> {
        let (mut sum, mut known) = (V::zero(), !self.pixels.iter().any(|pixel| pixel.sampled));
        for pixel in &self.pixels {
            match pixel.standard_error() {
                Some(error) => {
                    sum = sum.plus(&error.scaled_product(&error, 1.0));
                    known |= pixel.sampled;
                }
                None if pixel.rays > 1 && pixel.mean.total() == 0.0 => (),
                None => return None,
            }
        }
        let n = self.pixels.len() as f64;
        known.then(|| V::each(|c| sum.times(c, 1.0).sqrt() / n))
    }
}
