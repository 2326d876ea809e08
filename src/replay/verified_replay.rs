use super::flaw::Flaw;
use super::format::checkpoint_hash;
use super::header::{Header, offset};
use super::limits::{LimitKind, Limits};
use super::raw_replay::{RawReplay, ReplayPosition};
use super::reader::{Part, ReadError, Reader};
use super::trailer::Trailer;
use super::verdict::{Mismatch, Verdict};
use crate::codec;
use crate::lockstep::{Game, StartError, world_of};
use crate::world::World;

/// Simulates a replay and returns the verdict on it.
#[must_use]
pub fn verify<G: Game>(file: &[u8], limits: &Limits) -> Verdict {
    let mut replay = match VerifiedReplay::<G>::open(file, limits) {
        Ok(replay) => replay,
        Err(verdict) => return verdict,
    };
    loop {
        match replay.step() {
            Ok(Step::Ticked) => {}
            Ok(Step::Ended) => return replay.conclude(),
            Err(verdict) => return verdict,
        }
    }
}

/// Result of a step of a replay.
///
/// ```
/// # use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::replay::{Limits, Recording, Step, VerifiedReplay};
/// # let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60).expect("a setup");
/// # (0..2).for_each(|_| recording.step(&[vec![]]).expect("one input"));
/// # let file = recording.finish().expect("no claims");
/// let mut replay = VerifiedReplay::<Sandbox>::open(&file, &Limits::default())?;
/// assert_eq!([replay.step()?, replay.step()?, replay.step()?], [Step::Ticked, Step::Ticked, Step::Ended]);
/// # Ok::<(), lockstep2d::replay::Verdict>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The game advanced by one tick.
    Ticked,
    /// There are no ticks left.
    Ended,
}

/// A [`RawReplay`] whose states are compared with the checkpoints of the file.
///
/// ```
/// # use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::replay::{Limits, Recording, Step, VerifiedReplay};
/// # let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60).expect("a setup");
/// # (0..90).for_each(|_| recording.step(&[vec![]]).expect("one input"));
/// # let file = recording.finish().expect("no claims");
/// // Collects the frames of a film while the replay is verified.
/// let mut replay = VerifiedReplay::<Sandbox>::open(&file, &Limits::default())?;
/// let mut frames = vec![];
/// while replay.step()? == Step::Ticked {
///     frames.push(replay.game().world().awake_body_count());
/// }
/// assert_eq!(frames.len(), 90);
/// assert!(replay.conclude().is_match());
/// # Ok::<(), lockstep2d::replay::Verdict>(())
/// ```
pub struct VerifiedReplay<'a, G: Game> {
    raw: RawReplay<'a, G>,
    ending: Ending,
    failed: Option<Verdict>,
}

#[derive(Clone, Debug)]
pub(super) struct Ending {
    pub(super) ticks: u64,
    trailer: Option<Trailer>,
}

impl<'a, G: Game> VerifiedReplay<'a, G> {
    /// Scans the whole file, starts the game and compares the start checkpoint.
    ///
    /// # Errors
    /// The [`Verdict`] if nothing can be played: the file is malformed, exceeds a limit, is [`Verdict::Unverifiable`],
    /// or its setup leads to another start state.
    pub fn open(file: &'a [u8], limits: &Limits) -> Result<Self, Verdict> {
        let (raw, ending) = RawReplay::<G>::open_to_end(file, limits)?;
        let reader = raw.position().inputs.reader();
        if checkpoint_hash(raw.game().state_hash(), reader.inputs_digest()) != reader.start() {
            return Err(Verdict::Diverged { last_equal: None, first_different: 0 });
        }
        Ok(VerifiedReplay { raw, ending, failed: None })
    }

    /// The game at the current tick. Its state is wrong once a limit of work has been exceeded.
    #[must_use]
    pub fn game(&self) -> &G {
        self.raw.game()
    }

    /// The world of the game, if it has one.
    pub fn world(&mut self) -> Option<&World> {
        self.raw.world()
    }

    /// Returns the game at the current tick.
    #[must_use]
    pub fn into_game(self) -> G {
        self.raw.into_game()
    }

    /// Number of ticks played.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.raw.tick()
    }

    /// The inputs of the last tick played; empty before the first tick.
    #[must_use]
    pub fn inputs(&self) -> &[G::Input] {
        self.raw.inputs()
    }

    /// Work units of the setup and of the ticks played: see [`RawReplay::work`].
    #[must_use]
    pub fn work(&self) -> u64 {
        self.raw.work()
    }

    /// Number of ticks in the complete blocks of the file.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.raw.ticks()
    }

    /// The trailer, if the file is complete. Its statements are verified only if [`conclude`](Self::conclude) returns
    /// [`Verdict::Match`].
    #[must_use]
    pub fn trailer(&self) -> Option<&Trailer> {
        self.ending.trailer.as_ref()
    }

    /// Plays one tick. At the end of a block, compares the checkpoint.
    ///
    /// # Errors
    /// The [`Verdict`] if the inputs are not valid for this game, exceed a limit on work or bodies, or lead to another
    /// state. Further calls return the same verdict.
    pub fn step(&mut self) -> Result<Step, Verdict> {
        if let Some(verdict) = &self.failed {
            return Err(verdict.clone());
        }
        let result = self.try_step();
        if let Err(verdict) = &result {
            self.failed = Some(verdict.clone());
        }
        result
    }

    /// Returns the verdict. Before all ticks have been played, this is `Incomplete`, or the verdict of a failed step.
    #[must_use]
    pub fn conclude(self) -> Verdict {
        if let Some(verdict) = self.failed {
            return verdict;
        }
        let (ticks, hash) = (self.tick(), self.game().state_hash());
        let Some(trailer) = self.ending.trailer.filter(|trailer| trailer.ticks == ticks) else {
            return Verdict::Incomplete { ticks, hash };
        };
        match trailer.difference(hash, &self.raw.game().claims()) {
            Some(difference) => Verdict::ClaimMismatch { ticks, hash, difference },
            None => Verdict::Match { ticks, hash },
        }
    }

    fn try_step(&mut self) -> Result<Step, Verdict> {
        if self.raw.step()? == Step::Ended {
            return Ok(Step::Ended);
        }
        if self.agrees() {
            return Ok(Step::Ticked);
        }
        let (tick, inputs) = (self.tick(), &self.raw.position().inputs);
        let block_ticks = inputs.finished_block().map_or(0, |block| u64::from(block.ticks));
        // The state at the start of the block agreed with its checkpoint.
        Err(Verdict::Diverged { last_equal: Some(tick - block_ticks), first_different: tick })
    }

    /// Whether the state matches the checkpoint of this tick; true if the tick has no checkpoint.
    pub(super) fn agrees(&self) -> bool {
        self.raw.position().inputs.finished_block().is_none_or(|block| {
            checkpoint_hash(self.game().state_hash(), block.inputs_digest) == block.checkpoint
        })
    }

    pub(super) fn position(&self) -> &ReplayPosition<'a> {
        self.raw.position()
    }

    pub(super) fn go(&mut self, save: &G::Save, position: ReplayPosition<'a>) {
        self.raw.go(save, position);
        self.failed = None;
    }
}

pub(super) fn scan(mut reader: Reader<'_>) -> Result<Ending, ReadError> {
    loop {
        match reader.next_part()? {
            Some(Part::Inputs(_)) => {}
            Some(Part::Trailer(trailer)) => {
                return Ok(Ending { ticks: trailer.ticks, trailer: Some(trailer) });
            }
            Some(Part::Cut) | None => return Ok(Ending { ticks: reader.ticks(), trailer: None }),
        }
    }
}

pub(super) fn check_rules<G: Game>(header: &Header<'_>) -> Result<(), Verdict> {
    if header.semantics != crate::SEMANTICS {
        let why = Mismatch::Semantics { file: header.semantics, here: crate::SEMANTICS };
        return Err(Verdict::Unverifiable { why });
    }
    if header.rules_name != G::RULES.name || header.rules_version != G::RULES.version {
        let why = Mismatch::Rules {
            file: (header.rules_name.into(), header.rules_version),
            here: (G::RULES.name.into(), G::RULES.version),
        };
        return Err(Verdict::Unverifiable { why });
    }
    Ok(())
}

/// Checks the number of bodies against [`Limits::bodies`]. A game without a world has 0 bodies.
pub(super) fn check_bodies<G: Game>(game: &mut G, limits: &Limits) -> Result<(), ReadError> {
    let bodies = world_of(game).map_or(0, World::body_count);
    LimitKind::Bodies.check(u64::try_from(bodies).unwrap_or(u64::MAX), limits.bodies)
}

pub(super) fn decode_setup<G: Game>(header: &Header<'_>) -> Result<G::Setup, Verdict> {
    codec::decode(header.setup)
        .ok()
        .filter(|setup| codec::encode(setup) == header.setup)
        .ok_or(Verdict::Malformed { offset: header.setup_offset(), flaw: Flaw::Setup })
}

/// Creates the game and checks it against the header. Returns the game with the work units of its setup.
pub(super) fn start<G: Game>(header: &Header<'_>, limits: &Limits) -> Result<(G, u64), Verdict> {
    let malformed = |offset, flaw| Verdict::Malformed { offset, flaw };
    let setup = decode_setup::<G>(header)?;
    let (game, work) = G::new_within(&setup, limits.total_work).map_err(|error| match error {
        StartError::Refused(error) => malformed(header.setup_offset(), Flaw::SetupRefused { why: error.why }),
        StartError::TooMuchWork { work, max } => {
            Verdict::LimitExceeded { limit: LimitKind::TotalWork, value: work, max }
        }
    })?;
    if game.players() != header.players {
        let flaw = Flaw::PlayersDisagree { header: header.players, game: game.players() };
        return Err(malformed(offset::PLAYERS, flaw));
    }
    if game.tick_rate() != header.tick_rate {
        let flaw = Flaw::TickRateDisagrees { header: header.tick_rate, game: game.tick_rate() };
        return Err(malformed(offset::TICK_RATE, flaw));
    }
    Ok((game, work))
}
