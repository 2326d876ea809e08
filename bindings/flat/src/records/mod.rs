//! Structs that callers fill or receive, and their conversions.
//!
//! Structs with an `_init` function, except `RawRng`, begin with their size. The size detects programs that were
//! compiled with another version of the header.

mod body;
mod character;
mod config;
mod events;
mod joint;
mod joint_parts;
#[cfg_attr(not(feature = "lockstep"), expect(dead_code, reason = "conversions of the missing functions"))]
mod match_config;
#[cfg_attr(not(feature = "lockstep"), expect(dead_code, reason = "conversions of the missing functions"))]
mod matches;
mod query;
mod shape;

pub use body::*;
pub use body::{BodyInfo, RawBodyDef, RawExplosion, RawPose};
pub use character::*;
pub use config::*;
pub use events::*;
pub use joint::*;
pub use matches::*;
pub use query::*;
pub use shape::*;

use crate::describe::{Constant, Struct};
use crate::status::{Failure, Outcome, Status, value};

pub(crate) const CONSTANTS: &[&[Constant]] = &[
    body::CONSTANTS,
    character::CONSTANTS,
    config::CONSTANTS,
    joint::CONSTANTS,
    matches::CONSTANTS,
    query::CONSTANTS,
    shape::CONSTANTS,
];

/// All structs, in an order in which no struct uses a later one.
pub(crate) const STRUCTS: &[&[Struct]] = &[
    crate::numbers::STRUCTS,
    config::STRUCTS,
    body::STRUCTS,
    shape::STRUCTS,
    joint::STRUCTS,
    query::STRUCTS,
    character::STRUCTS,
    events::STRUCTS,
    matches::STRUCTS,
];

pub(crate) const fn size<T>() -> u32 {
    let size = size_of::<T>();
    assert!(size < 1 << 16, "structs are small");
    #[expect(clippy::cast_possible_truncation, reason = "checked")]
    let size = size as u32;
    size
}

fn check_size<T>(given: u32) -> Outcome {
    if given == size::<T>() {
        return Ok(());
    }
    let expected = size::<T>();
    Err(Failure::new(Status::Size, format!("a struct of {given} bytes, this version expects {expected}")))
}

/// Checks that all flags are in `known`.
fn check_flags(what: &str, flags: u32, known: u32) -> Outcome {
    if flags & !known == 0 {
        Ok(())
    } else {
        Err(value(what, format!("{flags:#x}, the allowed bits are {known:#x}")))
    }
}

/// Checks that a reserved field is 0, because a later version may use it.
fn check_reserved(reserved: u32) -> Outcome {
    if reserved == 0 { Ok(()) } else { Err(value("a reserved field", reserved)) }
}

const fn has(flags: u32, flag: u32) -> bool {
    flags & flag != 0
}

const fn flag(holds: bool, flag: u32) -> u32 {
    if holds { flag } else { 0 }
}
