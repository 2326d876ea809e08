use alloc::vec::Vec;
use core::fmt;

use super::validate::Violation;
use crate::SEMANTICS;
use crate::codec::DecodeError;
use crate::hash::{Envelope, EnvelopeError};
use crate::world::World;
use crate::world::state::State;

const MAGIC: [u8; 8] = *b"LS2DWRLD";
const FORMAT: u32 = 4;
const ENVELOPE: Envelope = Envelope { magic: MAGIC, format: FORMAT };

/// Reason why [`World::from_bytes`] refuses bytes.
///
/// ```
/// use lockstep2d::world::{SnapshotError, World};
/// let bytes = World::default().to_bytes();
/// // A bit of a saved game was flipped, by a stranger or a bad disk.
/// let mut damaged = bytes.clone();
/// damaged[40] ^= 1;
/// assert_eq!(World::from_bytes(&damaged).err(), Some(SnapshotError::Hash));
/// let cut = World::from_bytes(&bytes[..bytes.len() - 1]).err();
/// assert!(matches!(cut, Some(SnapshotError::Length { announced, found }) if announced == found + 1));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SnapshotError {
    /// The bytes do not start with the magic of a world, or are shorter than a header.
    NotASnapshot,
    /// The bytes have another version of the layout than this engine reads.
    Format {
        /// The version found.
        found: u32,
    },
    /// The bytes were made by an engine with other semantics, in which the world would continue differently.
    Semantics {
        /// The semantics id found.
        found: u32,
    },
    /// There are fewer or more bytes than the header announces.
    Length {
        /// Number of bytes that the header announces, including the header and the hash at the end.
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

impl From<EnvelopeError> for SnapshotError {
    fn from(error: EnvelopeError) -> Self {
        match error {
            EnvelopeError::Magic => SnapshotError::NotASnapshot,
            EnvelopeError::Format { found } => SnapshotError::Format { found },
            EnvelopeError::Length { announced, found } => SnapshotError::Length { announced, found },
            EnvelopeError::Hash => SnapshotError::Hash,
            EnvelopeError::Decode(error) => SnapshotError::Decode(error),
        }
    }
}

impl World {
    /// Returns the state as portable bytes: a header, the canonical encoding of the state, and a hash of both.
    /// `docs/FORMAT.md` has the layout.
    #[must_use]
    #[doc(alias = "serialize")]
    pub fn to_bytes(&self) -> Vec<u8> {
        state_to_bytes(self.state.get())
    }

    /// Returns the world whose [`World::to_bytes`] are given. Safe for untrusted bytes: the memory used is at most a
    /// multiple of their number, plus a constant.
    ///
    /// # Errors
    /// [`SnapshotError`] if the bytes are damaged, were made by an engine with another format or other semantics, or
    /// contain a state that breaks an invariant.
    #[doc(alias = "deserialize")]
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SnapshotError> {
        let opened = ENVELOPE.open(bytes)?;
        if opened.semantics != SEMANTICS {
            return Err(SnapshotError::Semantics { found: opened.semantics });
        }
        let state: State = opened.decode()?;
        state.validate().map_err(SnapshotError::Invalid)?;
        Ok(World::of(state, Default::default()))
    }
}

pub(super) fn state_to_bytes(state: &State) -> Vec<u8> {
    ENVELOPE.seal(SEMANTICS, state)
}
