//! [`Peers`]: the data that a session keeps about each peer.

use alloc::vec::Vec;

use super::id::{Key, PeerId, Tick};
use super::link::Link;
use super::row::Row;
use super::view::{View, bit};

/// Largest number of known peers. Beyond it, the peer without a vote that has been silent longest is removed.
pub(super) const PEERS_MAX: usize = 192;

#[derive(Clone, Debug)]
pub(super) struct Remote {
    pub(super) id: PeerId,
    pub(super) key: Option<Key>,
    pub(super) row: Option<Row>,
    /// Time at which the peer's newest row arrived, directly or through others.
    pub(super) fresh: Option<u64>,
    /// Time of the last packet from the peer itself.
    pub(super) heard: Option<u64>,
    /// Time at which the newest row arrived in which the peer states that it is connected to a quorum. Before such a
    /// row, the time at which the peer became known.
    pub(super) contact: u64,
    /// Whether the peer is served without a vote.
    pub(super) attached: bool,
    /// Whether the peer issued two different inputs for a tick, or has a different state.
    pub(super) faulty: bool,
    /// For each span whose last run did not fit in a packet, the tick at which the next run continues.
    pub(super) resumes: Vec<(u16, Tick)>,
    pub(super) link: Link,
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
            attached: false,
            faulty: false,
            resumes: Vec::new(),
            link: Link::default(),
        });
    }

    pub(super) fn follow(&mut self, view: &View, now: u64) {
        for voter in &view.voters {
            self.add(voter.id, Some(voter.key), now);
        }
        self.index(view);
    }

    fn index(&mut self, view: &View) {
        let place = |id: PeerId| self.list.iter().position(|remote| remote.id == id);
        self.voters = view.voters.iter().map(|voter| place(voter.id)).collect();
    }

    pub(super) fn bound(&mut self, view: &View) {
        while self.list.len() > PEERS_MAX {
            let silent = |(_, remote): &(usize, &Remote)| remote.fresh.max(remote.heard);
            let strangers = self.list.iter().enumerate().skip(1);
            let oldest = strangers.filter(|(_, remote)| view.voter(remote.id).is_none()).min_by_key(silent);
            let Some((place, _)) = oldest else { return };
            self.list.remove(place);
            self.index(view);
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
