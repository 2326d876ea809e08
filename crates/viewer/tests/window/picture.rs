//! [`Picture`]: the pixels of a picture, read from a file and compared.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Red, green and blue of each pixel, rows from top to bottom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Picture {
    pub(crate) width: usize,
    pub(crate) pixels: Vec<[u8; 3]>,
}

impl Picture {
    pub(crate) fn read(path: &Path) -> Self {
        let mut reader = png::Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let frame = reader.next_frame(&mut bytes).unwrap();
        assert_eq!(frame.color_type, png::ColorType::Rgba);
        Picture::from_rgba(frame.width as usize, &bytes)
    }

    pub(crate) fn from_rgba(width: usize, bytes: &[u8]) -> Self {
        let pixels = bytes.chunks_exact(4).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        Picture { width, pixels }
    }

    pub(crate) fn at(&self, x: usize, y: usize) -> [u8; 3] {
        self.pixels[y * self.width + x]
    }

    /// Positions of the pixels that differ by more than `step` in a channel.
    pub(crate) fn differing<'a>(
        &'a self,
        other: &'a Self,
        step: u8,
    ) -> impl Iterator<Item = [usize; 2]> + 'a {
        assert_eq!(
            (self.width, self.pixels.len()),
            (other.width, other.pixels.len()),
            "the pictures should have the same size"
        );
        let pairs = self.pixels.iter().zip(&other.pixels).enumerate();
        let different = pairs.filter(move |(_, (a, b))| distance(**a, **b) > step);
        different.map(|(at, _)| [at % self.width, at / self.width])
    }
}

/// Largest difference of two colours in a channel.
pub(crate) fn distance(a: [u8; 3], b: [u8; 3]) -> u8 {
    (0..3).map(|channel| a[channel].abs_diff(b[channel])).max().unwrap()
}
