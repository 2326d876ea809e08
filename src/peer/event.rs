//! [`PeerEvent`]: what happened in a match; [`PeerEnd`]: what remains of it.

use alloc::vec::Vec;

use crate::hash::StateHash;
use crate::session::{Event, PeerId};

/// Something that happened in a match.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PeerEvent {
    /// An event of the session.
    Session(Event),
    /// The state to begin with has arrived; the game goes on from it.
    Joined {
        /// Number of ticks that lead to it.
        tick: u64,
    },
    /// Another peer has another state. Write [`Peer::report`](super::Peer::report) to a file.
    Desync(PeerDesync),
}

/// Two peers had different states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PeerDesync {
    /// The other peer.
    pub peer: PeerId,
    /// Number of ticks played.
    pub tick: u64,
    /// Hash of this peer.
    pub ours: StateHash,
    /// Hash of the other peer.
    pub theirs: StateHash,
}

/// What remains of a peer that has finished.
#[derive(Clone, Debug)]
pub struct PeerEnd<G> {
    /// Number of final ticks.
    pub ticks: u64,
    /// The game after that tick.
    pub game: G,
    /// Last bytes of the replay. Empty for a peer that joined after the first tick.
    pub replay: Vec<u8>,
}
