//! The shapes of a body: one or two lie in the body itself, which is where every step looks for them.

use alloc::vec::Vec;

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use smallvec::SmallVec;

use super::arena::ShapeId;

/// In order of attachment.
pub(crate) type ShapeList = SmallVec<[ShapeId; 2]>;

/// Writes them as a sequence.
pub(super) fn serialize<S: Serializer>(shapes: &ShapeList, to: S) -> Result<S::Ok, S::Error> {
    shapes.as_slice().serialize(to)
}

/// Reads them as a `Vec`, which makes room for what comes and not for what a stranger's file announces.
pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<ShapeList, D::Error> {
    Vec::deserialize(from).map(|shapes| ShapeList::from_slice(&shapes))
}
