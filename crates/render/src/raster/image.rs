//! [`Image`]: pixels in memory.

use tiny_skia::Pixmap;

use crate::colour::Colour;

/// Image of 8-bit RGBA pixels, in rows from top to bottom.
///
/// ```
/// use lockstep2d::{draw::View, world::World};
/// use lockstep2d_render::{Colour, DrawList, Image, page, raster};
/// # let world = World::default();
/// // A picture of a failed test, with the legend.
/// let view = View { width: 320, height: 240, title: "after 3 s".into(), ..View::default() };
/// let mut list = DrawList::default();
/// page(&mut list, &world, &view);
/// let image: Image = raster(&list, (view.width, view.height), Colour::hex(0xffffff));
/// assert_eq!((image.width(), image.rgba().len()), (320, 4 * 320 * 240));
/// assert!(image.is_opaque());
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    width: u32,
    height: u32,
    rgba: Vec<u8>,
}

impl Image {
    pub(super) fn of(pixels: &Pixmap) -> Self {
        let (width, height) = (pixels.width(), pixels.height());
        let colours = pixels.pixels().iter().map(|pixel| pixel.demultiply());
        let rgba = colours
            .flat_map(|colour| [colour.red(), colour.green(), colour.blue(), colour.alpha()])
            .collect();
        Image { width, height, rgba }
    }

    /// Width in pixels, at least 1.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels, at least 1.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Red, green, blue and opacity of each pixel, not premultiplied.
    #[must_use]
    pub fn rgba(&self) -> &[u8] {
        &self.rgba
    }

    /// A pixel. `None` if it is outside of the image.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> Option<Colour> {
        if x >= self.width || y >= self.height {
            return None;
        }
        let at = (y as usize * self.width as usize + x as usize) * 4;
        let [red, green, blue, opacity] = *self.rgba.get(at..)?.first_chunk()?;
        Some(Colour { rgb: [red, green, blue], opacity })
    }

    /// Whether every pixel is opaque.
    #[must_use]
    pub fn is_opaque(&self) -> bool {
        self.rgba.chunks_exact(4).all(|pixel| pixel[3] == 255)
    }
}
