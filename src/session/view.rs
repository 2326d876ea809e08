//! [`View`]: the voters of a match, and which peer plays which seat in which ticks.
//!
//! A [`Change`] leads from each view to the next one (`agreement.rs`). Spans are never removed, so that their indices
//! remain valid.

use alloc::vec::Vec;

use super::id::{Key, NEVER, PeerId, Tick};

/// Largest number of seats of a match, and of voters of a view.
pub const SEATS_MAX: usize = 64;
/// Largest number of spans of a match. A join adds one for each of its seats.
pub const SPANS_MAX: usize = 1 << 14;
pub(super) const JOINS_MAX: usize = 8;

/// A peer with a vote on changes of the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Voter {
    /// Incarnation of the peer.
    pub id: PeerId,
    /// Identity of the peer.
    pub key: Key,
    /// Weight of the vote: 1, unless [`View::found`] sets another one. A voter that outweighs all others together
    /// decides alone.
    pub weight: u8,
}

/// The ticks in which a peer plays a seat: `from <= tick < until`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// Number of the seat, below [`SEATS_MAX`].
    pub seat: u8,
    /// Incarnation of the peer.
    pub owner: PeerId,
    /// Identity of the peer.
    pub key: Key,
    /// Number of the view in which the span was added.
    pub since: u32,
    /// First tick of the span.
    pub from: Tick,
    /// First tick after the span; [`NEVER`] while its end is undecided.
    pub until: Tick,
}

impl Span {
    /// Whether the span contains a tick.
    #[must_use]
    pub const fn contains(&self, tick: Tick) -> bool {
        self.from <= tick && tick < self.until
    }

    /// Whether the end of the span is undecided.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        self.until == NEVER
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Join {
    pub(super) id: PeerId,
    pub(super) key: Key,
    pub(super) seats: u64,
}

/// A step from one view to the next, proposed or decided.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Change {
    /// First tick that the change may affect. All final ticks lie before the cut. Once the change is decided, all ticks
    /// before the cut are final.
    pub(super) cut: Tick,
    /// First tick that is not played; `None` while no end is decided.
    pub(super) end: Option<Tick>,
    /// Whether the match has begun, so that its first tick may be played.
    pub(super) begun: bool,
    /// Bit for each voter of the old view that leaves.
    pub(super) leaves: u64,
    pub(super) tie_holder: PeerId,
    pub(super) joins: Vec<Join>,
    /// First tick of the peers that join.
    pub(super) from: Tick,
}

/// Membership of a match: its voters, and which peer plays which seat in which ticks.
///
/// ```
/// use lockstep2d::session::{Key, PeerId, Span, View, Voter};
/// let mut view = View::opened_by(PeerId(1), Key(10), 0b01, true);
/// view.found(PeerId(2), Key(20), 1, 0b10);
/// view.found(PeerId(3), Key(30), 1, 0b100);
/// // Two of the three voters are a quorum.
/// assert!(view.is_quorum(0b011) && !view.is_quorum(0b100));
/// assert!(view.voters.iter().all(|Voter { weight, .. }| *weight == 1));
/// // The peer that plays the second seat.
/// let player = view.spans.iter().find(|span: &&Span| span.seat == 1 && span.is_open());
/// assert_eq!(player.map(|span| span.owner), Some(PeerId(2)));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct View {
    /// Number of the view, increased by 1 with each change.
    pub number: u32,
    /// Whether the match has begun. It begins when enough seats are taken.
    pub begun: bool,
    /// Cut of the last change. The ticks before it are final.
    pub cut: Tick,
    /// First tick that is not played; `None` while no end is decided.
    pub end: Option<Tick>,
    /// Voter with the casting vote.
    pub tie_holder: PeerId,
    /// The voters in the order of joining, at most [`SEATS_MAX`].
    pub voters: Vec<Voter>,
    /// All spans of the match so far.
    pub spans: Vec<Span>,
}

impl View {
    /// The first view of a match opened by one peer. `seats` has a bit for each of its seats.
    #[must_use]
    pub fn opened_by(id: PeerId, key: Key, seats: u64, begun: bool) -> Self {
        let mut view = View {
            number: 0,
            begun,
            cut: 0,
            end: None,
            tie_holder: id,
            voters: Vec::new(),
            spans: Vec::new(),
        };
        view.found(id, key, 1, seats);
        view
    }

    /// Adds a voter to a view that is not in use yet. The voter gets those of the given seats that are still free.
    pub fn found(&mut self, id: PeerId, key: Key, weight: u8, seats: u64) {
        self.voters.push(Voter { id, key, weight });
        let seats = seats & self.free_seats();
        self.begin_spans(Join { id, key, seats }, 0);
    }

    fn begin_spans(&mut self, join: Join, from: Tick) {
        let since = self.number;
        let Join { id, key, seats } = join;
        let span = |seat| Span { seat, owner: id, key, since, from, until: NEVER };
        self.spans.extend(bits(seats).map(span));
    }

    /// Index of a voter.
    #[must_use]
    pub fn voter(&self, id: PeerId) -> Option<usize> {
        self.voters.iter().position(|voter| voter.id == id)
    }

    /// Twice the weight of a voter, plus 1 for the tie-holder.
    fn weight(&self, voter: &Voter) -> u32 {
        2 * u32::from(voter.weight) + u32::from(voter.id == self.tie_holder)
    }

    pub(super) fn weight_of(&self, set: u64) -> u32 {
        let members = self.voters.iter().enumerate().filter(|(index, _)| has_bit(set, *index));
        members.map(|(_, voter)| self.weight(voter)).sum()
    }

    /// Whether a set of voters (a bit for each index) has more than half of the weight. Because of the casting vote of
    /// the tie-holder, there are no ties.
    #[must_use]
    pub fn is_quorum(&self, set: u64) -> bool {
        2 * self.weight_of(set) > self.weight_of(u64::MAX)
    }

    /// First tick that is not played; [`NEVER`] while no end is decided.
    #[must_use]
    pub fn stop(&self) -> Tick {
        self.end.unwrap_or(NEVER)
    }

    /// Bit for each of the [`SEATS_MAX`] seats that no peer plays now and no peer is going to play.
    #[must_use]
    pub fn free_seats(&self) -> u64 {
        let taken = self.spans.iter().filter(|span| span.is_open());
        !taken.fold(0, |set, span| set | bit(usize::from(span.seat)))
    }

    /// Bit for each seat that the peer plays or is going to play.
    #[must_use]
    pub fn seats_of(&self, id: PeerId) -> u64 {
        let own = self.spans.iter().filter(|span| span.is_open() && span.owner == id);
        own.fold(0, |set, span| set | bit(usize::from(span.seat)))
    }

    /// Bit for each seat whose latest player up to `tick` is the peer. If nobody has played the seat by then, its first
    /// player counts instead.
    pub(crate) fn seats_at(&self, id: PeerId, tick: Tick) -> u64 {
        let (mut known, mut own) = (0, 0);
        for span in self.spans.iter().filter(|span| span.from < span.until) {
            let seat = bit(span.seat.into());
            if span.from <= tick || known & seat == 0 {
                known |= seat;
                own = if span.owner == id { own | seat } else { own & !seat };
            }
        }
        own
    }

    /// Whether the list of spans has room for a peer that joins with these seats, and for others that join with the same
    /// change.
    pub(super) fn has_room_for(&self, seats: u8) -> bool {
        self.spans.len() + usize::from(seats) + SEATS_MAX <= SPANS_MAX
    }

    /// The view after a change, or `None` if the change is not valid for this view.
    pub(super) fn changed_by(&self, change: &Change) -> Option<View> {
        let mut next = self.clone();
        next.number = self.number.checked_add(1)?;
        next.begun = change.begun;
        next.cut = change.cut;
        next.end = change.end;
        next.tie_holder = change.tie_holder;
        let leaves = |voter: &Voter| self.voter(voter.id).is_some_and(|index| has_bit(change.leaves, index));
        next.voters.retain(|voter| !leaves(voter));
        for span in next.spans.iter_mut().filter(|span| span.is_open()) {
            let votes = self.voter(span.owner).is_some_and(|index| !has_bit(change.leaves, index));
            if !votes {
                span.until = change.cut.max(span.from);
            }
        }
        for join in &change.joins {
            let is_new = next.voter(join.id).is_none() && join.seats != 0;
            if !is_new || join.seats & !next.free_seats() != 0 {
                return None;
            }
            next.voters.push(Voter { id: join.id, key: join.key, weight: 1 });
            next.begin_spans(*join, change.from);
        }
        let ends_right = match (self.end, change.end) {
            (Some(end), new) => new == Some(end),
            (None, Some(end)) => end >= change.cut,
            (None, None) => true,
        };
        let sound = ends_right
            && change.cut >= self.cut
            && change.from >= change.cut
            && (change.begun || !self.begun)
            && next.voters.len() <= SEATS_MAX
            && next.spans.len() <= SPANS_MAX
            && next.voter(change.tie_holder).is_some();
        sound.then_some(next)
    }
}

/// The set that contains one index; empty for an index above 63.
pub(super) const fn bit(index: usize) -> u64 {
    if index < 64 { 1 << index } else { 0 }
}

pub(super) const fn has_bit(set: u64, index: usize) -> bool {
    set & bit(index) != 0
}

pub(super) fn bits(mut set: u64) -> impl Iterator<Item = u8> {
    core::iter::from_fn(move || {
        let [lowest, ..] = set.trailing_zeros().to_le_bytes();
        let some = set != 0;
        set &= set.wrapping_sub(1);
        some.then_some(lowest)
    })
}
