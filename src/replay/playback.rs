//! [`Playback`]: plays a replay again, tick by tick, and [`verify`], which does so to the end.

use alloc::collections::BTreeMap;
use alloc::string::String;
use alloc::vec::Vec;

use super::flaw::Flaw;
use super::format::checkpoint_hash;
use super::header::{Header, offset};
use super::limits::{Limit, Limits};
use super::reader::{Part, ReadError, Reader, Trailer};
use super::rerun::{Place, Rerun};
use super::verdict::{ClaimDifference, Mismatch, Verdict};
use crate::codec;
use crate::lockstep::Game;
use crate::world::World;

/// Plays a replay again and says what it is worth.
#[must_use]
pub fn verify<G: Game>(file: &[u8], limits: &Limits) -> Verdict {
    let mut playback = match Playback::<G>::open(file, limits) {
        Ok(playback) => playback,
        Err(verdict) => return verdict,
    };
    loop {
        match playback.step() {
            Ok(Step::Ticked) => {}
            Ok(Step::Ended) => return playback.conclude(),
            Err(verdict) => return verdict,
        }
    }
}

/// What a step of a [`Playback`] did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The game is one tick further.
    Ticked,
    /// There are no more ticks.
    Ended,
}

/// A replay being played again: a [`Rerun`] that is compared with what the file states.
pub struct Playback<'a, G: Game> {
    rerun: Rerun<'a, G>,
    ending: Ending,
    failed: Option<Verdict>,
}

/// How the file ends, known before the first tick is played.
#[derive(Clone, Debug)]
pub(super) struct Ending {
    pub(super) ticks: u64,
    trailer: Option<Trailer>,
}

impl<'a, G: Game> Playback<'a, G> {
    /// Scans the whole file, starts the game and compares the start.
    ///
    /// # Errors
    /// The [`Verdict`] when there is nothing to play: the file is malformed, too large, of another game, or its
    /// setup starts another state.
    pub fn open(file: &'a [u8], limits: &Limits) -> Result<Self, Verdict> {
        let (rerun, ending) = Rerun::<G>::open_to_end(file, limits)?;
        let reader = rerun.place().inputs.reader();
        if checkpoint_hash(rerun.game().state_hash(), reader.inputs_digest()) != reader.start() {
            return Err(Verdict::Diverged { last_equal: None, first_different: 0 });
        }
        Ok(Playback { rerun, ending, failed: None })
    }

    /// The game as of now.
    #[must_use]
    pub fn game(&self) -> &G {
        self.rerun.game()
    }

    /// The physics world of the game as of now, if it has one, to look at.
    pub fn world(&mut self) -> Option<&World> {
        self.rerun.world()
    }

    /// The game as of now, to keep.
    #[must_use]
    pub fn into_game(self) -> G {
        self.rerun.into_game()
    }

    /// How many ticks have been played.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.rerun.tick()
    }

    /// The inputs that the last tick was played with; before the first, none.
    #[must_use]
    pub fn inputs(&self) -> &[G::Input] {
        self.rerun.inputs()
    }

    /// The work units of all ticks so far, as [`Game::work`] counts them.
    #[must_use]
    pub fn work(&self) -> u64 {
        self.rerun.work()
    }

    /// How many ticks the file has, as far as it is whole.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.rerun.ticks()
    }

    /// What the file states of its end, if it is complete. Only a [`Verdict::Match`] makes it true.
    #[must_use]
    pub fn trailer(&self) -> Option<&Trailer> {
        self.ending.trailer.as_ref()
    }

    /// Plays one tick and, at the end of a block, compares the checkpoint.
    ///
    /// # Errors
    /// The [`Verdict`] when the inputs are not this game's, cost too much, or lead elsewhere. It is final.
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

    /// The verdict on the file, given that all its ticks have been played.
    ///
    /// Before the end it can be nothing better than `Incomplete`.
    #[must_use]
    pub fn conclude(self) -> Verdict {
        if let Some(verdict) = self.failed {
            return verdict;
        }
        let (ticks, hash) = (self.tick(), self.game().state_hash());
        let Some(trailer) = self.ending.trailer.filter(|trailer| trailer.ticks == ticks) else {
            return Verdict::Incomplete { ticks, hash };
        };
        // The last checkpoint already binds this state, so a final hash that differs is not another course
        // that the game took but a statement about it.
        if trailer.final_hash != hash {
            let difference = ClaimDifference::FinalHash { claimed: trailer.final_hash, actual: hash };
            return Verdict::ClaimMismatch { ticks, hash, difference };
        }
        match first_difference(trailer.claims, self.rerun.game().claims()) {
            Some(difference) => Verdict::ClaimMismatch { ticks, hash, difference },
            None => Verdict::Match { ticks, hash },
        }
    }

    fn try_step(&mut self) -> Result<Step, Verdict> {
        if self.rerun.step()? == Step::Ended {
            return Ok(Step::Ended);
        }
        if self.agrees() {
            return Ok(Step::Ticked);
        }
        let (tick, inputs) = (self.tick(), &self.rerun.place().inputs);
        let block_ticks = inputs.finished_block().map_or(0, |block| u64::from(block.ticks));
        // All blocks before have been compared.
        Err(Verdict::Diverged { last_equal: Some(tick - block_ticks), first_different: tick })
    }

    /// Whether the state is that of the checkpoint, if the file has one of this tick.
    pub(super) fn agrees(&self) -> bool {
        self.rerun.place().inputs.finished_block().is_none_or(|block| {
            checkpoint_hash(self.game().state_hash(), block.inputs_digest) == block.checkpoint
        })
    }

    /// Where in the file it is.
    pub(super) fn place(&self) -> &Place<'a> {
        self.rerun.place()
    }

    /// Goes where it has been.
    pub(super) fn go(&mut self, save: &G::Save, place: Place<'a>) {
        self.rerun.go(save, place);
        self.failed = None;
    }
}

/// Reads the file to its end.
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

/// A game that shows no world has no bodies to count.
pub(super) fn check_bodies<G: Game>(game: &mut G, limits: &Limits) -> Result<(), ReadError> {
    let bodies = game.world_mut().map_or(0, |world| world.body_count());
    Limit::Bodies.check(u64::try_from(bodies).unwrap_or(u64::MAX), limits.bodies)
}

/// The setup, if it is written as this program writes it.
pub(super) fn decode_setup<G: Game>(header: &Header<'_>) -> Result<G::Setup, Verdict> {
    codec::decode(header.setup)
        .ok()
        .filter(|setup| codec::encode(setup) == header.setup)
        .ok_or(Verdict::Malformed { offset: header.setup_offset(), flaw: Flaw::Setup })
}

/// The game before its first tick, if it is the one that the header describes.
pub(super) fn start<G: Game>(header: &Header<'_>) -> Result<G, Verdict> {
    let malformed = |offset, flaw| Verdict::Malformed { offset, flaw };
    let setup = decode_setup::<G>(header)?;
    let game = G::new(&setup)
        .map_err(|error| malformed(header.setup_offset(), Flaw::SetupRefused { why: error.why }))?;
    if game.players() != header.players {
        let flaw = Flaw::PlayersDisagree { header: header.players, game: game.players() };
        return Err(malformed(offset::PLAYERS, flaw));
    }
    if game.tick_rate() != header.tick_rate {
        let flaw = Flaw::TickRateDisagrees { header: header.tick_rate, game: game.tick_rate() };
        return Err(malformed(offset::TICK_RATE, flaw));
    }
    Ok(game)
}

/// The first name, in order, whose value is not the same on both sides.
fn first_difference(claimed: Vec<(String, i64)>, actual: Vec<(String, i64)>) -> Option<ClaimDifference> {
    let claimed: BTreeMap<String, i64> = claimed.into_iter().collect();
    let actual: BTreeMap<String, i64> = actual.into_iter().collect();
    let mut names: Vec<&String> = claimed.keys().chain(actual.keys()).collect();
    names.sort();
    let name = names.into_iter().find(|name| claimed.get(*name) != actual.get(*name))?;
    Some(ClaimDifference::Value {
        name: name.clone(),
        claimed: claimed.get(name).copied(),
        actual: actual.get(name).copied(),
    })
}
