//! lockstep2d: a deterministic fixed-point 2D physics and lockstep engine.
#![no_std]

extern crate alloc;
#[cfg(test)]
extern crate std;

pub mod body;
pub mod codec;
pub mod collision;
pub mod draw;
pub mod hash;
pub mod lockstep;
pub mod math;
pub mod replay;
pub mod scenes;
pub mod solver;
pub mod world;

/// Names the arithmetic of the engine. It changes whenever the same inputs give another state, and replays and
/// snapshots carry it: one made with other semantics is refused, not misread.
pub const SEMANTICS: u32 = 1;
