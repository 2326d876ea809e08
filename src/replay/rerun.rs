//! [`Rerun`]: plays the inputs of a replay again, whatever its checkpoints say.

use alloc::vec::Vec;

use super::flaw::Flaw;
use super::limits::{Limit, Limits};
use super::playback::{Step, check_bodies, check_rules, decode_setup, scan, start};
use super::reader::{Part, ReadError, Reader};
use super::runs::{Run, Runs};
use super::verdict::Verdict;
use crate::lockstep::{Game, decode_inputs};

/// The encoded inputs of a replay, tick by tick.
#[derive(Clone, Debug)]
pub struct TickInputs<'a> {
    reader: Reader<'a>,
    runs: Runs<'a>,
    run: Option<Run<'a>>,
}

impl<'a> TickInputs<'a> {
    /// The inputs from the first tick on.
    ///
    /// # Errors
    /// [`ReadError`] for a header that is none.
    pub fn open(file: &'a [u8], limits: &Limits) -> Result<Self, ReadError> {
        Ok(TickInputs { reader: Reader::open(file, limits)?, runs: Runs::new(&[], 0), run: None })
    }

    /// The run that the next tick belongs to, with the ticks that are left of it; that tick is then passed. `None` at the
    /// end of what is whole.
    ///
    /// # Errors
    /// [`ReadError`] when the next block is none.
    pub fn next_tick(&mut self) -> Result<Option<Run<'a>>, ReadError> {
        loop {
            if let Some(run) = self.run.as_mut().filter(|run| run.ticks > 0) {
                let found = *run;
                run.ticks -= 1;
                return Ok(Some(found));
            }
            self.run = self.runs.next_run()?;
            if self.run.is_none() {
                match self.reader.next_part()? {
                    Some(Part::Inputs(block)) => self.runs = block.runs(),
                    _ => return Ok(None),
                }
            }
        }
    }
}

/// A replay whose inputs are played again. Unlike a [`Playback`](super::Playback) it compares nothing: it is what the
/// running engine makes of these inputs.
pub struct Rerun<'a, G: Game> {
    game: G,
    limits: Limits,
    ticks: TickInputs<'a>,
    encoded: &'a [u8],
    inputs: Vec<G::Input>,
    tick: u64,
    work: u64,
    /// How many ticks the file has, as far as it is whole.
    length: u64,
}

impl<'a, G: Game> Rerun<'a, G> {
    /// Scans the whole file and starts the game.
    ///
    /// # Errors
    /// The [`Verdict`] when there is nothing to play: the file is malformed, too large, or of another game.
    pub fn open(file: &'a [u8], limits: &Limits) -> Result<Self, Verdict> {
        let ticks = TickInputs::open(file, limits)?;
        let length = scan(ticks.reader.clone())?.ticks;
        check_rules::<G>(ticks.reader.header())?;
        let mut game = start::<G>(ticks.reader.header())?;
        check_bodies(&mut game, limits)?;
        let limits = limits.clone();
        Ok(Rerun { game, limits, ticks, encoded: &[], inputs: Vec::new(), tick: 0, work: 0, length })
    }

    /// The game as of now.
    #[must_use]
    pub fn game(&self) -> &G {
        &self.game
    }

    /// The game as of now, to keep.
    #[must_use]
    pub fn into_game(self) -> G {
        self.game
    }

    /// The game as of now, for tools that look into its world.
    pub(crate) fn game_mut(&mut self) -> &mut G {
        &mut self.game
    }

    /// The setup that the game was started from.
    pub(crate) fn setup(&self) -> Result<G::Setup, Verdict> {
        decode_setup::<G>(self.ticks.reader.header())
    }

    /// How many ticks have been played.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// How many ticks the file has, as far as it is whole.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.length
    }

    /// The inputs that the last tick was played with.
    #[must_use]
    pub fn inputs(&self) -> &[G::Input] {
        &self.inputs
    }

    /// Work units so far.
    #[must_use]
    pub fn work(&self) -> u64 {
        self.work
    }

    /// Plays one tick.
    ///
    /// # Errors
    /// The [`Verdict`] when the inputs are not this game's or cost too much.
    pub fn step(&mut self) -> Result<Step, Verdict> {
        if self.read_inputs()? == Step::Ended {
            return Ok(Step::Ended);
        }
        self.play()?;
        Ok(Step::Ticked)
    }

    /// Fetches the inputs of the next tick, which [`Rerun::play`] or [`Rerun::follow`] has to be called for.
    pub(crate) fn read_inputs(&mut self) -> Result<Step, Verdict> {
        let Some(run) = self.ticks.next_tick()? else {
            return Ok(Step::Ended);
        };
        if self.tick == 0 || run.encoded != self.encoded {
            let malformed = |_| Verdict::Malformed { offset: run.offset, flaw: Flaw::Inputs };
            self.inputs =
                decode_inputs(run.encoded, self.ticks.reader.header().players).map_err(malformed)?;
            self.encoded = run.encoded;
        }
        self.tick += 1;
        Ok(Step::Ticked)
    }

    /// Plays the tick whose inputs were read.
    pub(crate) fn play(&mut self) -> Result<(), Verdict> {
        self.play_with(G::step)
    }

    /// The same with a `step` that does more than to step.
    pub(crate) fn play_with<T>(&mut self, step: impl FnOnce(&mut G, &[G::Input]) -> T) -> Result<T, Verdict> {
        let work = self.game.work(&self.inputs);
        Limit::TickWork.check(work, self.limits.tick_work)?;
        self.work = self.work.saturating_add(work);
        Limit::TotalWork.check(self.work, self.limits.total_work)?;
        let done = step(&mut self.game, &self.inputs);
        check_bodies(&mut self.game, &self.limits)?;
        Ok(done)
    }

    /// Takes over what another game with the same state and the same inputs has come to.
    pub(crate) fn follow(&mut self, save: &G::Save) {
        self.game.load(save);
    }

    /// The canonical bytes of the inputs that were read last.
    pub(crate) fn encoded(&self) -> &'a [u8] {
        self.encoded
    }
}
