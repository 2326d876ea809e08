//! Outgoing packets: this peer's row, and the changes, inputs and rows of other peers (foreign rows) that the receiver
//! lacks.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use super::config::Fault;
use super::id::{PeerId, Tick};
use super::link::stamp;
use super::packet::{Composer, Header, RESERVE, RUN_TICKS_MAX};
use super::peers::{Remote, Resume, within};
use super::row::{Row, STRANGERS_MAX};
use super::state::Session;
use super::view::has_bit;

#[derive(Clone, Debug, Default)]
pub(super) struct Outbox {
    pub(super) packets: VecDeque<(PeerId, Vec<u8>)>,
    next_at: u64,
    /// [`Session::send_interval`] at the last call of [`Session::transmit`].
    interval: u64,
    pub(super) urgent: bool,
    version: u32,
}

/// Maximum number of packets waiting to be sent. The oldest ones are dropped.
const PACKETS_MAX: usize = 4096;
/// If a receiver lacks more than this number of a peer's inputs, other peers relay them even if the receiver hears that
/// peer (gets packets from it).
const HELP_TICKS: Tick = 20;
/// Interval, in row versions, at which a peer that has no vote or hears no quorum sends to all peers that it knows.
const TRY_ROWS: u32 = 8;
/// Upper bound of [`Session::send_interval`] with up to 16 peers, in microseconds.
const INTERVAL_MAX: u64 = 100_000;
/// Bytes of the sender's id before a foreign row.
const ROW_ID_BYTES: usize = 4;
/// Maximum number of packets sent at once to a receiver that lacks more than [`HELP_TICKS`] inputs of a span.
const BURST_MAX: usize = 4;
/// Maximum number of spans that a [`Row`] lists, so that the row fits in a packet. Further spans are listed as the
/// final ticks advance.
const SPANS_LISTED: usize = 200;
/// Interval, in row versions, at which the row contains a state hash.
const HASH_ROWS: u32 = 4;

/// A run: consecutive inputs of a span for a packet.
struct Run<'a> {
    span: u16,
    /// First tick whose input the receiver lacks.
    lacks: Tick,
    /// Tick after the last input that this peer has.
    until: Tick,
    start: Tick,
    inputs: &'a [u8],
}

impl Session {
    /// Usual time between packets in microseconds: a tick, but at most [`INTERVAL_MAX`]. It is doubled with more than
    /// 16 peers, and tripled with more than 32.
    pub(super) fn send_interval(&self) -> u64 {
        let many = match self.taking_part() {
            0..=16 => 1,
            17..=32 => 2,
            _ => 3,
        };
        many * u64::from(self.config.tick_micros).min(INTERVAL_MAX)
    }

    /// Whether a peer has a vote or is served without one.
    pub(super) fn takes_part(&self, remote: &Remote) -> bool {
        remote.is_served(self.clock.active) || self.view.voter(remote.id).is_some()
    }

    pub(super) fn serves(&self, id: PeerId) -> bool {
        self.peers.find(id).is_some_and(|remote| self.takes_part(remote))
    }

    /// Number of peers that take part, including this one.
    fn taking_part(&self) -> usize {
        1 + self.peers.list.iter().skip(1).filter(|remote| self.takes_part(remote)).count()
    }

    /// Updates the fields of this peer's row that the agreement reads.
    pub(super) fn refresh_row(&mut self) {
        let Some(own) = self.peers.list.first_mut() else { return };
        let row = own.row.get_or_insert_with(|| Row::new(0));
        row.view = self.view.number;
        row.ack = self.progress.ack;
        row.fin = self.progress.fin;
        row.promised = self.agreement.promised;
        row.accepted.clone_from(&self.agreement.accepted);
        if row.wants != self.wants {
            row.wants.clone_from(&self.wants);
        }
        own.fresh = Some(self.clock.active);
        own.contact = self.clock.active;
    }

    fn renew_row(&mut self) {
        self.refresh_row();
        let version = self.outbox.version.saturating_add(1);
        self.outbox.version = version;
        let (active, timing) = (self.clock.active, self.config.timing);
        let hears = self.peers.voters_that(|remote| within(remote.heard, timing.heard, active));
        let others = self.peers.list.iter().skip(1);
        let others = others.filter(|remote| self.view.voter(remote.id).is_none());
        let others = others.filter(|remote| within(remote.heard, timing.heard, active));
        let others: Vec<PeerId> = others.map(|remote| remote.id).take(STRANGERS_MAX).collect();
        let connected = self.is_connected();
        let hash = self.play.last_hash().filter(|_| version.is_multiple_of(HASH_ROWS));
        let (played, paused, fin) = (self.play.played, self.paused, self.progress.fin);
        let Some(row) = self.peers.list.first_mut().and_then(|own| own.row.as_mut()) else { return };
        row.version = version;
        row.played = played;
        row.hears = hears;
        row.hears_others = others;
        row.connected = connected;
        row.paused = paused;
        row.hash = hash;
        row.have.clear();
        for &index in &self.progress.live {
            let (Ok(number), Some(span)) = (u16::try_from(index), self.view.spans.get(index)) else {
                continue;
            };
            if span.until > fin && row.have.len() < SPANS_LISTED {
                row.have.push((number, self.log.next(index).max(fin)));
            }
        }
    }

    pub(super) fn transmit(&mut self) {
        let now = self.clock.now;
        let interval = self.send_interval();
        self.outbox.interval = interval;
        let in_large = self.taking_part() > 16;
        let early = self.outbox.urgent && !in_large;
        if now < self.outbox.next_at && !early {
            return;
        }
        // If new inputs are about to be issued, the packets wait for them for at most one interval.
        if !early && self.is_due(now) && self.issues() && now < self.outbox.next_at.saturating_add(interval) {
            return;
        }
        self.outbox.urgent = false;
        self.outbox.next_at = now + interval;
        self.renew_row();
        let Some(own) = self.peers.list.first().and_then(|own| own.row.as_ref()) else { return };
        let mut row = Vec::with_capacity(64);
        own.write(&mut row);
        for place in 1..self.peers.list.len() {
            let mut burst = 1;
            while self.transmit_to(place, &row) && burst < BURST_MAX {
                burst += 1;
            }
        }
        while self.outbox.packets.len() > PACKETS_MAX {
            self.outbox.packets.pop_front();
        }
    }

    /// Whether packets are sent to a peer. If this peer has no vote or hears no quorum, every [`TRY_ROWS`]th row goes
    /// to all peers that it knows.
    fn is_served(&self, remote: &Remote) -> bool {
        let tries = self.outbox.version.is_multiple_of(TRY_ROWS)
            && (self.view.voter(self.me).is_none() || !self.is_connected());
        tries || self.takes_part(remote)
    }

    /// Sends a packet to a peer. Returns whether the peer is so far behind that another packet would help.
    fn transmit_to(&mut self, place: usize, own: &[u8]) -> bool {
        let Some(to) = self.peers.list.get(place).filter(|remote| self.is_served(remote)) else {
            return false;
        };
        let now = self.clock.now;
        let header = Header {
            sender: self.me,
            sequence: to.link.next_sequence,
            sent: stamp(now),
            echo: to.link.echo(now),
        };
        let mut packet = Composer::new(&header, own);
        if let Some(row) = to.row.as_ref().filter(|row| row.view < self.view.number) {
            let first = row.view.saturating_add(1);
            packet.changes(first, self.changes.since(first));
        }
        let behind = to.row.as_ref().map_or(0, |row| row.fin) < self.progress.live_from;
        let all = if behind { 0..self.view.spans.len() } else { 0..0 };
        let live = if behind { &[] } else { self.progress.live.as_slice() };
        let spans = all.chain(live.iter().copied());
        let foreign = self.foreign_rows(to);
        let mut first_row = Vec::new();
        if let Some(row) = foreign.first().and_then(|remote| remote.row.as_ref()) {
            row.write(&mut first_row);
        }
        // In every second row version, long runs leave room for a foreign row. A long run may leave no room for further
        // runs, so the next packet begins with the first run that did not fit.
        let mut runs: Vec<_> = spans.filter_map(|span| self.run_for(to, span)).collect();
        rotate_to(&mut runs, |run| run.span >= to.next_span);
        let keeps_room = self.outbox.version.is_multiple_of(2);
        let room = RESERVE + if keeps_room { ROW_ID_BYTES + first_row.len() } else { 0 };
        let parts = runs.iter().map(|run| (run.span, run.start, run.inputs));
        let ends = packet.runs(self.log.size(), room, parts);
        let resumes = next_resumes(&to.resumes, &runs, &ends, self.clock.active);
        let next_span = runs.get(ends.len()).map_or(0, |run| run.span);
        let heard = within(to.heard, self.config.timing.heard, self.clock.active);
        let is_behind = heard && is_behind(&runs, &ends);
        let rows = foreign.iter().filter_map(|remote| Some((remote.id, remote.row.as_ref()?)));
        let count = packet.foreign(rows);
        let next_row = foreign.get(count).map(|remote| remote.id);
        let id = to.id;
        let bytes = packet.finish(self.config.match_tag, id);
        if let Some(to) = self.peers.list.get_mut(place) {
            to.link.sent(bytes.len());
            (to.resumes, to.next_span, to.next_row) = (resumes, next_span, next_row);
        }
        self.outbox.packets.push_back((id, bytes));
        is_behind
    }

    /// Whether the row of `receiver` states that it hears `other`. The bits for voters count only if the row belongs to
    /// this view.
    fn hears(&self, receiver: &Remote, other: PeerId) -> bool {
        let Some(row) = receiver.row.as_ref() else { return false };
        let as_voter = self.view.voter(other).filter(|_| row.view == self.view.number);
        as_voter.is_some_and(|index| has_bit(row.hears, index)) || row.hears_others.contains(&other)
    }

    /// First tick of a span whose input the receiver lacks.
    fn lacks(&self, receiver: &Remote, index: usize) -> Tick {
        let Some(span) = self.view.spans.get(index) else { return 0 };
        let Some(row) = receiver.row.as_ref() else { return span.from };
        let listed = row.have.iter().find(|(number, _)| usize::from(*number) == index);
        match listed {
            Some(&(_, next)) => next.max(span.from),
            // The receiver does not know the span yet.
            None if span.since > row.view => span.from.max(row.fin),
            None => span.until,
        }
    }

    /// The inputs of a span for the next packet. They begin with the oldest input that the receiver lacks, or continue
    /// after the last packet if that packet had no room for all inputs. If the oldest input is assumed lost, they begin
    /// with it again. Inputs of another peer are relayed only if the receiver does not hear that peer or lacks many of
    /// its inputs. A receiver that still downloads a state has no row, and gets no inputs.
    fn run_for(&self, receiver: &Remote, index: usize) -> Option<Run<'_>> {
        let span = self.view.spans.get(index)?;
        let lacks = self.lacks(receiver, index);
        let until = self.log.next(index).min(span.until);
        let is_guest = receiver.row.is_none() && self.view.voter(receiver.id).is_none();
        if lacks >= until || span.owner == receiver.id || is_guest {
            return None;
        }
        let helps = || !self.hears(receiver, span.owner) || lacks.saturating_add(HELP_TICKS) < until;
        if span.owner != self.me && (self.config.has(Fault::NoRelay) || !helps()) {
            return None;
        }
        let number = u16::try_from(index).ok()?;
        // A receiver drops inputs after a gap. If a run is lost, the series therefore begins again.
        let patience = receiver.link.round_trip + 3 * self.outbox.interval;
        let goes_on = |resume: &&Resume| {
            let is_lost = resume.lacks == lacks && self.clock.active > resume.since.saturating_add(patience);
            !is_lost && (lacks..until).contains(&resume.tick)
        };
        let resume = receiver.resumes.iter().find(|resume| resume.span == number).filter(goes_on);
        let start = resume.map_or(lacks, |resume| resume.tick);
        let inputs = self.log.range(index, start, until.min(start.saturating_add(RUN_TICKS_MAX)))?;
        Some(Run { span: number, lacks, until, start, inputs })
    }

    /// Rows of voters and of peers that request seats, if the receiver does not hear these peers. Rows that did not fit
    /// in the last packet come first.
    fn foreign_rows(&self, receiver: &Remote) -> Vec<&Remote> {
        if self.config.has(Fault::NoRelay) {
            return Vec::new();
        }
        let (fresh, active) = (self.config.timing.fresh, self.clock.active);
        let others = self.peers.list.iter().skip(1);
        let mut rows: Vec<&Remote> = others
            .filter(|other| {
                let asks = |row: &Row| row.wants.seats.is_some();
                let matters = self.view.voter(other.id).is_some()
                    || within(other.fresh, fresh, active) && other.row.as_ref().is_some_and(asks);
                matters && other.id != receiver.id && other.row.is_some() && !self.hears(receiver, other.id)
            })
            .collect();
        rotate_to(&mut rows, |other| receiver.next_row == Some(other.id));
        rows
    }
}

/// For each span with inputs that did not fit in the last packet, the position at which the next packet continues.
/// Without these positions, each packet would repeat the same inputs until the receiver acknowledges them.
fn next_resumes(before: &[Resume], runs: &[Run], ends: &[Tick], now: u64) -> Vec<Resume> {
    let waits = |resume: &&Resume| runs.iter().skip(ends.len()).any(|run| run.span == resume.span);
    let cut = runs.iter().zip(ends).filter(|(run, end)| **end < run.until).map(|(run, &tick)| {
        let Run { span, lacks, start, .. } = *run;
        let is_series = |resume: &&Resume| resume.span == span && resume.lacks == lacks && start != lacks;
        let since = before.iter().find(is_series).map_or(now, |resume| resume.since);
        Resume { span, tick, lacks, since }
    });
    before.iter().filter(waits).copied().chain(cut).collect()
}

/// Whether the receiver lacks many inputs of a span, and some of them did not fit in the packet.
fn is_behind(runs: &[Run], ends: &[Tick]) -> bool {
    runs.iter().enumerate().any(|(index, run)| {
        let is_cut = ends.get(index).is_none_or(|&end| end < run.until);
        is_cut && run.lacks.saturating_add(HELP_TICKS) < run.until
    })
}

/// Rotates the parts of a packet so that the part selected by `is_first` comes first.
fn rotate_to<T>(parts: &mut [T], is_first: impl Fn(&T) -> bool) {
    if let Some(place) = parts.iter().position(is_first) {
        parts.rotate_left(place);
    }
}
