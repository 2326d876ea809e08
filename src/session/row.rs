//! [`Row`]: the status that a peer sends to others. The row with the highest version counts, so that lost, duplicated
//! and reordered packets do no harm.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::id::{Key, PeerId, Tick};
use super::view::Change;

/// An attempt to change the view. Ballots are ordered by round, then by proposer. A peer starts at most one ballot per
/// round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Ballot {
    pub(super) round: u32,
    pub(super) proposer: PeerId,
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Wants {
    pub(super) seats: Option<SeatWant>,
    pub(super) leave: bool,
    /// Requested end of the match: the first tick that is not played.
    pub(super) end: Option<Tick>,
    /// Votes against peers, at most [`REMOVALS_MAX`].
    pub(super) removals: Vec<Removal>,
}

pub(super) const REMOVALS_MAX: usize = 8;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SeatWant {
    pub(super) seats: u8,
    pub(super) key: Key,
    /// Bit for each requested seat; 0 for any.
    pub(super) which: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Removal {
    /// Vote to continue without this incarnation, which may return.
    Without(PeerId),
    /// Vote to remove this identity, which gets no seat while enough votes count.
    Kick(Key),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Row {
    pub(super) version: u32,
    /// View of the sender, to which the other fields refer.
    pub(super) view: u32,
    /// Number of acknowledged ticks: the sender has their inputs.
    pub(super) ack: Tick,
    /// Number of final ticks.
    pub(super) fin: Tick,
    /// Number of ticks that the game has played.
    pub(super) played: Tick,
    /// For up to 200 spans that end after `fin`, in ascending order: the index, and the first tick whose input the
    /// sender lacks. Other peers send the inputs of a span only if the span is in this list, or began after the view of
    /// this row.
    pub(super) have: Vec<(u16, Tick)>,
    /// Bit for each voter from which a packet arrived within `Timing::heard`.
    pub(super) hears: u64,
    /// Peers without a vote from which a packet arrived within `Timing::heard`, at most [`STRANGERS_MAX`].
    pub(super) hears_others: Vec<PeerId>,
    pub(super) connected: bool,
    pub(super) paused: bool,
    pub(super) promised: Option<Ballot>,
    pub(super) accepted: Option<(Ballot, Arc<Change>)>,
    pub(super) wants: Wants,
    /// A number of final ticks, and the hash of the state after them.
    pub(super) hash: Option<(Tick, u128)>,
}

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
