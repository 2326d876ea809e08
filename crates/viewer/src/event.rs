//! [`Event`]: input from the user.

/// Input event. Positions are in units of the draw list (screen pixels divided by the scale factor), from the upper
/// left corner.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// New width and height of the window, in units of the draw list.
    Resized([f32; 2]),
    /// A key went down.
    Pressed(Key),
    /// A key went up.
    Released(Key),
    /// The pointer moved to this position.
    Moved([f32; 2]),
    /// A pointer button went down.
    Down(Button),
    /// A pointer button went up.
    Up(Button),
    /// Number of notches by which the wheel was turned. Positive if turned away from the user.
    Wheel(f32),
    /// A file was dropped on the window. Not sent by a window of Windows.
    Dropped {
        /// File name, for display.
        name: String,
        /// Contents of the file.
        bytes: Vec<u8>,
    },
}

/// Key of the keyboard. A key that prints a character is named by that character in lower case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// Character that the key produces without Shift. On Windows and in a browser, the character at the place of the
    /// key on a US keyboard, whatever the actual layout is.
    Character(char),
    /// The space bar.
    Space,
    /// The left arrow.
    Left,
    /// The right arrow.
    Right,
    /// The up arrow.
    Up,
    /// The down arrow.
    Down,
    /// The Home key.
    Home,
    /// The End key.
    End,
    /// The Page Up key.
    PageUp,
    /// The Page Down key.
    PageDown,
    /// The Enter key, also that of the number pad.
    Enter,
    /// The Escape key.
    Escape,
    /// The Delete or the Backspace key.
    Delete,
    /// The Tab key.
    Tab,
    /// Either Shift key.
    Shift,
    /// Either Control key.
    Control,
}

impl From<char> for Key {
    /// The key of a character. A space gives the space bar, and ASCII letters are converted to lower case.
    fn from(character: char) -> Self {
        match character {
            ' ' => Key::Space,
            other => Key::Character(other.to_ascii_lowercase()),
        }
    }
}

/// Button of the pointer.
///
/// ```
/// use lockstep2d_viewer::{App, Button, Event};
///
/// // A click in the middle of the picture, and a drag with the right button, which draws a new body in a live scene.
/// let mut app = App::default();
/// app.show_scene("box_stack", 0);
/// let click = [Event::Moved([480.0, 360.0]), Event::Down(Button::Left), Event::Up(Button::Left)];
/// let body = [Event::Down(Button::Right), Event::Moved([500.0, 360.0]), Event::Up(Button::Right)];
/// click.into_iter().chain(body).for_each(|event| app.handle(event));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Button {
    /// The left button, or a touch.
    Left,
    /// The wheel pressed as a button.
    Middle,
    /// The right button.
    Right,
}
