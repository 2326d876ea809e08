//! [`glyph`]: the glyphs of a bitmap font.
//!
//! The font is Noto Sans Mono with the characters of Latin-1, 7 x 16 pixels each. Some other characters are replaced by
//! similar ones. All others are drawn as a hollow box.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use crate::text::{CELL_HEIGHT, CELL_WIDTH};

const WEIGHT: FontWeight = FontWeight::Regular;
const SIZE: RasterHeight = RasterHeight::Size16;

/// Width of a glyph in pixels. It is the width of a text cell at scale 1.
pub const GLYPH_WIDTH: usize = get_raster_width(WEIGHT, SIZE);
/// Height of a glyph in pixels. It is the height of a text cell at scale 1.
pub const GLYPH_HEIGHT: usize = SIZE.val();

const _: () = assert!(GLYPH_WIDTH as f32 == CELL_WIDTH && GLYPH_HEIGHT as f32 == CELL_HEIGHT);

/// Coverage of each pixel of a glyph, from 0 to 255, in rows from top to bottom.
pub type Glyph = [[u8; GLYPH_WIDTH]; GLYPH_HEIGHT];

/// Returns the glyph of a character: that of a similar one if the font lacks the character, or else a hollow box.
#[must_use]
pub fn glyph(character: char) -> Glyph {
    let Some(raster) = get_raster(nearest(character), WEIGHT, SIZE) else { return MISSING };
    let mut glyph = [[0; GLYPH_WIDTH]; GLYPH_HEIGHT];
    for (row, pixels) in glyph.iter_mut().zip(raster.rows()) {
        row.copy_from_slice(pixels);
    }
    glyph
}

/// Returns a similar character for one that the font lacks. If there is no similar character, returns the character
/// itself.
fn nearest(character: char) -> char {
    match character {
        '\u{2010}'..='\u{2015}' | '\u{2212}' => '-',
        '\u{2018}' | '\u{2019}' => '\'',
        '\u{201c}' | '\u{201d}' => '"',
        '\u{2022}' => '\u{b7}',
        '\u{2003}' | '\u{2009}' | '\u{202f}' => ' ',
        '\u{3bc}' => '\u{b5}',
        other => other,
    }
}

const MISSING: Glyph = {
    let mut glyph = [[0; GLYPH_WIDTH]; GLYPH_HEIGHT];
    let mut y = 2;
    while y < 13 {
        let mut x = 1;
        while x < GLYPH_WIDTH - 1 {
            if y == 2 || y == 12 || x == 1 || x == GLYPH_WIDTH - 2 {
                glyph[y][x] = 255;
            }
            x += 1;
        }
        y += 1;
    }
    glyph
};

#[cfg(test)]
mod tests {
    use super::*;

    fn ink(glyph: Glyph) -> u32 {
        glyph.iter().flatten().map(|&coverage| u32::from(coverage)).sum()
    }

    #[test]
    fn latin_letters_digits_and_signs_are_there() {
        for character in ('!'..='~').chain("·°±²³µ×äöüßéñ§÷¿".chars()) {
            let glyph = glyph(character);
            assert_ne!(glyph, MISSING, "{character:?}");
            assert!(ink(glyph) > 100, "{character:?} should be visible");
        }
        assert_eq!(ink(glyph(' ')), 0);
    }

    #[test]
    fn what_the_font_lacks_can_be_seen() {
        assert_eq!(glyph('\u{2212}'), glyph('-'), "the minus sign should look like a hyphen");
        for character in ['語', '\u{1f600}', '\u{0}', '\n'] {
            assert_eq!(glyph(character), MISSING, "{character:?}");
        }
        assert!(ink(MISSING) > 1000);
    }

    #[test]
    fn no_two_printable_characters_look_alike() {
        let all: Vec<(char, Glyph)> = ('!'..='~').map(|character| (character, glyph(character))).collect();
        for (at, (a, first)) in all.iter().enumerate() {
            for (b, second) in &all[at + 1..] {
                assert_ne!(first, second, "{a:?} and {b:?} should differ");
            }
        }
    }
}
