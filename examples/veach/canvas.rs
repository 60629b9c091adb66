//! Colours of pixels, and words in a picture.

use font8x8::legacy::BASIC_LEGACY;

/// Red, green and blue, in sRGB.
pub(crate) type Colour = [u8; 3];

/// A picture to look at.
#[derive(Debug, Clone)]
pub(crate) struct Canvas {
    width: usize,
    pixels: Vec<Colour>,
}

/// The side of a letter, in pixels, at the scale 1.
pub(crate) const LETTER: usize = 8;

impl Canvas {
    pub(crate) fn filled([width, height]: [usize; 2], colour: Colour) -> Self {
        Self { width, pixels: vec![colour; width * height] }
    }

    /// Row by row from the top.
    pub(crate) fn new(width: usize, pixels: impl Iterator<Item = Colour>) -> Self {
        Self { width, pixels: pixels.collect() }
    }

    pub(crate) fn size(&self) -> [usize; 2] {
        [self.width, self.pixels.len() / self.width.max(1)]
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        self.pixels.as_flattened().to_vec()
    }

    /// Colours a pixel, if there is one at this place.
    pub(crate) fn set(&mut self, x: usize, y: usize, colour: Colour) {
        if x < self.width
            && let Some(pixel) = self.pixels.get_mut(y * self.width + x)
        {
            *pixel = colour;
        }
    }

    /// Puts `other` down with its upper left corner at this place.
    pub(crate) fn put(&mut self, x: usize, y: usize, other: &Canvas) {
        for (row, pixels) in other.pixels.chunks(other.width.max(1)).enumerate() {
            for (column, colour) in pixels.iter().enumerate() {
                self.set(x + column, y + row, *colour);
            }
        }
    }

    /// Writes a line of ASCII from this upper left corner on; letters have the side `scale` · 8.
    pub(crate) fn write(&mut self, [x, y]: [usize; 2], scale: usize, text: &str, colour: Colour) {
        for (place, letter) in text.bytes().enumerate() {
            let rows = BASIC_LEGACY.get(usize::from(letter)).copied().unwrap_or_default();
            for (row, bits) in rows.into_iter().enumerate() {
                for column in (0..8).filter(|column| bits >> column & 1 == 1) {
                    let (left, top) = (x + (place * LETTER + column) * scale, y + row * scale);
                    for at in 0..scale * scale {
                        self.set(left + at % scale, top + at / scale, colour);
                    }
                }
            }
        }
    }
}
