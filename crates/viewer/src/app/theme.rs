//! Colours and panels of the user interface.

use lockstep2d::draw::PAPER;
use lockstep2d_render::{Colour, DrawList};

pub(super) const GROUND: Colour = Colour::hex(PAPER);
pub(super) const INK: Colour = Colour::hex(0x22272b);
pub(super) const FAINT: Colour = Colour::hex(0x9099a2);
pub(super) const GOOD: Colour = Colour::hex(0x1b7f3b);
pub(super) const BAD: Colour = Colour::hex(0xc62828);
pub(super) const ACCENT: Colour = Colour::hex(0x1f5f9e);
pub(super) const SELECTED: Colour = Colour::hex(0xff6d00);
/// Tint of the second of two compared sources.
pub(super) const OTHER: Colour = Colour::hex(0xd9480f);

/// Draws a translucent background for text.
pub(super) fn panel(list: &mut DrawList, [x, y]: [f32; 2], [width, height]: [f32; 2]) {
    list.rectangle([x - 4.0, y - 2.0], [width + 8.0, height + 4.0], Colour::hex(0xffffff).with_opacity(215));
}
