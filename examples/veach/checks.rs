//! Whether all strategies make the same picture.
//!
//! A deviation from the reference is divided by the larger of two standard errors: the strategy's own,
//! and that which the reference foretells for as many rays. A strategy's own is too small where rare large
//! samples are still to come; but its deviation is then downwards. So downwards, only what the strategy is
//! [sure](crate::strategies::Strategy::sure) to see is asked for, of which the reference foretells the
//! error; upwards, the large samples that make the deviation are seen in the strategy's own error. Of a
//! single pixel, a few rays do not tell the error well: it is no less than those of the pixels around.

use mis::lighting::{Picture, Pixel};

use crate::errors::{Reference, Shot, error_of};
use crate::scene::{Rgb, grey};

/// The side of a block of pixels.
const BLOCK: usize = 8;

/// The largest deviations that pass, in standard errors: of the picture's mean or factor, of a block, and
/// of a pixel. Beyond are, of normal errors, one in 2 million, in 500 million and in 400 thousand million;
/// but those of a few rays have longer tails.
const MEAN: f64 = 5.0;
const OF_BLOCK: f64 = 6.0;
const OF_PIXEL: f64 = 7.0;

/// Sums over pixels.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    value: f64,
    reference: f64,
    /// What of the reference the strategy is sure to see.
    sure: f64,
    /// Variances: the strategy's own, foretold, and of the reference.
    own: f64,
    foretold: f64,
    of_reference: f64,
}

impl Sum {
    fn new(shot: &Shot, reference: &Pixel<Rgb>, pixel: &Pixel<Rgb>) -> Self {
        // No less than the error of the mean of the channels.
        let [own, of_reference] = [pixel, reference].map(|pixel| grey(&error_of(pixel)).powi(2));
        let value = grey(&reference.value());
        Self {
            value: grey(&pixel.value()),
            reference: value,
            sure: shot.strategy.sure(reference) * value,
            own: known(own),
            foretold: of_reference * reference.rays() as f64 / pixel.rays() as f64,
            of_reference,
        }
    }

    fn add(&mut self, other: &Self) {
        self.value += other.value;
        self.reference += other.reference;
        self.sure += other.sure;
        self.own += other.own;
        self.foretold += other.foretold;
        self.of_reference += other.of_reference;
    }

    /// With variances of at least these: the strategy's, and of the reference.
    fn no_surer_than(&self, [own, of_reference]: [f64; 2]) -> Self {
        let of_reference = self.of_reference.max(of_reference);
        let foretold = self.foretold
            * if self.of_reference > 0.0 { of_reference / self.of_reference } else { 1.0 };
        Self { own: self.own.max(own), foretold, of_reference, ..*self }
    }

    fn error(&self) -> f64 {
        (self.own.max(self.foretold) + self.of_reference).sqrt()
    }

    /// The deviation, in standard errors.
    fn z(&self) -> f64 {
        (self.value - self.reference) / self.error()
    }

    /// The same, where only what is sure must be there.
    fn z_of_sure(&self) -> f64 {
        let beyond = self.value - self.value.clamp(self.sure.min(self.reference), self.reference);
        // Where all is black, there is no error at all.
        if beyond == 0.0 { 0.0 } else { beyond / self.error() }
    }
}

/// An estimate that has seen nothing but 0 may not know its error; the reference foretells one.
fn known(variance: f64) -> f64 {
    if variance.is_finite() { variance } else { 0.0 }
}

/// The mean variance of the pixels up to two away.
fn around(picture: &Picture<Rgb>, reference: &Reference) -> Vec<f64> {
    let (width, height) = (picture.width(), picture.height());
    let variance = |pixel: &Pixel<Rgb>| known(grey(&error_of(pixel)).powi(2));
    let variances: Vec<f64> = picture.pixels().iter().map(variance).collect();
    let near = |at: usize, size: usize| at.saturating_sub(2)..(at + 3).min(size);
    let mean = |number: usize| {
        let (x, y) = (number % width, number / width);
        let places = near(y, height).flat_map(|y| near(x, width).map(move |x| y * width + x));
        let counted = places.filter(|place| reference.counted[*place]);
        let (sum, n) = counted.fold((0.0, 0.0), |(sum, n), at| (sum + variances[at], n + 1.0));
        if n > 0.0 { sum / n } else { 0.0 }
    };
    (0..variances.len()).map(mean).collect()
}

/// The deviations of a picture.
pub(crate) struct Deviations {
    /// Of the mean, in standard errors.
    pub(crate) mean: f64,
    /// The factor to the reference, less 1, that fits the blocks best, and its standard error.
    pub(crate) bias: (f64, f64),
    /// The largest of a block and of a pixel.
    pub(crate) block: f64,
    pub(crate) pixel: f64,
    /// The part of the pixels beyond 3; 0.27 % if errors were normal.
    pub(crate) beyond_3: f64,
    pixels: usize,
}

impl Deviations {
    pub(crate) fn of(shot: &Shot, reference: &Reference) -> Self {
        let (width, height) = (shot.picture.width(), shot.picture.height());
        let across = width.div_ceil(BLOCK);
        let around = [&shot.picture, &reference.picture].map(|picture| around(picture, reference));
        let mut blocks = vec![Sum::default(); across * height.div_ceil(BLOCK)];
        let (mut all, mut largest, mut beyond, mut pixels) = (Sum::default(), 0.0_f64, 0, 0);
        let pairs = reference.picture.pixels().iter().zip(shot.picture.pixels());
        for (number, (of_reference, pixel)) in pairs.enumerate() {
            if !reference.counted[number] {
                continue;
            }
            let sum = Sum::new(shot, of_reference, pixel);
            blocks[number / width / BLOCK * across + number % width / BLOCK].add(&sum);
            all.add(&sum);
            let z = sum.no_surer_than(around.each_ref().map(|v| v[number])).z_of_sure().abs();
            largest = if z.is_nan() { z } else { largest.max(z) };
            beyond += usize::from(z > 3.0);
            pixels += 1;
        }
        Self {
            mean: all.z(),
            bias: bias(&blocks),
            block: blocks.iter().map(|sum| sum.z_of_sure().abs()).fold(0.0, f64::max),
            pixel: largest,
            beyond_3: beyond as f64 / pixels as f64,
            pixels,
        }
    }

    fn passes(&self) -> bool {
        let (bias, error) = self.bias;
        let means = [self.mean, bias / error].map(|z| z.abs() < MEAN);
        means == [true; 2] && self.block < OF_BLOCK && self.pixel < OF_PIXEL
    }
}

/// The b for which the blocks are 1 + b times the reference, by least squares, with its standard error.
///
/// Weights are from the errors of the reference, which do not depend on the strategy's. They do depend
/// on the reference: a block that is too dark there has too small an error. As if blocks had an error of
/// half a percent of their own, that is of no account.
fn bias(blocks: &[Sum]) -> (f64, f64) {
    let (mut deviation, mut variance, mut norm) = (0.0, 0.0, 0.0);
    for block in blocks.iter().filter(|block| block.of_reference > 0.0) {
        let weight = block.reference / (block.of_reference + (0.005 * block.reference).powi(2));
        deviation += weight * (block.value - block.reference);
        variance += (weight * block.error()).powi(2);
        norm += weight * block.reference;
    }
    (deviation / norm, variance.sqrt() / norm)
}

/// An error unless all pictures are the reference, to their errors.
pub(crate) fn assert(shots: &[Shot], deviations: &[Deviations]) -> Result<String, String> {
    for (shot, deviation) in shots.iter().zip(deviations) {
        if !deviation.passes() {
            let (bias, error) = deviation.bias;
            return Err(format!(
                "{} is not the reference: it deviates by {:.1} standard errors in the mean, {:.1} in the \
                 factor (at most {MEAN}), {:.1} in a block (at most {OF_BLOCK}) and {:.1} in a pixel (at most {OF_PIXEL})",
                shot.strategy.title,
                deviation.mean,
                bias / error,
                deviation.block,
                deviation.pixel
            ));
        }
    }
    let pixels: usize = deviations.iter().map(|d| d.pixels).sum();
    let blocks = pixels as f64 / (BLOCK * BLOCK) as f64;
    let false_alarms = 1.1e-6 * deviations.len() as f64 + 2e-9 * blocks + 2.6e-12 * pixels as f64;
    Ok(format!(
        "all pictures agree with the reference: means and factors to {MEAN} standard errors, {blocks:.0} \
         blocks to {OF_BLOCK}, {pixels} pixels to {OF_PIXEL}.\nIf errors were normal, a run in {:.0} would \
         raise a false alarm.",
        1.0 / false_alarms
    ))
}
