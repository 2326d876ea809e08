//! Error messages of the library: the exact sentences, with their values.

mod check;
mod files;
mod game;
mod peer;
mod replays;
mod world;

use std::fmt::Display;

/// Compares the `Display` output of values with the expected text.
#[track_caller]
fn says<T: Display>(table: impl IntoIterator<Item = (T, &'static str)>) {
    for (value, expected) in table {
        assert_eq!(value.to_string(), expected);
    }
}
