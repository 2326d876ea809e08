//! Sleeping islands: waking and putting to sleep, for the step and for edits between ticks.
//!
//! A body is sleepy once it has been slower than its `sleep_speed` for half a second. An island is a set of dynamic
//! bodies that contacts and joints connect. It falls asleep when all its bodies are sleepy. It wakes as a whole:
//! - when an active body comes into contact with one of its bodies,
//! - when a force, impulse, velocity, pose or property of one of its bodies is changed by an edit,
//! - when a joint is added to or removed from one of its bodies,
//! - when a body or shape whose fat box overlaps that of one of its bodies is moved, changed or removed by an edit,
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
