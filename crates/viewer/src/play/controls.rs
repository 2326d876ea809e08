//! [`Controls`]: a player's input from the keyboard.

use std::fmt;
use std::rc::Rc;

use crate::event::{Event, Key};

type Change<I> = Rc<dyn Fn(&mut I)>;

/// The keys of a player. Each key has a function that changes the player's input for a tick.
///
/// The input of a tick starts as the default. Every key that is down changes it, in the order in which the keys were
/// added. A key that goes down and up between two ticks counts for one tick.
///
/// ```
/// use lockstep2d_viewer::{Controls, Event, Key};
///
/// let mut controls = Controls::<i8>::new()
///     .key(Key::Left, |push| *push -= 2)
///     .key(Key::Right, |push| *push += 2)
///     .key('d', |push| *push += 2);
/// assert!(controls.handle(&Event::Pressed(Key::Character('d'))));
/// assert!(!controls.handle(&Event::Pressed(Key::Escape)), "not a key of this player");
/// assert_eq!(controls.input(), 2);
/// ```
pub struct Controls<I> {
    bindings: Vec<(Key, Change<I>)>,
    down: Vec<Key>,
    /// Keys that went down since the last tick.
    tapped: Vec<Key>,
}

impl<I> Clone for Controls<I> {
    fn clone(&self) -> Self {
        let Controls { bindings, down, tapped } = self;
        Controls { bindings: bindings.clone(), down: down.clone(), tapped: tapped.clone() }
    }
}

impl<I> fmt::Debug for Controls<I> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.bindings.iter().map(|(key, _)| key)).finish()
    }
}

impl<I: Default> Default for Controls<I> {
    fn default() -> Self {
        Self::new()
    }
}

impl<I: Default> Controls<I> {
    /// Creates controls without keys.
    #[must_use]
    pub const fn new() -> Self {
        Controls { bindings: Vec::new(), down: Vec::new(), tapped: Vec::new() }
    }

    /// Adds a key that changes the input of a tick while it is down. The key loses its function in the viewer.
    #[must_use]
    pub fn key(mut self, key: impl Into<Key>, change: impl Fn(&mut I) + 'static) -> Self {
        self.bindings.push((key.into(), Rc::new(change)));
        self
    }

    /// Adds all keys of another player.
    #[must_use]
    pub fn with(mut self, other: &Self) -> Self {
        self.bindings.extend(other.bindings.iter().cloned());
        self
    }

    /// Keys, in the order in which they were added.
    pub fn keys(&self) -> impl Iterator<Item = Key> {
        self.bindings.iter().map(|(key, _)| *key)
    }

    /// Handles a key that goes down or up. Returns `true` if it is a key of this player.
    pub fn handle(&mut self, event: &Event) -> bool {
        let (Event::Pressed(key) | Event::Released(key)) = event else { return false };
        if self.bindings.iter().all(|(bound, _)| bound != key) {
            return false;
        }
        let was_down = self.down.contains(key);
        self.down.retain(|down| down != key);
        if matches!(event, Event::Pressed(_)) {
            self.down.push(*key);
            if !was_down {
                self.tapped.push(*key);
            }
        }
        true
    }

    /// Returns the input for the next tick.
    #[must_use]
    pub fn input(&self) -> I {
        let mut input = I::default();
        for (key, change) in &self.bindings {
            if self.down.contains(key) || self.tapped.contains(key) {
                change(&mut input);
            }
        }
        input
    }

    /// Returns the input for the next tick, and forgets the keys that went down since the last tick.
    pub(super) fn take(&mut self) -> I {
        let input = self.input();
        self.forget_taps();
        input
    }

    /// Forgets the keys that went down since the last tick. Keys that are still down keep their effect.
    pub(super) fn forget_taps(&mut self) {
        self.tapped.clear();
    }

    pub(super) fn is_pressed(&self) -> bool {
        !self.down.is_empty() || !self.tapped.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn controls() -> Controls<Vec<u8>> {
        let controls = Controls::new().key('w', |input: &mut Vec<u8>| input.push(1));
        controls.key(Key::Up, |input| input.push(1)).key(Key::Control, |input| input.push(2))
    }

    #[test]
    fn a_key_counts_as_long_as_it_is_down() {
        let mut controls = controls();
        for key in [Key::Control, Key::Up, Key::Up] {
            assert!(controls.handle(&Event::Pressed(key)), "keyboards repeat keys");
        }
        assert_eq!(controls.take(), [1, 2], "in the order in which the keys were added");
        assert_eq!(controls.take(), [1, 2]);
        assert!(controls.handle(&Event::Released(Key::Up)));
        assert_eq!((controls.take(), controls.is_pressed()), (vec![2], true));
        assert!(controls.handle(&Event::Released(Key::Control)));
        assert_eq!((controls.take(), controls.is_pressed()), (vec![], false));
    }

    #[test]
    fn a_short_tap_counts_for_one_tick() {
        let mut controls = controls();
        assert!(controls.handle(&Event::Pressed(Key::Up)) && controls.handle(&Event::Released(Key::Up)));
        assert_eq!((controls.take(), controls.take()), (vec![1], vec![]));
    }

    #[test]
    fn other_keys_are_for_others() {
        let mut controls = controls();
        for key in [Key::Left, Key::Enter, Key::Space, Key::Character('x')] {
            assert!(!controls.handle(&Event::Pressed(key)), "{key:?}");
        }
        assert!(!controls.handle(&Event::Wheel(1.0)));
        assert_eq!(controls.input(), [] as [u8; 0]);
    }
}
