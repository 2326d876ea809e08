//! The overlay layers and the keys that toggle them.

use lockstep2d::draw::Layers;
use lockstep2d_render::{CELL_HEIGHT, DrawList, width_of};

use super::theme;
use crate::event::Key;

/// Key of each layer, in the order of [`Layers::named`].
pub const LAYER_KEYS: [char; 13] = ['1', '2', '3', '4', '5', '6', '7', '8', '9', '0', 'c', 'v', 'i'];

/// Initial layers, which show the world as a game would.
pub(crate) const fn layers_at_first() -> Layers {
    Layers { outlines: true, joints: true, ..Layers::NONE }
}

/// Toggles the layer of a key. Returns `false` if the key has no layer.
pub(super) fn switch(layers: &mut Layers, key: Key) -> bool {
    let place = LAYER_KEYS.iter().position(|&of_layer| key == Key::Character(of_layer));
    let named = layers.named();
    match place.and_then(|place| named.into_iter().nth(place)) {
        Some((_, shown)) => {
            *shown = !*shown;
            true
        }
        None => false,
    }
}

/// Clickable list of layers.
#[derive(Clone, Copy, Debug)]
pub(super) struct LayerList {
    /// Upper left corner, in pixels.
    pub(super) corner: [f32; 2],
}

impl LayerList {
    const WIDTH: usize = 21;

    pub(super) fn size() -> [f32; 2] {
        [width_of("x", 1.0) * Self::WIDTH as f32, CELL_HEIGHT * LAYER_KEYS.len() as f32]
    }

    pub(super) fn draw(self, list: &mut DrawList, mut layers: Layers) {
        theme::panel(list, self.corner, Self::size());
        for (row, (key, (name, shown))) in LAYER_KEYS.iter().zip(layers.named()).enumerate() {
            let mark = if *shown { '*' } else { ' ' };
            let colour = if *shown { theme::INK } else { theme::FAINT };
            let at = [self.corner[0], self.corner[1] + row as f32 * CELL_HEIGHT];
            list.text(at, 1.0, colour, format!("{key} {mark} {}", name.replace('_', " ")));
        }
    }

    pub(super) fn key_at(self, [x, y]: [f32; 2]) -> Option<Key> {
        let [width, height] = Self::size();
        let (x, y) = (x - self.corner[0], y - self.corner[1]);
        let inside = (0.0..width).contains(&x) && (0.0..height).contains(&y);
        let key = inside.then(|| LAYER_KEYS.get((y / CELL_HEIGHT) as usize)).flatten();
        key.map(|&key| Key::Character(key))
    }
}
