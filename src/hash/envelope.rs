//! The envelope of files that hold one value: `docs/FORMAT.md` gives the layout.

use alloc::vec::Vec;

use serde::{Serialize, de::DeserializeOwned};

use super::StateHash;
use crate::codec::{self, DecodeError};

/// Size of the header in bytes: magic, format, semantics, length.
const HEADER_LEN: usize = 8 + 4 + 4 + 8;
const HASH_LEN: usize = 16;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Envelope {
    pub(crate) magic: [u8; 8],
    pub(crate) format: u32,
}

/// Reason why bytes are not an intact file of the expected kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum EnvelopeError {
    Magic,
    Format { found: u32 },
    Length { announced: u64, found: u64 },
    Hash,
    Decode(DecodeError),
}

/// A file whose header has been read. Length, hash and body are not checked yet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Opened<'a> {
    bytes: &'a [u8],
    /// [`crate::SEMANTICS`] of the engine that wrote the file.
    pub(crate) semantics: u32,
    length: u64,
}

impl Envelope {
    /// Returns the bytes of a file with this body and its hash.
    pub(crate) fn seal<T: Serialize>(&self, semantics: u32, body: &T) -> Vec<u8> {
        let mut bytes = self.magic.to_vec();
        bytes.extend_from_slice(&self.format.to_le_bytes());
        bytes.extend_from_slice(&semantics.to_le_bytes());
        bytes.extend_from_slice(&[0; 8]);
        codec::encode_into(body, &mut bytes);
        let length = (bytes.len() - HEADER_LEN) as u64;
        bytes[HEADER_LEN - 8..HEADER_LEN].copy_from_slice(&length.to_le_bytes());
        let hash = StateHash::of_bytes(&bytes);
        bytes.extend_from_slice(&hash.0.to_le_bytes());
        bytes
    }

    /// Reads the header.
    ///
    /// # Errors
    /// [`EnvelopeError::Magic`] and [`EnvelopeError::Format`].
    pub(crate) fn open<'a>(&self, bytes: &'a [u8]) -> Result<Opened<'a>, EnvelopeError> {
        let header: &[u8; HEADER_LEN] = bytes.first_chunk().ok_or(EnvelopeError::Magic)?;
        let number =
            |at: usize| u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
        if header[..8] != self.magic {
            return Err(EnvelopeError::Magic);
        }
        if number(8) != self.format {
            return Err(EnvelopeError::Format { found: number(8) });
        }
        let length = u64::from(number(16)) | u64::from(number(20)) << 32;
        Ok(Opened { bytes, semantics: number(12), length })
    }
}

impl Opened<'_> {
    /// Checks length and hash, and decodes the body.
    ///
    /// # Errors
    /// [`EnvelopeError::Length`], [`EnvelopeError::Hash`] and [`EnvelopeError::Decode`].
    pub(crate) fn decode<T: DeserializeOwned>(&self) -> Result<T, EnvelopeError> {
        let announced = self.length.saturating_add((HEADER_LEN + HASH_LEN) as u64);
        let found = self.bytes.len() as u64;
        if announced != found {
            return Err(EnvelopeError::Length { announced, found });
        }
        let (covered, hash) = self.bytes.split_at(self.bytes.len() - HASH_LEN);
        if StateHash::of_bytes(covered).0.to_le_bytes() != *hash {
            return Err(EnvelopeError::Hash);
        }
        codec::decode(&covered[HEADER_LEN..]).map_err(EnvelopeError::Decode)
    }
}
