//! The contact sheet: all strategies side by side, each with its errors and weights.

use mis::lighting::Picture;

use crate::canvas::{Canvas, Colour, LETTER};
use crate::colours;
use crate::errors::{Reference, Shot};
use crate::scene::Rgb;

const PAPER: Colour = [250; 3];
const INK: Colour = [25; 3];

/// Between pictures, in pixels.
const GAP: usize = 8;

/// Pictures in a row.
const ACROSS: usize = 5;

/// The picture as it is shown.
pub(crate) fn shown(picture: &Picture<Rgb>) -> Canvas {
    let colours = picture.pixels().iter().map(|pixel| colours::radiance(&pixel.value()));
    Canvas::new(picture.width(), colours)
}

/// The relative error of each pixel.
pub(crate) fn errors(shot: &Shot, reference: &Reference) -> Canvas {
    let pairs = reference.picture.pixels().iter().zip(shot.picture.pixels());
    let error = pairs.map(|(r, pixel)| colours::error(reference.relative_error(r, pixel)));
    Canvas::new(shot.picture.width(), error)
}

/// The part of each pixel that samples of the lights contribute.
pub(crate) fn weights(picture: &Picture<Rgb>) -> Canvas {
    let shares = picture.pixels().iter().map(|pixel| colours::share(pixel.light_share()));
    Canvas::new(picture.width(), shares)
}

/// Three pictures above each other, and a title.
struct Stack {
    title: String,
    pictures: [Canvas; 3],
}

pub(crate) fn sheet(shots: &[Shot], reference: &Reference, errors_of: &[f64]) -> Canvas {
    let first = Stack {
        title: "reference".into(),
        pictures: [shown(&reference.picture), error_legend(reference), weights(&reference.picture)],
    };
    let mut stacks = vec![first];
    for (shot, error) in shots.iter().zip(errors_of) {
        stacks.push(Stack {
            title: format!("{} {:.1}%", shot.strategy.title, 100.0 * error),
            pictures: [shown(&shot.picture), errors(shot, reference), weights(&shot.picture)],
        });
    }
    let (width, height) = (reference.picture.width(), reference.picture.height());
    let (wide, high) = (width + GAP, 3 * (height + GAP) + LETTER + GAP);
    let across = ACROSS.min(stacks.len());
    let size = [across * wide + GAP, stacks.len().div_ceil(across) * (high + GAP) + GAP];
    let mut sheet = Canvas::filled(size, PAPER);
    for (number, stack) in stacks.iter().enumerate() {
        let (x, y) = (GAP + number % across * wide, GAP + number / across * (high + GAP));
        sheet.write(x, y, &stack.title, INK);
        for (row, picture) in stack.pictures.iter().enumerate() {
            sheet.put(x, y + LETTER + GAP + row * (height + GAP), picture);
        }
    }
    sheet
}

/// The scales of errors and of weights.
fn error_legend(reference: &Reference) -> Canvas {
    let (width, height) = (reference.picture.width(), reference.picture.height());
    let mut legend = Canvas::filled([width, height], PAPER);
    let [low, high] = colours::ERRORS;
    let bar = |legend: &mut Canvas, y: usize, colour: &dyn Fn(f64) -> Colour| {
        for x in 0..width {
            for row in 0..LETTER {
                legend.set(x, y + row, colour(x as f64 / width as f64));
            }
        }
    };
    let step = LETTER + GAP / 2;
    let top = height.saturating_sub(6 * step) / 2;
    legend.write(0, top, "relative error", INK);
    bar(&mut legend, top + step, &|t| colours::error(low * (high / low).powf(t)));
    legend.write(0, top + 2 * step, &format!("{}%", 100.0 * low), INK);
    let end = format!("{}%", 100.0 * high);
    legend.write(width.saturating_sub(LETTER * end.len()), top + 2 * step, &end, INK);
    legend.write(0, top + 7 * step / 2, "comes from", INK);
    bar(&mut legend, top + 9 * step / 2, &|t| colours::share(Some(t)));
    legend.write(0, top + 11 * step / 2, "BSDF", INK);
    legend.write(width.saturating_sub(6 * LETTER), top + 11 * step / 2, "lights", INK);
    legend
}
