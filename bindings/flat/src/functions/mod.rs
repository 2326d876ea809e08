//! Functions by subject.

mod character;
mod definitions;
mod drawing;
mod edit;
mod events;
#[cfg(feature = "lockstep")]
mod host_recorder;
#[cfg(feature = "lockstep")]
mod host_replay;
#[cfg(feature = "lockstep")]
mod host_timeline;
mod library;
#[cfg(feature = "lockstep")]
mod matches;
mod maths;
mod query;
#[cfg(feature = "lockstep")]
mod replay;
mod snapshot;
#[cfg(feature = "lockstep")]
mod timeline;
mod view;
mod world;

pub use character::*;
pub use definitions::*;
pub use drawing::*;
pub use edit::*;
pub use events::*;
#[cfg(feature = "lockstep")]
pub use host_recorder::*;
#[cfg(feature = "lockstep")]
pub use host_replay::*;
#[cfg(feature = "lockstep")]
pub use host_timeline::*;
pub use library::*;
#[cfg(feature = "lockstep")]
pub use matches::*;
pub use maths::*;
pub use query::*;
#[cfg(feature = "lockstep")]
pub use replay::*;
pub use snapshot::*;
#[cfg(feature = "lockstep")]
pub use timeline::*;
pub use view::*;
pub use world::*;

use crate::describe::Function;

/// Functions by subject, in the order of the header.
pub(crate) const FUNCTIONS: &[(&str, &[Function])] = &[
    ("The library", library::FUNCTIONS),
    ("Worlds", world::FUNCTIONS),
    ("Definitions", definitions::FUNCTIONS),
    ("Edits of a world, or of a list of commands", edit::FUNCTIONS),
    ("Contents of a world", view::FUNCTIONS),
    ("Drawing", drawing::FUNCTIONS),
    ("Events of the last tick", events::FUNCTIONS),
    ("Queries", query::FUNCTIONS),
    ("Characters", character::FUNCTIONS),
    ("Snapshots", snapshot::FUNCTIONS),
    #[cfg(feature = "lockstep")]
    ("Replays of worlds", replay::FUNCTIONS),
    #[cfg(feature = "lockstep")]
    ("Timelines of replays of worlds", timeline::FUNCTIONS),
    #[cfg(feature = "lockstep")]
    ("Recorders of games with rules of their own", host_recorder::FUNCTIONS),
    #[cfg(feature = "lockstep")]
    ("Replays of games with rules of their own", host_replay::FUNCTIONS),
    #[cfg(feature = "lockstep")]
    ("Timelines of replays of games with rules of their own", host_timeline::FUNCTIONS),
    #[cfg(feature = "lockstep")]
    ("Matches", matches::FUNCTIONS),
    ("Mathematics", maths::FUNCTIONS),
];

#[cfg(any(test, feature = "fuzzing"))]
pub(crate) const DRAWN: &[&[crate::fuzzing::DrawnCall]] = &[
    library::DRAWN,
    world::DRAWN,
    definitions::DRAWN,
    edit::DRAWN,
    view::DRAWN,
    drawing::DRAWN,
    events::DRAWN,
    query::DRAWN,
    character::DRAWN,
    snapshot::DRAWN,
    #[cfg(feature = "lockstep")]
    replay::DRAWN,
    #[cfg(feature = "lockstep")]
    timeline::DRAWN,
    #[cfg(feature = "lockstep")]
    host_recorder::DRAWN,
    #[cfg(feature = "lockstep")]
    host_replay::DRAWN,
    #[cfg(feature = "lockstep")]
    host_timeline::DRAWN,
    #[cfg(feature = "lockstep")]
    matches::DRAWN,
    maths::DRAWN,
];
