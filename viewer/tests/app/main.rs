//! The viewer, driven as a window drives it: by events and time.
#![expect(clippy::unwrap_used, reason = "what fails here is the test")]
#![expect(clippy::disallowed_types, reason = "floats are what screens take")]

mod common;
mod compare;
mod files;
mod live;
mod look;
mod travel;
