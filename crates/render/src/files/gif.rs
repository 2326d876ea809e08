//! Writes animations as GIF files.

use std::borrow::Cow;
use std::io::{self, Write};

use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};

use super::invalid;
use super::pace::Pace;
use super::palette::{Counts, Palette};
use super::region::Region;
use crate::raster::Image;

pub(super) struct Gif<W: Write> {
    pace: Pace,
    frames: u64,
    /// Number of pixels of each colour in all frames passed to [`Gif::expect`].
    samples: Counts,
    state: State<W>,
}

enum State<W: Write> {
    /// The header is not written yet, because it needs the size and colours of the first frame.
    Empty(Option<W>),
    Begun(Box<Begun<W>>),
}

struct Begun<W: Write> {
    encoder: Encoder<W>,
    size: (u32, u32),
    palette: Palette,
    /// Whether `palette` is no longer the global palette. If so, each further frame contains a palette.
    is_local: bool,
    /// Picture that a viewer shows after the frames written so far.
    shown: Vec<[u8; 3]>,
}

impl<W: Write> Gif<W> {
    pub(super) fn new(writer: W, pace: Pace) -> Self {
        Gif { pace, frames: 0, samples: Counts::default(), state: State::Empty(Some(writer)) }
    }

    pub(super) fn expect(&mut self, frame: &Image) {
        self.samples.add(colours(frame));
    }

    pub(super) fn add(&mut self, frame: &Image) -> io::Result<()> {
        let delay = self.pace.hundredths(self.frames);
        match &mut self.state {
            State::Empty(writer) => {
                let writer = writer.take().ok_or_else(|| invalid("the first frame could not be written"))?;
                let mut counts = std::mem::take(&mut self.samples);
                counts.add(colours(frame));
                let palette = Palette::of(&counts);
                self.state = State::Begun(Box::new(Begun::new(writer, palette, delay, frame)?));
            }
            State::Begun(begun) => begun.add(delay, frame)?,
        }
        self.frames += 1;
        Ok(())
    }

    pub(super) fn finish(self) -> io::Result<()> {
        match self.state {
            State::Empty(_) => Err(invalid("an animation needs at least one frame")),
            State::Begun(begun) => begun.encoder.into_inner().map_err(failed)?.flush(),
        }
    }
}

impl<W: Write> Begun<W> {
    fn new(writer: W, mut palette: Palette, delay: u16, frame: &Image) -> io::Result<Self> {
        let size = (frame.width(), frame.height());
        let [width, height] = sides(size.0, size.1)?;
        let mut encoder = Encoder::new(writer, width, height, &palette.table()).map_err(failed)?;
        encoder.set_repeat(Repeat::Infinite).map_err(failed)?;
        let indices: Vec<u8> = colours(frame).map(|colour| palette.index(colour)).collect();
        let shown = indices.iter().map(|&index| palette.colour(index)).collect();
        let buffer = Cow::Owned(indices);
        let frame = Frame { delay, width, height, buffer, ..Frame::default() };
        encoder.write_frame(&frame).map_err(failed)?;
        Ok(Begun { encoder, size, palette, is_local: false, shown })
    }

    fn add(&mut self, delay: u16, frame: &Image) -> io::Result<()> {
        if (frame.width(), frame.height()) != self.size {
            return Err(invalid("all frames must have the same size"));
        }
        let counts = Counts::of(colours(frame));
        if !self.palette.suits(&counts) {
            self.palette = Palette::of(&counts);
            self.is_local = true;
        }
        let Begun { palette, shown, .. } = self;
        let indices: Vec<u8> = colours(frame).map(|colour| palette.index(colour)).collect();
        let has_changed = |pixel: usize| palette.colour(indices[pixel]) != shown[pixel];
        let region = Region::around(self.size, has_changed);
        let transparent = palette.transparent();
        let changes = region
            .pixels(self.size.0)
            .map(|pixel| if has_changed(pixel) { indices[pixel] } else { transparent });
        let buffer: Vec<u8> = changes.collect();
        for (shown, &index) in shown.iter_mut().zip(&indices) {
            *shown = palette.colour(index);
        }
        let [left, top] = sides(region.left, region.top)?;
        let [width, height] = sides(region.width, region.height)?;
        let frame = Frame {
            delay,
            dispose: DisposalMethod::Keep,
            transparent: Some(transparent),
            left,
            top,
            width,
            height,
            palette: self.is_local.then(|| palette.table()),
            buffer: Cow::Owned(buffer),
            ..Frame::default()
        };
        self.encoder.write_frame(&frame).map_err(failed)
    }
}

fn sides(width: u32, height: u32) -> io::Result<[u16; 2]> {
    match (u16::try_from(width), u16::try_from(height)) {
        (Ok(width), Ok(height)) => Ok([width, height]),
        _ => Err(invalid("a GIF can have at most 65535 pixels per side")),
    }
}

fn colours(image: &Image) -> impl Iterator<Item = [u8; 3]> {
    image.rgba().chunks_exact(4).map(|pixel| [pixel[0], pixel[1], pixel[2]])
}

fn failed(error: EncodingError) -> io::Error {
    match error {
        EncodingError::Io(error) => error,
        other => io::Error::other(other),
    }
}
