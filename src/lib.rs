//! lockstep2d: a deterministic fixed-point 2D physics and lockstep engine.
#![no_std]

extern crate alloc;
#[cfg(test)]
extern crate std;

pub mod codec;
pub mod hash;
pub mod lockstep;
pub mod math;
pub mod replay;

/// What a state hash means: equal inputs give equal hashes only under equal semantics.
///
/// It is written into every replay. Any change of the engine that changes a hash of a golden bumps it.
pub const SEMANTICS: u32 = 1;
