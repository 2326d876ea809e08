//! The viewer without its window: what it shows, and what keys and the pointer do to it.
//!
//! [`App`] takes [`Event`]s and time, and fills a [`DrawList`](lockstep2d_picture::DrawList); it knows no window, no
//! clock and no files. A window, a web page, a script and a test drive it alike.
#![expect(clippy::disallowed_types, reason = "floats are what screens take")]

mod app;
mod event;
pub mod live;
pub mod mesh;
pub mod script;
mod source;
mod tape;
pub mod versus;

pub use app::{App, LAYER_KEYS, Report, Request};
pub use event::{Button, Event, Key};
pub use source::{OpenError, Replay, Snapshot, Source, SourceError, open};
