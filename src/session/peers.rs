//! [`Peers`]: the data that a session keeps about each peer.

use alloc::vec::Vec;

use super::id::{Key, PeerId, Tick};
use super::link::Link;
use super::row::Row;
use super::view::{View, bit};

/// Maximum number of known peers. If it is reached, a further peer replaces the peer without a vote that has been
/// silent longest.
const PEERS_MAX: usize = 192;
/// A peer without a vote is served (gets rows, changes and inputs) until this time after its last packet, in
/// microseconds.
const SERVED: u64 = 5_000_000;
/// Longest measured round trip through other peers, in microseconds. A longer one is ignored, because an outage is its
/// likely cause.
const RELAYED_MAX: u64 = 1_000_000;

/// Position in a series of runs. A series sends, over several packets, the inputs of a span that do not fit in one
/// packet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resume {
    pub(super) span: u16,
    /// First tick of the next run.
    pub(super) tick: Tick,
    /// First tick that the peer lacked when the last run was sent.
    pub(super) lacks: Tick,
    /// Time at which the run that begins with `lacks` was sent, or at which the peer's row showed that it lacks this
    /// tick.
    pub(super) since: u64,
}

#[derive(Clone, Debug)]
pub(super) struct Remote {
    pub(super) id: PeerId,
    pub(super) key: Option<Key>,
    pub(super) row: Option<Row>,
    /// Time at which the peer's newest row arrived, directly or through others.
    pub(super) fresh: Option<u64>,
    /// Time of the last packet from the peer itself.
    pub(super) heard: Option<u64>,
    /// Arrival time of the newest row in which the peer states that it is connected to a quorum. Before the first such
    /// row, the time at which the peer became known.
    pub(super) contact: u64,
    /// Time of the last call of [`Session::attach`](super::Session::attach) for the peer.
    pub(super) attached: Option<u64>,
    /// Whether the peer issued two different inputs for a tick, or has a different state.
    pub(super) faulty: bool,
    /// Time at which the peer lost its vote; `None` while it has one, and if it never had one.
    pub(super) lost_vote_at: Option<u64>,
    pub(super) resumes: Vec<Resume>,
    /// Span of the first run in the next packet to the peer, because the last packet had no room for this run.
    pub(super) next_span: u16,
    /// Peer of the first foreign row (row of another peer) in the next packet, because the last packet had no room for
    /// this row.
    pub(super) next_row: Option<PeerId>,
    pub(super) link: Link,
    /// Measurement of the round trip through other peers, while no packets arrive from the peer itself: the span and
    /// tick of an own input, and the time at which the input was issued. A relayed row that acknowledges the input ends
    /// the measurement.
    pub(super) probe: Option<(usize, Tick, u64)>,
}

impl Remote {
    /// Whether the peer is served even without a vote: a packet from it arrived, or it was attached, within [`SERVED`].
    pub(super) fn is_served(&self, now: u64) -> bool {
        within(self.heard.max(self.attached), SERVED, now)
    }

    /// Ends the measurement of a round trip if a row acknowledges its input.
    pub(super) fn end_probe(&mut self, row: &Row, heard: u64, now: u64) {
        let Some((span, tick, at)) = self.probe else { return };
        if !row.have.iter().any(|&(number, next)| usize::from(number) == span && next > tick) {
            return;
        }
        self.probe = None;
        let trip = now.saturating_sub(at);
        if trip < RELAYED_MAX && !within(self.heard, heard, now) {
            self.link.measure(trip);
        }
    }

    /// Time of the last sign of the peer: a row or packet from it, a call of `attach` for it, or that it became known.
    fn known_at(&self) -> Option<u64> {
        self.fresh.max(self.heard).max(self.attached).max(Some(self.contact))
    }
}

/// All known peers. The first one is this peer itself.
#[derive(Clone, Debug)]
pub(super) struct Peers {
    pub(super) list: Vec<Remote>,
    /// Index in `list` for each voter of the view.
    voters: Vec<Option<usize>>,
}

impl Peers {
    pub(super) fn new(me: PeerId, key: Key) -> Self {
        let mut peers = Peers { list: Vec::new(), voters: Vec::new() };
        peers.add(me, Some(key), 0);
        peers
    }

    pub(super) fn find(&self, id: PeerId) -> Option<&Remote> {
        self.list.iter().find(|remote| remote.id == id)
    }

    pub(super) fn find_mut(&mut self, id: PeerId) -> Option<&mut Remote> {
        self.list.iter_mut().find(|remote| remote.id == id)
    }

    /// Adds an unknown peer, with `now` as the time of its last contact. If the peer is known already, sets only its
    /// key, if the key is missing.
    pub(super) fn add(&mut self, id: PeerId, key: Option<Key>, now: u64) {
        if let Some(remote) = self.find_mut(id) {
            remote.key = remote.key.or(key);
            return;
        }
        self.list.push(Remote {
            id,
            key,
            row: None,
            fresh: None,
            heard: None,
            contact: now,
            attached: None,
            faulty: false,
            lost_vote_at: None,
            resumes: Vec::new(),
            next_span: 0,
            next_row: None,
            link: Link::default(),
            probe: None,
        });
    }

    pub(super) fn follow(&mut self, view: &View, now: u64) {
        for voter in &view.voters {
            self.has_room(voter.id, view, now);
            self.add(voter.id, Some(voter.key), now);
        }
        self.index(view);
    }

    fn index(&mut self, view: &View) {
        let place = |id: PeerId| self.list.iter().position(|remote| remote.id == id);
        self.voters = view.voters.iter().map(|voter| place(voter.id)).collect();
    }

    /// Makes room for a peer. If the list is full, removes the peer without a vote that has been silent longest, unless
    /// that peer is still served. Returns whether there is room.
    pub(super) fn has_room(&mut self, id: PeerId, view: &View, now: u64) -> bool {
        self.find(id).is_some() || self.list.len() < PEERS_MAX || {
            let strangers = self.list.iter().enumerate().skip(1);
            let strangers = strangers.filter(|(_, remote)| view.voter(remote.id).is_none());
            let oldest = strangers.min_by_key(|(_, remote)| remote.known_at());
            let Some((place, _)) = oldest.filter(|(_, remote)| !remote.is_served(now)) else { return false };
            self.list.remove(place);
            self.index(view);
            true
        }
    }

    /// Begins to measure the round trips to peers from which no packets arrive. The caller has just issued the input of
    /// `span` for `tick`.
    pub(super) fn probe(&mut self, span: usize, tick: Tick, heard: u64, now: u64) {
        for remote in self.list.iter_mut().skip(1).filter(|remote| !within(remote.heard, heard, now)) {
            remote.probe.get_or_insert((span, tick, now));
        }
    }

    pub(super) fn voter(&self, index: usize) -> Option<&Remote> {
        self.list.get((*self.voters.get(index)?)?)
    }

    pub(super) fn voters(&self) -> impl Iterator<Item = (usize, &Remote)> {
        (0..self.voters.len()).filter_map(|index| Some((index, self.voter(index)?)))
    }

    /// Voters whose row belongs to the view with the number `view`, each with its index among the voters and its row.
    pub(super) fn rows(&self, view: u32) -> impl Iterator<Item = (usize, &Remote, &Row)> {
        self.voters().filter_map(move |(index, remote)| {
            let row = remote.row.as_ref().filter(|row| row.view == view)?;
            Some((index, remote, row))
        })
    }

    pub(super) fn voters_that(&self, condition: impl Fn(&Remote) -> bool) -> u64 {
        self.voters().filter(|(_, remote)| condition(remote)).fold(0, |set, (index, _)| set | bit(index))
    }
}

/// Whether a time lies less than `period` before `now`.
pub(super) fn within(time: Option<u64>, period: u64, now: u64) -> bool {
    time.is_some_and(|time| now < time.saturating_add(period))
}
