//! Metrics of the monospaced text cells.

/// Width of a character at scale 1, in pixels.
pub const CELL_WIDTH: f32 = 7.0;
/// Height of a line at scale 1, in pixels.
pub const CELL_HEIGHT: f32 = 16.0;

/// Width of a line of text, in pixels.
#[must_use]
pub fn width_of(text: &str, scale: f32) -> f32 {
    text.chars().count() as f32 * CELL_WIDTH * scale
}
