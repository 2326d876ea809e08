//! Processes received packets, and advances the session in time.

use super::config::{Fault, TIME_MAX};
use super::event::Event;
use super::id::{PeerId, Tick};
use super::input_log::Added;
use super::packet::{self, Packet};
use super::peers::within;
use super::row::{Removal, Row};
use super::state::Session;

/// If the known inputs of a span lead the complete ticks by more than this number of ticks, further inputs of the span
/// are dropped, so that no peer can exhaust the memory.
const INPUTS_AHEAD_MAX: Tick = 1024;

impl Session {
    /// Advances the clocks. The clock `active` advances by at most `Timing::step_max`, also after a suspension of the
    /// program.
    pub(super) fn look(&mut self, now: u64) {
        let now = now.min(TIME_MAX);
        let passed = now.saturating_sub(self.clock.now);
        self.clock.active = self.clock.active.saturating_add(passed.min(self.config.timing.step_max));
        self.clock.now = self.clock.now.max(now);
    }

    /// Processes a packet. Returns its sender; `None` if the session is closed, if the packet is malformed, belongs to
    /// another match or is for another peer, or if its sender is unknown or is this peer itself.
    pub fn receive(&mut self, now: u64, bytes: &[u8]) -> Option<PeerId> {
        self.look(now);
        if self.status().is_closed() {
            return None;
        }
        let body = packet::open(packet::seed(self.config.match_tag, self.me), bytes).ok()?;
        let packet = Packet::read(body, self.log.size()).ok()?;
        let sender = packet.header.sender;
        let (active, wall) = (self.clock.active, self.clock.now);
        let remote = self.peers.find_mut(sender).filter(|_| sender != self.me)?;
        remote.heard = Some(active);
        let header = packet.header;
        remote.link.arrived(header.sequence, header.sent, header.echo, bytes.len(), wall);
        self.take_changes(packet.changes.0, &packet.changes.1);
        self.take_row(sender, packet.row);
        for (id, row) in packet.foreign {
            self.take_foreign_row(id, row);
        }
        for run in packet.runs {
            let inputs = packet.inputs.get(run.bytes).unwrap_or_default();
            self.take_inputs(usize::from(run.span), run.start, inputs);
        }
        self.settle();
        self.agree();
        Some(sender)
    }

    fn take_changes(&mut self, first: u32, changes: &[super::view::Change]) {
        let known = self.view.number.saturating_add(1).checked_sub(first);
        let new = known.and_then(|known| usize::try_from(known).ok()).and_then(|known| changes.get(known..));
        if let Some(new) = new.filter(|new| !new.is_empty()) {
            self.install(new);
        }
    }

    fn take_row(&mut self, id: PeerId, row: Row) {
        let active = self.clock.active;
        let Some(remote) = self.peers.find_mut(id) else { return };
        if remote.row.as_ref().is_some_and(|known| known.version >= row.version) {
            return;
        }
        if !within(remote.fresh, self.config.timing.heard, active) {
            // The peer is heard again, so the vote to continue without it ends.
            self.wants.removals.retain(|removal| *removal != Removal::Without(id));
        }
        remote.fresh = Some(active);
        remote.end_probe(&row, self.config.timing.heard, active);
        if row.connected {
            remote.contact = active;
        }
        if let Some(want) = row.wants.seats {
            remote.key.get_or_insert(want.key);
        }
        if let Some(ballot) = row.promised.filter(|_| row.view == self.view.number) {
            self.agreement.round = self.agreement.round.max(ballot.round);
        }
        let hash = row.hash;
        remote.row = Some(row);
        if let Some((tick, hash)) = hash {
            self.compare_hash(id, tick, hash);
        }
    }

    /// Takes a row that another peer relays. If the row's peer is unknown, it is added only if the row requests seats.
    fn take_foreign_row(&mut self, id: PeerId, row: Row) {
        if id == self.me || self.config.has(Fault::NoRelay) {
            return;
        }
        if self.peers.find(id).is_none() {
            let active = self.clock.active;
            if row.wants.seats.is_none() || !self.peers.has_room(id, &self.view, active) {
                return;
            }
            self.peers.add(id, None, active);
        }
        self.take_row(id, row);
    }

    fn take_inputs(&mut self, index: usize, start: u32, inputs: &[u8]) {
        let Some(span) = self.view.spans.get(index) else { return };
        let owner = span.owner;
        // A peer that catches up rarely reaches this limit: a packet extends each span by at most 64 ticks.
        let far = self.progress.complete.saturating_add(INPUTS_AHEAD_MAX);
        if owner == self.me || self.log.next(index) > far.max(span.from) {
            return;
        }
        match self.log.add(index, start, inputs) {
            Added::Nothing => {}
            Added::From(tick) => self.play.note_change(tick),
            Added::Conflict(tick) => {
                let Some(remote) = self.peers.find_mut(owner).filter(|remote| !remote.faulty) else { return };
                remote.faulty = true;
                self.events.push_back(Event::Conflict { peer: owner, tick });
            }
        }
    }

    /// Advances to the time `now`. Call it every few milliseconds, and after packets have arrived.
    pub fn update(&mut self, now: u64) {
        self.look(now);
        if self.status().is_closed() {
            return;
        }
        self.settle();
        self.update_wants();
        self.agree_in_time();
        self.resolve();
        self.steer();
        self.update_status();
        self.transmit();
    }
}
