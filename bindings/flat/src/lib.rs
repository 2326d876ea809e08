//! The flat API of lockstep2d, for C and for WebAssembly: functions with integers, pointers to plain structs, and
//! handles.
//!
//! - Objects are numbers that are looked up. A handle that is wrong, stale, freed twice or of another kind is an error.
//! - Functions return a status code; `ls2d_last_error` has the reason in words. No function panics or calls back.
//! - Numbers of the simulation are integers: [`RawFx`] counts 2^-32 m and so on, [`RawAngle`] 2^-32 turn.
//! - Structs are the same on all machines, have no gaps, and begin with their size if the caller fills them.
//! - Different objects may be used on different threads at the same time. Calls with the same object wait for each
//!   other.
//!
//! `include/lockstep2d.h` and `bindings/npm/src/layout.js`, from which JavaScript takes offsets, are written by
//! [`header`] and [`layout`]; a test compares them.

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
