//! The viewer without a window, driven by events and time as a window would drive it.
#![expect(clippy::unwrap_used, reason = "a failed unwrap fails the test")]
#![expect(clippy::disallowed_types, reason = "drawing uses floats")]

mod common;
mod compare;
mod files;
mod live;
mod look;
mod play;
mod travel;
