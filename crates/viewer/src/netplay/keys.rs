//! [`Keys`]: a player's [`Pad`] from the keyboard.

use lockstep2d_shove::Pad;

use crate::event::{Event, Key};

/// Set of keys that a player uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// W, A, S and D, and Shift or F to dash.
    Left,
    /// The arrows, and Enter or Control to dash.
    Right,
    /// The keys of both sides, for a player alone at the keyboard.
    Both,
}

/// Keys of one player that are currently down.
#[derive(Clone, Debug)]
pub struct Keys {
    side: Side,
    /// Keys that are down. Two keys may stand for the same button.
    down: Vec<Key>,
}

impl Keys {
    /// Starts with no key down.
    #[must_use]
    pub const fn new(side: Side) -> Self {
        Keys { side, down: Vec::new() }
    }

    /// Handles a key that goes down or up. Returns `true` if it is a key of this player.
    pub fn handle(&mut self, event: &Event) -> bool {
        let (Event::Pressed(key) | Event::Released(key)) = event else { return false };
        if button(self.side, *key).is_none() {
            return false;
        }
        self.down.retain(|down| down != key);
        if matches!(event, Event::Pressed(_)) {
            self.down.push(*key);
        }
        true
    }

    /// Returns the buttons that are down.
    #[must_use]
    pub fn pad(&self) -> Pad {
        let buttons = self.down.iter().filter_map(|key| button(self.side, *key));
        buttons.fold(Pad::default(), Pad::with)
    }
}

fn button(side: Side, key: Key) -> Option<Pad> {
    match side {
        Side::Left => left(key),
        Side::Right => right(key),
        Side::Both => left(key).or_else(|| right(key)),
    }
}

fn left(key: Key) -> Option<Pad> {
    match key {
        Key::Character('w') => Some(Pad::UP),
        Key::Character('a') => Some(Pad::LEFT),
        Key::Character('s') => Some(Pad::DOWN),
        Key::Character('d') => Some(Pad::RIGHT),
        Key::Shift | Key::Character('f') => Some(Pad::DASH),
        _ => None,
    }
}

fn right(key: Key) -> Option<Pad> {
    match key {
        Key::Up => Some(Pad::UP),
        Key::Left => Some(Pad::LEFT),
        Key::Down => Some(Pad::DOWN),
        Key::Right => Some(Pad::RIGHT),
        Key::Enter | Key::Control => Some(Pad::DASH),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_button_is_down_as_long_as_one_of_its_keys_is() {
        let mut keys = Keys::new(Side::Both);
        let press = |key| Event::Pressed(key);
        assert!(keys.handle(&press(Key::Character('w'))) && keys.handle(&press(Key::Up)));
        assert!(
            keys.handle(&press(Key::Up)),
            "a repeated press should be accepted, as keyboards repeat keys"
        );
        assert!(keys.handle(&press(Key::Control)));
        assert_eq!(keys.pad(), Pad::UP.with(Pad::DASH));
        assert!(keys.handle(&Event::Released(Key::Up)));
        assert_eq!(keys.pad(), Pad::UP.with(Pad::DASH));
        assert!(keys.handle(&Event::Released(Key::Character('w'))));
        assert_eq!(keys.pad(), Pad::DASH);
    }

    #[test]
    fn other_keys_are_for_others() {
        let mut keys = Keys::new(Side::Left);
        for key in [Key::Up, Key::Enter, Key::Control, Key::Space, Key::Character('x')] {
            assert!(!keys.handle(&Event::Pressed(key)), "{key:?}");
        }
        assert!(!keys.handle(&Event::Wheel(1.0)));
        assert_eq!(keys.pad(), Pad::default());
    }
}
