//! [`Event`]: what a person does.

/// What a person does, or a script in their place. Positions are pixels from the upper left corner.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// The window has this size now.
    Resized([f32; 2]),
    /// A key went down.
    Pressed(Key),
    /// A key went up.
    Released(Key),
    /// The pointer is here now.
    Moved([f32; 2]),
    /// A button of the pointer went down.
    Down(Button),
    /// A button of the pointer went up.
    Up(Button),
    /// The wheel was turned, by notches: positive is away from the person.
    Wheel(f32),
    /// A file was dropped on the window.
    Dropped {
        /// Its name, to be shown.
        name: String,
        /// What is in it.
        bytes: Vec<u8>,
    },
}

/// A key: letters and digits as characters in lower case, the others by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// A letter, a digit or another character: the one on the key, without Shift.
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
    /// To the start.
    Home,
    /// To the end.
    End,
    /// A longer way back.
    PageUp,
    /// A longer way forward.
    PageDown,
    /// Confirms.
    Enter,
    /// Gives up.
    Escape,
    /// Removes.
    Delete,
    /// To the next.
    Tab,
    /// Either Shift key.
    Shift,
    /// Either Control key.
    Control,
}

/// A button of the pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Button {
    /// The first, also a touch.
    Left,
    /// The wheel as a button.
    Middle,
    /// The other.
    Right,
}
