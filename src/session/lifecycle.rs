//! The [`Status`] of a session.

use alloc::vec::Vec;

use super::config::Fault;
use super::event::{Event, Status};
use super::id::{PeerId, Tick};
use super::row::{Removal, SeatWant};
use super::state::{CHANGES_KEPT, Role, Session};
use super::view::{View, has_bit};

#[derive(Clone, Debug)]
pub(super) struct Lifecycle {
    pub(super) status: Status,
    /// Time at which this peer began to leave, had left, or had finished. The times for which it continues to answer
    /// (`linger`, `linger_max`) start here.
    since: Option<u64>,
    /// Whether this peer lost its vote against its will.
    dropped: bool,
    /// Whether the tie-holder or a quorum votes to kick this peer, or did so when this peer lost its vote.
    kicked: bool,
    left: bool,
    /// Cut of the view in which this peer got its vote; 0 if it had one from the start.
    voted_from: Tick,
    /// The peer that holds up the match, as last reported.
    waiting_for: Option<PeerId>,
    too_far_behind: bool,
    /// Peers that request a pause, as last reported.
    paused: Vec<PeerId>,
}

/// A stall is reported only when it lasts longer than this number of ticks.
const WAITING_TICKS: u64 = 6;

/// This peer sends its request for the end of the match this long before the end, in microseconds.
const END_NOTICE: u64 = 2_000_000;

impl Lifecycle {
    pub(super) fn new(role: Role) -> Self {
        let status = match role {
            Role::Player { .. } => Status::Joining,
            Role::Spectator => Status::Watching,
        };
        Lifecycle {
            status,
            since: None,
            dropped: false,
            kicked: false,
            left: false,
            voted_from: 0,
            waiting_for: None,
            too_far_behind: false,
            paused: Vec::new(),
        }
    }
}

impl Session {
    pub(super) fn lifecycle_after_change(&mut self, before: &View) {
        let (was, is) = (before.voter(self.me).is_some(), self.view.voter(self.me).is_some());
        if is {
            self.lifecycle.dropped = false;
            if !was {
                self.hurry();
                self.lifecycle.voted_from = self.view.cut;
            }
        } else if was {
            self.lifecycle.left = self.wants.leave;
            self.lifecycle.dropped = !self.wants.leave;
            self.lifecycle.since = None;
        }
        for remote in &mut self.peers.list {
            let (had, has) = (before.voter(remote.id).is_some(), self.view.voter(remote.id).is_some());
            if had || has {
                remote.lost_vote_at = (!has).then_some(self.clock.active);
            }
        }
        // A peer removed with `Removal::Without` may return, so the vote ends when the peer is removed.
        let view = &self.view;
        self.wants.removals.retain(|removal| match *removal {
            Removal::Without(id) => view.voter(id).is_some(),
            Removal::Kick(_) => true,
        });
    }

    pub(super) fn stop(&self) -> Tick {
        let own = self.wants.end.filter(|_| self.config.has(Fault::LocalEnd));
        own.map_or(self.view.stop(), |own| own.min(self.view.stop()))
    }

    pub(super) fn update_wants(&mut self) {
        let is_kicked = self.is_voted(|removal| *removal == Removal::Kick(self.key));
        // The rows of the voters arrive later than their view. Until all of them have arrived, `kicked` stays set.
        let is_unknown = !self.all_voters(|_| true);
        self.lifecycle.kicked = is_kicked || self.lifecycle.kicked && (self.lifecycle.dropped || is_unknown);
        let lead = self.peers.voters().filter_map(|(_, remote)| remote.row.as_ref()).map(|row| row.ack).max();
        let within = Tick::from(self.config.seat_within);
        let caught_up = lead.is_some_and(|lead| self.play.played.saturating_add(within) >= lead);
        let may_have = self.view.voter(self.me).is_none()
            && !self.wants.leave
            && !self.lifecycle.left
            && !self.lifecycle.kicked
            && self.view.end.is_none();
        let seats = match self.role {
            Role::Player { seats } => seats,
            Role::Spectator => 0,
        };
        let wants = seats > 0 && may_have && caught_up && self.is_connected();
        // The seats of a dropped peer may be taken, so this peer asks for any seats.
        let which = if self.lifecycle.dropped { 0 } else { self.config.seats_wanted };
        self.wants.seats = wants.then_some(SeatWant { seats, key: self.key, which });
        let notice =
            Tick::try_from(END_NOTICE / u64::from(self.config.tick_micros.max(1))).unwrap_or(Tick::MAX);
        let near = self.play.played.saturating_add(notice);
        // A request from a time without a vote does not end the match at once when this peer gets a seat.
        let votes = self.view.voter(self.me).is_some();
        let is_ahead = |&end: &Tick| self.view.begun && near >= end && end >= self.lifecycle.voted_from;
        self.wants.end = self.wants.end.or(self.end_at.filter(is_ahead)).filter(|_| votes);
    }

    /// Whether this peer requests seats of a match that has no room for further spans.
    pub(crate) fn is_match_used_up(&self) -> bool {
        self.wants.seats.is_some_and(|want| !self.view.has_room_for(want.seats))
    }

    /// A seat that this peer requests but that a peer with another key plays.
    pub(crate) fn taken_seat(&self) -> Option<u8> {
        let want = self.wants.seats?;
        let others = self.view.spans.iter().filter(|span| span.is_open() && span.key != self.key);
        others.map(|span| span.seat).find(|&seat| has_bit(want.which, usize::from(seat)))
    }

    pub(super) fn update_status(&mut self) {
        let status = self.determine_status();
        if status != self.lifecycle.status {
            self.lifecycle.status = status;
            self.events.push_back(Event::Status(status));
        }
        self.tell_waiting();
        self.tell_pauses();
    }

    fn determine_status(&mut self) -> Status {
        if self.lifecycle.status.is_closed() {
            return Status::Closed;
        }
        let votes = self.view.voter(self.me).is_some();
        let stop = self.stop();
        if self.progress.fin >= stop && !self.lifecycle.left {
            let since = *self.lifecycle.since.get_or_insert(self.clock.active);
            let acknowledged = || self.all_voters(|row| row.ack >= stop) && !self.awaits_return(since, stop);
            let own = self.config.has(Fault::LocalEnd);
            return if self.lingered(since, own || acknowledged()) {
                Status::Closed
            } else {
                Status::Finished { ticks: stop }
            };
        }
        if self.lifecycle.left || self.wants.leave && !votes {
            let since = *self.lifecycle.since.get_or_insert(self.clock.active);
            let known = !self.lifecycle.left || self.all_voters(|row| row.ack >= self.view.cut);
            return if self.lingered(since, known) { Status::Closed } else { Status::Left };
        }
        if self.wants.leave {
            // A minority cannot agree on a change without this peer. This peer then leaves without a change, after
            // `linger_max`.
            let since = *self.lifecycle.since.get_or_insert(self.clock.active);
            let waited = self.clock.active > since.saturating_add(self.config.timing.linger_max);
            return if waited { Status::Closed } else { Status::Leaving };
        }
        let may_want = self.lifecycle.dropped || self.role != Role::Spectator;
        match (votes, self.role) {
            (true, _) if !self.view.begun => Status::Waiting,
            (true, _) if !self.is_connected() => Status::Paused,
            (true, _) => Status::Playing,
            (false, _) if self.lifecycle.kicked && may_want => Status::Kicked,
            (false, _) if self.lifecycle.dropped => Status::Dropped,
            (false, _) if !self.is_connected() => Status::Paused,
            (false, Role::Player { .. }) => Status::Joining,
            (false, Role::Spectator) => Status::Watching,
        }
    }

    /// Whether this peer needs another contact: it has no vote, was not kicked, and has lost contact with the majority
    /// before the end of the match.
    pub(super) fn needs_contact(&self) -> bool {
        let is_over = matches!(self.status(), Status::Left | Status::Finished { .. } | Status::Closed);
        !is_over && !self.lifecycle.kicked && self.view.voter(self.me).is_none() && !self.is_connected()
    }

    /// Whether this peer may stop answering, after it has finished or left at the time `since`. `known` is true if the
    /// other peers need no more answers.
    fn lingered(&self, since: u64, known: bool) -> bool {
        let timing = &self.config.timing;
        let hasty = self.config.has(Fault::HastyLeave);
        let waited = |period: u64| hasty || self.clock.active > since.saturating_add(period);
        waited(timing.linger) && known || waited(timing.linger_max)
    }

    /// Whether a peer without the last inputs may return: it lost its vote shortly before this peer finished at the time
    /// `since`, did not leave, was not kicked, and no new process has taken its place.
    fn awaits_return(&self, since: u64, stop: Tick) -> bool {
        let number = self.view.number;
        self.peers.list.iter().skip(1).any(|remote| {
            let (row, key) = (remote.row.as_ref(), remote.key);
            let lost = remote.lost_vote_at.map(|at| at.saturating_add(self.config.timing.linger_max));
            lost.is_some_and(|until| since <= until)
                && !row.is_some_and(|row| row.wants.leave || row.view == number && row.ack >= stop)
                && !self.view.voters.iter().any(|voter| Some(voter.key) == key)
                && !self.is_voted(|removal| key.is_some_and(|key| *removal == Removal::Kick(key)))
        })
    }

    fn all_voters(&self, condition: impl Fn(&super::row::Row) -> bool) -> bool {
        let count = self.peers.rows(self.view.number).filter(|(_, _, row)| condition(row)).count();
        count == self.view.voters.len()
    }

    fn tell_waiting(&mut self) {
        let tick = u64::from(self.config.tick_micros);
        let begun = self.view.begun && self.progress.complete < self.stop();
        let still = begun
            && self.clock.active
                > self.progress.moved_at.saturating_add((WAITING_TICKS * tick).max(self.config.timing.heard));
        let peer = self.waiting_for().filter(|&peer| still && peer != self.me);
        self.tell_too_far_behind(peer.is_some());
        if peer == self.lifecycle.waiting_for {
            return;
        }
        self.lifecycle.waiting_for = peer;
        let Some(peer) = peer else {
            self.events.push_back(Event::Resumed);
            return;
        };
        let since = self.peers.find(peer).and_then(|remote| remote.fresh);
        let heard = super::peers::within(since, self.config.timing.heard, self.clock.active);
        self.events.push_back(Event::Waiting { peer, heard });
    }

    /// Reports that this peer is so far behind that the other peers may no longer keep the inputs or changes that it
    /// lacks. Runs in each update, and not only when a stall begins: after an outage, the rows that show the lag arrive
    /// later than the stall is reported.
    fn tell_too_far_behind(&mut self, waits: bool) {
        let lead = self.peers.voters().filter_map(|(_, remote)| remote.row.as_ref()).map(|row| row.fin).max();
        let behind = lead.unwrap_or(0).saturating_sub(self.progress.complete);
        let views = self.peers.list.iter().filter_map(|remote| remote.row.as_ref()).map(|row| row.view).max();
        let missed = views.unwrap_or(0).saturating_sub(self.view.number);
        let is_too_far = (waits && behind > self.config.log_ticks) || missed > u32::from(CHANGES_KEPT);
        if is_too_far && !self.lifecycle.too_far_behind {
            self.lifecycle.too_far_behind = true;
            self.events.push_back(Event::TooFarBehind);
        }
    }

    /// Reports which other voters begin or cease to request a pause. A voter that loses its vote ceases to request one.
    fn tell_pauses(&mut self) {
        let others = self.peers.voters().map(|(_, remote)| remote).filter(|remote| remote.id != self.me);
        let asking = others.filter(|remote| remote.row.as_ref().is_some_and(|row| row.paused));
        let asking: Vec<PeerId> = asking.map(|remote| remote.id).collect();
        let before = core::mem::replace(&mut self.lifecycle.paused, asking);
        let now = &self.lifecycle.paused;
        let ended = before.iter().filter(|peer| !now.contains(peer)).map(|&peer| (peer, false));
        let begun = now.iter().filter(|peer| !before.contains(peer)).map(|&peer| (peer, true));
        let events = ended.chain(begun).map(|(peer, paused)| Event::Pause { peer, paused });
        self.events.extend(events);
    }
}
