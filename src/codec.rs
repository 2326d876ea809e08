//! The canonical bytes of a value: its serde encoding with bincode 2, little-endian, fixed-width integers.
//!
//! `docs/FORMAT.md` spells the layout out, so that it can be read without bincode.

use alloc::vec::Vec;
use core::fmt;

use bincode::config::{Configuration, Fixint, LittleEndian};
use serde::{Serialize, de::DeserializeOwned};

type Layout = Configuration<LittleEndian, Fixint>;

const LAYOUT: Layout = bincode::config::standard().with_little_endian().with_fixed_int_encoding();

/// Bytes that are not the canonical encoding of the expected value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DecodeError {
    /// The bytes do not describe such a value.
    Invalid {
        /// What the decoder ran into.
        why: alloc::string::String,
    },
    /// The value ends before the bytes do.
    TrailingBytes {
        /// How many bytes are left over.
        count: u64,
    },
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DecodeError::Invalid { why } => write!(f, "not a valid encoding: {why}"),
            DecodeError::TrailingBytes { count } => write!(f, "{count} bytes after the end of the value"),
        }
    }
}

impl core::error::Error for DecodeError {}

/// Appends the canonical bytes of `value` to `bytes`.
///
/// # Panics
/// If the type's `Serialize` refuses the value, which the derived ones never do.
pub fn encode_into<T: Serialize + ?Sized>(value: &T, bytes: &mut Vec<u8>) {
    struct Append<'a>(&'a mut Vec<u8>);
    impl bincode::enc::write::Writer for Append<'_> {
        fn write(&mut self, bytes: &[u8]) -> Result<(), bincode::error::EncodeError> {
            self.0.extend_from_slice(bytes);
            Ok(())
        }
    }
    bincode::serde::encode_into_writer(value, Append(bytes), LAYOUT)
        .expect("a value that serde can describe");
}

/// The canonical bytes of `value`.
#[must_use]
pub fn encode<T: Serialize + ?Sized>(value: &T) -> Vec<u8> {
    let mut bytes = Vec::new();
    encode_into(value, &mut bytes);
    bytes
}

/// The value whose canonical bytes these are, all of them.
///
/// Memory is bounded by the number of bytes: a length prefix is never believed beyond what is there.
///
/// # Errors
/// [`DecodeError`] when the bytes are not exactly one such value.
pub fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, DecodeError> {
    match bincode::serde::decode_from_slice(bytes, LAYOUT) {
        Ok((value, used)) if used == bytes.len() => Ok(value),
        Ok((_, used)) => Err(DecodeError::TrailingBytes { count: (bytes.len() - used) as u64 }),
        Err(error) => Err(DecodeError::Invalid { why: alloc::format!("{error}") }),
    }
}
