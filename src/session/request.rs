//! [`Request`]: what a session asks the game to do, and the inputs of a tick.

use alloc::vec::Vec;

use super::id::Tick;
use super::view::has_bit;

/// What is known of the input of a seat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputStatus {
    /// Issued by the player.
    Confirmed,
    /// Not here yet: the player's last known input.
    Guessed,
    /// Nobody plays the seat.
    Absent,
}

/// The inputs of all seats for a tick.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TickInputs {
    pub(super) bytes: Vec<u8>,
    pub(super) size: usize,
    pub(super) absent: u64,
    pub(super) guessed: u64,
}

impl TickInputs {
    /// The input of a seat and what is known of it. Nothing for a seat that does not exist; zeros for an absent player.
    #[must_use]
    pub fn seat(&self, seat: u8) -> Option<(&[u8], InputStatus)> {
        let index = usize::from(seat);
        let input = self.bytes.chunks_exact(self.size.max(1)).nth(index)?;
        let status = if has_bit(self.absent, index) {
            InputStatus::Absent
        } else if has_bit(self.guessed, index) {
            InputStatus::Guessed
        } else {
            InputStatus::Confirmed
        };
        Some((input, status))
    }

    /// The inputs of all seats, one after another.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Bit for each seat that nobody plays.
    #[must_use]
    pub fn absent(&self) -> u64 {
        self.absent
    }

    /// Bit for each seat whose input is guessed.
    #[must_use]
    pub fn guessed(&self) -> u64 {
        self.guessed
    }

    pub(super) fn set(&mut self, seat: u8, input: &[u8]) {
        let start = usize::from(seat) * self.size;
        if let Some(place) = self.bytes.get_mut(start..start + self.size) {
            place.copy_from_slice(input);
        }
    }
}

/// What a session asks the game to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Request {
    /// Keep a copy of the state before this tick. An older copy for the same tick is replaced.
    Save {
        /// The tick.
        tick: Tick,
    },
    /// Restore the copy of the state before this tick. Later copies are no longer needed.
    Load {
        /// The tick.
        tick: Tick,
    },
    /// Simulate a tick.
    Advance {
        /// The tick.
        tick: Tick,
        /// The inputs.
        inputs: TickInputs,
    },
    /// Pass the hash of the copy of the state before this tick to
    /// [`Session::report_hash`](super::Session::report_hash).
    Checksum {
        /// The tick.
        tick: Tick,
    },
    /// Copies of states before this tick are no longer needed.
    Forget {
        /// The tick.
        tick: Tick,
    },
}
