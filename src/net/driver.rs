//! [`Driver`]: executes the requests of a GGRS session.

use alloc::collections::VecDeque;
use alloc::vec;
use alloc::vec::Vec;

use ggrs::{Frame, GgrsRequest, InputStatus};
use serde::{Serialize, de::DeserializeOwned};

use super::error::DriverError;
use super::wire::{Address, ChecksumReport, GgrsConfig, NetGame, Wire};
use crate::hash::StateHash;
use crate::lockstep::{EncodedInputs, Game, History};
use crate::replay::{RecordError, Recorder};
use crate::report::{Desync, DesyncReport};

/// Number of seconds for which inputs are kept for late joiners.
const KEPT_SECONDS: u64 = 60;

/// A peer had another state after a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Divergence {
    /// Number of ticks played.
    pub tick: u64,
    /// Seat of the peer whose hash differs.
    pub seat: u32,
    /// Hash of this peer.
    pub ours: StateHash,
    /// Hash of the other peer.
    pub theirs: StateHash,
}

/// A game, its recent states and its replay, driven by the requests of a GGRS session of any kind: peer to peer,
/// spectator or sync test.
///
/// The inputs of a tick are written to the replay after [`Driver::commit`] has declared that no rollback will change
/// them.
///
/// ```
/// use ggrs::{PlayerType, SessionBuilder};
/// use lockstep2d::net::{Driver, GgrsConfig};
/// # use lockstep2d::{hash::StateHash, lockstep::{Game, RulesId, SetupError}};
/// # #[derive(Clone)] struct Sum(u64);
/// # impl Game for Sum {
/// #     type Setup = ();
/// #     type Input = u8;
/// #     type Save = u64;
/// #     const RULES: RulesId = RulesId { name: "sum", version: 1 };
/// #     fn new(_: &()) -> Result<Self, SetupError> { Ok(Sum(0)) }
/// #     fn players(&self) -> u32 { 1 }
/// #     fn tick_rate(&self) -> u32 { 60 }
/// #     fn step(&mut self, inputs: &[u8]) { self.0 = self.0 * 31 + u64::from(inputs[0]) }
/// #     fn state_hash(&self) -> StateHash { StateHash::of(&self.0) }
/// #     fn save(&self) -> u64 { self.0 }
/// #     fn load(&mut self, save: &u64) { self.0 = *save }
/// #     fn work(&self, _: &[u8]) -> u64 { 1 }
/// # }
///
/// // Does the game come to the same states when it is rolled back and played again?
/// let mut session = SessionBuilder::<GgrsConfig<Sum, u8>>::new()
///     .with_num_players(1)?
///     .add_player(PlayerType::Local, 0)?
///     .with_check_distance(7)
///     .start_synctest_session()?;
/// let mut driver = Driver::<Sum>::start(&(), 60)?;
/// for pad in 0..10 {
///     session.add_local_input(0, driver.local_input(pad))?;
///     driver.fulfil(session.advance_frame()?)?;
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Driver<G: Game> {
    game: G,
    /// Number of ticks that the game has played.
    tick: u64,
    /// Tick of the session's frame 0.
    base: u64,
    /// Seat of each of the session's players.
    seats: Vec<u32>,
    history: History<G>,
    /// Inputs of the ticks from `first_input` on.
    inputs: VecDeque<EncodedInputs<G::Input>>,
    first_input: u64,
    /// Number of ticks whose inputs are final.
    committed: u64,
    recorder: Option<Recorder<G>>,
    /// The part of the replay that has been taken, kept for reports.
    taken: Vec<u8>,
    /// Interval in ticks between the hashes that inputs carry, if they carry any.
    echo_interval: Option<u64>,
    divergences: Vec<Divergence>,
    /// Checksum reports received from the seats, newest last.
    heard: VecDeque<(u32, ChecksumReport)>,
}

/// Number of checksum reports that are kept per seat.
const HEARD: usize = 16;

impl<G: NetGame> Driver<G> {
    /// Starts the game and its replay; every seat is a player of the session, in order.
    ///
    /// # Errors
    /// [`RecordError`] when the setup cannot start a game, or when a replay cannot represent that game.
    pub fn start(setup: &G::Setup, checkpoint_interval: u32) -> Result<Self, RecordError> {
        let (recorder, game) = Recorder::start(setup, checkpoint_interval)?;
        Ok(Driver { recorder: Some(recorder), ..Self::of(game, 0) })
    }

    /// Continues a game that others have played up to `tick`. It has no replay, because the earlier inputs are unknown.
    #[must_use]
    pub fn resume(game: G, tick: u64) -> Self {
        Self::of(game, tick)
    }

    fn of(game: G, tick: u64) -> Self {
        let mut history = History::new(&game);
        history.push(tick, game.save(), game.state_hash());
        Driver {
            seats: (0..game.players()).collect(),
            game,
            tick,
            base: tick,
            history,
            inputs: VecDeque::new(),
            first_input: tick,
            committed: tick,
            recorder: None,
            taken: Vec::new(),
            echo_interval: None,
            divergences: Vec::new(),
            heard: VecDeque::new(),
        }
    }

    /// Makes inputs carry the hash of every `interval`-th tick. This is needed for sessions without prediction, which
    /// never compare checksums.
    #[must_use]
    pub fn with_echo(mut self, interval: u64) -> Self {
        self.echo_interval = Some(interval.max(1));
        self
    }

    /// Keeps the states of at least this many ticks. Must be called before the first tick.
    pub(super) fn set_memory(&mut self, ticks: u32) {
        if self.history.capacity() < u64::from(ticks) {
            self.history = History::of_ticks(ticks);
            self.history.push(self.tick, self.game.save(), self.game.state_hash());
        }
    }

    /// The current state of the game, which may depend on predicted inputs.
    #[must_use]
    pub const fn game(&self) -> &G {
        &self.game
    }

    /// Number of ticks played, including predicted ones.
    #[must_use]
    pub const fn tick(&self) -> u64 {
        self.tick
    }

    /// Number of final ticks.
    #[must_use]
    pub const fn committed(&self) -> u64 {
        self.committed
    }

    /// The recent states.
    #[must_use]
    pub const fn history(&self) -> &History<G> {
        &self.history
    }

    /// The tick of a frame of the session.
    #[must_use]
    pub fn tick_of(&self, frame: Frame) -> u64 {
        self.base + u64::try_from(frame).unwrap_or(0)
    }

    /// Converts a local player's input for a session: encoded and decoded, and in lockstep with a hash.
    #[must_use]
    pub fn local_input(&self, input: G::Input) -> Wire<G::Input> {
        Wire { input: canonical(input).unwrap_or_default(), checksum: self.checksum().unwrap_or_default() }
    }

    fn checksum(&self) -> Option<ChecksumReport> {
        let interval = self.echo_interval?;
        let tick = self.tick - self.tick % interval;
        Some(ChecksumReport { tick, hash: self.history.get(tick)?.hash })
    }

    /// Executes the requests of a session in order.
    ///
    /// # Errors
    /// [`DriverError`] when a request is impossible. A GGRS session that plays this game makes no such requests.
    pub fn fulfil<A: Address>(
        &mut self,
        requests: Vec<GgrsRequest<GgrsConfig<G, A>>>,
    ) -> Result<(), DriverError> {
        for request in requests {
            match request {
                GgrsRequest::SaveGameState { cell, frame } => {
                    let tick = self.tick_of(frame);
                    let moment = self.history.get(tick).ok_or(DriverError::NoState { tick })?;
                    cell.save(frame, None, Some(moment.hash.0));
                }
                GgrsRequest::LoadGameState { frame, .. } => self.rewind(self.tick_of(frame))?,
                GgrsRequest::AdvanceFrame { inputs } => self.advance(&inputs)?,
            }
        }
        Ok(())
    }

    /// Restores the state after `tick` ticks.
    fn rewind(&mut self, tick: u64) -> Result<(), DriverError> {
        let moment = self.history.get(tick).ok_or(DriverError::NoState { tick })?;
        self.game.load(&moment.save);
        self.history.truncate(tick);
        let played = tick.saturating_sub(self.first_input);
        self.inputs.truncate(usize::try_from(played).unwrap_or(usize::MAX));
        self.tick = tick;
        Ok(())
    }

    fn advance(&mut self, inputs: &[(Wire<G::Input>, InputStatus)]) -> Result<(), DriverError> {
        if inputs.len() != self.seats.len() {
            let (seated, inputs) = (self.seats.len() as u64, inputs.len() as u64);
            return Err(DriverError::Players { seated, inputs });
        }
        let of_all_seats = |change: fn(G::Input) -> G::Input| {
            let mut of_seat = vec![G::absent(); self.game.players() as usize];
            for (seat, (wire, status)) in self.seats.iter().zip(inputs) {
                let Some(input) = of_seat.get_mut(*seat as usize) else { continue };
                if *status != InputStatus::Disconnected {
                    *input = change(wire.input);
                }
            }
            of_seat
        };
        // An input that does not survive its encoding counts as the default, with every peer.
        let encoded = self
            .encode(&of_all_seats(|input| input))
            .or_else(|_| self.encode(&of_all_seats(|input| canonical(input).unwrap_or_default())))?;
        self.step_encoded(encoded);
        for (at, (wire, _)) in inputs.iter().enumerate() {
            self.receive(self.seats[at], wire.checksum);
        }
        Ok(())
    }

    /// Receives the hash that a seat's peer had after a tick. Hashes inside inputs are received automatically. With a
    /// session of your own, pass on the data of `GgrsEvent::DesyncDetected`.
    pub fn receive(&mut self, seat: u32, checksum: ChecksumReport) {
        if checksum.tick == 0 || self.heard.contains(&(seat, checksum)) {
            return;
        }
        if self.heard.len() == HEARD * self.seats.len() {
            self.heard.pop_front();
        }
        self.heard.push_back((seat, checksum));
        let Some(ours) = self.history.get(checksum.tick).map(|past| past.hash) else { return };
        if ours != checksum.hash {
            self.divergences.push(Divergence { tick: checksum.tick, seat, ours, theirs: checksum.hash });
        }
    }

    /// Plays a tick with the inputs of all seats.
    ///
    /// # Errors
    /// [`DriverError`] when there is not exactly one input per seat.
    pub fn step(&mut self, inputs: &[G::Input]) -> Result<(), DriverError> {
        let inputs = self.encode(inputs)?;
        self.step_encoded(inputs);
        Ok(())
    }

    fn encode(&self, inputs: &[G::Input]) -> Result<EncodedInputs<G::Input>, DriverError> {
        let encoded = EncodedInputs::new(inputs, self.game.players());
        encoded.map_err(|error| DriverError::Record(RecordError::Inputs(error)))
    }

    /// Plays a tick with the inputs of all seats, of which there must be one for each.
    pub(super) fn step_encoded(&mut self, inputs: EncodedInputs<G::Input>) {
        self.game.step(inputs.inputs());
        self.tick += 1;
        self.history.push(self.tick, self.game.save(), self.game.state_hash());
        self.inputs.push_back(inputs);
    }

    /// Returns the divergences detected since the last call.
    pub fn take_divergences(&mut self) -> Vec<Divergence> {
        core::mem::take(&mut self.divergences)
    }

    /// Declares that the first `ticks` ticks will not be rolled back any more: their inputs go into the replay.
    ///
    /// # Errors
    /// [`DriverError::Record`] when the replay cannot represent them.
    pub fn commit(&mut self, ticks: u64) -> Result<(), DriverError> {
        while self.committed < ticks.min(self.tick) {
            let tick = self.committed;
            if let Some(mut recorder) = self.recorder.take() {
                let recorded = self.record(tick, &mut recorder);
                // The ticks recorded so far are kept.
                self.recorder = Some(recorder);
                recorded?;
            }
            self.committed += 1;
        }
        let kept = KEPT_SECONDS * u64::from(self.game.tick_rate());
        while self.first_input + kept < self.committed {
            self.inputs.pop_front();
            self.first_input += 1;
        }
        Ok(())
    }

    fn record(&self, tick: u64, recorder: &mut Recorder<G>) -> Result<(), DriverError> {
        let inputs = self.inputs_of(tick).ok_or(DriverError::NoState { tick })?;
        recorder.record_encoded(inputs).map_err(DriverError::Record)?;
        if recorder.is_checkpoint_due() {
            let tick = tick + 1;
            let moment = self.history.get(tick).ok_or(DriverError::NoState { tick })?;
            recorder.checkpoint(moment.hash);
        }
        Ok(())
    }

    /// The inputs of all seats in a tick, if they are kept.
    pub(super) fn inputs_of(&self, tick: u64) -> Option<&EncodedInputs<G::Input>> {
        self.inputs.get(usize::try_from(tick.checked_sub(self.first_input)?).ok()?)
    }

    /// Continues from tick `base` with a new session, whose players have these seats.
    ///
    /// # Errors
    /// [`DriverError::NoState`] when the state of that tick is not kept.
    pub fn restart(&mut self, base: u64, seats: Vec<u32>) -> Result<(), DriverError> {
        self.rewind(base)?;
        // Reports about later ticks refer to states that have been rolled back.
        self.heard.retain(|(_, checksum)| checksum.tick <= base);
        self.base = base;
        self.seats = seats;
        Ok(())
    }

    /// Takes the finished bytes of the replay, to be appended to its file. Every byte is returned once. Empty without a
    /// replay.
    #[must_use]
    pub fn take_replay(&mut self) -> Vec<u8> {
        let bytes = self.recorder.as_mut().map(Recorder::take_bytes).unwrap_or_default();
        self.taken.extend_from_slice(&bytes);
        bytes
    }

    /// Creates this peer's report of a divergence, to be written to a file. Given two reports, `diff` tells which peer
    /// diverged, when and where.
    ///
    /// `seats` are played by this peer; `known` ticks have been simulated with the confirmed inputs of all players.
    #[must_use]
    pub fn report(&self, divergence: &Divergence, seats: Vec<u32>, known: u64) -> DesyncReport {
        let players = self.game.players();
        let said = |seat| {
            let said =
                self.heard.iter().find(|(of, checksum)| *of == seat && checksum.tick == divergence.tick);
            said.map(|(_, checksum)| checksum.hash).or((seat == divergence.seat).then_some(divergence.theirs))
        };
        let hashes = (0..players).map(said).collect();
        let known = known.clamp(self.committed, self.tick);
        let found = Desync { players, tick: divergence.tick, known, seats, hashes };
        DesyncReport::new(&found, &self.history, self.replay_so_far(known).unwrap_or_default())
    }

    /// The replay with the inputs of the first `known` ticks, some of which may not be committed.
    fn replay_so_far(&self, known: u64) -> Option<Vec<u8>> {
        let mut recorder = self.recorder.clone()?;
        for tick in self.committed..known {
            self.record(tick, &mut recorder).ok()?;
        }
        let state = self.history.get(known)?.hash;
        Some([&self.taken[..], &recorder.so_far(state)].concat())
    }

    /// Ends the replay after the last committed tick, and returns the bytes that have not been taken yet.
    ///
    /// # Errors
    /// [`DriverError`] when the state after that tick is not kept, or the game's claims cannot be recorded.
    pub fn finish(mut self) -> Result<Vec<u8>, DriverError> {
        self.rewind(self.committed)?;
        let recorder = self.recorder.take();
        recorder.map_or(Ok(Vec::new()), |recorder| recorder.finish(&self.game).map_err(DriverError::Record))
    }
}

/// Encodes and decodes an input.
fn canonical<I: Copy + Serialize + DeserializeOwned>(input: I) -> Option<I> {
    EncodedInputs::new(&[input], 1).ok()?.inputs().first().copied()
}
