//! [`InputSlot`]: encodes inputs in the fixed number of bytes that a session transmits.

#[cfg(test)]
mod tests;

use alloc::vec::Vec;

use serde::{Serialize, de::DeserializeOwned};

use super::error::PeerError;
use crate::codec;
use crate::lockstep::InputError;
use crate::replay::RecordError;

pub(super) const LENGTH_BYTES: u16 = 2;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InputSlot {
    /// Every input has this many bytes.
    Fixed(u16),
    /// Two bytes state the length of an input, which is at most this number. Zeros fill the rest of the slot.
    Prefixed(u16),
}

impl InputSlot {
    /// The slot for inputs of up to `bytes` bytes. If `bytes` is `None`, every input has to be as long as the default
    /// input.
    pub(super) fn of<I: Serialize + Default>(bytes: Option<u16>) -> Result<Self, PeerError> {
        let default = codec::encode(&I::default()).len();
        match (bytes, u16::try_from(default)) {
            (Some(bytes), _) => Ok(InputSlot::Prefixed(bytes)),
            (None, Ok(bytes)) => Ok(InputSlot::Fixed(bytes)),
            (None, Err(_)) => Err(PeerError::InputLength { bytes: default, possible: usize::from(u16::MAX) }),
        }
    }

    /// Bytes of an input in the session.
    pub(super) fn bytes(self) -> u16 {
        match self {
            // A session transmits at least one byte per input.
            InputSlot::Fixed(bytes) => bytes.max(1),
            InputSlot::Prefixed(bytes) => bytes.saturating_add(LENGTH_BYTES),
        }
    }

    /// Appends an input. Like a recorder, refuses an input that changes when it is encoded and decoded.
    pub(super) fn put<I: Serialize + DeserializeOwned>(
        self,
        input: &I,
        slots: &mut Vec<u8>,
    ) -> Result<(), PeerError> {
        let encoded = codec::encode(input);
        if !codec::decode::<I>(&encoded).is_ok_and(|decoded| codec::encode(&decoded) == encoded) {
            return Err(PeerError::Record(RecordError::Inputs(InputError::NotCanonical)));
        }
        let end = slots.len() + usize::from(self.bytes());
        let possible = match self {
            InputSlot::Fixed(bytes) => {
                let fits = encoded.len() == usize::from(bytes);
                (!fits).then_some(bytes)
            }
            InputSlot::Prefixed(bytes) => (encoded.len() > usize::from(bytes)).then_some(bytes),
        };
        if let Some(possible) = possible {
            return Err(PeerError::InputLength { bytes: encoded.len(), possible: possible.into() });
        }
        if let InputSlot::Prefixed(_) = self {
            let length = u16::try_from(encoded.len()).unwrap_or(0);
            slots.extend_from_slice(&length.to_le_bytes());
        }
        slots.extend_from_slice(&encoded);
        slots.resize(end, 0);
        Ok(())
    }

    /// Decodes the input in a slot. Invalid bytes decode to the default input on all peers.
    pub(super) fn take<I: Default + DeserializeOwned>(self, slot: &[u8]) -> I {
        let encoded = match self {
            InputSlot::Fixed(bytes) => slot.get(..usize::from(bytes)),
            InputSlot::Prefixed(_) => slot
                .split_first_chunk()
                .and_then(|(length, rest)| rest.get(..usize::from(u16::from_le_bytes(*length)))),
        };
        encoded.and_then(|encoded| codec::decode(encoded).ok()).unwrap_or_default()
    }
}
