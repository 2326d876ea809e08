//! Sleeping islands: waking and putting to sleep, for the step and for edits between ticks.
//!
//! A body is sleepy once it has been slower than its `sleep_speed` for half a second, if its settings and those of the
//! world let it sleep. An island is a set of dynamic bodies that contacts, joints and areas connect. It falls asleep
//! when all its bodies are sleepy, or when an edit puts one of them to sleep. It wakes as a whole:
//! - when an active body touches one of its bodies, or an area of an active body begins to act on one,
//! - when an edit wakes one of its bodies, applies a force or impulse to it, or changes its velocity, its pose or a
//!   property other than its user data and its name,
//! - when a joint of one of its bodies is added, changed or removed,
//! - when an edit adds, moves, changes or removes a shape whose fat box overlaps that of one of its bodies (unless it
//!   spawns a dynamic body), enables or disables a body with such a shape, or changes the kind of that body or whether
//!   it has mass,
//! - when an edit moves, enables or disables a body that is joined to one of its bodies, changes the kind of that body
//!   or whether it has mass, or sets that body in motion if it is kinematic,
//! - when gravity or another setting that affects the balance of forces changes, or sleeping is turned off,
//! - when a fixed or kinematic body that it touches or is joined to is woken by an edit.
//!
//! Bodies that touch a moving kinematic body, are joined to one, or are in an area of one do not become sleepy.

mod sleep;
mod wake;

pub(crate) use sleep::{put_sleepy_sets_to_sleep, put_to_sleep, unite, unite_connected, unite_touching};
pub(crate) use wake::{
    contact_ended, joint_retuned, joints_changed, wake_body, wake_island, wake_joined, wake_overlapping,
    wake_overlapping_shape, wake_touching,
};
