//! Writes animations as animated PNG (APNG) files.

use std::io::{self, Write};

use png::{BitDepth, BlendOp, ColorType, Encoder, Writer};

use super::pace::Pace;
use super::region::Region;
use super::{failed, invalid};
use crate::raster::Image;

pub(super) struct Apng<W: Write> {
    pace: Pace,
    /// Number of frames that are still to be added.
    frames: u32,
    state: State<W>,
}

enum State<W: Write> {
    /// The header is not written yet, because it needs the size of the first frame.
    Empty(Option<W>),
    Begun {
        writer: Writer<W>,
        shown: Image,
    },
}

impl<W: Write> Apng<W> {
    pub(super) fn new(writer: W, pace: Pace, frames: u32) -> Self {
        Apng { pace, frames, state: State::Empty(Some(writer)) }
    }

    pub(super) fn add(&mut self, frame: &Image) -> io::Result<()> {
        if self.frames == 0 {
            return Err(invalid("more frames than announced"));
        }
        match &mut self.state {
            State::Empty(writer) => {
                let writer = writer.take().ok_or_else(|| invalid("the first frame could not be written"))?;
                let writer = begin(writer, self.pace, self.frames, frame)?;
                self.state = State::Begun { writer, shown: frame.clone() };
            }
            State::Begun { writer, shown } => {
                if (frame.width(), frame.height()) != (shown.width(), shown.height()) {
                    return Err(invalid("all frames must have the same size"));
                }
                write_changes(writer, shown, frame)?;
                shown.clone_from(frame);
            }
        }
        self.frames -= 1;
        Ok(())
    }

    pub(super) fn finish(self) -> io::Result<()> {
        match self.state {
            State::Begun { writer, .. } if self.frames == 0 => writer.finish().map_err(failed),
            _ => Err(invalid("fewer frames than announced")),
        }
    }
}

fn begin<W: Write>(writer: W, pace: Pace, frames: u32, frame: &Image) -> io::Result<Writer<W>> {
    let mut encoder = Encoder::new(writer, frame.width(), frame.height());
    encoder.set_depth(BitDepth::Eight);
    encoder.set_color(ColorType::Rgba);
    encoder.set_animated(frames, 0).map_err(failed)?;
    let (numerator, denominator) = pace.fraction();
    encoder.set_frame_delay(numerator, denominator).map_err(failed)?;
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(frame.rgba()).map_err(failed)?;
    Ok(writer)
}

/// Writes the bounding rectangle of the changed pixels. If the frame is opaque, the unchanged pixels of the rectangle
/// are written as transparent ones, because this compresses best. Otherwise, all pixels of the rectangle are replaced,
/// because new pixels may be transparent themselves.
fn write_changes<W: Write>(writer: &mut Writer<W>, shown: &Image, frame: &Image) -> io::Result<()> {
    let has_changed = |pixel: usize| colour(shown, pixel) != colour(frame, pixel);
    let region = Region::around((frame.width(), frame.height()), has_changed);
    let is_opaque = frame.is_opaque();
    let nothing = [0; 4];
    let changes = region
        .pixels(frame.width())
        .flat_map(|pixel| if is_opaque && !has_changed(pixel) { &nothing[..] } else { colour(frame, pixel) });
    let changes: Vec<u8> = changes.copied().collect();
    // Without the reset, the encoder would check the new dimension against the old position.
    writer.reset_frame_position().map_err(failed)?;
    writer.set_frame_dimension(region.width, region.height).map_err(failed)?;
    writer.set_frame_position(region.left, region.top).map_err(failed)?;
    writer.set_blend_op(if is_opaque { BlendOp::Over } else { BlendOp::Source }).map_err(failed)?;
    writer.write_image_data(&changes).map_err(failed)
}

/// Red, green, blue and opacity of a pixel.
fn colour(image: &Image, pixel: usize) -> &[u8] {
    &image.rgba()[pixel * 4..pixel * 4 + 4]
}
