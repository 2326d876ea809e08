//! The window on a virtual screen. Its pixels are compared with draw lists and replays.
//!
//! `crates/viewer/test-window` installs the required packages and starts the screen.
#![expect(
    clippy::unwrap_used,
    clippy::disallowed_types,
    reason = "tests may panic, and pixel positions are floats"
)]

mod overlays;
mod picture;
mod run;
mod screen;
mod session;
mod time_travel;
