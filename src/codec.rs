//! Canonical encoding of a value: its serde encoding with bincode 2, little-endian, fixed-width integers.
//!
//! `docs/FORMAT.md` specifies the layout, so that a reader needs no bincode.

#[cfg(test)]
mod tests;

use alloc::vec::Vec;
use core::fmt;

use bincode::config::{Configuration, Fixint, LittleEndian};
use bincode::de::{Decode, Decoder, DecoderImpl, read::Reader};
use bincode::error;
use bincode::serde::Compat;
use serde::{Serialize, de::DeserializeOwned};

type Layout = Configuration<LittleEndian, Fixint>;

const LAYOUT: Layout = bincode::config::standard().with_little_endian().with_fixed_int_encoding();

/// Reason why [`decode`] rejects bytes.
///
/// ```
/// use lockstep2d::codec::{self, DecodeError};
/// // Four bytes that encode a `u32` are decoded completely, then without the last byte, then as a `u16`.
/// let bytes = codec::encode(&0x0102_0304_u32);
/// assert_eq!(codec::decode::<u32>(&bytes), Ok(0x0102_0304));
/// assert!(matches!(codec::decode::<u32>(&bytes[..3]), Err(DecodeError::Invalid { .. })));
/// assert_eq!(codec::decode::<u16>(&bytes), Err(DecodeError::TrailingBytes { count: 2 }));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DecodeError {
    /// The bytes are not a valid encoding of the expected type.
    Invalid {
        /// Message of the decoder.
        why: alloc::string::String,
    },
    /// The value ends before the bytes do.
    TrailingBytes {
        /// Number of bytes after the value.
        count: u64,
    },
    /// There are more than [`DECODE_BYTES_MAX`] bytes.
    TooLong {
        /// Number of bytes.
        count: u64,
    },
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DecodeError::Invalid { why } => write!(f, "not a valid encoding: {why}"),
            DecodeError::TrailingBytes { count } => write!(f, "{count} bytes after the end of the value"),
            DecodeError::TooLong { count } => {
                write!(f, "{count} bytes, at most {DECODE_BYTES_MAX} are decoded")
            }
        }
    }
}

impl core::error::Error for DecodeError {}

/// Appends the canonical encoding of `value` to `bytes`.
///
/// # Panics
/// If the type's `Serialize` fails, or does not announce the length of a list or map, as with `#[serde(flatten)]`.
pub fn encode_into<T: Serialize + ?Sized>(value: &T, bytes: &mut Vec<u8>) {
    struct Append<'a>(&'a mut Vec<u8>);
    impl bincode::enc::write::Writer for Append<'_> {
        fn write(&mut self, bytes: &[u8]) -> Result<(), bincode::error::EncodeError> {
            self.0.extend_from_slice(bytes);
            Ok(())
        }
    }
    bincode::serde::encode_into_writer(value, Append(bytes), LAYOUT)
        .expect("`Serialize` should not return an error");
}

/// Returns the canonical encoding of `value`.
///
/// # Panics
/// As [`encode_into`].
#[must_use]
pub fn encode<T: Serialize + ?Sized>(value: &T) -> Vec<u8> {
    // Most values fit without reallocation.
    let mut bytes = Vec::with_capacity(256);
    encode_into(value, &mut bytes);
    bytes
}

/// Largest number of bytes that [`decode`] accepts: 256 MiB.
pub const DECODE_BYTES_MAX: usize = 256 << 20;

/// Number of bytes by which the decoder's limit exceeds the input: the size of a `u128`. If at most this many bytes of
/// a string are missing from the input, the decoder reports an unexpected end, otherwise an exceeded limit.
const SLACK: usize = 16;

/// Decodes a value whose canonical encoding is all of `bytes`.
///
/// A length prefix is not trusted: allocations are bounded by a multiple of the bytes given, plus up to 1 MiB per list.
/// Do not decode untrusted bytes as lists of zero-sized values, whose length is unbounded, or as recursive types, whose
/// depth is unbounded.
///
/// # Errors
/// [`DecodeError`] if there are more than [`DECODE_BYTES_MAX`] bytes, or if they do not encode exactly one value of
/// this type.
pub fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, DecodeError> {
    let unused = DECODE_BYTES_MAX.checked_sub(bytes.len());
    let unused = unused.ok_or(DecodeError::TooLong { count: bytes.len() as u64 })?;
    // bincode allocates the announced length of a string, up to a constant limit, before it checks whether the input is
    // that long. Claiming the unused part of the limit in advance reduces the limit to the length of the input plus the
    // slack.
    let layout = LAYOUT.with_limit::<{ DECODE_BYTES_MAX + SLACK }>();
    let mut decoder = DecoderImpl::new(Rest(bytes), layout, ());
    let decoded = decoder.claim_bytes_read(unused).and_then(|()| Compat::<T>::decode(&mut decoder));
    match (decoded, decoder.reader().0.len()) {
        (Ok(Compat(value)), 0) => Ok(value),
        (Ok(_), rest) => Err(DecodeError::TrailingBytes { count: rest as u64 }),
        (Err(error), _) => Err(DecodeError::Invalid { why: alloc::format!("{error}") }),
    }
}

struct Rest<'a>(&'a [u8]);

impl Reader for Rest<'_> {
    #[inline]
    fn read(&mut self, bytes: &mut [u8]) -> Result<(), error::DecodeError> {
        let count = bytes.len();
        let missing = error::DecodeError::UnexpectedEnd { additional: count.saturating_sub(self.0.len()) };
        let (read, rest) = self.0.split_at_checked(count).ok_or(missing)?;
        bytes.copy_from_slice(read);
        self.0 = rest;
        Ok(())
    }

    #[inline]
    fn peek_read(&mut self, count: usize) -> Option<&[u8]> {
        self.0.get(..count)
    }

    #[inline]
    fn consume(&mut self, count: usize) {
        self.0 = self.0.get(count..).unwrap_or_default();
    }
}
