//! Ballots of this peer: reasons to start one, and the proposed change.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::agreement::Agreement;
use super::config::Fault;
use super::id::{Key, PeerId, Tick};
use super::peers::{Remote, within};
use super::row::{Ballot, Removal, Row, SeatWant};
use super::state::Session;
use super::view::{Change, JOINS_MAX, Join, SEATS_MAX, bit, bits, has_bit};

#[derive(Clone, Debug)]
pub(super) struct Proposal {
    pub(super) ballot: Ballot,
    started_at: u64,
    /// Time at which this peer learned that a quorum has promised the ballot.
    quorum_at: Option<u64>,
    change: Option<Arc<Change>>,
}

/// The time limit of a ballot grows with each round of a view that brings no decision: linearly up to this number of
/// rounds, quadratically afterwards.
const ROUNDS_MAX: u64 = 4;
/// Upper bound of the time limit of a ballot in microseconds. If `ROUNDS_MAX` times the initial limit is larger, that
/// is the bound.
const BALLOT_MAX: u64 = 6_000_000;

impl Session {
    pub(super) fn begin_ballot(&mut self) {
        let active = self.clock.active;
        if active < self.agreement.not_before {
            return;
        }
        let rank = self.rank();
        let ballot = self.config.timing.ballot;
        let wanted = self.change_is_wanted();
        let since = if wanted { Some(*self.agreement.wanted_since.get_or_insert(active)) } else { None };
        self.agreement.wanted_since = since;
        let Agreement { promised, promised_at, round, .. } = self.agreement;
        let free = promised.is_none() || self.config.has(Fault::CompetingBallots);
        let waited = free && since.is_some_and(|since| active >= since + rank * ballot / 3);
        let stalled = free && self.is_stalled(rank);
        let stuck = promised.is_some() && active > promised_at + self.ballot_time() * (5 + rank) / 5;
        if !(stuck || waited || stalled) || !self.is_connected() {
            return;
        }
        self.agreement.round = round.saturating_add(1);
        let own = Ballot { round: self.agreement.round, proposer: self.me };
        self.set_promise(own);
        self.agreement.proposal =
            Some(Proposal { ballot: own, started_at: active, quorum_at: None, change: None });
        self.agreement.not_before = active + self.backoff();
    }

    /// Time limit of a ballot. It grows with each round of this view that brings no decision.
    fn ballot_time(&self) -> u64 {
        let ballot = self.config.timing.ballot.max(1);
        let rounds = u64::from(self.agreement.round.saturating_sub(self.agreement.base_round));
        let factor = if rounds <= ROUNDS_MAX { rounds.max(1) } else { rounds * rounds / ROUNDS_MAX };
        ballot.saturating_mul(factor).min((ballot * ROUNDS_MAX).max(BALLOT_MAX))
    }

    /// Whether to start a ballot because of a silent voter: another voter has been out of contact for `patience`, and
    /// either play has stalled for `patience` or that voter has no seat. `rank` lengthens `patience`, so that voters do
    /// not start ballots at the same time.
    fn is_stalled(&self, rank: u64) -> bool {
        let active = self.clock.active;
        let patience = self.config.timing.patience.saturating_add(rank * self.config.timing.ballot / 15);
        let stop = self.view.stop();
        if self.progress.fin >= stop {
            return false;
        }
        let stands_still = active > self.progress.moved_at.saturating_add(patience);
        self.peers.voters().any(|(_, remote)| {
            remote.id != self.me
                && active >= remote.contact.saturating_add(patience)
                && (stands_still || self.view.seats_of(remote.id) == 0)
        })
    }

    fn change_is_wanted(&self) -> bool {
        let (number, ends) = (self.view.number, self.view.end.is_some());
        let voters = self.fresh_rows().any(|(_, row)| row.wants.leave || row.wants.end.is_some() && !ends);
        let removed = || {
            let some = self.peers.rows(number).any(|(_, _, row)| !row.wants.removals.is_empty());
            some && self.view.voters.iter().any(|voter| self.is_removed(voter.id, voter.key))
        };
        let begins = || {
            let taken = !self.view.free_seats() & self.config.seat_set();
            !self.view.begun && self.may_begin(self.view.tie_holder, taken)
        };
        voters || removed() || !ends && (self.seat_wants(number).next().is_some() || begins())
    }

    /// Whether the match begins once these seats are taken. Only the tie-holder decides this, because peers may have
    /// different values of `Config::start_with`.
    fn may_begin(&self, tie_holder: PeerId, taken: u64) -> bool {
        tie_holder == self.me && taken.count_ones() >= u32::from(self.config.start_with.max(1))
    }

    /// Voters whose newest row is fresh and belongs to this view, each with this row.
    fn fresh_rows(&self) -> impl Iterator<Item = (&Remote, &Row)> {
        let (fresh, active) = (self.config.timing.fresh, self.clock.active);
        let rows = self.peers.rows(self.view.number);
        rows.filter(move |(_, remote, _)| within(remote.fresh, fresh, active))
            .map(|(_, remote, row)| (remote, row))
    }

    /// Peers without a vote to which the seats that they request may be given, each with its request.
    fn seat_wants(&self, number: u32) -> impl Iterator<Item = (PeerId, SeatWant)> {
        let (fresh, active) = (self.config.timing.fresh, self.clock.active);
        self.peers.list.iter().filter_map(move |remote| {
            let row = remote.row.as_ref().filter(|row| row.view == number)?;
            let want = row.wants.seats?;
            let may = self.view.voter(remote.id).is_none()
                && within(remote.fresh, fresh, active)
                && !remote.faulty
                && !row.wants.leave
                && !self.is_removed(remote.id, want.key)
                && !self
                    .peers
                    .voters()
                    .any(|(_, voter)| voter.key == Some(want.key) && within(voter.fresh, fresh, active));
            let fits = may && self.may_add(want, 0, 0) && self.seats_for(want, self.free_after(0)).is_some();
            fits.then_some((remote.id, want))
        })
    }

    /// Whether a view has room for another voter with these seats, after the voters in `leaves` and in `replaced` have
    /// left and `joined` other voters have joined.
    fn may_add(&self, want: SeatWant, leaves: u64, joined: usize) -> bool {
        let gone = usize::try_from((leaves | self.replaced()).count_ones()).unwrap_or(0);
        self.view.voters.len().saturating_sub(gone) + joined < SEATS_MAX && self.view.has_room_for(want.seats)
    }

    /// Bit for each silent voter whose key another incarnation uses to request seats.
    fn replaced(&self) -> u64 {
        let (fresh, active) = (self.config.timing.fresh, self.clock.active);
        let number = self.view.number;
        let wanted = |key: Key| {
            self.peers.list.iter().any(|remote| {
                let row = remote.row.as_ref().filter(|row| row.view == number);
                let wants = row.and_then(|row| row.wants.seats).is_some_and(|want| want.key == key);
                wants && self.view.voter(remote.id).is_none() && within(remote.fresh, fresh, active)
            })
        };
        let silent = |remote: &Remote| remote.id != self.me && !within(remote.fresh, fresh, active);
        self.peers.voters_that(|remote| silent(remote) && remote.key.is_some_and(wanted))
    }

    /// Bit for each seat that is free once the voters in `leaves` and in `replaced` are gone.
    fn free_after(&self, leaves: u64) -> u64 {
        let leaves = leaves | self.replaced();
        let voters = self.view.voters.iter().enumerate();
        let kept = voters.filter(|(index, _)| !has_bit(leaves, *index)).map(|(_, voter)| voter.id);
        let taken = kept.fold(0, |set, id| set | self.view.seats_of(id));
        self.config.seat_set() & !taken
    }

    /// Whether the tie-holder or a quorum votes to remove a peer.
    pub(super) fn is_removed(&self, id: PeerId, key: Key) -> bool {
        self.is_voted(|removal| [Removal::Without(id), Removal::Kick(key)].contains(removal))
    }

    /// Whether the tie-holder or a quorum votes for a removal that satisfies `is_meant`.
    pub(super) fn is_voted(&self, is_meant: impl Fn(&Removal) -> bool) -> bool {
        let mut set = 0;
        for (index, remote, row) in self.peers.rows(self.view.number) {
            if row.wants.removals.iter().any(&is_meant) {
                set |= bit(index);
                if remote.id == self.view.tie_holder {
                    return true;
                }
            }
        }
        self.is_quorum(set)
    }

    /// Chooses seats for a joining peer among the `free` seats. If it requests certain seats, only these are
    /// considered. Seats that its key had before come first, then seats that nobody had, then other seats. `None` if
    /// there are too few.
    fn seats_for(&self, want: SeatWant, free: u64) -> Option<u64> {
        let SeatWant { seats: count, key, which } = want;
        let free = if which == 0 { free } else { free & which };
        let mut own = 0;
        let mut had = 0;
        for span in &self.view.spans {
            had |= bit(usize::from(span.seat));
            own |= if span.key == key { bit(usize::from(span.seat)) } else { 0 };
        }
        let ordered = [free & own, free & !had, free & had & !own];
        let chosen = ordered.into_iter().flat_map(bits).take(usize::from(count));
        let chosen = chosen.fold(0, |set, seat| set | bit(usize::from(seat)));
        (count > 0 && chosen.count_ones() == u32::from(count)).then_some(chosen)
    }

    /// Performs the next step of this peer's ballot, if it is possible. Returns whether another step may be possible at
    /// once.
    pub(super) fn conduct_ballot(&mut self) -> bool {
        let Some(mut proposal) = self.agreement.proposal.take() else { return false };
        let active = self.clock.active;
        if proposal.change.is_none() {
            let promisers = self.promisers(proposal.ballot);
            if self.is_quorum(promisers) {
                let since = *proposal.quorum_at.get_or_insert(active);
                let all = promisers.count_ones() >= u32::try_from(self.view.voters.len()).unwrap_or(u32::MAX);
                if all || active >= since + self.config.timing.promises {
                    proposal.change = Some(self.choose_change(proposal.ballot));
                }
            }
        }
        let is_new = self.agreement.accepted.as_ref().is_none_or(|(own, _)| *own < proposal.ballot);
        if let Some(change) = proposal.change.clone().filter(|change| is_new && self.holds(change)) {
            let ballot = proposal.ballot;
            self.agreement.proposal = Some(proposal);
            self.set_accepted(ballot, change);
            return true;
        }
        if active > proposal.started_at + 2 * self.ballot_time() {
            self.agreement.not_before = active + self.backoff();
            self.agreement.promised_at = active;
        } else {
            self.agreement.proposal = Some(proposal);
        }
        false
    }

    fn promisers(&self, ballot: Ballot) -> u64 {
        let rows = self.peers.rows(self.view.number);
        rows.filter(|(_, _, row)| row.promised == Some(ballot)).fold(0, |set, (index, _, _)| set | bit(index))
    }

    /// The change that promisers have accepted in the highest ballot, or a new change if they have accepted none.
    fn choose_change(&self, ballot: Ballot) -> Arc<Change> {
        let promisers = self.promisers(ballot);
        let rows = || self.peers.rows(self.view.number).filter(|(index, _, _)| has_bit(promisers, *index));
        let accepted =
            rows().filter_map(|(_, _, row)| row.accepted.as_ref()).max_by_key(|(ballot, _)| *ballot);
        if let Some((_, change)) = accepted.filter(|_| !self.config.has(Fault::ForgetAccepted)) {
            return Arc::clone(change);
        }
        let mut cut = rows().map(|(_, _, row)| row.ack).max().unwrap_or(0);
        if self.config.has(Fault::OwnCut) {
            cut = self.progress.ack;
        }
        Arc::new(self.new_change(promisers, cut.max(self.view.cut)))
    }

    fn new_change(&self, promisers: u64, cut: Tick) -> Change {
        let mut leaves = self.leaving(promisers) | self.replaced();
        let mut end = self.view.end;
        let keeps = |leaves: u64| {
            self.view.voters.iter().enumerate().filter(move |(index, _)| !has_bit(leaves, *index))
        };
        if keeps(leaves).next().is_none() {
            // If all voters leave, the match ends, and the proposer remains a voter.
            end = end.or(Some(cut));
            leaves &= !self.view.voter(self.me).map_or(0, bit);
        }
        let wanted = self.fresh_rows().filter_map(|(_, row)| row.wants.end).max();
        end = end.or(wanted.map(|wanted| wanted.max(cut)));
        let joins = if end.is_some() { Vec::new() } else { self.joins(leaves) };
        let stays = |id: PeerId| keeps(leaves).any(|(_, voter)| voter.id == id);
        let tie_holder = if stays(self.view.tie_holder) {
            self.view.tie_holder
        } else {
            keeps(leaves).next().map_or(self.me, |(_, voter)| voter.id)
        };
        let taken = keeps(leaves).fold(0, |set, (_, voter)| set | self.view.seats_of(voter.id));
        let taken = joins.iter().fold(taken, |set, join| set | join.seats);
        let begun = self.view.begun || self.may_begin(tie_holder, taken) || end.is_some();
        let lead = if self.view.begun { self.seat_lead(&joins) } else { 0 };
        Change { cut, end, begun, leaves, tie_holder, joins, from: cut.saturating_add(lead) }
    }

    /// Number of ticks from the cut to the first tick of joining peers. It leaves time for the round trips of promises
    /// and acceptances, and for the first inputs to arrive.
    fn seat_lead(&self, joins: &[Join]) -> Tick {
        let matters = |remote: &&Remote| {
            self.view.voter(remote.id).is_some() || joins.iter().any(|join| join.id == remote.id)
        };
        let round_trips = self.peers.list.iter().filter(matters).map(|remote| remote.link.round_trip);
        let ticks = 3 * round_trips.max().unwrap_or(0) / u64::from(self.config.tick_micros.max(1));
        let lead = Tick::from(self.config.seat_lead);
        lead.saturating_add(Tick::try_from(ticks).unwrap_or(0))
            .min(Tick::from(self.config.history / 2).max(lead))
    }

    /// Bit for each voter that leaves with the change: it wants to leave, votes remove it, or it has not promised the
    /// ballot and has been out of contact for `patience`.
    fn leaving(&self, promisers: u64) -> u64 {
        let active = self.clock.active;
        let number = self.view.number;
        let gone = |index: usize, remote: &Remote| {
            let silent = active >= remote.contact.saturating_add(self.config.timing.patience);
            !has_bit(promisers, index) && (silent || self.config.has(Fault::Accuse))
        };
        let leaves = |remote: &Remote| {
            remote.row.as_ref().is_some_and(|row| row.view == number && row.wants.leave)
                || remote.key.is_some_and(|key| self.is_removed(remote.id, key))
        };
        let voters = self.peers.voters();
        voters
            .filter(|(index, remote)| gone(*index, remote) || leaves(remote))
            .fold(0, |set, (index, _)| set | bit(index))
    }

    fn joins(&self, leaves: u64) -> Vec<Join> {
        let mut joins: Vec<Join> = Vec::new();
        let mut free = self.free_after(leaves);
        for (id, want) in self.seat_wants(self.view.number) {
            // One process gets the seats, even if several use the same key.
            if joins.iter().any(|join| join.key == want.key) {
                continue;
            }
            if joins.len() == JOINS_MAX || !self.may_add(want, leaves, joins.len()) {
                break;
            }
            if let Some(seats) = self.seats_for(want, free) {
                free &= !seats;
                joins.push(Join { id, key: want.key, seats });
            }
        }
        joins
    }
}
