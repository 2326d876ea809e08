//! The flat API of lockstep2d, for C and for WebAssembly.
//!
//! - Objects are referred to by handles. A wrong, stale or freed handle, or the handle of an object of another kind, is
//!   an error.
//! - Functions that can fail return a status code. `ls2d_last_error` copies the error text.
//! - Numbers of the simulation are integers: [`RawFx`] has 32 fraction bits, [`RawAngle`] is in units of 2^-32 turn.
//! - Structs have no padding. Structs with an `_init` function, except [`RawRng`], begin with their size in bytes.
//! - Different threads may use different objects at the same time. Calls with the same object wait for each other.
//!
//! [`header`] and [`layout`] generate `include/lockstep2d.h` and `bindings/npm/src/layout.js`.

mod border;
mod describe;
mod functions;
#[cfg(any(test, feature = "fuzzing"))]
pub mod fuzzing;
mod generate;
mod numbers;
mod records;
mod status;
mod table;
#[cfg(test)]
mod tests;

pub use border::{In, Out, Plain};
pub use functions::*;
pub use generate::{header, layout};
pub use numbers::{RawAngle, RawBody, RawFx, RawHash, RawJoint, RawRng, RawShape, RawVec2};
pub use records::*;
pub use status::Status;
