use alloc::collections::VecDeque;
use alloc::vec::Vec;
use core::fmt;

use super::desync::{Desync, DesyncReport, SAVES_BYTES_MAX};
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
        let mut memory = Memory::new(ticks, Limits::default().file_bytes);
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

    /// Creates the report of the last ticks, with a replay from the start. To fit into the default of
    /// [`Limits::file_bytes`], the report leaves out saves and the worlds at the starts of steps, the oldest first. It
    /// never leaves out the replay and the hashes.
    #[must_use]
    pub fn report(&self) -> DesyncReport {
        let replay = [self.replay.as_slice(), &self.recorder.so_far(self.game.state_hash())].concat();
        self.memory.report(&self.game, self.ticks(), replay)
    }

    /// Simulates the inputs of a replay up to tick `until`, and reports the last `ticks` ticks. Checkpoints are not
    /// compared. To fit into [`Limits::file_bytes`], the report leaves out saves and the worlds at the starts of steps,
    /// the oldest first.
    ///
    /// # Errors
    /// [`TraceError`] if the file is malformed or unverifiable, exceeds a limit, or cannot be recorded again, or if the
    /// report does not fit.
    pub fn of_replay(
        file: &[u8],
        limits: &Limits,
        until: u64,
        ticks: u32,
    ) -> Result<DesyncReport, TraceError> {
        let mut raw = RawReplay::<G>::open(file, limits)?;
        let (mut recorder, _) = Recorder::<G>::start(&raw.setup()?, raw.header().checkpoint_interval)?;
        let mut memory = Memory::new(ticks, limits.file_bytes);
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
        let (bytes, max) = (memory.bytes_without_saves(raw.game().players(), &replay), limits.file_bytes);
        if bytes > max {
            return Err(TraceError::TooLong { bytes, max });
        }
        Ok(memory.report(raw.game(), raw.tick(), replay))
    }
}

struct Memory<G: Game> {
    history: History<G>,
    phases: VecDeque<(u64, TickPhases)>,
    /// Number of entries at the front of `phases` whose world at the start of the step was dropped.
    bare: usize,
    /// Length in bytes of all worlds at the starts of steps in `phases`, at most a quarter of `bytes_max`.
    starts: usize,
    /// Maximum length of the report.
    bytes_max: u64,
}

impl<G: Game> Memory<G> {
    fn new(ticks: u32, bytes_max: u64) -> Self {
        let history = History::of_ticks(ticks.saturating_add(1));
        Memory { history, phases: VecDeque::new(), bare: 0, starts: 0, bytes_max }
    }

    fn push(&mut self, tick: u64, game: &G, phases: TickPhases) {
        self.history.push(tick, game.save(), game.state_hash());
        if !phases.digests.is_empty() {
            self.starts += phases.start_bytes();
            self.phases.push_back((tick, phases));
        }
        let oldest = self.history.oldest().unwrap_or(0);
        while self.phases.front().is_some_and(|(tick, _)| *tick < oldest)
            && let Some((_, gone)) = self.phases.pop_front()
        {
            self.starts -= gone.start_bytes();
            self.bare = self.bare.saturating_sub(1);
        }
        while self.starts as u64 > self.bytes_max / 4
            && let Some((_, old)) = self.phases.get_mut(self.bare)
        {
            self.starts -= old.start_bytes();
            old.forget_start();
            self.bare += 1;
        }
    }

    /// Upper bound of the length of a report without saves, in bytes.
    fn bytes_without_saves(&self, players: u32, replay: &[u8]) -> u64 {
        // Upper bound of the length of the envelope, the name of the rules (at most 64 bytes) and all fields of fixed
        // length.
        const FIXED: usize = 1024;
        // For each tick: 8 + 16 bytes in the history (its number and hash), and 8 + 8 bytes in the list of saves (its
        // number again, and the length of its save).
        let history = 40 * self.history.iter().count();
        let phases: usize = self.phases.iter().map(|(_, phases)| phases.bytes()).sum();
        (FIXED + replay.len() + history + phases) as u64 + 17 * u64::from(players)
    }

    fn report(&self, game: &G, tick: u64, replay: Vec<u8>) -> DesyncReport {
        let players = game.players();
        let found = Desync { players, tick, known: u64::MAX, seats: Vec::new(), hashes: Vec::new() };
        let room = self.bytes_max.saturating_sub(self.bytes_without_saves(players, &replay));
        let saves = usize::try_from(room).unwrap_or(usize::MAX).min(SAVES_BYTES_MAX);
        let report = DesyncReport::within(saves, &found, &self.history, replay);
        report.with_phases(self.phases.iter().cloned().collect())
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
    /// The report would exceed [`Limits::file_bytes`], even without saves.
    TooLong {
        /// Upper bound of the report's length in bytes.
        bytes: u64,
        /// Maximum number of bytes.
        max: u64,
    },
}

impl fmt::Display for TraceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TraceError::Replay(verdict) => verdict.fmt(f),
            TraceError::Record(error) => error.fmt(f),
            TraceError::TooLong { bytes, max } => {
                write!(f, "a report of {bytes} bytes, at most {max} are allowed: trace fewer ticks")
            }
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
