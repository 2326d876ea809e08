//! Translates miniquad's keys, buttons and wheel to those of the viewer.

use crate::{Button, Key};
use miniquad::{KeyCode, MouseButton};

#[derive(Debug, Default)]
pub(super) struct Keyboard {
    down: Vec<KeyCode>,
}

impl Keyboard {
    /// Handles a key that goes down or repeats. Returns the key if the viewer should handle it.
    pub(super) fn down(&mut self, code: KeyCode, repeat: bool) -> Option<Key> {
        let key = key(code)?;
        if !self.down.contains(&code) {
            self.down.push(code);
        }
        (!repeat || repeats(key)).then_some(key)
    }

    /// Handles a key that goes up. Returns the key, unless another key with the same meaning is still down, such as the
    /// other Shift key.
    pub(super) fn up(&mut self, code: KeyCode) -> Option<Key> {
        self.down.retain(|&down| down != code);
        let key = key(code)?;
        let held = self.down.iter().any(|&down| self::key(down) == Some(key));
        (!held).then_some(key)
    }

    pub(super) fn release(&mut self) -> Vec<Key> {
        self.down.drain(..).filter_map(key).collect()
    }
}

/// Whether the viewer handles the repetitions of a held key. It does for keys that change the tick, speed or zoom by a
/// step, and not for keys that toggle a setting.
fn repeats(key: Key) -> bool {
    let steps = [Key::Left, Key::Right, Key::Up, Key::Down, Key::PageUp, Key::PageDown];
    steps.contains(&key) || matches!(key, Key::Character(',' | '.' | '+' | '-' | '='))
}

fn key(code: KeyCode) -> Option<Key> {
    Some(match code {
        KeyCode::Space => Key::Space,
        KeyCode::Left => Key::Left,
        KeyCode::Right => Key::Right,
        KeyCode::Up => Key::Up,
        KeyCode::Down => Key::Down,
        KeyCode::Home => Key::Home,
        KeyCode::End => Key::End,
        KeyCode::PageUp => Key::PageUp,
        KeyCode::PageDown => Key::PageDown,
        KeyCode::Enter | KeyCode::KpEnter => Key::Enter,
        KeyCode::Escape => Key::Escape,
        KeyCode::Delete | KeyCode::Backspace => Key::Delete,
        KeyCode::Tab => Key::Tab,
        KeyCode::LeftShift | KeyCode::RightShift => Key::Shift,
        KeyCode::LeftControl | KeyCode::RightControl => Key::Control,
        other => Key::Character(character(other)?),
    })
}

fn character(code: KeyCode) -> Option<char> {
    // The code of a printable key is the ASCII code of the key's character.
    let ascii = u8::try_from(code as u16).ok().map(char::from).filter(char::is_ascii_graphic);
    ascii.map(|character| character.to_ascii_lowercase()).or(match code {
        KeyCode::KpAdd => Some('+'),
        KeyCode::KpSubtract => Some('-'),
        KeyCode::KpMultiply => Some('*'),
        KeyCode::KpDivide => Some('/'),
        KeyCode::KpDecimal => Some('.'),
        KeyCode::Kp0 => Some('0'),
        KeyCode::Kp1 => Some('1'),
        KeyCode::Kp2 => Some('2'),
        KeyCode::Kp3 => Some('3'),
        KeyCode::Kp4 => Some('4'),
        KeyCode::Kp5 => Some('5'),
        KeyCode::Kp6 => Some('6'),
        KeyCode::Kp7 => Some('7'),
        KeyCode::Kp8 => Some('8'),
        KeyCode::Kp9 => Some('9'),
        _ => None,
    })
}

pub(super) fn button(button: MouseButton) -> Option<Button> {
    match button {
        MouseButton::Left => Some(Button::Left),
        MouseButton::Middle => Some(Button::Middle),
        MouseButton::Right => Some(Button::Right),
        MouseButton::Unknown => None,
    }
}

/// Wheel movement that miniquad reports for one notch: pixels in a browser, Windows' own units, or lines on other
/// systems.
const NOTCH: f32 = if cfg!(target_arch = "wasm32") {
    100.0
} else if cfg!(target_os = "windows") {
    120.0
} else {
    1.0
};

/// Converts a wheel movement to notches, from -10 to 10. A value that is not finite becomes 0.
pub(super) fn notches(turned: f32) -> f32 {
    let notches = turned / NOTCH;
    if notches.is_finite() { notches.clamp(-10.0, 10.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_in_lower_case_and_both_shifts_are_one_key() {
        assert_eq!(key(KeyCode::A), Some(Key::Character('a')));
        assert_eq!(key(KeyCode::Key7), Some(Key::Character('7')));
        assert_eq!(key(KeyCode::Comma), Some(Key::Character(',')));
        assert_eq!(key(KeyCode::Kp3), Some(Key::Character('3')));
        assert_eq!(key(KeyCode::LeftShift), key(KeyCode::RightShift));
        assert_eq!(key(KeyCode::F1), None);
        assert_eq!(key(KeyCode::World1), None);
    }

    #[test]
    fn a_shift_key_is_up_when_both_are() {
        let mut keyboard = Keyboard::default();
        assert_eq!(keyboard.down(KeyCode::LeftShift, false), Some(Key::Shift));
        assert_eq!(keyboard.down(KeyCode::RightShift, false), Some(Key::Shift));
        assert_eq!(keyboard.up(KeyCode::LeftShift), None);
        assert_eq!(keyboard.up(KeyCode::RightShift), Some(Key::Shift));
    }

    #[test]
    fn held_keys_repeat_if_they_go_a_step() {
        let mut keyboard = Keyboard::default();
        assert_eq!(keyboard.down(KeyCode::Right, true), Some(Key::Right));
        assert_eq!(keyboard.down(KeyCode::Space, false), Some(Key::Space));
        assert_eq!(keyboard.down(KeyCode::Space, true), None);
        assert_eq!(keyboard.release(), [Key::Right, Key::Space]);
        assert_eq!(keyboard.release(), []);
    }

    #[test]
    fn wheels_turn_by_notches() {
        assert_eq!(notches(NOTCH), 1.0);
        assert_eq!(notches(-1e9), -10.0);
        assert_eq!(notches(f32::NAN), 0.0);
    }
}
