//! Error messages of the library.

mod check;
mod files;
mod game;
mod peer;
mod replays;
mod world;

use std::fmt::Display;

#[track_caller]
fn says<T: Display>(table: impl IntoIterator<Item = (T, &'static str)>) {
    for (value, expected) in table {
        assert_eq!(value.to_string(), expected);
    }
}
