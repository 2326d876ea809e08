//! [`Recording`]: a game recorded while it is played. Play can continue from any recorded tick with new inputs.

mod history;

use std::fmt;

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{EncodedInputs, Game, InputError, InputLog};
use lockstep2d::replay::{CHECKPOINT_INTERVAL, Limits, RecordError, Recorder};

use history::History;

/// Interval between saves, in ticks.
const SAVE_INTERVAL: u64 = 4;
/// Memory budget of the saves, in bytes.
const SAVES_BYTES: usize = 256 << 20;

/// A game, and the recording of all its inputs. *Tick t* is the state after *t* ticks.
///
/// [`Recording::replay_tick`] plays the next tick with the recorded inputs. [`Recording::play`] plays it with new
/// inputs, and drops all recorded ticks after the current one.
pub(crate) struct Recording<G: Game> {
    game: G,
    tick: u64,
    /// The recorder before the first tick. When recorded ticks are dropped, a copy of this recorder records the
    /// remaining ones again.
    blank: Recorder<G>,
    recorder: Recorder<G>,
    log: InputLog<G::Input>,
    /// State hashes at the checkpoints.
    checkpoints: Vec<StateHash>,
    /// Sum of the work units of the recorded ticks up to each tick.
    work: Vec<u64>,
    history: History<G::Save>,
    /// Returns the number of bytes that a save does not share with other saves. The game must be in the saved state.
    weigh: fn(&G, &G::Save) -> usize,
    /// State after the last recorded tick. `None` if the game is at this tick.
    end: Option<G::Save>,
    /// The limits with which the replay will be verified.
    limits: Limits,
}

#[derive(Debug, PartialEq, Eq)]
pub(crate) enum RecordingError {
    NoSuchTick {
        tick: u64,
        ticks: u64,
    },
    /// [`Game::work`] of the tick exceeds the limit of a verifier.
    TooMuch,
    Record(RecordError),
    Log(InputError),
    /// Playing a tick again gave another hash, because saving and loading this game loses state.
    Forgetful {
        tick: u64,
    },
}

impl<G: Game> Recording<G> {
    /// Starts a game. `weigh` returns the number of bytes that a save does not share with other saves.
    pub(crate) fn start(setup: &G::Setup, weigh: fn(&G, &G::Save) -> usize) -> Result<Self, RecordError> {
        let (recorder, game) = Recorder::<G>::start(setup, CHECKPOINT_INTERVAL)?;
        Ok(Recording {
            tick: 0,
            blank: recorder.clone(),
            recorder,
            log: InputLog::new(game.players()),
            checkpoints: Vec::new(),
            work: Vec::new(),
            history: History::new(game.save(), SAVES_BYTES),
            weigh,
            end: None,
            limits: Limits::default(),
            game,
        })
    }

    /// Sets the limits with which the replay will be verified.
    pub(crate) fn limited(self, limits: Limits) -> Self {
        Recording { limits, ..self }
    }

    pub(crate) fn game(&self) -> &G {
        &self.game
    }

    pub(crate) fn tick(&self) -> u64 {
        self.tick
    }

    /// Number of recorded ticks.
    pub(crate) fn ticks(&self) -> u64 {
        self.log.ticks()
    }

    pub(crate) fn is_at_end(&self) -> bool {
        self.tick == self.ticks()
    }

    /// Text for the end of the status line. If the recorded work exceeds `total_work` of the limits, the text tells the
    /// user to verify with a `--max-work` above this work. The limit may have to be even larger, because a verifier
    /// also counts the work of the setup, and work that becomes known only while a tick runs.
    pub(crate) fn limit_hint(&self) -> String {
        match self.work.last() {
            Some(&work) if work > self.limits.total_work => {
                format!(" · verify it with --max-work above {work}")
            }
            _ => String::new(),
        }
    }

    /// Plays and records the next tick. First drops the recorded ticks after the current one.
    pub(crate) fn play(&mut self, inputs: &[G::Input]) -> Result<(), RecordingError> {
        let work = self.game.work(inputs);
        if work > self.limits.tick_work {
            return Err(RecordingError::TooMuch);
        }
        if !self.is_at_end() {
            self.cut()?;
        }
        let inputs = EncodedInputs::new(inputs, self.game.players())
            .map_err(|error| RecordingError::Record(RecordError::Inputs(error)))?;
        self.recorder.record_encoded(&inputs).map_err(RecordingError::Record)?;
        let inputs = self.log.push_encoded(&inputs).map_err(RecordingError::Log)?;
        self.work.push(self.work.last().map_or(work, |before| before.saturating_add(work)));
        self.game.step(inputs);
        self.tick += 1;
        if self.recorder.is_checkpoint_due() {
            let hash = self.game.state_hash();
            self.recorder.checkpoint(hash);
            self.checkpoints.push(hash);
        }
        self.keep_save(self.tick);
        Ok(())
    }

    pub(crate) fn replay_tick(&mut self) -> Result<(), RecordingError> {
        self.replay_towards(self.tick + 1)
    }

    pub(crate) fn seek(&mut self, tick: u64) -> Result<(), RecordingError> {
        if tick > self.ticks() {
            return Err(RecordingError::NoSuchTick { tick, ticks: self.ticks() });
        }
        // Starts from an earlier tick and plays to the requested one, so that derived data such as contact points and
        // events is available.
        let latest = self.history.latest(tick.saturating_sub(1));
        let elsewhere = latest.filter(|(from, _)| !(*from..=tick).contains(&self.tick));
        if let Some((from, save)) = elsewhere.map(|(from, save)| (from, save.clone())) {
            if self.is_at_end() {
                self.end = Some(self.game.save());
            }
            self.game.load(&save);
            self.tick = from;
        }
        while self.tick < tick {
            self.replay_towards(tick)?;
        }
        Ok(())
    }

    /// Returns a replay file of all recorded ticks.
    pub(crate) fn replay_file(&mut self) -> Result<Vec<u8>, RecordingError> {
        let recorder = self.recorder.clone();
        let Some(end) = &self.end else {
            return recorder.finish(&self.game).map_err(RecordingError::Record);
        };
        let here = self.tick;
        self.game.load(end);
        self.tick = self.ticks();
        let file = recorder.finish(&self.game).map_err(RecordingError::Record);
        // Goes back even after an error, because `end` must be `None` while the game is at the last recorded tick.
        self.seek(here)?;
        file
    }

    fn replay_towards(&mut self, target: u64) -> Result<(), RecordingError> {
        let (tick, ticks) = (self.tick + 1, self.ticks());
        let inputs = self.log.get(self.tick).ok_or(RecordingError::NoSuchTick { tick, ticks })?;
        self.game.step(inputs);
        self.tick = tick;
        if tick.is_multiple_of(CHECKPOINT_INTERVAL.into()) {
            let index = usize::try_from(tick / u64::from(CHECKPOINT_INTERVAL) - 1).unwrap_or(usize::MAX);
            if self.checkpoints.get(index) != Some(&self.game.state_hash()) {
                return Err(RecordingError::Forgetful { tick });
            }
        }
        if self.is_at_end() {
            self.end = None;
        }
        self.keep_save(target);
        Ok(())
    }

    fn keep_save(&mut self, here: u64) {
        if self.tick.is_multiple_of(SAVE_INTERVAL) && !self.history.has(self.tick) {
            let save = self.game.save();
            let bytes = (self.weigh)(&self.game, &save);
            self.history.keep(self.tick, save, bytes, here);
        }
    }

    /// Drops all recorded ticks after the current one.
    fn cut(&mut self) -> Result<(), RecordingError> {
        let mut recorder = self.blank.clone();
        let mut checkpoints = self.checkpoints.iter();
        for tick in 0..self.tick {
            if let Some(inputs) = self.log.get_encoded(tick) {
                recorder.record_encoded(inputs).map_err(RecordingError::Record)?;
            }
            if recorder.is_checkpoint_due()
                && let Some(hash) = checkpoints.next()
            {
                recorder.checkpoint(*hash);
            }
        }
        let blocks = self.checkpoints.len() - checkpoints.len();
        self.checkpoints.truncate(blocks);
        self.recorder = recorder;
        self.log.truncate(self.tick);
        self.work.truncate(usize::try_from(self.tick).unwrap_or(usize::MAX));
        self.history.truncate(self.tick);
        self.end = None;
        Ok(())
    }
}

impl fmt::Display for RecordingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RecordingError::NoSuchTick { tick, ticks } => {
                write!(f, "tick {tick} is not recorded: there are {ticks} ticks")
            }
            RecordingError::TooMuch => write!(f, "the tick costs more work than a replay may contain"),
            RecordingError::Record(error) => error.fmt(f),
            RecordingError::Log(error) => error.fmt(f),
            RecordingError::Forgetful { tick } => {
                write!(
                    f,
                    "tick {tick} has another hash when it is played again: saving and loading this game loses state"
                )
            }
        }
    }
}
