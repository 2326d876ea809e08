//! Images and animations as files: PNG, APNG and GIF.

mod apng;
mod gif;
mod pace;
mod palette;
mod region;
mod still;

use std::io::{self, Write};

use crate::raster::Image;

pub use pace::Pace;

/// An animation that repeats for ever, written frame by frame: however many there are, it holds two of them.
///
/// Of each frame only the rectangle in which something has changed is written, and in that only the pixels that have.
pub struct Animation<W: Write>(Format<W>);

enum Format<W: Write> {
    Gif(gif::Gif<W>),
    Apng(Box<apng::Apng<W>>),
}

impl<W: Write> Animation<W> {
    /// A GIF: up to 255 colours are written as they are, of more the nearest of 255 that are chosen from the frame.
    /// It has no opacity: whatever shines through is taken as opaque.
    pub fn gif(writer: W, pace: Pace) -> Self {
        Animation(Format::Gif(gif::Gif::new(writer, pace)))
    }

    /// An animated PNG of so many frames, in all colours.
    pub fn apng(writer: W, pace: Pace, frames: u32) -> Self {
        Animation(Format::Apng(Box::new(apng::Apng::new(writer, pace, frames))))
    }

    /// Prepares for a frame that is likely to come, in any size: a GIF has the colours of those that were expected
    /// before the first frame once for all, and has to repeat those of others.
    pub fn expect(&mut self, frame: &Image) {
        match &mut self.0 {
            Format::Gif(gif) => gif.expect(frame),
            Format::Apng(_) => {}
        }
    }

    /// Adds a frame. All frames are as large as the first.
    ///
    /// # Errors
    ///
    /// Those of the writer; [`io::ErrorKind::InvalidInput`] for a frame of another size, or one more than an APNG was
    /// to have.
    pub fn add(&mut self, frame: &Image) -> io::Result<()> {
        match &mut self.0 {
            Format::Gif(gif) => gif.add(frame),
            Format::Apng(apng) => apng.add(frame),
        }
    }

    /// Writes the end, and returns the writer; without it the file is not whole.
    ///
    /// # Errors
    ///
    /// Those of the writer; [`io::ErrorKind::InvalidInput`] if there is no frame, or an APNG has fewer than it was to
    /// have.
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

/// What a failure of the PNG encoder is, with the writer's own error in it if there was one.
fn failed(error: png::EncodingError) -> io::Error {
    match error {
        png::EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    }
}
