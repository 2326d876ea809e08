//! Pictures with many colours.

use lockstep2d_render::{Colour, DrawList, Image, raster};

/// A picture with far more colours than a GIF can have.
pub(crate) fn colourful(frame: u32, size: (u32, u32)) -> Image {
    let mut list = DrawList::default();
    for i in 0..40u32 {
        let angle = (i * 7 + frame) as f32 * 0.1;
        let (x, y) = ((i % 8) as f32 * 15.0 + 7.0, (i / 8) as f32 * 16.0 + 8.0);
        let corners = [0.0f32, 2.1, 4.2].map(|turn| {
            let (sin, cos) = (angle + turn).sin_cos();
            [x + 9.0 * cos, y + 9.0 * sin]
        });
        let colour = Colour::hex(0x200000 + i * 0x050307);
        list.polygon(corners, colour, Colour::hex(0x101010), 1.2);
    }
    raster(&list, size, Colour::hex(0xffffff))
}
