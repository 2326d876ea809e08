//! Sleeping islands: waking and putting to sleep, for the step and for edits between ticks.
//!
//! A body is sleepy once it has been slower than its `sleep_speed` for half a second, if its settings and the settings
//! of the world let it sleep. An island is a set of dynamic bodies that contacts, joints and areas connect. It falls
//! asleep when all its bodies are sleepy, or when an edit puts one of them to sleep. A whole island wakes in three
//! cases: an active body touches one of its bodies, an area of an active body begins to act on one of its bodies, or an
//! edit may disturb the island. Such an edit changes a body or joint of the island, another body that overlaps or is
//! joined to a body of the island, or a setting that affects the balance of forces.
//!
//! A body does not become sleepy while it touches a moving kinematic body, is joined to a moving kinematic body, or is
//! inside an area of a moving kinematic body.

mod sleep;
mod wake;

pub(crate) use sleep::{put_sleepy_sets_to_sleep, put_to_sleep, unite, unite_connected, unite_touching};
pub(crate) use wake::{
    contact_ended, joint_retuned, joints_changed, wake_body, wake_island, wake_joined, wake_overlapping,
    wake_overlapping_shape, wake_touching,
};
