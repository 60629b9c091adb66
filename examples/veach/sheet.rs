//! The contact sheet: all strategies side by side, each with its errors and weights.

use mis::lighting::{Picture, Pixel};

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
    let shares = || picture.pixels().iter().map(Pixel::light_share);
    let mut canvas = Canvas::new(picture.width(), shares().map(colours::share));
    if shares().all(|share| share.is_none()) {
        canvas.write([GAP; 2], scale(picture.width()), "not a share", PAPER);
    }
    canvas
}

/// Pictures of one size above each other, and a title.
struct Stack {
    title: String,
    pictures: Vec<Canvas>,
}

/// The contact sheet. Titles have the mean relative error.
pub(crate) fn sheet(shots: &[Shot], reference: &Reference, errors_of: &[f64]) -> Canvas {
    let picture = &reference.picture;
    let legend = legend(picture.width(), picture.height());
    let pictures = vec![shown(picture), legend, weights(picture)];
    let mut stacks = vec![Stack { title: "reference".into(), pictures }];
    for (shot, error) in shots.iter().zip(errors_of) {
        let title = format!("{} {:.1}%", shot.strategy.title, 100.0 * error);
        let pictures = vec![shown(&shot.picture), errors(shot, reference), weights(&shot.picture)];
        stacks.push(Stack { title, pictures });
    }
    side_by_side(&stacks)
}

/// Either technique alone beside both, as far as they are among `shots`.
pub(crate) fn figure(shots: &[Shot]) -> Canvas {
    let few = shots.iter().filter(|shot| ["light", "bsdf", "power"].contains(&shot.strategy.name));
    let stack = |shot: &Shot| Stack {
        title: shot.strategy.title.into(),
        pictures: vec![shown(&shot.picture)],
    };
    side_by_side(&few.map(stack).collect::<Vec<_>>())
}

fn side_by_side(stacks: &[Stack]) -> Canvas {
    let first = stacks.first();
    let [width, height] =
        first.and_then(|stack| stack.pictures.first()).map_or([0; 2], Canvas::size);
    let rows = first.map_or(0, |stack| stack.pictures.len());
    let head = LETTER * scale(width) + GAP;
    let (wide, high) = (width + GAP, rows * (height + GAP) + head);
    let across = ACROSS.min(stacks.len()).max(1);
    let size = [across * wide + GAP, stacks.len().div_ceil(across) * (high + GAP) + GAP];
    let mut sheet = Canvas::filled(size, PAPER);
    for (number, stack) in stacks.iter().enumerate() {
        let (x, y) = (GAP + number % across * wide, GAP + number / across * (high + GAP));
        sheet.write([x, y], scale(width), &stack.title, INK);
        for (row, picture) in stack.pictures.iter().enumerate() {
            sheet.put(x, y + head + row * (height + GAP), picture);
        }
    }
    sheet
}

/// Of letters, for titles to fit above pictures of this width.
fn scale(width: usize) -> usize {
    (width / (20 * LETTER)).max(1)
}

/// The scales of colours, as large as a picture.
fn legend(width: usize, height: usize) -> Canvas {
    let mut legend = Canvas::filled([width, height], PAPER);
    let [low, high] = colours::ERRORS;
    let (scale, letter) = (scale(width), LETTER * scale(width));
    let mut top = height.saturating_sub(10 * letter) / 2;
    let mut bar = |title: &str, ends: [&str; 2], colour: &dyn Fn(f64) -> Colour| {
        legend.write([0, top], scale, title, INK);
        for (x, y) in (0..width).flat_map(|x| (0..letter).map(move |y| (x, y))) {
            legend.set(x, top + 3 * letter / 2 + y, colour(x as f64 / width as f64));
        }
        let [left, right] = ends;
        let y = top + 3 * letter;
        legend.write([0, y], scale, left, INK);
        legend.write([width.saturating_sub(letter * right.len()), y], scale, right, INK);
        top += 6 * letter;
    };
    let ends = [low, high].map(|end| format!("{}%", 100.0 * end));
    let at = |place: f64| colours::error(low * (high / low).powf(place));
    bar("relative error", [&ends[0], &ends[1]], &at);
    bar("share", ["BSDF", "lights"], &|place| colours::share(Some(place)));
    legend
}
