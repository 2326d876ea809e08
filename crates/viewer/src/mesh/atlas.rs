//! [`Atlas`]: texture atlas of all glyphs.

use lockstep2d_render::{GLYPH_HEIGHT, GLYPH_WIDTH, glyph};

/// Size of the place of a glyph in the atlas, in pixels. To the right of a glyph and below it there is an empty pixel,
/// so that magnified glyphs do not show pixels of their neighbours.
const SLOT: [usize; 2] = [GLYPH_WIDTH + 1, GLYPH_HEIGHT + 1];
const COLUMNS: usize = 16;
/// Number of Latin-1 characters. They have the first slots.
const LATIN: usize = 0x100;
/// First of the 64 characters that follow in the atlas: dashes, quotes and spaces.
const PUNCTUATION: u32 = 0x2000;
const SLOTS: usize = LATIN + 0x40;

/// Image of all glyphs: white pixels, with the coverage by the glyph as opacity.
#[derive(Clone, Debug)]
pub struct Atlas {
    /// Red, green, blue and opacity of each pixel, rows from top to bottom.
    pub pixels: Vec<u8>,
}

impl Default for Atlas {
    fn default() -> Self {
        let mut pixels = vec![0; Atlas::WIDTH * Atlas::HEIGHT * 4];
        for slot in 0..SLOTS {
            let [left, top] = corner(slot);
            for (y, row) in glyph(character(slot)).iter().enumerate() {
                for (x, &coverage) in row.iter().enumerate() {
                    let at = ((top + y) * Atlas::WIDTH + left + x) * 4;
                    pixels[at..at + 4].copy_from_slice(&[255, 255, 255, coverage]);
                }
            }
        }
        Atlas { pixels }
    }
}

impl Atlas {
    /// Width in pixels.
    pub const WIDTH: usize = COLUMNS * SLOT[0];
    /// Height in pixels.
    pub const HEIGHT: usize = SLOTS.div_ceil(COLUMNS) * SLOT[1];

    /// Upper left and lower right corner of a character, as fractions of the image.
    pub(super) fn place(character: char) -> [[f32; 2]; 2] {
        let [left, top] = corner(slot(character));
        let fraction = |x: usize, y: usize| [x as f32 / Atlas::WIDTH as f32, y as f32 / Atlas::HEIGHT as f32];
        [fraction(left, top), fraction(left + GLYPH_WIDTH, top + GLYPH_HEIGHT)]
    }
}

fn corner(slot: usize) -> [usize; 2] {
    [slot % COLUMNS * SLOT[0], slot / COLUMNS * SLOT[1]]
}

/// Slot of a character. Slot 0 is the glyph for characters that the atlas lacks.
fn slot(character: char) -> usize {
    let code = u32::from(character);
    match character {
        '\0'..='\u{ff}' => code as usize,
        '\u{2000}'..='\u{203f}' => LATIN + (code - PUNCTUATION) as usize,
        '\u{2212}' => slot('-'),
        '\u{3bc}' => slot('\u{b5}'),
        _ => 0,
    }
}

fn character(slot: usize) -> char {
    let code = slot as u32;
    let code = if slot < LATIN { code } else { code - LATIN as u32 + PUNCTUATION };
    char::from_u32(code).unwrap_or('\0')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_character_is_where_its_glyph_is() {
        let atlas = Atlas::default();
        for character in " Az~°µé–’…\u{2212}\u{3bc}語\n".chars() {
            let [[u, v], _] = Atlas::place(character);
            let left = (u * Atlas::WIDTH as f32).round() as usize;
            let top = (v * Atlas::HEIGHT as f32).round() as usize;
            for (y, row) in glyph(character).iter().enumerate() {
                for (x, &coverage) in row.iter().enumerate() {
                    let at = ((top + y) * Atlas::WIDTH + left + x) * 4;
                    assert_eq!(atlas.pixels[at + 3], coverage, "{character:?} at {x}, {y}");
                }
            }
        }
    }
}
