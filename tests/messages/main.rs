//! What errors say to those who read them: every sentence, with its values.

mod check;
mod files;
mod game;
#[cfg(feature = "ggrs")]
mod net;
mod replays;
mod world;

use std::fmt::Display;

/// Compares what values say with what they should.
#[track_caller]
fn says<T: Display>(table: impl IntoIterator<Item = (T, &'static str)>) {
    for (value, expected) in table {
        assert_eq!(value.to_string(), expected);
    }
}
