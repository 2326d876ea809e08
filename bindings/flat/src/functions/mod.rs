//! The functions of the API, by subject.

mod drawing;
mod edit;
mod events;
mod host;
mod library;
mod matches;
mod maths;
mod query;
mod replay;
mod snapshot;
mod view;
mod world;

pub use drawing::*;
pub use edit::*;
pub use events::*;
pub use host::*;
pub use library::*;
pub use matches::*;
pub use maths::*;
pub use query::*;
pub use replay::*;
pub use snapshot::*;
pub use view::*;
pub use world::*;

use crate::describe::Function;

/// Functions by subject, in the order of the header.
pub(crate) const FUNCTIONS: &[(&str, &[Function])] = &[
    ("The library", library::FUNCTIONS),
    ("Worlds", world::FUNCTIONS),
    ("Edits of a world, or of a list of commands", edit::FUNCTIONS),
    ("What is in a world", view::FUNCTIONS),
    ("Drawing", drawing::FUNCTIONS),
    ("Events of the last tick", events::FUNCTIONS),
    ("Queries", query::FUNCTIONS),
    ("Snapshots", snapshot::FUNCTIONS),
    ("Replays of worlds", replay::FUNCTIONS),
    ("Replays of games with rules of their own", host::FUNCTIONS),
    ("Matches", matches::FUNCTIONS),
    ("Mathematics", maths::FUNCTIONS),
];
