//! Draws text into pixels.

use tiny_skia::{Pixmap, PremultipliedColorU8};

use crate::colour::Colour;
use crate::glyphs::{GLYPH_HEIGHT, GLYPH_WIDTH, Glyph, glyph};
use crate::list::Text;
use crate::text::{CELL_HEIGHT, CELL_WIDTH};

/// Range of text scales. Text with another scale is not drawn.
const SCALES: std::ops::RangeInclusive<f32> = 0.1..=64.0;

/// Draws a line of text. At scale 1, its pixels are those of the font. At other scales, they are interpolated.
pub(super) fn draw(pixels: &mut Pixmap, line: &Text) {
    let far = 2.0 * super::SIDE_MAX as f32;
    let is_near = line.at.iter().all(|coordinate| coordinate.abs() <= far);
    if !is_near || !SCALES.contains(&line.scale) || line.colour.is_none() {
        return;
    }
    let top = line.at[1].round();
    for (at, character) in line.text.chars().enumerate() {
        let left = (line.at[0] + at as f32 * CELL_WIDTH * line.scale).round();
        if left >= pixels.width() as f32 {
            return;
        }
        if left + CELL_WIDTH * line.scale >= 0.0 {
            draw_glyph(pixels, &glyph(character), [left, top], line.scale, line.colour);
        }
    }
}

fn draw_glyph(pixels: &mut Pixmap, glyph: &Glyph, [left, top]: [f32; 2], scale: f32, colour: Colour) {
    let (columns, rows) = ((CELL_WIDTH * scale).ceil(), (CELL_HEIGHT * scale).ceil());
    let (width, height) = (pixels.width(), pixels.height());
    // The casts are exact for whole numbers below 100 000.
    let range = |from: f32, count: f32, end: u32| {
        (from.max(0.0) as u32).min(end)..((from + count).max(0.0) as u32).min(end)
    };
    for y in range(top, rows, height) {
        for x in range(left, columns, width) {
            let coverage = if scale == 1.0 {
                glyph[(y as f32 - top) as usize][(x as f32 - left) as usize].into()
            } else {
                mixed(glyph, (x as f32 - left + 0.5) / scale - 0.5, (y as f32 - top + 0.5) / scale - 0.5)
            };
            if coverage > 0.0 {
                let pixel = &mut pixels.pixels_mut()[(y * width + x) as usize];
                *pixel = blended(*pixel, colour, coverage / 255.0);
            }
        }
    }
}

/// Coverage at a position in the glyph, interpolated bilinearly. The position is in pixels of the font, from the centre
/// of the upper left pixel.
fn mixed(glyph: &Glyph, x: f32, y: f32) -> f32 {
    let at = |column: f32, row: f32| {
        let inside = (0.0..GLYPH_WIDTH as f32).contains(&column) && (0.0..GLYPH_HEIGHT as f32).contains(&row);
        if inside { f32::from(glyph[row as usize][column as usize]) } else { 0.0 }
    };
    let (left, top) = (x.floor(), y.floor());
    let (right_share, low_share) = (x - left, y - top);
    let row = |row: f32| at(left, row) * (1.0 - right_share) + at(left + 1.0, row) * right_share;
    row(top) * (1.0 - low_share) + row(top + 1.0) * low_share
}

fn blended(below: PremultipliedColorU8, colour: Colour, coverage: f32) -> PremultipliedColorU8 {
    let share = coverage * f32::from(colour.opacity) / 255.0;
    let mix =
        |below: u8, above: u8| (f32::from(below) * (1.0 - share) + f32::from(above) * share).round() as u8;
    let [red, green, blue] = colour.rgb;
    let opacity = mix(below.alpha(), 255);
    let [red, green, blue] = [mix(below.red(), red), mix(below.green(), green), mix(below.blue(), blue)]
        .map(|part| part.min(opacity));
    PremultipliedColorU8::from_rgba(red, green, blue, opacity).unwrap_or(below)
}
