use alloc::collections::VecDeque;
use alloc::vec::Vec;
use core::fmt;

use super::desync::{Desync, DesyncReport};
use super::phases::TickPhases;
use crate::lockstep::{Game, History};
use crate::replay::{CHECKPOINT_INTERVAL, Limits, RawReplay, RecordError, Recorder, Step, Verdict};

/// Records a game with hashes, saves and phase digests of its last ticks, as a [`DesyncReport`] for
/// [`bisect`](super::bisect).
///
/// A replay usually shows the second in which two engines diverge. A trace of that second, made by the engine that
/// wrote the replay, can show the tick, the phase, the body and the field.
///
/// ```
/// use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::replay::Limits;
/// use lockstep2d::report::{Evidence, Trace, bisect};
///
/// let mut trace = Trace::<Sandbox>::start(&SandboxSetup::default(), 120)?;
/// for _ in 0..300 {
///     trace.step(&[vec![]])?;
/// }
/// let file = trace.report().to_bytes();
///
/// let limits = Limits::default();
/// let evidence = Evidence::read(file, &limits).expect("a report");
/// let found = bisect::<Sandbox>(&evidence, None, &limits).expect("it can be played");
/// assert!(found.is_equal());
/// # Ok::<(), lockstep2d::replay::RecordError>(())
/// ```
pub struct Trace<G: Game> {
    game: G,
    recorder: Recorder<G>,
    replay: Vec<u8>,
    memory: Memory<G>,
}

impl<G: Game> Trace<G> {
    /// Starts a game, and keeps the data of its last `ticks` ticks.
    ///
    /// # Errors
    /// [`RecordError`] if the setup cannot start a game, or a replay cannot represent the game.
    pub fn start(setup: &G::Setup, ticks: u32) -> Result<Self, RecordError> {
        let (recorder, game) = Recorder::start(setup, CHECKPOINT_INTERVAL)?;
        let mut memory = Memory::new(ticks);
        memory.push(0, &game, TickPhases::default());
        Ok(Trace { game, recorder, replay: Vec::new(), memory })
    }

    /// The game at the current tick.
    #[must_use]
    pub fn game(&self) -> &G {
        &self.game
    }

    /// Number of ticks played.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.recorder.ticks()
    }

    /// Plays one tick with the inputs as a verifier decodes them.
    ///
    /// # Errors
    /// [`RecordError`] if the inputs cannot be recorded. The tick is not played.
    pub fn step(&mut self, inputs: &[G::Input]) -> Result<(), RecordError> {
        let inputs = self.recorder.record(inputs)?;
        let phases = TickPhases::of(&mut self.game, inputs);
        self.memory.push(self.recorder.ticks(), &self.game, phases);
        if self.recorder.is_checkpoint_due() {
            self.recorder.checkpoint(self.game.state_hash());
            self.replay.extend(self.recorder.take_bytes());
        }
        Ok(())
    }

    /// Creates the report of the last ticks, with a replay from the start.
    #[must_use]
    pub fn report(&self) -> DesyncReport {
        let replay = [self.replay.as_slice(), &self.recorder.so_far(self.game.state_hash())].concat();
        self.memory.report(&self.game, self.ticks(), replay)
    }

    /// Simulates the inputs of a replay up to tick `until`, and reports the last `ticks` ticks. Checkpoints are
    /// ignored.
    ///
    /// # Errors
    /// [`TraceError`] if the file is malformed or unverifiable, exceeds a limit, or cannot be recorded again.
    pub fn of_replay(
        file: &[u8],
        limits: &Limits,
        until: u64,
        ticks: u32,
    ) -> Result<DesyncReport, TraceError> {
        let mut raw = RawReplay::<G>::open(file, limits)?;
        let (mut recorder, _) = Recorder::<G>::start(&raw.setup()?, CHECKPOINT_INTERVAL)?;
        let mut memory = Memory::new(ticks);
        let from = until.min(raw.ticks()).saturating_sub(ticks.into());
        if from == 0 {
            memory.push(0, raw.game(), TickPhases::default());
        }
        while raw.tick() < until && raw.read_inputs()? == Step::Ticked {
            let tick = raw.tick() + 1;
            recorder.record(raw.inputs())?;
            let phases = if tick <= from {
                raw.play()?;
                TickPhases::default()
            } else {
                raw.play_with(TickPhases::of)?
            };
            if tick >= from {
                memory.push(tick, raw.game(), phases);
            }
            if recorder.is_checkpoint_due() {
                recorder.checkpoint(raw.game().state_hash());
            }
        }
        let replay = recorder.so_far(raw.game().state_hash());
        Ok(memory.report(raw.game(), raw.tick(), replay))
    }
}

struct Memory<G: Game> {
    history: History<G>,
    phases: VecDeque<(u64, TickPhases)>,
}

impl<G: Game> Memory<G> {
    fn new(ticks: u32) -> Self {
        Memory { history: History::of_ticks(ticks.saturating_add(1)), phases: VecDeque::new() }
    }

    fn push(&mut self, tick: u64, game: &G, phases: TickPhases) {
        self.history.push(tick, game.save(), game.state_hash());
        if !phases.digests.is_empty() {
            self.phases.push_back((tick, phases));
        }
        let oldest = self.history.oldest().unwrap_or(0);
        while self.phases.front().is_some_and(|(tick, _)| *tick < oldest) {
            self.phases.pop_front();
        }
    }

    fn report(&self, game: &G, tick: u64, replay: Vec<u8>) -> DesyncReport {
        let found =
            Desync { players: game.players(), tick, known: u64::MAX, seats: Vec::new(), hashes: Vec::new() };
        DesyncReport::new(&found, &self.history, replay).with_phases(self.phases.iter().cloned().collect())
    }
}

/// Reason why a replay cannot be traced.
///
/// ```
/// use lockstep2d::{lockstep::Sandbox, replay::{Limits, Verdict}};
/// use lockstep2d::report::{Trace, TraceError};
/// let result = Trace::<Sandbox>::of_replay(b"GIF89a, a picture", &Limits::default(), u64::MAX, 60);
/// assert!(matches!(result, Err(TraceError::Replay(Verdict::Malformed { offset: 0, .. }))));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TraceError {
    /// The replay cannot be played.
    Replay(Verdict),
    /// The replay cannot be recorded again.
    Record(RecordError),
}

impl fmt::Display for TraceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TraceError::Replay(verdict) => verdict.fmt(f),
            TraceError::Record(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for TraceError {}

impl From<Verdict> for TraceError {
    fn from(verdict: Verdict) -> Self {
        TraceError::Replay(verdict)
    }
}

impl From<RecordError> for TraceError {
    fn from(error: RecordError) -> Self {
        TraceError::Record(error)
    }
}
