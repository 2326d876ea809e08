//! Shape list of a body. Up to two handles are stored inline in the body, where every step reads them.

use alloc::vec::Vec;

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use smallvec::SmallVec;

use super::arena::ShapeId;

/// Shapes in order of attachment.
pub(crate) type ShapeList = SmallVec<[ShapeId; 2]>;

/// Serializes the list as a sequence.
pub(super) fn serialize<S: Serializer>(shapes: &ShapeList, to: S) -> Result<S::Ok, S::Error> {
    shapes.as_slice().serialize(to)
}

/// Deserializes through a `Vec`, which allocates for the elements that arrive, not for the length that an untrusted
/// file announces.
pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<ShapeList, D::Error> {
    Vec::deserialize(from).map(|shapes| ShapeList::from_slice(&shapes))
}
