//! Sleeping islands: waking and putting to sleep, for the step and for edits between ticks.
//!
//! A body is sleepy once it has been slower than its `sleep_speed` for half a second. An island is a set of dynamic
//! bodies that contacts and joints connect. It falls asleep when all its bodies are sleepy. It wakes as a whole:
//! - when an active body comes into contact with one of its bodies,
//! - when an edit applies a force or impulse to one of its bodies, or changes the velocity, pose or a property of one,
//!   except for its user data and its name,
//! - when a joint of one of its bodies is added, changed or removed,
//! - when an edit adds, moves, changes or removes a shape whose fat box overlaps that of one of its bodies, or enables,
//!   disables or changes the kind of a body with such a shape, except when it spawns a dynamic body,
//! - when an edit moves, enables or disables a body that is joined to one of its bodies, changes its kind, or sets a
//!   kinematic body that is joined to one of its bodies in motion,
//! - when gravity or another setting that affects the balance of forces changes,
//! - when a fixed or kinematic body that it touches or is joined to is woken by an edit.
//!
//! Bodies that touch, or are joined to, a moving kinematic body do not become sleepy.

mod sleep;
mod wake;

pub(crate) use sleep::{put_sleepy_sets_to_sleep, put_to_sleep, unite, unite_connected, unite_touching};
pub(crate) use wake::{
    contact_ended, joint_retuned, joints_changed, wake_body, wake_island, wake_joined, wake_overlapping,
    wake_overlapping_shape, wake_touching,
};
