//! Sleeping islands: waking and putting to sleep, for the step and for edits between ticks.
//!
//! A body is sleepy once it has been slower than its `sleep_speed` for half a second, if its settings and those of the
//! world let it sleep. An island is a set of dynamic bodies that contacts, joints and areas connect. It falls asleep
//! when all its bodies are sleepy, or when an edit puts one of them to sleep. It wakes as a whole when an active body
//! touches one of its bodies, when an area of an active body begins to act on one, or when an edit may disturb it. Such
//! an edit changes one of its bodies or joints, a body that overlaps one of its bodies or is joined to one, or a
//! setting that affects the balance of forces.
//!
//! Bodies that touch a moving kinematic body, are joined to one, or are in an area of one do not become sleepy.

mod sleep;
mod wake;

pub(crate) use sleep::{put_sleepy_sets_to_sleep, put_to_sleep, unite, unite_connected, unite_touching};
pub(crate) use wake::{
    contact_ended, joint_retuned, joints_changed, wake_body, wake_island, wake_joined, wake_overlapping,
    wake_overlapping_shape, wake_touching,
};
