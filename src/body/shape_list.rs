//! Shape list of a body. It stores up to two handles inline, beside the other fields that every step reads.

use alloc::vec::Vec;

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use smallvec::SmallVec;

use super::arena::ShapeId;

pub(crate) type ShapeList = SmallVec<[ShapeId; 2]>;

pub(super) fn serialize<S: Serializer>(shapes: &ShapeList, to: S) -> Result<S::Ok, S::Error> {
    shapes.as_slice().serialize(to)
}

/// Deserializes through a `Vec`, because `Vec` bounds the memory that it allocates for an untrusted length.
pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<ShapeList, D::Error> {
    Vec::deserialize(from).map(|shapes| ShapeList::from_slice(&shapes))
}
