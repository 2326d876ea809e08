//! Worlds as bytes, for files and networks.

use alloc::vec::Vec;
use core::fmt;

use super::validate::Violation;
use crate::SEMANTICS;
use crate::codec::{self, DecodeError};
use crate::hash::StateHash;
use crate::world::World;
use crate::world::state::State;

/// The first bytes of every world.
const MAGIC: [u8; 8] = *b"LS2DWRLD";
/// Version of the layout.
const FORMAT: u32 = 2;
/// Size of magic, format, semantics and length.
const HEADER_LEN: usize = 8 + 4 + 4 + 8;
/// Size of the hash at the end.
const HASH_LEN: usize = 16;

/// Why bytes were refused as a world.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SnapshotError {
    /// They do not start with the magic of a world.
    NotASnapshot,
    /// The layout has another version.
    Format {
        /// The version found.
        found: u32,
    },
    /// They were made by an engine with other semantics and would not continue bit-identically.
    Semantics {
        /// The semantics id found.
        found: u32,
    },
    /// There are fewer or more bytes than the header announces.
    Length {
        /// Number of bytes that the header announces, including the header.
        announced: u64,
        /// Number of bytes found.
        found: u64,
    },
    /// The hash at the end does not match the bytes before it.
    Hash,
    /// The state does not decode.
    Decode(DecodeError),
    /// The state decodes but breaks an invariant.
    Invalid(Violation),
}

impl fmt::Display for SnapshotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SnapshotError::NotASnapshot => write!(f, "not the bytes of a world"),
            SnapshotError::Format { found } => {
                write!(f, "format version {found}, this engine reads {FORMAT}")
            }
            SnapshotError::Semantics { found } => {
                write!(f, "made with semantics {found}, this engine has {SEMANTICS}")
            }
            SnapshotError::Length { announced, found } => {
                write!(f, "{found} bytes where {announced} are announced")
            }
            SnapshotError::Hash => write!(f, "the hash does not match the bytes"),
            SnapshotError::Decode(error) => error.fmt(f),
            SnapshotError::Invalid(violation) => write!(f, "an impossible state: {violation}"),
        }
    }
}

impl core::error::Error for SnapshotError {}

impl World {
    /// Returns the state as portable bytes: header, canonical encoding, hash. `docs/FORMAT.md` has the layout.
    #[must_use]
    #[doc(alias = "serialize")]
    pub fn to_bytes(&self) -> Vec<u8> {
        state_to_bytes(self.state.get())
    }

    /// Returns the world that [`World::to_bytes`] has written. Safe for untrusted bytes: the memory used is bounded by
    /// their number, and a state that breaks an invariant is refused.
    ///
    /// # Errors
    /// [`SnapshotError`] for any bytes that [`World::to_bytes`] cannot have written.
    #[doc(alias = "deserialize")]
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SnapshotError> {
        let header: &[u8; HEADER_LEN] = bytes.first_chunk().ok_or(SnapshotError::NotASnapshot)?;
        let number =
            |at: usize| u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
        if header[..8] != MAGIC {
            return Err(SnapshotError::NotASnapshot);
        }
        if number(8) != FORMAT {
            return Err(SnapshotError::Format { found: number(8) });
        }
        if number(12) != SEMANTICS {
            return Err(SnapshotError::Semantics { found: number(12) });
        }
        let length = u64::from(number(16)) | u64::from(number(20)) << 32;
        let announced = length.saturating_add((HEADER_LEN + HASH_LEN) as u64);
        if announced != bytes.len() as u64 {
            return Err(SnapshotError::Length { announced, found: bytes.len() as u64 });
        }
        let (covered, hash) = bytes.split_at(bytes.len() - HASH_LEN);
        if StateHash::of_bytes(covered).0.to_le_bytes() != *hash {
            return Err(SnapshotError::Hash);
        }
        let state: State = codec::decode(&covered[HEADER_LEN..]).map_err(SnapshotError::Decode)?;
        state.validate().map_err(SnapshotError::Invalid)?;
        Ok(World::of(state, Default::default()))
    }
}

/// [`World::to_bytes`] of a state.
pub(super) fn state_to_bytes(state: &State) -> Vec<u8> {
    let mut bytes = Vec::new();
    bytes.extend_from_slice(&MAGIC);
    bytes.extend_from_slice(&FORMAT.to_le_bytes());
    bytes.extend_from_slice(&SEMANTICS.to_le_bytes());
    bytes.extend_from_slice(&[0; 8]);
    codec::encode_into(state, &mut bytes);
    let length = (bytes.len() - HEADER_LEN) as u64;
    bytes[HEADER_LEN - 8..HEADER_LEN].copy_from_slice(&length.to_le_bytes());
    let hash = StateHash::of_bytes(&bytes);
    bytes.extend_from_slice(&hash.0.to_le_bytes());
    bytes
}
