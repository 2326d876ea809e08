//! Verifies replays on many machines. `submit` puts jobs into a queue in NATS JetStream, and workers take them. The
//! results are in another stream: each is a line of `verify --json`.
//!
//! A game gets the program with one line in `main`:
//!
//! ```no_run
//! use lockstep2d::lockstep::Sandbox;
//!
//! fn main() -> std::process::ExitCode {
//!     // Instead of `Sandbox`, any type that implements `lockstep2d::lockstep::Game`.
//!     lockstep2d_worker::run::<Sandbox>()
//! }
//! ```
//!
//! Invariants:
//! - A job stays in the queue until its result is in the stream of results.
//! - A file has at most one result under the same rules and limits, because the server refuses a second one.
//! - A process verifies one file at a time. A file that crashes the process therefore affects no other file.

mod app;
mod bucket;
mod error;
mod files;
mod job;
mod metrics;
mod queue;
mod results;
mod shutdown;
mod submit;
mod work;

use std::process::ExitCode;

use lockstep2d::lockstep::Game;

pub use app::Worker;

/// Runs the worker of a game with the default limits and the arguments of this process.
#[must_use]
pub fn run<G: Game + 'static>() -> ExitCode {
    Worker::<G>::new().run()
}
