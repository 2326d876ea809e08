//! [`Rerun`]: plays the inputs of a replay again, whatever its checkpoints say.

use alloc::vec::Vec;

use super::flaw::Flaw;
use super::limits::{Limit, Limits};
use super::playback::{Ending, Step, check_bodies, check_rules, decode_setup, scan, start};
use super::tick_inputs::TickInputs;
use super::verdict::Verdict;
use crate::lockstep::{Game, decode_inputs};
use crate::world::World;

/// A replay whose inputs are played again. Unlike a [`Playback`](super::Playback) it compares nothing: it is what the
/// running engine makes of these inputs.
pub struct Rerun<'a, G: Game> {
    game: G,
    limits: Limits,
    place: Place<'a>,
    /// What `inputs` were decoded from.
    encoded: Option<&'a [u8]>,
    inputs: Vec<G::Input>,
    /// How many ticks the file has, as far as it is whole.
    length: u64,
}

/// Where in a replay a rerun is: all of it but the game.
#[derive(Clone, Debug)]
pub(super) struct Place<'a> {
    pub(super) inputs: TickInputs<'a>,
    pub(super) tick: u64,
    /// Work units up to here.
    pub(super) work: u64,
}

impl<'a, G: Game> Rerun<'a, G> {
    /// Scans the whole file and starts the game.
    ///
    /// # Errors
    /// The [`Verdict`] when there is nothing to play: the file is malformed, too large, or of another game.
    pub fn open(file: &'a [u8], limits: &Limits) -> Result<Self, Verdict> {
        Self::open_to_end(file, limits).map(|(rerun, _)| rerun)
    }

    /// [`Rerun::open`], with what the scan has found at the end.
    pub(super) fn open_to_end(file: &'a [u8], limits: &Limits) -> Result<(Self, Ending), Verdict> {
        let inputs = TickInputs::open(file, limits)?;
        let ending = scan(inputs.reader().clone())?;
        check_rules::<G>(inputs.reader().header())?;
        let mut game = start::<G>(inputs.reader().header())?;
        check_bodies(&mut game, limits)?;
        let (limits, place) = (limits.clone(), Place { inputs, tick: 0, work: 0 });
        let length = ending.ticks;
        Ok((Rerun { game, limits, place, encoded: None, inputs: Vec::new(), length }, ending))
    }

    /// The game as of now.
    #[must_use]
    pub fn game(&self) -> &G {
        &self.game
    }

    /// The physics world of the game as of now, if it has one, to look at.
    pub fn world(&mut self) -> Option<&World> {
        self.game.world_mut().map(|world| &*world)
    }

    /// The game as of now, to keep.
    #[must_use]
    pub fn into_game(self) -> G {
        self.game
    }

    /// How many ticks have been played.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.place.tick
    }

    /// The work units of all ticks so far, as [`Game::work`] counts them.
    #[must_use]
    pub fn work(&self) -> u64 {
        self.place.work
    }

    /// The inputs that the last tick was played with; before the first, none.
    #[must_use]
    pub fn inputs(&self) -> &[G::Input] {
        &self.inputs
    }

    /// How many ticks the file has, as far as it is whole.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.length
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

    /// Fetches the inputs of the next tick, which has to be played or skipped then.
    pub(crate) fn read_inputs(&mut self) -> Result<Step, Verdict> {
        let Some(run) = self.place.inputs.next_tick()? else {
            return Ok(Step::Ended);
        };
        if self.encoded != Some(run.encoded) {
            let malformed = |_| Verdict::Malformed { offset: run.offset, flaw: Flaw::Inputs };
            let players = self.place.inputs.reader().header().players;
            self.inputs = decode_inputs(run.encoded, players).map_err(malformed)?;
            self.encoded = Some(run.encoded);
        }
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
        self.place.work = self.place.work.saturating_add(work);
        Limit::TotalWork.check(self.place.work, self.limits.total_work)?;
        let done = step(&mut self.game, &self.inputs);
        self.place.tick += 1;
        check_bodies(&mut self.game, &self.limits)?;
        Ok(done)
    }

    /// Counts the tick whose inputs were read as played: another game with the same state has played it.
    pub(crate) fn skip(&mut self) {
        self.place.tick += 1;
    }

    /// The canonical bytes of the inputs that were read last.
    pub(crate) fn encoded(&self) -> Option<&'a [u8]> {
        self.encoded
    }

    /// The game as of now, for tools that look into its world.
    pub(crate) fn game_mut(&mut self) -> &mut G {
        &mut self.game
    }

    /// The setup that the game was started from.
    pub(crate) fn setup(&self) -> Result<G::Setup, Verdict> {
        decode_setup::<G>(self.place.inputs.reader().header())
    }

    /// Where it is.
    pub(super) fn place(&self) -> &Place<'a> {
        &self.place
    }

    /// Goes where it, or another rerun of the same file, has been. [`Rerun::inputs`] are none then.
    pub(super) fn go(&mut self, save: &G::Save, place: Place<'a>) {
        self.game.load(save);
        self.place = place;
        self.encoded = None;
        self.inputs.clear();
    }
}
