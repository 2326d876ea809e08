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
