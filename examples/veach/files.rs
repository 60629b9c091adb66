//! Files: PNG for the eye, PFM for other programs.

use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use mis::lighting::Picture;

use crate::canvas::Canvas;
use crate::scene::Rgb;

/// Eight bits for each channel, sRGB.
pub(crate) fn png(path: &Path, canvas: &Canvas) -> Result<(), Box<dyn Error>> {
    let [width, height] = canvas.size().map(u32::try_from);
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), width?, height?);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&canvas.bytes())?;
    Ok(writer.finish()?)
}

/// The radiances as they are: three `f32` a pixel, little-endian, row by row from the bottom.
pub(crate) fn pfm(path: &Path, picture: &Picture<Rgb>) -> Result<(), Box<dyn Error>> {
    let mut file = BufWriter::new(File::create(path)?);
    // A negative scale says little-endian.
    write!(file, "PF\n{} {}\n-1.0\n", picture.width(), picture.height())?;
    for row in picture.pixels().chunks(picture.width()).rev() {
        for channel in row.iter().flat_map(mis::lighting::Pixel::value) {
            #[allow(clippy::cast_possible_truncation)] // The format has single precision.
            file.write_all(&(channel as f32).to_le_bytes())?;
        }
    }
    Ok(file.flush()?)
}
