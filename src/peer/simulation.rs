//! [`Simulation`]: a game with its states and its replay, driven by the requests of a session.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use super::error::PeerError;
use super::event::PeerDesync;
use super::input_slot::InputSlot;
use crate::codec;
use crate::hash::StateHash;
use crate::lockstep::{EncodedInputs, Game, History};
use crate::replay::{RecordError, Recorder};
use crate::report::{Desync, DesyncReport};
use crate::session::{InputStatus, Request, Session, Tick, TickInputs};

pub(super) struct Simulation<G: Game> {
    pub(super) game: G,
    pub(super) tick: u64,
    pub(super) history: History<G>,
    slot: InputSlot,
    inputs: VecDeque<EncodedInputs<G::Input>>,
    first_input: u64,
    /// Number of ticks played with final inputs and, if there is a replay, recorded.
    pub(super) committed: u64,
    recorder: Option<Recorder<G>>,
    checkpoint_interval: u64,
    /// The part of the replay that has been taken, kept for reports.
    taken: Vec<u8>,
}

impl<G: Game> Simulation<G> {
    pub(super) fn start(
        setup: &G::Setup,
        checkpoint_interval: u32,
        slot: InputSlot,
    ) -> Result<Self, RecordError> {
        let (recorder, game) = Recorder::<G>::start(setup, checkpoint_interval)?;
        let mut history = History::new(&game);
        history.push(0, game.save(), game.state_hash());
        Ok(Simulation {
            game,
            tick: 0,
            history,
            slot,
            inputs: VecDeque::new(),
            first_input: 0,
            committed: 0,
            recorder: Some(recorder),
            checkpoint_interval: u64::from(checkpoint_interval).max(1),
            taken: Vec::new(),
        })
    }

    pub(super) fn set_memory(&mut self, ticks: u32) {
        if self.history.capacity() < u64::from(ticks) {
            self.history = History::of_ticks(ticks);
            self.history.push(self.tick, self.game.save(), self.game.state_hash());
        }
    }

    /// Continues from a received state. Drops the replay if the state is later than tick 0, because the earlier inputs
    /// are missing. Also drops a replay that already has ticks, because they belong to another match or to an earlier
    /// part of this match.
    pub(super) fn resume(&mut self, tick: u64, bytes: &[u8]) -> Result<(), PeerError> {
        let wrong = |why: &dyn core::fmt::Display| PeerError::State { why: alloc::format!("{why}") };
        let (hash, save): (StateHash, G::Save) = codec::decode(bytes).map_err(|error| wrong(&error))?;
        self.game.load(&save);
        if self.game.state_hash() != hash {
            return Err(wrong(&"it does not have the stated hash"));
        }
        if tick > 0 || self.committed > 0 {
            self.recorder = None;
            self.taken.clear();
        }
        self.history = History::of_ticks(u32::try_from(self.history.capacity()).unwrap_or(u32::MAX));
        self.history.push(tick, save, hash);
        (self.tick, self.first_input, self.committed) = (tick, tick, tick);
        self.inputs.clear();
        Ok(())
    }

    /// The newest state up to `tick`, as bytes for a joining peer.
    pub(super) fn state_for(&self, tick: u64) -> Option<(u64, Vec<u8>)> {
        let past = self.history.iter().rev().find(|past| past.tick <= tick)?;
        Some((past.tick, codec::encode(&(past.hash, &past.save))))
    }

    pub(super) fn fulfil(&mut self, session: &mut Session) -> Result<(), PeerError> {
        while let Some(request) = session.next_request() {
            match request {
                Request::Save { .. } => {
                    self.history.push(self.tick, self.game.save(), self.game.state_hash());
                }
                Request::Load { tick } => self.rewind(tick.into())?,
                Request::Advance { inputs, .. } => self.step(&inputs)?,
                Request::Checksum { tick } => {
                    if let Some(past) = self.history.get(tick.into()) {
                        session.report_hash(tick, past.hash.0);
                    }
                }
                Request::Forget { .. } => {}
            }
        }
        self.commit(session.confirmed())
    }

    fn rewind(&mut self, tick: u64) -> Result<(), PeerError> {
        let past = self.history.get(tick).ok_or(PeerError::NoState { tick })?;
        self.game.load(&past.save);
        self.history.truncate(tick);
        let played = tick.saturating_sub(self.first_input);
        self.inputs.truncate(usize::try_from(played).unwrap_or(usize::MAX));
        self.tick = tick;
        Ok(())
    }

    fn step(&mut self, inputs: &TickInputs) -> Result<(), PeerError> {
        let players = self.game.players();
        let of_seat = |seat: u32| {
            let (slot, status) = inputs.seat(u8::try_from(seat).ok()?)?;
            (status != InputStatus::Absent).then(|| self.slot.take(slot))
        };
        let inputs: Vec<G::Input> =
            (0..players).map(|seat| of_seat(seat).unwrap_or_else(G::absent)).collect();
        let encoded = EncodedInputs::new(&inputs, players).map_err(RecordError::Inputs)?;
        self.game.step(encoded.inputs());
        self.tick += 1;
        self.inputs.push_back(encoded);
        Ok(())
    }

    /// Commits ticks up to a total of `ticks`, which no rollback can change. If there is a replay, records them.
    fn commit(&mut self, ticks: Tick) -> Result<(), PeerError> {
        while self.committed < u64::from(ticks).min(self.tick) {
            let tick = self.committed;
            if let Some(mut recorder) = self.recorder.take() {
                let recorded = self.record(tick, &mut recorder);
                // An error must not lose the recorder.
                self.recorder = Some(recorder);
                if !recorded? {
                    break;
                }
            }
            self.committed += 1;
        }
        // Drops inputs from before the oldest state. Later inputs are needed for the end of the replay and for reports.
        let oldest = self.history.oldest().unwrap_or(0).min(self.committed);
        while self.first_input < oldest {
            self.inputs.pop_front();
            self.first_input += 1;
        }
        Ok(())
    }

    /// Records a tick. Returns `false` if the tick ends a block and the state's hash, which the checkpoint needs, is
    /// unknown.
    fn record(&self, tick: u64, recorder: &mut Recorder<G>) -> Result<bool, PeerError> {
        let place = tick.checked_sub(self.first_input).and_then(|place| usize::try_from(place).ok());
        let inputs = place.and_then(|place| self.inputs.get(place)).ok_or(PeerError::NoState { tick })?;
        let next = tick + 1;
        let hash = self.history.get(next).map(|past| past.hash);
        let hash = hash.or_else(|| (self.tick == next).then(|| self.game.state_hash()));
        if next.is_multiple_of(self.checkpoint_interval) && hash.is_none() {
            return Ok(false);
        }
        recorder.record_encoded(inputs)?;
        if let Some(hash) = hash {
            recorder.checkpoint(hash);
        }
        Ok(true)
    }

    pub(super) fn take_replay(&mut self) -> Vec<u8> {
        let bytes = self.recorder.as_mut().map(Recorder::take_bytes).unwrap_or_default();
        self.taken.extend_from_slice(&bytes);
        bytes
    }

    /// A complete replay of the committed ticks, including the bytes that have been taken.
    pub(super) fn replay_so_far(&mut self) -> Result<Vec<u8>, PeerError> {
        let Some(recorder) = self.recorder.clone() else { return Ok(Vec::new()) };
        let rest = self.read_committed(|game| recorder.finish(game))??;
        Ok([&self.taken[..], &rest].concat())
    }

    /// Calls `read` with the game after the last committed tick. Afterwards the game is at its current tick again.
    fn read_committed<R>(&mut self, read: impl FnOnce(&G) -> R) -> Result<R, PeerError> {
        if self.tick == self.committed {
            return Ok(read(&self.game));
        }
        let (now, state) = (self.tick, self.game.save());
        let found = self.play_to(self.committed).map(|()| read(&self.game));
        self.game.load(&state);
        self.tick = now;
        found
    }

    /// Ends the replay after the last committed tick. Returns the game after that tick, and the rest of the replay.
    pub(super) fn finish(mut self) -> Result<(G, Vec<u8>), PeerError> {
        self.play_to(self.committed)?;
        let replay = match self.recorder.take() {
            Some(recorder) => recorder.finish(&self.game)?,
            None => Vec::new(),
        };
        Ok((self.game, replay))
    }

    /// Restores the state after `tick` ticks, which have been played: loads the newest save up to there and plays the
    /// rest again.
    fn play_to(&mut self, tick: u64) -> Result<(), PeerError> {
        if self.tick == tick {
            return Ok(());
        }
        let past =
            self.history.iter().rev().find(|past| past.tick <= tick).ok_or(PeerError::NoState { tick })?;
        let mut at = past.tick;
        self.game.load(&past.save);
        while at < tick {
            let place = at.checked_sub(self.first_input).and_then(|place| usize::try_from(place).ok());
            let inputs =
                place.and_then(|place| self.inputs.get(place)).ok_or(PeerError::NoState { tick: at })?;
            self.game.step(inputs.inputs());
            at += 1;
        }
        self.tick = tick;
        Ok(())
    }

    /// Creates the report of a desync. The report states which seats the two peers had at the tick of the desync,
    /// because a peer may have left its seats since then.
    pub(super) fn report(
        &mut self,
        desync: &PeerDesync,
        session: Option<&Session>,
    ) -> Result<DesyncReport, PeerError> {
        let (players, tick) = (self.game.players(), desync.tick);
        let at = Tick::try_from(tick).unwrap_or(Tick::MAX);
        let [own, theirs] = session
            .map_or([0; 2], |session| [session.id(), desync.peer].map(|id| session.view().seats_at(id, at)));
        let seats = (0..players).filter(|seat| own >> seat & 1 == 1).collect();
        let hashes = (0..players).map(|seat| (theirs >> seat & 1 == 1).then_some(desync.theirs)).collect();
        let known = self.committed;
        let hash = self.read_committed(G::state_hash)?;
        let recorder = self.recorder.as_ref();
        let replay = recorder.map(|recorder| [&self.taken[..], &recorder.so_far(hash)].concat());
        let found = Desync { players, tick, known, seats, hashes };
        Ok(DesyncReport::new(&found, &self.history, replay.unwrap_or_default()))
    }
}
