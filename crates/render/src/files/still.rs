//! Writes an image as a PNG file.

use std::io::{self, Write};

use png::{BitDepth, ColorType, Compression, Encoder};

use super::failed;
use crate::raster::Image;

impl Image {
    /// Writes a PNG file. If the image is not opaque, the file is in RGBA.
    ///
    /// # Errors
    ///
    /// Errors of the writer.
    pub fn write_png(&self, writer: impl Write) -> io::Result<()> {
        let mut encoder = Encoder::new(writer, self.width(), self.height());
        encoder.set_depth(BitDepth::Eight);
        encoder.set_compression(Compression::High);
        let is_opaque = self.is_opaque();
        encoder.set_color(if is_opaque { ColorType::Rgb } else { ColorType::Rgba });
        let mut png = encoder.write_header().map_err(failed)?;
        if is_opaque {
            let rgb: Vec<u8> = self.rgba().chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied().collect();
            png.write_image_data(&rgb).map_err(failed)?;
        } else {
            png.write_image_data(self.rgba()).map_err(failed)?;
        }
        png.finish().map_err(failed)
    }

    /// Returns the bytes of a PNG file.
    #[must_use]
    pub fn to_png(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.write_png(&mut bytes)
            .expect("writing to a Vec cannot fail, and the image has the right number of bytes");
        bytes
    }
}
