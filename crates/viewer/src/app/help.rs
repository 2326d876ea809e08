//! Help overlay: the actions of keys and the pointer.

use lockstep2d_render::{CELL_HEIGHT, DrawList, width_of};

use super::layers::LAYER_KEYS;
use super::theme;
use crate::event::Key;

/// Width of the column of keys, in characters.
const KEY_COLUMNS: usize = 27;
/// Width of the whole list, in characters.
const COLUMNS: usize = 72;

/// Row of the help: an action of the pointer, or an empty text and the keys with the same effect; and this effect.
type Row<'a> = (&'static str, &'a [Key], &'static str);

const ROWS: &[Row<'static>] = &[
    ("", &[Key::Space, Key::Character('p')], "play, pause"),
    ("", &[Key::Left, Key::Character(',')], "one tick back; ten with shift"),
    ("", &[Key::Right, Key::Character('.')], "one tick forward; ten with shift"),
    ("", &[Key::PageUp], "one second back"),
    ("", &[Key::PageDown], "one second forward"),
    ("", &[Key::Home], "go to the start"),
    ("", &[Key::End], "go to the end"),
    ("", &[Key::Up], "double the speed"),
    ("", &[Key::Down], "halve the speed"),
    ("wheel", &[], "zoom"),
    ("", &[Key::Character('+'), Key::Character('=')], "zoom in"),
    ("", &[Key::Character('-')], "zoom out"),
    ("drag", &[], "pan"),
    ("click", &[], "select a body and show all its fields, or toggle a layer"),
    ("", &[Key::Character('t')], "show the state of the game's own rules"),
    ("", &[Key::Character('f')], "follow the selected body"),
    ("", &[Key::Character('r')], "show the whole scene"),
    ("", &[Key::Character('j')], "go to the first difference of two replays"),
    ("", &[Key::Character('[')], "previous scene"),
    ("", &[Key::Character(']')], "next scene"),
    ("", &[Key::Character('s')], "save the recording as a replay"),
    ("", &[Key::Escape], "close this list and the fields of a body"),
    ("", &[Key::Character('h')], "this list"),
];

/// Rows for a live world that the user can act in.
const LIVE: &[Row<'static>] = &[
    ("drag", &[], "move a body, and throw it"),
    ("right drag", &[], "draw a new body"),
    ("", &[Key::Character('b')], "form of new bodies: disc, box, polygon, rod"),
    ("", &[Key::Character('x'), Key::Delete], "remove the body under the pointer"),
    ("", &[Key::Character('e')], "explosion at the pointer"),
    ("", &[Key::Character('g')], "gravity: down, none, up, left, right"),
];

fn name_of(key: Key) -> String {
    match key {
        Key::Character(character) => character.to_string(),
        Key::PageUp => "page up".into(),
        Key::PageDown => "page down".into(),
        other => format!("{other:?}").to_lowercase(),
    }
}

/// Returns the keys and the effect of each row as text. A key that a player of the game uses has no effect in the
/// viewer, so it is left out, and so is a row without any other key.
fn rows(of: &[Row<'_>], players: &[Key]) -> Vec<(String, &'static str)> {
    let row = |&(pointer, keys, effect): &Row<'_>| {
        if !pointer.is_empty() {
            return Some((pointer.to_owned(), effect));
        }
        let free = keys.iter().filter(|key| !players.contains(key));
        let names: Vec<String> = free.map(|&key| name_of(key)).collect();
        let separator = if names.len() > 2 { " " } else { " or " };
        (!names.is_empty()).then(|| (names.join(separator), effect))
    };
    of.iter().filter_map(row).collect()
}

pub(super) fn draw(list: &mut DrawList, [width, height]: [f32; 2], is_live: bool, players: &[Key]) {
    let layers = LAYER_KEYS.map(Key::Character);
    let mut lines = rows(ROWS, players);
    lines.extend(rows(&[("", &layers, "toggle layers")], players));
    if is_live {
        lines.extend([(String::new(), ""), (String::new(), "in this live world:")]);
        lines.extend(rows(LIVE, players));
    }
    let (column, columns) = (width_of("x", 1.0) * KEY_COLUMNS as f32, width_of("x", 1.0) * COLUMNS as f32);
    let tall = CELL_HEIGHT * lines.len() as f32;
    let corner = [((width - columns) / 2.0).max(8.0), ((height - tall) / 2.0).max(8.0)];
    theme::panel(list, corner, [columns, tall]);
    for (row, (keys, effect)) in lines.into_iter().enumerate() {
        let y = corner[1] + row as f32 * CELL_HEIGHT;
        list.text([corner[0], y], 1.0, theme::ACCENT, keys);
        list.text([corner[0] + column, y], 1.0, theme::INK, effect);
    }
}
