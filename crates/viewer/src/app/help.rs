//! Help overlay: the actions of keys and the pointer.

use lockstep2d_render::{CELL_HEIGHT, DrawList, width_of};

use super::theme;

const LINES: &[(&str, &str)] = &[
    ("space, p", "play, pause"),
    ("left, right", "one tick back, forward; ten with shift"),
    ("page up, down", "one second back, forward"),
    ("home, end", "go to the start, to the end"),
    ("up, down", "double, halve the speed"),
    ("1 ... 0 c v i", "toggle layers; or click them"),
    ("wheel, + -", "zoom"),
    ("drag", "pan"),
    ("click", "select a body and show all its fields"),
    ("t", "show the state of the game's own rules"),
    ("f", "follow the selected body"),
    ("r", "show the whole scene"),
    ("j", "go to the first difference of two replays"),
    ("[ ]", "previous scene, next scene"),
    ("s", "save the recording as a replay"),
    ("h", "this list"),
    ("", ""),
    ("", "in a live world:"),
    ("drag", "move a body, and throw it"),
    ("right drag", "draw a new body"),
    ("b", "form of new bodies: disc, box, polygon, rod"),
    ("x, delete", "remove the body under the pointer"),
    ("e", "explosion at the pointer"),
    ("g", "gravity: down, none, up, left, right"),
];

pub(super) fn draw(list: &mut DrawList, [width, height]: [f32; 2]) {
    let (column, columns) = (width_of("x", 1.0) * 16.0, width_of("x", 1.0) * 64.0);
    let tall = CELL_HEIGHT * LINES.len() as f32;
    let corner = [((width - columns) / 2.0).max(8.0), ((height - tall) / 2.0).max(8.0)];
    theme::panel(list, corner, [columns, tall]);
    for (row, (keys, what)) in LINES.iter().enumerate() {
        let y = corner[1] + row as f32 * CELL_HEIGHT;
        list.text([corner[0], y], 1.0, theme::ACCENT, *keys);
        list.text([corner[0] + column, y], 1.0, theme::INK, *what);
    }
}
