//! [`InputSlot`]: encodes inputs in the fixed number of bytes that a session transmits.

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inputs_survive_in_their_slots() {
        let mut slots = Vec::new();
        let fixed = InputSlot::of::<u32>(None).unwrap();
        fixed.put(&7_u32, &mut slots).unwrap();
        assert_eq!((fixed.bytes(), fixed.take::<u32>(&slots)), (4, 7));
        let list = InputSlot::of::<Vec<u8>>(Some(12)).unwrap();
        let mut slots = Vec::new();
        list.put(&alloc::vec![1_u8, 2], &mut slots).unwrap();
        assert_eq!((slots.len(), list.take::<Vec<u8>>(&slots)), (14, alloc::vec![1, 2]));
        assert_eq!(
            list.put(&alloc::vec![0_u8; 5], &mut slots),
            Err(PeerError::InputLength { bytes: 13, possible: 12 })
        );
        assert_eq!(list.take::<Vec<u8>>(&[255; 14]), Vec::<u8>::new(), "not an input");
        assert_eq!(InputSlot::of::<()>(None).unwrap().bytes(), 1);
    }

    #[test]
    fn an_own_input_that_its_type_refuses_is_an_error() {
        #[derive(Clone, Copy, Default, serde::Serialize, serde::Deserialize)]
        #[serde(try_from = "u16", into = "u16")]
        struct Degrees(u16);
        impl From<Degrees> for u16 {
            fn from(degrees: Degrees) -> u16 {
                degrees.0
            }
        }
        impl TryFrom<u16> for Degrees {
            type Error = &'static str;
            fn try_from(degrees: u16) -> Result<Self, &'static str> {
                (degrees < 360).then_some(Degrees(degrees)).ok_or("more than a turn")
            }
        }
        let (slot, mut slots) = (InputSlot::of::<Degrees>(None).unwrap(), Vec::new());
        let refused = Err(PeerError::Record(RecordError::Inputs(InputError::NotCanonical)));
        assert_eq!(slot.put(&Degrees(360), &mut slots), refused);
        assert_eq!((slot.put(&Degrees(359), &mut slots), slots.len()), (Ok(()), 2));
    }
}
