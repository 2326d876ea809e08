//! lockstep2d: a deterministic fixed-point 2D physics and lockstep engine.
//!
//! Equal setups and equal inputs give equal state hashes after every tick, on every machine, because the
//! simulation does not use floating-point numbers. A saved replay contains hashes at a fixed interval of ticks, so that
//! any machine can check this.
//!
//! - [`world`]: start here. [`world::World`] owns bodies, shapes and joints and steps them.
//! - [`body`]: definitions of bodies and shapes. [`solver`]: joints and settings. [`collision`]: contact manifolds.
//! - [`math`]: numbers, vectors and angles, also for a game's own rules; [`fx!`] writes constants.
//! - [`lockstep`]: [`lockstep::Game`], the trait over which recording, verification and tools are generic.
//! - [`peer`]: a participant of a match, for any game. It is built on [`session`], the protocol without I/O by which
//!   the peers of a match agree on one history.
//! - [`replay`]: writes, reads and verifies replay files.
//! - [`report`]: the report that a peer writes when states differ, and its analysis: which peer diverged, when and
//!   where.
//! - [`check`]: runs a game in many ways that must give the same result, for tests and fuzzers.
//! - [`inspect`]: converts any value to named fields, and compares two values.
//! - [`draw`]: renders a world.
//! - [`hash`] and [`codec`]: the state hash and the canonical encoding that it covers.
//!
//! ```
//! use lockstep2d::{body::{BodyDef, Geometry, ShapeDef}, fx, world::World};
//!
//! let mut world = World::default();
//! let ball = ShapeDef::new(Geometry::circle(fx!(0.5))?);
//! let ball = world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(10))), &[ball])?;
//! let saved = world.save();
//! world.step();
//! let hash = world.state_hash();
//! world.restore(&saved);
//! world.step();
//! assert_eq!(world.state_hash(), hash);
//! # Ok::<(), lockstep2d::body::WorldError>(())
//! ```
#![no_std]

extern crate alloc;
#[cfg(any(test, feature = "std"))]
extern crate std;

pub mod body;
pub mod check;
pub mod codec;
pub mod collision;
pub mod draw;
pub mod hash;
pub mod inspect;
pub mod lockstep;
pub mod math;
pub mod peer;
pub mod replay;
pub mod report;
pub mod session;
mod simd;
pub mod solver;
mod threads;
pub mod world;

/// Version of the engine's arithmetic. It changes whenever the same inputs give a different state. Replays and
/// snapshots store it. A snapshot with another version is rejected, and a replay with another version cannot be played.
pub const SEMANTICS: u32 = 19;

/// Version of this crate.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Compiles and runs the code of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
