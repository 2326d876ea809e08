//! Help overlay: the actions of keys and the pointer.

use lockstep2d_render::{CELL_HEIGHT, DrawList, width_of};

use super::theme;
use crate::event::Key;

/// Row of the help: the keys as text, the keys as values, and their effect. The row is left out if a player of the game
/// uses one of the keys.
type Line = (&'static str, &'static [Key], &'static str);

const LINES: &[Line] = &[
    ("space", &[Key::Space], "play, pause"),
    ("p", &[Key::Character('p')], "play, pause"),
    ("left, right", &[Key::Left, Key::Right], "one tick back, forward; ten with shift"),
    (", .", &[Key::Character(','), Key::Character('.')], "one tick back, forward; ten with shift"),
    ("page up, down", &[Key::PageUp, Key::PageDown], "one second back, forward"),
    ("home, end", &[Key::Home, Key::End], "go to the start, to the end"),
    ("up, down", &[Key::Up, Key::Down], "double, halve the speed"),
    ("1 ... 0 c v i", &[], "toggle layers; or click them"),
    ("wheel, + -", &[], "zoom"),
    ("drag", &[], "pan"),
    ("click", &[], "select a body and show all its fields"),
    ("t", &[Key::Character('t')], "show the state of the game's own rules"),
    ("f", &[Key::Character('f')], "follow the selected body"),
    ("r", &[Key::Character('r')], "show the whole scene"),
    ("j", &[Key::Character('j')], "go to the first difference of two replays"),
    ("[ ]", &[Key::Character('['), Key::Character(']')], "previous scene, next scene"),
    ("s", &[Key::Character('s')], "save the recording as a replay"),
    ("h", &[Key::Character('h')], "this list"),
];

/// Rows for a live world that the user can act in.
const LIVE: &[Line] = &[
    ("", &[], ""),
    ("", &[], "in this live world:"),
    ("drag", &[], "move a body, and throw it"),
    ("right drag", &[], "draw a new body"),
    ("b", &[], "form of new bodies: disc, box, polygon, rod"),
    ("x, delete", &[], "remove the body under the pointer"),
    ("e", &[], "explosion at the pointer"),
    ("g", &[], "gravity: down, none, up, left, right"),
];

pub(super) fn draw(list: &mut DrawList, [width, height]: [f32; 2], is_live: bool, players: &[Key]) {
    let is_free = |line: &&Line| line.1.iter().all(|key| !players.contains(key));
    let live = if is_live { LIVE } else { &[] };
    let lines: Vec<_> = LINES.iter().chain(live).filter(is_free).collect();
    let (column, columns) = (width_of("x", 1.0) * 16.0, width_of("x", 1.0) * 64.0);
    let tall = CELL_HEIGHT * lines.len() as f32;
    let corner = [((width - columns) / 2.0).max(8.0), ((height - tall) / 2.0).max(8.0)];
    theme::panel(list, corner, [columns, tall]);
    for (row, (keys, _, what)) in lines.into_iter().enumerate() {
        let y = corner[1] + row as f32 * CELL_HEIGHT;
        list.text([corner[0], y], 1.0, theme::ACCENT, *keys);
        list.text([corner[0] + column, y], 1.0, theme::INK, *what);
    }
}
