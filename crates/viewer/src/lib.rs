//! The viewer without its window: the content that it shows and its reaction to keys and the pointer.
//!
//! [`App`] takes [`Event`]s and elapsed time, and fills a [`DrawList`](lockstep2d_render::DrawList). It does not
//! depend on a window, a clock or files, so a window, a web page, a script and a test all drive it in the same way.
#![expect(clippy::disallowed_types, reason = "drawing uses floats")]

mod app;
mod event;
pub mod live;
pub mod mesh;
pub mod netplay;
mod recording;
pub mod script;
mod source;

pub use app::{App, LAYER_KEYS, Report, Request};
pub use event::{Button, Event, Key};
pub use source::{OpenError, Replay, Snapshot, Source, SourceError, open};
