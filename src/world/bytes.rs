//! A world as bytes, for files and networks.

use alloc::vec::Vec;
use core::fmt;

use super::World;
use super::state::State;
use super::validate::Violation;
use crate::SEMANTICS;
use crate::codec::DecodeError;
use crate::hash::{Envelope, EnvelopeError};

/// Starts the bytes of a world.
const MAGIC: [u8; 8] = *b"LS2DWRLD";
/// Version of the layout of these bytes.
const FORMAT: u32 = 2;
const ENVELOPE: Envelope = Envelope { magic: MAGIC, format: FORMAT };

/// Bytes from which no world can be made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SnapshotError {
    /// They do not start like a world's bytes.
    NotASnapshot,
    /// The layout is of another version.
    Format {
        /// The version found.
        found: u32,
    },
    /// They were made by an engine with other semantics, and could not continue bit-identically.
    Semantics {
        /// The semantics id found.
        found: u32,
    },
    /// There are fewer or more bytes than announced.
    Length {
        /// How many bytes the header announces, itself included.
        announced: u64,
        /// How many there are.
        found: u64,
    },
    /// The hash at the end does not belong to the bytes before it.
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
    /// The state as portable bytes: header, canonical encoding, hash. `docs/FORMAT.md` has the layout.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        state_to_bytes(self.state.get())
    }

    /// The world that [`World::to_bytes`] has written.
    ///
    /// # Errors
    /// [`SnapshotError`] for any other bytes. Nothing is believed before it is checked: memory is bounded by the
    /// number of bytes, and an impossible state is refused.
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

/// [`World::to_bytes`] of a state.
pub(super) fn state_to_bytes(state: &State) -> Vec<u8> {
    ENVELOPE.seal(SEMANTICS, state)
}
