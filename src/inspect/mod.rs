//! Any value as a list of named fields, and what differs between two of them.
//!
//! A field has a path, as in `world.bodies.body 12v1.velocity.x`, and a [`Value`] that keeps the raw bits beside a
//! readable form. Whatever has a `Serialize` can be looked at: it is asked for the form that it has for people.
//!
//! ```
//! use lockstep2d::{fx, inspect::{differences, fields}, math::Vec2};
//!
//! let (a, b) = (Vec2::new(fx!(1), fx!(2)), Vec2::new(fx!(1), fx!(2.5)));
//! let found = differences(&fields(&a)?, &fields(&b)?);
//! assert_eq!(found.len(), 1);
//! assert_eq!(found[0].to_string(), "y: 2 (bits 8589934592) | 2.5 (bits 10737418240)");
//! # Ok::<(), lockstep2d::inspect::InspectError>(())
//! ```

mod compound;
mod decimal;
mod difference;
mod serializer;
#[cfg(test)]
mod tests;
mod value;

pub use difference::{Difference, differences};
pub use serializer::InspectError;
pub use value::{Field, Value};

use alloc::vec::Vec;

use serde::Serialize;

use serializer::Collector;

/// How deep values may be nested.
pub const DEPTH_MAX: u32 = 128;

/// All fields of a value, in the order in which it is serialised.
///
/// An `Option` is its value or `none`, a variant its name and its fields, and an empty list or map a field of its own, so
/// that two values with the same fields are the same value.
///
/// # Errors
/// [`InspectError`] if the value refuses to be serialised or is nested deeper than [`DEPTH_MAX`].
pub fn fields<T: Serialize + ?Sized>(value: &T) -> Result<Vec<Field>, InspectError> {
    let mut collector = Collector::default();
    collector.nested(value)?;
    Ok(collector.into_fields())
}
