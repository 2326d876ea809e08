//! Writes images and animations as files: PNG, APNG and GIF.

mod apng;
mod gif;
mod pace;
mod palette;
mod region;
mod still;

use std::io::{self, Write};

use crate::raster::Image;

pub use pace::Pace;

/// Animation that repeats forever. It is written frame by frame, with bounded memory.
///
/// Frames after the first contain only the bounding rectangle of the changed pixels.
///
/// ```
/// use lockstep2d_render::{Animation, Colour, DrawList, Pace, raster};
/// // A bar that grows, for a replay of 60 ticks a second with a frame for every third tick.
/// let mut file = Vec::new();
/// let mut animation = Animation::gif(&mut file, Pace { ticks: 3, tick_rate: 60 });
/// for width in 1..=4 {
///     let mut list = DrawList::default();
///     list.rectangle([0.0, 0.0], [8.0 * width as f32, 8.0], Colour::hex(0xd62728));
///     animation.add(&raster(&list, (32, 8), Colour::hex(0xffffff)))?;
/// }
/// animation.finish()?;
/// assert!(file.starts_with(b"GIF89a"));
/// # Ok::<(), std::io::Error>(())
/// ```
pub struct Animation<W: Write>(Format<W>);

enum Format<W: Write> {
    Gif(gif::Gif<W>),
    Apng(Box<apng::Apng<W>>),
}

impl<W: Write> Animation<W> {
    /// Starts a GIF. A frame with at most 255 colours is exact. For the first frame, the colours of the announced
    /// frames ([`Animation::expect`]) count, too. In all other frames, the colours are replaced by the nearest of 255
    /// colours. Translucent pixels become opaque.
    pub fn gif(writer: W, pace: Pace) -> Self {
        Animation(Format::Gif(gif::Gif::new(writer, pace)))
    }

    /// Starts an animated PNG of exactly `frames` frames, with exact colours.
    pub fn apng(writer: W, pace: Pace, frames: u32) -> Self {
        Animation(Format::Apng(Box::new(apng::Apng::new(writer, pace, frames))))
    }

    /// Announces the colours of a later frame of a GIF. Call it before the first frame is added. The GIF has a global
    /// palette, which is made for the first frame and the announced frames. If the global palette does not suit a
    /// frame, this frame and all later ones contain palettes, and the file is larger. For an APNG, this function has no
    /// effect.
    pub fn expect(&mut self, frame: &Image) {
        match &mut self.0 {
            Format::Gif(gif) => gif.expect(frame),
            Format::Apng(_) => {}
        }
    }

    /// Adds a frame. All frames must have the size of the first.
    ///
    /// # Errors
    ///
    /// Errors of the writer; [`io::ErrorKind::InvalidInput`] for a frame of another size, a side of more than 65 535
    /// pixels in a GIF, or more frames in an APNG than [`Animation::apng`] was given.
    pub fn add(&mut self, frame: &Image) -> io::Result<()> {
        match &mut self.0 {
            Format::Gif(gif) => gif.add(frame),
            Format::Apng(apng) => apng.add(frame),
        }
    }

    /// Writes the end of the file. Without it, the file is incomplete.
    ///
    /// # Errors
    ///
    /// Errors of the writer; [`io::ErrorKind::InvalidInput`] if no frame was added, or fewer frames to an APNG than
    /// [`Animation::apng`] was given.
    pub fn finish(self) -> io::Result<()> {
        match self.0 {
            Format::Gif(gif) => gif.finish(),
            Format::Apng(apng) => apng.finish(),
        }
    }
}

fn invalid(why: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, why)
}

/// Converts an error of the encoder. Returns an I/O error of the writer unchanged.
fn failed(error: png::EncodingError) -> io::Error {
    match error {
        png::EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    }
}
