//! [`Playback`]: plays a replay again, tick by tick, and [`verify`], which does so to the end.

use alloc::collections::BTreeMap;
use alloc::string::String;
use alloc::vec::Vec;

use super::flaw::Flaw;
use super::format::checkpoint_hash;
use super::header::{Header, offset};
use super::limits::{Limit, Limits};
use super::reader::{InputBlock, Part, ReadError, Reader, Trailer};
use super::runs::Runs;
use super::verdict::{ClaimDifference, Mismatch, Verdict};
use crate::codec;
use crate::lockstep::{Game, InputError, decode_inputs};

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

/// A replay being played again.
pub struct Playback<'a, G: Game> {
    game: G,
    limits: Limits,
    reader: Reader<'a>,
    ending: Ending,
    /// The block being played and its ticks yet to come.
    block: Option<(InputBlock<'a>, u32)>,
    runs: Runs<'a>,
    /// The inputs of the current run, for one tick, and its ticks yet to come.
    inputs: Vec<G::Input>,
    run_left: u32,
    tick: u64,
    last_equal: u64,
    work: u64,
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
        let reader = Reader::open(file, limits)?;
        let ending = scan(reader.clone())?;
        check_rules::<G>(reader.header())?;
        let mut game = start::<G>(reader.header())?;
        check_bodies(&mut game, limits)?;
        if checkpoint_hash(game.state_hash(), reader.inputs_digest()) != reader.start() {
            return Err(Verdict::Diverged { last_equal: None, first_different: 0 });
        }
        Ok(Playback {
            game,
            limits: limits.clone(),
            reader,
            ending,
            block: None,
            runs: Runs::new(&[], 0),
            inputs: Vec::new(),
            run_left: 0,
            tick: 0,
            last_equal: 0,
            work: 0,
            failed: None,
        })
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

    /// How many ticks have been played.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// How many ticks the file has, as far as it is whole.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.ending.ticks
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
        let (ticks, hash) = (self.tick, self.game.state_hash());
        let Some(trailer) = self.ending.trailer.filter(|trailer| trailer.ticks == ticks) else {
            return Verdict::Incomplete { ticks, hash };
        };
        // The last checkpoint already binds this state, so a final hash that differs is not another course
        // that the game took but a statement about it.
        if trailer.final_hash != hash {
            let difference = ClaimDifference::FinalHash { claimed: trailer.final_hash, actual: hash };
            return Verdict::ClaimMismatch { ticks, hash, difference };
        }
        match first_difference(trailer.claims, self.game.claims()) {
            Some(difference) => Verdict::ClaimMismatch { ticks, hash, difference },
            None => Verdict::Match { ticks, hash },
        }
    }

    fn try_step(&mut self) -> Result<Step, Verdict> {
        while self.run_left == 0 {
            if !self.next_run()? && !self.next_block()? {
                return Ok(Step::Ended);
            }
        }
        let work = self.game.work(&self.inputs);
        Limit::TickWork.check(work, self.limits.tick_work)?;
        self.work = self.work.saturating_add(work);
        Limit::TotalWork.check(self.work, self.limits.total_work)?;

        self.game.step(&self.inputs);
        self.tick += 1;
        self.run_left -= 1;
        check_bodies(&mut self.game, &self.limits)?;
        self.compare_at_block_end()?;
        Ok(Step::Ticked)
    }

    /// Decodes the next run's inputs; false at the end of the block.
    fn next_run(&mut self) -> Result<bool, Verdict> {
        let Some(run) = self.runs.next_run()? else {
            return Ok(false);
        };
        let malformed = |_: InputError| Verdict::Malformed { offset: run.offset, flaw: Flaw::Inputs };
        self.inputs = decode_inputs(run.encoded, self.reader.header().players).map_err(malformed)?;
        self.run_left = run.ticks;
        Ok(true)
    }

    /// Goes on to the next block of inputs; false at the end of the file.
    fn next_block(&mut self) -> Result<bool, Verdict> {
        let Some(Part::Inputs(block)) = self.reader.next_part()? else {
            return Ok(false);
        };
        self.runs = block.runs();
        let ticks = block.ticks;
        self.block = Some((block, ticks));
        Ok(true)
    }

    fn compare_at_block_end(&mut self) -> Result<(), Verdict> {
        let Some((block, left)) = &mut self.block else {
            return Ok(());
        };
        *left -= 1;
        if *left > 0 {
            return Ok(());
        }
        if checkpoint_hash(self.game.state_hash(), block.inputs_digest) != block.checkpoint {
            let last_equal = Some(self.last_equal);
            return Err(Verdict::Diverged { last_equal, first_different: self.tick });
        }
        self.last_equal = self.tick;
        Ok(())
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

/// A game that shows no world has no bodies to count.
pub(super) fn check_bodies<G: Game>(game: &mut G, limits: &Limits) -> Result<(), ReadError> {
    let bodies = game.world_mut().map_or(0, |world| world.body_count());
    Limit::Bodies.check(u64::try_from(bodies).unwrap_or(u64::MAX), limits.bodies)
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
