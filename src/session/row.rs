//! [`Row`]: the status that a peer sends to other peers. Only the row with the highest version counts, so that lost,
//! duplicated and reordered packets do no harm.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::id::{Key, PeerId, Tick};
use super::view::Change;

/// An attempt to change a view. Ballots are ordered by round, then by proposer. A peer makes at most one attempt per
/// round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Ballot {
    pub(super) round: u32,
    pub(super) proposer: PeerId,
}

/// Requests of a peer to the others.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Wants {
    /// The seats requested by a peer that has caught up and wants to play.
    pub(super) seats: Option<SeatWant>,
    pub(super) leave: bool,
    /// First tick after the end that the peer requests for the match.
    pub(super) end: Option<Tick>,
    /// Peers that should no longer play. At most [`REMOVALS_MAX`].
    pub(super) removals: Vec<Removal>,
}

/// Largest number of removals in a [`Row`].
pub(super) const REMOVALS_MAX: usize = 8;

/// A peer's request for seats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SeatWant {
    pub(super) seats: u8,
    pub(super) key: Key,
    /// Bit for each requested seat; 0 for any.
    pub(super) which: u64,
}

/// A vote against a peer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Removal {
    /// Play continues without this incarnation, which may return.
    Without(PeerId),
    /// This identity gets no seat any more.
    Kick(Key),
}

/// The status of a peer, sent to other peers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Row {
    pub(super) version: u32,
    /// Number of the view that the sender is in. The other fields refer to this view.
    pub(super) view: u32,
    /// Number of ticks that the sender acknowledges: it has all their inputs.
    pub(super) ack: Tick,
    /// Number of final ticks.
    pub(super) fin: Tick,
    /// Number of ticks that the game has played.
    pub(super) played: Tick,
    /// For spans that end after `fin`, ascending: index and first tick whose input is missing.
    pub(super) have: Vec<(u16, Tick)>,
    /// Bit for each voter from which a packet arrived recently.
    pub(super) hears: u64,
    /// Peers without a vote from which a packet arrived recently. At most [`STRANGERS_MAX`].
    pub(super) hears_others: Vec<PeerId>,
    /// Whether rows of a quorum arrived recently.
    pub(super) connected: bool,
    /// Whether the sender requests a pause.
    pub(super) paused: bool,
    pub(super) promised: Option<Ballot>,
    pub(super) accepted: Option<(Ballot, Arc<Change>)>,
    pub(super) wants: Wants,
    /// A number of ticks, all of them final, and the hash of the state after them.
    pub(super) hash: Option<(Tick, u128)>,
}

/// Largest length of [`Row::hears_others`].
pub(super) const STRANGERS_MAX: usize = 8;

impl Row {
    pub(super) fn new(view: u32) -> Self {
        Row {
            version: 0,
            view,
            ack: 0,
            fin: 0,
            played: 0,
            have: Vec::new(),
            hears: 0,
            hears_others: Vec::new(),
            connected: false,
            paused: false,
            promised: None,
            accepted: None,
            wants: Wants::default(),
            hash: None,
        }
    }
}
