//! [`Tape`]: a game that is recorded while it is played, in which one can go back and take another course.

mod history;

use std::fmt;

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{EncodedInputs, Game, InputError, InputLog};
use lockstep2d::replay::{CHECKPOINT_INTERVAL, Limits, RecordError, Recorder};

use history::History;

/// Ticks from one save to the next.
const SAVE_INTERVAL: u64 = 4;
/// Bytes that the saves may take.
const SAVES_BYTES: usize = 256 << 20;

/// A game and everything that has been done in it. *Tick t* is the state after *t* ticks.
///
/// One can go to any tick up to the last that was played. [`Tape::replay_tick`] plays on with the inputs that are there,
/// [`Tape::play`] with other ones, and drops those.
pub(crate) struct Tape<G: Game> {
    game: G,
    tick: u64,
    /// The recorder before the first tick, to record anew what is left after a cut.
    blank: Recorder<G>,
    /// It has recorded all ticks of the log.
    recorder: Recorder<G>,
    log: InputLog<G::Input>,
    /// The state hashes that the recorder has been given.
    checkpoints: Vec<StateHash>,
    /// The work units up to each tick.
    work: Vec<u64>,
    history: History<G::Save>,
    weigh: fn(&G::Save) -> usize,
    /// The game after the last tick, while it is not there.
    end: Option<G::Save>,
}

/// Why a tape does not go where it should.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum TapeError {
    /// A tick that has not been played.
    NoSuchTick { tick: u64, ticks: u64 },
    /// These inputs cost more than a verifier grants a stranger's file.
    TooMuch,
    /// Inputs that cannot be recorded.
    Record(RecordError),
    /// The tape does not hold what was put on it.
    Log(InputError),
    /// Played again, a tick is another one: saving and loading this game loses something.
    Forgetful { tick: u64 },
}

impl<G: Game> Tape<G> {
    /// Starts a game. `weigh` says how much memory a save takes that it shares with no other.
    pub(crate) fn start(setup: &G::Setup, weigh: fn(&G::Save) -> usize) -> Result<Self, RecordError> {
        let (recorder, game) = Recorder::<G>::start(setup, CHECKPOINT_INTERVAL)?;
        Ok(Tape {
            tick: 0,
            blank: recorder.clone(),
            recorder,
            log: InputLog::new(game.players()),
            checkpoints: Vec::new(),
            work: Vec::new(),
            history: History::new(game.save(), SAVES_BYTES),
            weigh,
            end: None,
            game,
        })
    }

    /// The game as of now.
    pub(crate) fn game(&self) -> &G {
        &self.game
    }

    /// Where it is.
    pub(crate) fn tick(&self) -> u64 {
        self.tick
    }

    /// How many ticks have been played.
    pub(crate) fn ticks(&self) -> u64 {
        self.log.ticks()
    }

    /// Whether no tick has been played after this one.
    pub(crate) fn is_at_end(&self) -> bool {
        self.tick == self.ticks()
    }

    /// The work units of all ticks that have been played, as a verifier counts them.
    pub(crate) fn work(&self) -> u64 {
        self.work.last().copied().unwrap_or(0)
    }

    /// Plays the next tick. If it has been played already, that and everything after it is dropped.
    pub(crate) fn play(&mut self, inputs: &[G::Input]) -> Result<(), TapeError> {
        let work = self.game.work(inputs);
        if work > Limits::default().tick_work {
            return Err(TapeError::TooMuch);
        }
        if !self.is_at_end() {
            self.cut()?;
        }
        let inputs = EncodedInputs::new(inputs, self.game.players())
            .map_err(|error| TapeError::Record(RecordError::Inputs(error)))?;
        self.recorder.record_encoded(&inputs).map_err(TapeError::Record)?;
        let inputs = self.log.push_encoded(&inputs).map_err(TapeError::Log)?;
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

    /// Plays the next tick with the inputs that it has been played with before.
    pub(crate) fn replay_tick(&mut self) -> Result<(), TapeError> {
        self.replay_towards(self.tick + 1)
    }

    /// Goes to a tick that has been played.
    pub(crate) fn seek(&mut self, tick: u64) -> Result<(), TapeError> {
        if tick > self.ticks() {
            return Err(TapeError::NoSuchTick { tick, ticks: self.ticks() });
        }
        // From a tick before, so that what is no state, such as contact points and events, is there to be seen.
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

    /// A replay file of all ticks that have been played, wherever it is.
    pub(crate) fn to_replay(&self) -> Result<Vec<u8>, RecordError>
    where
        G: Clone,
    {
        let recorder = self.recorder.clone();
        let Some(end) = &self.end else { return recorder.finish(&self.game) };
        let mut game = self.game.clone();
        game.load(end);
        recorder.finish(&game)
    }

    fn replay_towards(&mut self, target: u64) -> Result<(), TapeError> {
        let (tick, ticks) = (self.tick + 1, self.ticks());
        let inputs = self.log.get(self.tick).ok_or(TapeError::NoSuchTick { tick, ticks })?;
        self.game.step(inputs);
        self.tick = tick;
        if tick.is_multiple_of(CHECKPOINT_INTERVAL.into()) {
            let index = usize::try_from(tick / u64::from(CHECKPOINT_INTERVAL) - 1).unwrap_or(usize::MAX);
            if self.checkpoints.get(index) != Some(&self.game.state_hash()) {
                return Err(TapeError::Forgetful { tick });
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
            let bytes = (self.weigh)(&save);
            self.history.keep(self.tick, save, bytes, here);
        }
    }

    /// Drops all ticks after this one.
    fn cut(&mut self) -> Result<(), TapeError> {
        let mut recorder = self.blank.clone();
        let mut checkpoints = self.checkpoints.iter();
        for tick in 0..self.tick {
            if let Some(inputs) = self.log.get_encoded(tick) {
                recorder.record_encoded(inputs).map_err(TapeError::Record)?;
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

impl fmt::Display for TapeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TapeError::NoSuchTick { tick, ticks } => write!(f, "there are {ticks} ticks, and no tick {tick}"),
            TapeError::TooMuch => write!(f, "a tick that costs more than a replay may cost"),
            TapeError::Record(error) => error.fmt(f),
            TapeError::Log(error) => error.fmt(f),
            TapeError::Forgetful { tick } => {
                write!(
                    f,
                    "played again, tick {tick} is another one: saving and loading this game loses something"
                )
            }
        }
    }
}
