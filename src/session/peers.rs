//! [`Peers`]: the data that a session keeps about each peer.

use alloc::vec::Vec;

use super::id::{Key, PeerId, Tick};
use super::link::Link;
use super::row::Row;
use super::view::{View, bit};

/// Largest number of known peers. To add a further peer, the peer without a vote that has been silent longest is
/// removed.
const PEERS_MAX: usize = 192;
/// A peer without a vote is served until this time after its last packet, in microseconds. To serve a peer is to send
/// it rows, changes and inputs.
const SERVED: u64 = 5_000_000;
/// Longest round trip through other peers that is measured, in microseconds. A longer one is attributed to an outage.
const RELAYED_MAX: u64 = 1_000_000;

/// Position in a series of runs. A series sends the inputs of a span that do not fit in one packet.
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
    pub(super) resumes: Vec<Resume>,
    /// The span and the foreign row (row of another peer) with which the next packet to the peer begins, because the
    /// last packet had no room for them.
    pub(super) next_span: u16,
    pub(super) next_row: Option<PeerId>,
    pub(super) link: Link,
    /// Measurement of the round trip through other peers, while no packets arrive from the peer itself: span and tick
    /// of an own input, and the time at which it was issued. A relayed row that acknowledges the input ends the
    /// measurement.
    pub(super) probe: Option<(usize, Tick, u64)>,
}

impl Remote {
    /// Whether the peer is to be served although it may have no vote.
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

    /// The latest of the times at which a row or packet of the peer arrived, the peer was attached, or became known.
    fn known_at(&self) -> Option<u64> {
        self.fresh.max(self.heard).max(self.attached).max(Some(self.contact))
    }
}

/// All known peers. This peer is the first.
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

    /// Adds an unknown peer, with `now` as its last contact. If the peer is known, only a missing key is set.
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

    /// Makes room for a peer. If the list is full, this removes the peer without a vote that has been silent longest,
    /// unless it is still served. Returns whether there is room.
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

    /// Begins to measure the round trips to peers that are not heard. The caller has just issued the input of `span`
    /// for `tick`.
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

    /// Rows of voters that are in view `view`, with the index of the voter.
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
