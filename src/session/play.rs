//! Plays ticks: composes the inputs for the game, and rolls back ticks that were played with wrong inputs.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use super::config::{Fault, TIME_MAX};
use super::event::Event;
use super::id::{NEVER, PeerId, Tick};
use super::request::{InputSize, Request, TickInputs};
use super::state::Session;
use super::view::{bit, bits, has_bit};

/// Number of this peer's state hashes that are kept for comparison with those of other peers.
const HASHES_MAX: usize = 16;

#[derive(Clone, Debug)]
pub(super) struct Play {
    pub(super) played: Tick,
    pub(super) confirmed: Tick,
    /// Inputs of the ticks from `used_from` to `played`, which a rollback may play again.
    used: VecDeque<TickInputs>,
    used_from: Tick,
    /// Ticks before which the game has saved its state, ascending. The game still keeps these states.
    saves: VecDeque<Tick>,
    /// First tick whose inputs may differ from the inputs that it was played with.
    dirty: Tick,
    pub(super) requests: VecDeque<Request>,
    hashes: VecDeque<(Tick, u128)>,
    checked: Tick,
    seats: usize,
    pub(super) replayed: u64,
    pub(super) replayed_max: Tick,
}

/// Statistics of a session.
///
/// ```
/// # use lockstep2d::session::{Config, Key, PeerId, Role, Session, View};
/// use lockstep2d::session::Statistics;
/// # let view = View::opened_by(PeerId(1), Key(1), 0b01, true);
/// # let session = Session::new(Config::new(17, 1), PeerId(1), Key(1), Role::Player { seats: 1 }, view, 7)?;
/// // Text of a debug overlay.
/// let Statistics { replayed, replayed_max, peers, .. } = session.statistics();
/// let text = format!("{peers} peers, {replayed} ticks again, at most {replayed_max} at once");
/// assert_eq!(text, "1 peers, 0 ticks again, at most 0 at once");
/// # Ok::<(), lockstep2d::session::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Statistics {
    /// Number of ticks played again because of wrong guesses or changed views.
    pub replayed: u64,
    /// Largest number of ticks that one rollback played again.
    pub replayed_max: Tick,
    /// Bytes of inputs that are kept.
    pub input_bytes: usize,
    /// Number of known peers, including this one.
    pub peers: usize,
}

impl Play {
    pub(super) fn new(tick: Tick, seats: u8) -> Self {
        Play {
            played: tick,
            confirmed: tick,
            used: VecDeque::new(),
            used_from: tick,
            saves: VecDeque::new(),
            dirty: NEVER,
            requests: VecDeque::new(),
            hashes: VecDeque::new(),
            checked: tick,
            seats: usize::from(seats),
            replayed: 0,
            replayed_max: 0,
        }
    }

    pub(super) fn note_change(&mut self, tick: Tick) {
        self.dirty = self.dirty.min(tick);
    }

    pub(super) fn needed_from(&self) -> Tick {
        self.saves.front().copied().unwrap_or(self.used_from).min(self.used_from)
    }

    pub(super) fn last_hash(&self) -> Option<(Tick, u128)> {
        self.hashes.back().copied()
    }
}

impl Session {
    /// The final inputs of a tick, if they are still kept.
    #[must_use]
    pub fn final_inputs(&self, tick: Tick) -> Option<TickInputs> {
        if tick >= self.progress.fin {
            return None;
        }
        let all: Vec<usize> = (0..self.view.spans.len()).collect();
        let complete = all.iter().all(|&index| {
            let covers = self.view.spans.get(index).is_some_and(|span| span.contains(tick));
            !covers || self.log.get(index, tick).is_some()
        });
        complete.then(|| self.inputs_at(tick, &all))
    }

    /// The inputs of a tick as known now. Missing inputs are guessed.
    fn inputs_at(&self, tick: Tick, spans: &[usize]) -> TickInputs {
        let size = self.log.size();
        let bytes = alloc::vec![0; size * self.play.seats];
        let mut inputs = TickInputs { bytes, size, absent: self.config.seat_set(), guessed: 0 };
        for &index in spans {
            let Some(span) = self.view.spans.get(index).filter(|span| span.contains(tick)) else { continue };
            inputs.absent &= !bit(usize::from(span.seat));
            if let Some(input) = self.log.get(index, tick) {
                inputs.set(span.seat, input);
                continue;
            }
            inputs.guessed |= bit(usize::from(span.seat));
            if let Some(last) = self.log.next(index).checked_sub(1).and_then(|last| self.log.get(index, last))
            {
                inputs.set(span.seat, last);
            }
        }
        inputs
    }

    fn play_limit(&self) -> Tick {
        let limit = if self.view.voter(self.me).is_some() && !self.status().is_closed() {
            let guessed = self.progress.complete.saturating_add(Tick::from(self.config.guess));
            let begun = if self.view.begun { guessed } else { self.progress.complete };
            begun.min(self.progress.fin.saturating_add(Tick::from(self.config.history)))
        } else {
            self.progress.fin
        };
        limit.min(self.stop())
    }

    /// Whether to call [`advance`](Session::advance): it is time for the next tick, and this tick can be played or
    /// inputs of this peer's seats have to be issued. A closed session still plays final ticks.
    #[must_use]
    pub fn is_due(&self, now: u64) -> bool {
        self.pace.is_time(now.min(TIME_MAX)) && (self.play.played < self.play_limit() || self.issues())
    }

    pub(super) fn issues(&self) -> bool {
        !self.status().is_closed()
            && self.own_spans().any(|(index, _)| self.log.next(index) < self.issue_limit(index))
    }

    fn own_spans(&self) -> impl Iterator<Item = (usize, u8)> {
        let spans =
            self.view.spans.iter().enumerate().filter(|(_, span)| span.owner == self.me && span.is_open());
        spans.map(|(index, span)| (index, span.seat))
    }

    /// First tick for which the input of an own span may not be issued yet. At the start of a span, consecutive calls
    /// of `advance` issue the inputs of `delay + 1` ticks without waiting for further ticks, so that no peer waits for
    /// them.
    fn issue_limit(&self, span: usize) -> Tick {
        if !self.view.begun {
            return 0;
        }
        let from = self.view.spans.get(span).map_or(0, |span| span.from);
        let now = self.play.played.max(from);
        now.saturating_add(Tick::from(self.pace.delay)).saturating_add(1).min(self.stop())
    }

    /// Issues the inputs of this peer's seats, in the order of the seats, and plays a tick if possible. Call it while
    /// [`is_due`](Session::is_due). Returns whether the inputs were issued. If not, the caller may pass them again.
    ///
    /// A call issues the inputs of one tick. When the input delay grows, [`is_due`](Session::is_due) remains true:
    /// further calls issue the inputs of the additional ticks, and then the next tick is played.
    ///
    /// # Errors
    /// [`InputSize`] if `inputs` does not contain exactly one input for each own seat. In this case nothing is issued
    /// or played.
    pub fn advance(&mut self, now: u64, inputs: &[u8]) -> Result<bool, InputSize> {
        let expected = self.log.size() * usize::try_from(self.seats().count_ones()).unwrap_or(0);
        if inputs.len() != expected {
            return Err(InputSize { expected, given: inputs.len() });
        }
        let now = now.min(TIME_MAX);
        self.look(now);
        if !self.is_due(now) {
            return Ok(false);
        }
        let issued = self.issues() && self.issue(inputs);
        if issued {
            self.outbox.urgent = true;
            self.settle();
            self.agree();
            if self.issues() {
                return Ok(true);
            }
        }
        self.resolve();
        if self.play.played < self.play_limit() {
            self.play_tick();
            self.pace.played(now);
        } else {
            self.pace.blocked(now);
        }
        if issued {
            self.transmit();
        }
        Ok(issued)
    }

    fn issue(&mut self, inputs: &[u8]) -> bool {
        let own: Vec<(usize, u8)> = self.own_spans().collect();
        let seats = self.seats();
        let mut issued = false;
        for (index, seat) in own {
            let place = bits(seats).position(|other| other == seat).unwrap_or(0);
            let Some(input) = inputs.chunks_exact(self.log.size()).nth(place) else { continue };
            let tick = self.log.next(index);
            if tick < self.issue_limit(index) {
                self.log.add(index, tick, input);
                self.play.note_change(tick);
                self.peers.probe(index, tick, self.config.timing.heard, self.clock.active);
                issued = true;
            }
        }
        issued
    }

    /// Rolls back to the first tick that was played with wrong inputs, and plays the ticks from it on again. Takes back
    /// ticks after the end of the match.
    pub(super) fn resolve(&mut self) {
        let mut tick = self.play.dirty.max(self.play.used_from);
        self.play.dirty = NEVER;
        while tick < self.play.played && !self.config.has(Fault::NoRollback) {
            let known = self.inputs_at(tick, &self.progress.live);
            let place = usize::try_from(tick - self.play.used_from).unwrap_or(usize::MAX);
            let Some(used) = self.play.used.get_mut(place) else { break };
            if used.bytes == known.bytes && used.absent == known.absent {
                used.guessed = known.guessed;
            } else if known.guessed != 0 && Self::differs_in_guesses_only(used, &known) {
                // If only guesses have changed, the tick is not played again.
                used.guessed = known.guessed;
            } else {
                self.rewind(tick);
                break;
            }
            tick += 1;
        }
        if self.play.played > self.stop() {
            self.rewind(self.stop());
        }
        self.confirm();
    }

    fn differs_in_guesses_only(used: &TickInputs, known: &TickInputs) -> bool {
        let seats =
            used.bytes.chunks_exact(used.size.max(1)).zip(known.bytes.chunks_exact(known.size.max(1)));
        used.absent == known.absent
            && seats
                .enumerate()
                .all(|(seat, (used, known_input))| used == known_input || has_bit(known.guessed, seat))
    }

    /// Loads the last saved state at or before a tick, and plays the ticks from there on again with the inputs known
    /// now.
    fn rewind(&mut self, tick: Tick) {
        let limit = self.play_limit().max(self.progress.fin.min(self.play.played));
        let target = self.play.played.min(limit);
        while self.play.saves.len() > 1 && self.play.saves.back().is_some_and(|&save| save > tick.min(target))
        {
            self.play.saves.pop_back();
        }
        let Some(&save) = self.play.saves.back() else { return };
        self.play.requests.push_back(Request::Load { tick: save });
        let again = self.play.played.saturating_sub(save);
        self.play.replayed += u64::from(again);
        self.play.replayed_max = self.play.replayed_max.max(again);
        self.play.played = save;
        self.play.used.truncate(usize::try_from(save.saturating_sub(self.play.used_from)).unwrap_or(0));
        while self.play.played < target {
            self.play_tick();
        }
    }

    fn play_tick(&mut self) {
        let tick = self.play.played;
        let interval = Tick::from(self.config.save_interval);
        if (tick.is_multiple_of(interval) || self.play.saves.is_empty())
            && self.play.saves.back() != Some(&tick)
        {
            self.play.saves.push_back(tick);
            self.play.requests.push_back(Request::Save { tick });
        }
        let inputs = self.inputs_at(tick, &self.progress.live);
        self.play.used.push_back(inputs.clone());
        self.play.requests.push_back(Request::Advance { tick, inputs });
        self.play.played = tick.saturating_add(1);
    }

    /// Updates the number of played ticks that are final, and drops the saved states and inputs that no rollback needs
    /// any more.
    fn confirm(&mut self) {
        let play = &mut self.play;
        let confirmed = self.progress.fin.min(play.played);
        if confirmed <= play.confirmed {
            return;
        }
        play.confirmed = confirmed;
        let interval = Tick::from(self.config.check_interval);
        for &tick in play.saves.iter().filter(|&&save| save <= confirmed) {
            if tick > play.checked && tick.is_multiple_of(interval) {
                play.requests.push_back(Request::Checksum { tick });
                play.checked = tick;
            }
        }
        while play.saves.get(1).is_some_and(|&next| next <= confirmed) {
            play.saves.pop_front();
            if let Some(&tick) = play.saves.front() {
                play.requests.push_back(Request::Forget { tick });
            }
        }
        let keep_from = play.saves.front().copied().unwrap_or(confirmed).min(confirmed);
        while play.used_from < keep_from && play.used.pop_front().is_some() {
            play.used_from += 1;
        }
    }

    /// Takes the hash of the state that [`Request::Checksum`] has requested, and compares it with the hashes of other
    /// peers.
    pub fn report_hash(&mut self, tick: Tick, hash: u128) {
        if self.play.hashes.len() == HASHES_MAX {
            self.play.hashes.pop_front();
        }
        self.play.hashes.push_back((tick, hash));
        let others: Vec<(PeerId, u128)> = self
            .peers
            .list
            .iter()
            .skip(1)
            .filter_map(|remote| Some((remote.id, remote.row.as_ref()?.hash?)))
            .filter(|(_, (theirs, _))| *theirs == tick)
            .map(|(id, (_, theirs))| (id, theirs))
            .collect();
        for (id, theirs) in others {
            self.compare_hash(id, tick, theirs);
        }
    }

    pub(super) fn compare_hash(&mut self, peer: PeerId, tick: Tick, theirs: u128) {
        let own = self.play.hashes.iter().find(|(own, _)| *own == tick);
        let Some(&(_, ours)) = own.filter(|(_, ours)| *ours != theirs) else { return };
        let Some(remote) = self.peers.find_mut(peer).filter(|remote| !remote.faulty) else { return };
        remote.faulty = true;
        self.events.push_back(Event::Desync { peer, tick, ours, theirs });
    }
}
