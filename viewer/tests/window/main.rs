//! The window on a virtual screen: what is really there, against draw lists and replays.
//!
//! `viewer/test-window` installs what it needs and starts the screen.
#![expect(clippy::unwrap_used, clippy::disallowed_types, reason = "tests may panic, and look at pixels")]

mod overlays;
mod picture;
mod run;
mod screen;
mod session;
mod time_travel;
