//! Converts any value to a list of named fields, and compares two such lists.
//!
//! A field has a path, such as `world.bodies.body 12v1.velocity.x`, and an exact [`Value`]. Any type that implements
//! `Serialize` can be inspected: the fields are those of its human-readable serialization.
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

/// Largest nesting depth of a value.
pub const DEPTH_MAX: u32 = 128;

/// The fields of a value, in serialization order.
///
/// An `Option` results in the fields of its value, or in a field with the value `none`. An enum variant results in a
/// field with its name, followed by its own fields. An empty list or map results in one field with [`Value::Empty`].
///
/// # Errors
/// [`InspectError`] if the value's `Serialize` returns an error or the value is nested deeper than [`DEPTH_MAX`].
pub fn fields<T: Serialize + ?Sized>(value: &T) -> Result<Vec<Field>, InspectError> {
    let mut collector = Collector::default();
    collector.nested(value)?;
    Ok(collector.into_fields())
}
