use alloc::vec::Vec;

use super::flaw::Flaw;
use super::header::Header;
use super::limits::Limits;
use super::metered::play_within;
use super::tick_inputs::TickInputs;
use super::verdict::Verdict;
use super::verified_replay::{Ending, Step, check_bodies, check_rules, decode_setup, scan, start};
use crate::lockstep::{Game, decode_inputs, world_of};
use crate::world::World;

/// Simulates the inputs of a replay without comparing checkpoints, unlike [`VerifiedReplay`](super::VerifiedReplay).
/// Its states are therefore those that this machine and this version of the engine compute.
///
/// ```
/// # use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
/// use lockstep2d::replay::{Limits, RawReplay, Recording, Step};
/// # let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60).expect("a setup");
/// # (0..90).for_each(|_| recording.step(&[vec![]]).expect("one input"));
/// # let file = recording.finish().expect("no claims");
/// // Plays a replay that may diverge on this machine. Checkpoints are not compared, so it plays to the end.
/// let mut replay = RawReplay::<Sandbox>::open(&file, &Limits::default())?;
/// while replay.step()? == Step::Ticked {}
/// assert_eq!((replay.tick(), replay.game().world().tick()), (90, 90));
/// # Ok::<(), lockstep2d::replay::Verdict>(())
/// ```
pub struct RawReplay<'a, G: Game> {
    game: G,
    limits: Limits,
    position: ReplayPosition<'a>,
    /// Bytes that `inputs` were decoded from.
    encoded: Option<&'a [u8]>,
    inputs: Vec<G::Input>,
    length: u64,
    /// Number of ticks, from the start, that were played within the limits. Their work is not limited if they are
    /// played again.
    admitted: u64,
    /// Whether no tick was played since [`RawReplay::go`]. The first tick after a loaded state costs more.
    is_loaded: bool,
    /// The verdict with which [`RawReplay::step`] failed. Further calls return it again.
    failed: Option<Verdict>,
}

#[derive(Clone, Debug)]
pub(super) struct ReplayPosition<'a> {
    pub(super) inputs: TickInputs<'a>,
    pub(super) tick: u64,
    /// Work units of the setup and of the ticks so far.
    pub(super) work: u64,
}

impl<'a, G: Game> RawReplay<'a, G> {
    /// Scans the whole file and starts the game.
    ///
    /// # Errors
    /// The [`Verdict`] if nothing can be played: the file is malformed, exceeds a limit, or is
    /// [`Verdict::Unverifiable`].
    pub fn open(file: &'a [u8], limits: &Limits) -> Result<Self, Verdict> {
        Self::open_to_end(file, limits).map(|(raw, _)| raw)
    }

    /// Like [`RawReplay::open`], and also returns the ending of the file.
    pub(super) fn open_to_end(file: &'a [u8], limits: &Limits) -> Result<(Self, Ending), Verdict> {
        let inputs = TickInputs::open(file, limits)?;
        let ending = scan(inputs.reader().clone())?;
        check_rules::<G>(inputs.reader().header())?;
        let (mut game, work) = start::<G>(inputs.reader().header(), limits)?;
        check_bodies(&mut game, limits)?;
        let (limits, position) = (limits.clone(), ReplayPosition { inputs, tick: 0, work });
        let (length, inputs) = (ending.ticks, Vec::new());
        let raw = RawReplay {
            game,
            limits,
            position,
            encoded: None,
            inputs,
            length,
            admitted: 0,
            is_loaded: false,
            failed: None,
        };
        Ok((raw, ending))
    }

    /// The game at the current tick. Its state is wrong once a limit of work has been exceeded.
    #[must_use]
    pub fn game(&self) -> &G {
        &self.game
    }

    /// The world of the game, if it has one.
    pub fn world(&mut self) -> Option<&World> {
        world_of(&mut self.game)
    }

    /// Returns the game at the current tick.
    #[must_use]
    pub fn into_game(self) -> G {
        self.game
    }

    /// Number of ticks played.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.position.tick
    }

    /// Work units of the setup and of the ticks played, counted by [`Game::new_within`], [`Game::work`] and the world.
    #[must_use]
    pub fn work(&self) -> u64 {
        self.position.work
    }

    /// The inputs of the last tick played; empty before the first tick.
    #[must_use]
    pub fn inputs(&self) -> &[G::Input] {
        &self.inputs
    }

    /// Number of ticks in the complete blocks of the file.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.length
    }

    /// Plays one tick.
    ///
    /// # Errors
    /// The [`Verdict`] if the inputs are not valid for this game or exceed a limit on work or bodies. Further calls
    /// return the same verdict.
    pub fn step(&mut self) -> Result<Step, Verdict> {
        if let Some(verdict) = &self.failed {
            return Err(verdict.clone());
        }
        let result = self.try_step();
        self.failed = result.as_ref().err().cloned();
        result
    }

    fn try_step(&mut self) -> Result<Step, Verdict> {
        if self.read_inputs()? == Step::Ended {
            return Ok(Step::Ended);
        }
        self.play()?;
        Ok(Step::Ticked)
    }

    /// Reads the inputs of the next tick, which the caller then plays or skips.
    pub(crate) fn read_inputs(&mut self) -> Result<Step, Verdict> {
        let Some(run) = self.position.inputs.next_tick()? else {
            return Ok(Step::Ended);
        };
        if self.encoded != Some(run.encoded) {
            let malformed = |_| Verdict::Malformed { offset: run.offset, flaw: Flaw::Inputs };
            let players = self.header().players;
            self.inputs = decode_inputs(run.encoded, players).map_err(malformed)?;
            self.encoded = Some(run.encoded);
        }
        Ok(Step::Ticked)
    }

    pub(crate) fn play(&mut self) -> Result<(), Verdict> {
        self.play_with(G::step)
    }

    /// Plays the tick whose inputs were read, by calling `step`.
    pub(crate) fn play_with<T>(&mut self, step: impl FnOnce(&mut G, &[G::Input]) -> T) -> Result<T, Verdict> {
        let RawReplay { game, inputs, limits, position, admitted, is_loaded, .. } = self;
        // The first tick after a loaded state fills the caches. Only this work is exempt, because a state from a file may
        // come from anyone.
        let world = if core::mem::take(is_loaded) { game.world_mut() } else { None };
        if let Some(world) = world {
            world.exempt_fresh_caches();
        }
        let unlimited = Limits { tick_work: u64::MAX, total_work: u64::MAX, ..limits.clone() };
        let limits = if position.tick < *admitted { &unlimited } else { &*limits };
        let done = play_within(game, inputs, limits, &mut position.work, step)?;
        position.tick += 1;
        if position.tick == *admitted + 1 {
            *admitted += 1;
        }
        check_bodies(&mut self.game, &self.limits)?;
        Ok(done)
    }

    /// Skips the tick whose inputs were read.
    pub(crate) fn skip(&mut self) {
        self.position.tick += 1;
    }

    pub(crate) fn encoded(&self) -> Option<&'a [u8]> {
        self.encoded
    }

    pub(crate) fn game_mut(&mut self) -> &mut G {
        &mut self.game
    }

    pub(crate) fn setup(&self) -> Result<G::Setup, Verdict> {
        decode_setup::<G>(self.header())
    }

    pub(crate) fn header(&self) -> &Header<'a> {
        self.position.inputs.reader().header()
    }

    pub(super) fn position(&self) -> &ReplayPosition<'a> {
        &self.position
    }

    /// Restores a state and a position in this file, and clears [`RawReplay::inputs`].
    pub(super) fn go(&mut self, save: &G::Save, position: ReplayPosition<'a>) {
        self.game.load(save);
        self.position = position;
        self.is_loaded = true;
        self.encoded = None;
        self.inputs.clear();
        self.failed = None;
    }
}
