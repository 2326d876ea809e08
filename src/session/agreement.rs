//! Changes of the view: single-decree Paxos for each view number. Promises and acceptances are fields of the peers'
//! status records, which are called rows (`row.rs`).
//!
//! When a voter sees a ballot higher than all that it has promised, it promises this ballot and freezes its
//! acknowledgement (`progress.rs`). Once a quorum has promised the ballot, its proposer chooses the change
//! (`proposal.rs`). If promisers have already accepted changes, it must choose the one with the highest ballot;
//! otherwise it makes a new change. A voter accepts the change if it has promised no higher ballot and holds all inputs
//! before the cut (see below). The change is decided once a quorum of the old view has accepted it in one ballot. Each
//! peer that sees these acceptances installs the change.
//!
//! The cut is the first tick that the change may affect: the largest frozen acknowledgement of the promisers. All final
//! ticks lie before the cut, because a quorum has acknowledged them, and any two quorums have a voter in common.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::config::Fault;
use super::event::Event;
use super::peers::within;
use super::proposal::Proposal;
use super::row::Ballot;
use super::state::Session;
use super::view::{Change, View, bit, has_bit};

#[derive(Clone, Debug, Default)]
pub(super) struct Agreement {
    pub(super) promised: Option<Ballot>,
    pub(super) promised_at: u64,
    pub(super) accepted: Option<(Ballot, Arc<Change>)>,
    pub(super) proposal: Option<Proposal>,
    /// This peer starts no ballot before this time.
    pub(super) not_before: u64,
    /// Highest ballot round seen so far.
    pub(super) round: u32,
    /// Value of `round` at the start of the view.
    pub(super) base_round: u32,
    /// Time from which on this peer has wanted a change without interruption.
    pub(super) wanted_since: Option<u64>,
}

const STEPS_MAX: usize = 64;

impl Session {
    pub(super) fn agree(&mut self) {
        for _ in 0..STEPS_MAX {
            if !self.agreement_step() {
                return;
            }
        }
    }

    pub(super) fn agree_in_time(&mut self) {
        if self.view.voter(self.me).is_some() && self.agreement.proposal.is_none() {
            self.begin_ballot();
        }
        self.agree();
    }

    /// Does a step of the agreement. Returns whether another step may be possible.
    fn agreement_step(&mut self) -> bool {
        if let Some(change) = self.decided() {
            return self.install(&[(*change).clone()]);
        }
        if self.view.voter(self.me).is_none() {
            return false;
        }
        self.promise();
        self.give_up_outbid();
        if self.accept() {
            return true;
        }
        self.agreement.proposal.is_some() && self.conduct_ballot()
    }

    fn decided(&self) -> Option<Arc<Change>> {
        let mut tally: Vec<(Ballot, &Arc<Change>, u64)> = Vec::new();
        for (index, _, row) in self.peers.rows(self.view.number) {
            let Some((ballot, change)) = &row.accepted else { continue };
            match tally.iter_mut().find(|(other, _, _)| other == ballot) {
                Some((_, _, set)) => *set |= bit(index),
                None => tally.push((*ballot, change, bit(index))),
            }
        }
        let decided = tally.into_iter().find(|&(_, _, set)| self.is_quorum(set));
        decided.map(|(_, change, _)| Arc::clone(change))
    }

    fn promise(&mut self) {
        let rows = self.peers.rows(self.view.number);
        let Some(highest) = rows.filter_map(|(_, _, row)| row.promised).max() else { return };
        self.agreement.round = self.agreement.round.max(highest.round);
        if self.agreement.promised.is_none_or(|promised| highest > promised) {
            self.set_promise(highest);
        }
    }

    pub(super) fn set_promise(&mut self, ballot: Ballot) {
        self.agreement.promised = Some(ballot);
        self.agreement.promised_at = self.clock.active;
        self.refresh_row();
    }

    fn give_up_outbid(&mut self) {
        let own = self.agreement.proposal.as_ref().map(|proposal| proposal.ballot);
        if own.is_some() && own != self.agreement.promised {
            self.agreement.proposal = None;
            self.agreement.not_before = self.clock.active + self.backoff();
        }
    }

    /// Returns a random wait in microseconds, so that competing proposers do not collide again.
    pub(super) fn backoff(&mut self) -> u64 {
        let ballot = self.config.timing.ballot;
        ballot / 5 + self.random.below(ballot / 2)
    }

    fn accept(&mut self) -> bool {
        let rows = self.peers.rows(self.view.number);
        let accepted = rows.filter_map(|(_, _, row)| row.accepted.as_ref());
        let Some((ballot, change)) = accepted.max_by_key(|(ballot, _)| *ballot) else { return false };
        let promised = self.agreement.promised.is_none_or(|promised| *ballot >= promised);
        let newer = self.agreement.accepted.as_ref().is_none_or(|(own, _)| ballot > own);
        if !promised || !newer || !self.holds(change) {
            return false;
        }
        let (ballot, change) = (*ballot, Arc::clone(change));
        self.set_accepted(ballot, change);
        true
    }

    pub(super) fn holds(&self, change: &Change) -> bool {
        self.progress.complete >= change.cut || self.config.has(Fault::AcceptBlind)
    }

    pub(super) fn set_accepted(&mut self, ballot: Ballot, change: Arc<Change>) {
        if self.agreement.promised != Some(ballot) {
            self.agreement.promised_at = self.clock.active;
        }
        self.agreement.promised = Some(ballot);
        self.agreement.accepted = Some((ballot, change));
        self.refresh_row();
    }

    /// Applies decided changes if they lead to a newer view. Returns whether they do.
    pub(super) fn install(&mut self, changes: &[Change]) -> bool {
        let mut next = self.view.clone();
        for change in changes {
            let Some(changed) = next.changed_by(change) else { return false };
            next = changed;
        }
        if next.number == self.view.number {
            return false;
        }
        self.changes.extend(changes);
        let before = core::mem::replace(&mut self.view, next);
        self.tell_difference(&before);
        let agreement = &mut self.agreement;
        agreement.promised = None;
        agreement.accepted = None;
        agreement.proposal = None;
        agreement.wanted_since = None;
        agreement.base_round = agreement.round;
        self.peers.follow(&self.view, self.clock.active);
        self.log.follow(&self.view.spans);
        // Ticks that are complete but not final may be incomplete in the new view, which may have other players.
        // Therefore complete ticks are counted again, from the last final tick on.
        let (complete, moved_at) = (self.progress.complete, self.progress.moved_at);
        if !self.config.has(Fault::KeepComplete) {
            self.progress.complete = self.progress.fin;
        }
        self.progress.follow(&self.view, self.play.needed_from().min(self.progress.fin));
        self.play.note_change(self.progress.fin);
        self.lifecycle_after_change(&before);
        self.settle();
        if self.progress.complete <= complete {
            self.progress.moved_at = moved_at;
        }
        true
    }

    fn tell_difference(&mut self, before: &View) {
        self.events.push_back(Event::View { number: self.view.number });
        for (index, span) in self.view.spans.iter().enumerate() {
            let (peer, seat) = (span.owner, span.seat);
            match before.spans.get(index) {
                None => self.events.push_back(Event::Seated { peer, seat, from: span.from }),
                Some(old) if old.is_open() && !span.is_open() => {
                    self.events.push_back(Event::Unseated { peer, seat, from: span.until });
                }
                Some(_) => {}
            }
        }
        if let (None, Some(ticks)) = (before.end, self.view.end) {
            self.events.push_back(Event::End { ticks });
        }
    }

    /// Whether a quorum of the voters has fresh rows (`Timing::fresh`).
    pub(super) fn is_connected(&self) -> bool {
        let (fresh, active) = (self.config.timing.fresh, self.clock.active);
        let set =
            self.peers.voters_that(|remote| remote.id == self.me || within(remote.fresh, fresh, active));
        self.is_quorum(set)
    }

    /// Number of voters with fresh rows that come before this peer in the view. Voters of lower rank start ballots
    /// earlier.
    pub(super) fn rank(&self) -> u64 {
        let (fresh, active) = (self.config.timing.fresh, self.clock.active);
        let alive = self.peers.voters_that(|remote| within(remote.fresh, fresh, active));
        let own = self.view.voter(self.me).unwrap_or(0);
        (0..own).map(|index| u64::from(has_bit(alive, index))).sum()
    }
}
