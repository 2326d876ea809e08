//! lockstep2d: a deterministic fixed-point 2D physics and lockstep engine.
//!
//! The same setup and the same inputs give the same state hash after every tick, on every machine, because no
//! floating-point number takes part. Saved replays prove it.
//!
//! - [`world`]: start here. [`world::World`] holds bodies, shapes and joints and steps them.
//! - [`body`]: what to spawn. [`solver`]: joints and settings. [`collision`]: what contacts look like.
//! - [`math`]: numbers, vectors and angles, also for a game's own rules; [`fx!`] writes constants.
//! - [`lockstep`]: [`lockstep::Game`], the seam that recording, verifying and tools are generic over.
//! - [`replay`]: writes, reads and verifies replay files.
//! - [`report`]: what a peer writes when states differ, and who departed, when and where.
//! - [`check`]: plays a game in many ways that must make no difference, for tests and fuzzers.
//! - [`inspect`]: any value as named fields, and what differs between two.
//! - [`draw`]: pictures of a world. [`scenes`]: worlds that tests, replays and tools share.
//! - [`hash`] and [`codec`]: what a state hash is made of.
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
mod lanes;
pub mod lockstep;
pub mod math;
#[cfg(feature = "ggrs")]
pub mod net;
pub mod replay;
pub mod report;
pub mod scenes;
pub mod solver;
mod threads;
pub mod world;

/// Names the arithmetic of the engine. It changes whenever the same inputs give another state, and replays and
/// snapshots carry it: one made with other semantics is refused, not misread.
pub const SEMANTICS: u32 = 7;

/// The code of the README compiles and runs.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
