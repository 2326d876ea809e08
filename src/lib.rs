//! lockstep2d: a deterministic fixed-point 2D physics and lockstep engine.
//!
//! Equal setups and inputs give equal state hashes after every tick, on every machine: the simulation uses no
//! floating-point numbers. Replays contain these hashes, so that any machine can verify a replay.
//!
//! - [`world`]: start here. [`world::World`] owns bodies, shapes and joints and steps them.
//! - [`body`]: definitions of bodies and shapes. [`solver`]: joints and settings. [`collision`]: contact manifolds.
//! - [`math`]: numbers, vectors and angles, also for a game's own rules; [`fx!`] writes constants.
//! - [`lockstep`]: [`lockstep::Game`], the trait over which recording, verification and tools are generic.
//! - [`peer`]: plays any game in a match with other peers. [`session`]: the protocol between peers, without I/O.
//! - [`replay`]: writes, reads and verifies replay files.
//! - [`report`]: files that peers write when their states differ. Comparing these files shows which peer diverged, when
//!   and where.
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

/// Version of the engine's arithmetic. It increases when the same inputs may give another state. The engine rejects
/// snapshots of another version, and cannot play replays of another version.
pub const SEMANTICS: u32 = 25;

/// Version of this crate.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Compiles and runs the code of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
