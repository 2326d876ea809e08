use alloc::vec::Vec;
use core::fmt;

use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::bytes::state_to_bytes;
use super::restore::restore_state;
use super::rollback::Snapshot;
use super::state_view::StateView;
use crate::world::World;
use crate::world::state::State;

impl Snapshot {
    /// Returns [`World::to_bytes`] of the saved world.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        state_to_bytes(&self.state())
    }

    fn state(&self) -> State {
        let mut state = State::new(self.rest.config);
        restore_state(&mut state, self, &mut Default::default());
        state
    }
}

/// In a binary format, writes the bytes of [`World::to_bytes`]. In a human-readable format such as JSON, writes a view
/// of the state that names objects by their handles, as in `body 12v1`. This view cannot be deserialized.
impl Serialize for Snapshot {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let state = self.state();
        if serializer.is_human_readable() {
            StateView(&state).serialize(serializer)
        } else {
            serializer.serialize_bytes(&state_to_bytes(&state))
        }
    }
}

/// Reads the bytes of [`World::to_bytes`] from a binary format, with the checks of [`World::from_bytes`].
impl<'de> Deserialize<'de> for Snapshot {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if deserializer.is_human_readable() {
            return Err(D::Error::custom("a snapshot can only be read from a binary format"));
        }
        deserializer.deserialize_byte_buf(WorldBytes)
    }
}

struct WorldBytes;

impl Visitor<'_> for WorldBytes {
    type Value = Snapshot;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the bytes of a world")
    }

    fn visit_bytes<E: Error>(self, bytes: &[u8]) -> Result<Snapshot, E> {
        World::from_bytes(bytes).map(|world| world.save()).map_err(E::custom)
    }
}
