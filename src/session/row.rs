//! [`Row`]: what a peer tells all others about itself. Rows are merged by version: the newest one counts, so that lost,
//! duplicated and reordered packets do no harm.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::id::{Key, PeerId, Tick};
use super::view::Change;

/// An attempt to change a view. Later attempts of a view have higher rounds; a peer makes one attempt a round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Ballot {
    pub(super) round: u32,
    pub(super) proposer: PeerId,
}

/// Requests of a peer to the others.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Wants {
    /// Number of seats, for a peer that has caught up and wants to play.
    pub(super) seats: Option<SeatWant>,
    pub(super) leave: bool,
    /// Last tick of the match plus one.
    pub(super) end: Option<Tick>,
    /// Peers that should no longer play. At most [`REMOVALS_MAX`].
    pub(super) removals: Vec<Removal>,
}

/// Largest number of removals in a row.
pub(super) const REMOVALS_MAX: usize = 8;

/// A peer that wants to play.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SeatWant {
    pub(super) seats: u8,
    pub(super) key: Key,
    /// Bit for each seat that is asked for; 0 for any.
    pub(super) which: u64,
}

/// A vote against a peer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Removal {
    /// Play goes on without this incarnation. It may return.
    Without(PeerId),
    /// This identity does not get a seat any more.
    Kick(Key),
}

/// A row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Row {
    pub(super) version: u32,
    /// Number of the view that the sender is in. All that follows refers to it.
    pub(super) view: u32,
    /// Number of ticks that the sender acknowledges: all their inputs are there.
    pub(super) ack: Tick,
    /// Number of final ticks.
    pub(super) fin: Tick,
    /// Number of ticks that the game has played.
    pub(super) played: Tick,
    /// For spans that end after `fin`, ascending: index and first tick whose input is missing.
    pub(super) have: Vec<(u16, Tick)>,
    /// Bit for each voter from which a packet arrived lately.
    pub(super) hears: u64,
    /// Others from which a packet arrived lately. At most [`STRANGERS_MAX`].
    pub(super) hears_others: Vec<PeerId>,
    /// Whether rows of a quorum arrived lately.
    pub(super) connected: bool,
    /// Whether the game asks the session to stop for now.
    pub(super) paused: bool,
    pub(super) promised: Option<Ballot>,
    pub(super) accepted: Option<(Ballot, Arc<Change>)>,
    pub(super) wants: Wants,
    /// A final tick and the hash of the state before it.
    pub(super) hash: Option<(Tick, u128)>,
}

/// Largest number of peers without a vote in a row.
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
