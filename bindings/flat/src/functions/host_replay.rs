//! Replays of games whose rules are written in another language: the host simulates the game and passes state hashes.

use std::collections::BTreeSet;

use lockstep2d::codec;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::Game;
use lockstep2d::replay::{Flaw, Limits, Mismatch, Part, Reader, Trailer, Verdict, checkpoint_hash};

use super::host_recorder::{HostGame, HostSetup, are_possible, claim};
use super::replay::{limits_of, set_opened};
use crate::border::{In, Out};
use crate::describe::api;
use crate::numbers::RawHash;
use crate::records::{RawLimits, RawVerdict};
use crate::status::{Failure, Outcome, Status, note};
use crate::table::{self, Bytes, with};

/// By default, a replay is divided into at most this many intervals, with a saved state at each boundary.
const SAVES: u64 = 256;
/// Shortest default interval, in ticks.
const SAVE_INTERVAL: u64 = 60;

/// Consecutive ticks with equal inputs.
pub(super) struct Run {
    start: u64,
    /// Inputs of the players that are present.
    inputs: Vec<u8>,
    /// Bit for each seat that nobody plays.
    pub(super) absent: u64,
}

impl Run {
    /// Inputs of all players, with zeros for absent ones. A run does not store these zeros: otherwise a replay with
    /// absent players would need many times the size of its file in memory.
    fn inputs_of_all(&self, players: u32, input_bytes: usize) -> Vec<u8> {
        let mut present = self.inputs.chunks_exact(input_bytes);
        let zeros = vec![0; input_bytes];
        let of_seat = |seat| if self.absent >> seat & 1 == 0 { present.next() } else { None };
        (0..players).map(of_seat).flat_map(|input| input.unwrap_or(&zeros).to_vec()).collect()
    }
}

struct Checkpoint {
    tick: u64,
    /// Hash of the state and of all inputs so far.
    stored: StateHash,
    inputs: StateHash,
}

/// A replay of a game that a host simulates.
pub(crate) struct HostReplay {
    setup: HostSetup,
    runs: Vec<Run>,
    checkpoints: Vec<Checkpoint>,
    trailer: Option<Trailer>,
    pub(super) ticks: u64,
    /// Number of ticks that led to the current state.
    pub(super) tick: u64,
    /// Tick of the last comparison; `None` before the first one and after loading a state.
    pub(super) compared: Option<u64>,
    /// Number of checkpoints at the start of the replay that all match the state hashes of the host.
    equal: usize,
    pub(super) failed: Option<Verdict>,
    /// Claims that the host has added.
    claims: Vec<(String, i64)>,
    pub(super) target: u64,
    pub(super) saved: BTreeSet<u64>,
    pub(super) interval: u64,
}

impl HostReplay {
    fn open(file: &[u8], limits: &Limits) -> Result<Self, Verdict> {
        let mut reader = Reader::open(file, limits)?;
        let setup = read_setup(&reader)?;
        let (mut runs, mut trailer) = (Vec::new(), None);
        let (stored, inputs) = (reader.start(), reader.inputs_digest());
        let mut checkpoints = vec![Checkpoint { tick: 0, stored, inputs }];
        while let Some(part) = reader.next_part()? {
            match part {
                Part::Inputs(block) => {
                    let mut start = reader.ticks() - u64::from(block.ticks);
                    let mut found = block.runs();
                    while let Some(run) = found.next_run()? {
                        let malformed = Verdict::Malformed { offset: run.offset, flaw: Flaw::Inputs };
                        let (inputs, absent) = decode(&setup, run.encoded).ok_or(malformed)?;
                        runs.push(Run { start, inputs, absent });
                        start += u64::from(run.ticks);
                    }
                    let (stored, inputs) = (block.checkpoint, block.inputs_digest);
                    checkpoints.push(Checkpoint { tick: reader.ticks(), stored, inputs });
                }
                Part::Trailer(found) => trailer = Some(found),
                Part::Cut => {}
            }
        }
        let ticks = reader.ticks();
        Ok(HostReplay {
            setup,
            runs,
            checkpoints,
            trailer,
            ticks,
            tick: 0,
            compared: None,
            equal: 0,
            failed: None,
            claims: Vec::new(),
            target: 0,
            saved: BTreeSet::new(),
            interval: ticks.div_ceil(SAVES).max(SAVE_INTERVAL),
        })
    }

    pub(super) fn run(&self) -> Option<&Run> {
        let after = self.runs.partition_point(|run| run.start <= self.tick);
        self.runs.get(after.checked_sub(1)?).filter(|_| self.tick < self.ticks)
    }

    pub(super) fn inputs(&self) -> Vec<u8> {
        let (players, input_bytes) = (self.setup.2, usize::try_from(self.setup.4).unwrap_or(usize::MAX));
        self.run().map_or_else(Vec::new, |run| run.inputs_of_all(players, input_bytes))
    }

    pub(super) fn checkpoint(&self) -> Option<usize> {
        self.checkpoints.binary_search_by_key(&self.tick, |checkpoint| checkpoint.tick).ok()
    }

    /// Compares the state with the checkpoint at the current tick, if there is one.
    fn check(&mut self, hash: StateHash) -> Outcome {
        let Some(index) = self.checkpoint() else { return Ok(()) };
        let Some(&Checkpoint { tick, stored, inputs }) = self.checkpoints.get(index) else { return Ok(()) };
        if checkpoint_hash(hash, inputs) == stored {
            self.compared = Some(tick);
            // This checkpoint extends the sequence only if no earlier checkpoint was skipped.
            self.equal += usize::from(index == self.equal);
            return Ok(());
        }
        if index < self.equal {
            let why = "saving and loading this game loses state";
            return Err(Failure::new(Status::Record, format!("the state of tick {tick} has changed: {why}")));
        }
        self.compared = Some(tick);
        let last_equal = self.equal.checked_sub(1).and_then(|last| self.checkpoints.get(last));
        let last_equal = last_equal.map(|checkpoint| checkpoint.tick);
        self.failed.get_or_insert(Verdict::Diverged { last_equal, first_different: tick });
        Ok(())
    }

    /// Returns the verdict. Fails before the last tick, unless a checkpoint has differed.
    fn verdict(&mut self, hash: StateHash) -> Outcome<Verdict> {
        self.check(hash)?;
        if let Some(failed) = &self.failed {
            return Ok(failed.clone());
        }
        if self.tick < self.ticks {
            let text = format!("{} of {} ticks were played before the verdict", self.tick, self.ticks);
            return Err(Failure::new(Status::Value, text));
        }
        if self.equal < self.checkpoints.len() {
            let text = "the hash was not checked at every checkpoint: check it after every tick";
            return Err(Failure::new(Status::Value, text));
        }
        let ticks = self.ticks;
        Ok(match &self.trailer {
            None => Verdict::Incomplete { ticks, hash },
            Some(trailer) => match trailer.difference(hash, &self.claims) {
                Some(difference) => Verdict::ClaimMismatch { ticks, hash, difference },
                None => Verdict::Match { ticks, hash },
            },
        })
    }
}

fn read_setup(reader: &Reader<'_>) -> Result<HostSetup, Verdict> {
    let header = reader.header();
    let here = (HostGame::RULES.name.to_owned(), HostGame::RULES.version);
    if header.semantics != lockstep2d::SEMANTICS {
        let why = Mismatch::Semantics { file: header.semantics, here: lockstep2d::SEMANTICS };
        return Err(Verdict::Unverifiable { why });
    }
    let file = (header.rules_name.to_owned(), header.rules_version);
    if file != here {
        return Err(Verdict::Unverifiable { why: Mismatch::Rules { file, here } });
    }
    let setup: Option<HostSetup> = codec::decode(header.setup).ok();
    let setup = setup.filter(|setup| (setup.2, setup.3) == (header.players, header.tick_rate));
    let setup = setup.filter(|setup| are_possible(setup.2, setup.4));
    setup.ok_or(Verdict::Malformed { offset: 0, flaw: Flaw::Setup })
}

/// Decodes the inputs of a run. Returns the inputs of the present players, and a bit for each absent player. The
/// encoded input of an absent player is an empty list of bytes.
fn decode(setup: &HostSetup, encoded: &[u8]) -> Option<(Vec<u8>, u64)> {
    let (players, input_bytes) = (setup.2, usize::try_from(setup.4).ok()?);
    let mut list = u64::from(players).to_le_bytes().to_vec();
    list.extend_from_slice(encoded);
    let inputs: Vec<Vec<u8>> = codec::decode(&list).ok()?;
    let absent = inputs.iter().enumerate().filter(|(_, input)| input.is_empty());
    let absent = absent.fold(0, |bits, (seat, _)| bits | 1 << seat);
    let valid = inputs.iter().all(|input| input.is_empty() || input.len() == input_bytes);
    valid.then(|| (inputs.concat(), absent))
}

api! {
    /// Opens a replay of a game with its own rules. The replay may come from an untrusted source. If the replay cannot
    /// be played, its verdict is written, the handle is 0, and the result is `LS2D_RECORD`. Other failures write no
    /// verdict.
    fn ls2d_replay_open(
        data: In<'_, u8>,
        size: usize,
        limits: In<'_, RawLimits>,
        replay: Out<'_, u32>,
        verdict: Out<'_, RawVerdict>,
    ) {
        let (mut replay, mut verdict) = (replay, verdict);
        replay.set(0)?;
        let limits = limits_of(&limits)?;
        set_opened(HostReplay::open(data.slice(size)?, &limits), &mut replay, &mut verdict)
    }

    /// Name of the rules as a bytes object, and numbers that describe the replay. Each pointer except `rules` may be
    /// null.
    fn ls2d_replay_rules(
        replay: u32,
        rules: Out<'_, u32>,
        rules_version: Out<'_, u32>,
        players: Out<'_, u32>,
        tick_rate: Out<'_, u32>,
        input_bytes: Out<'_, u32>,
        ticks: Out<'_, u64>,
    ) {
        let (mut rules, mut ticks) = (rules, ticks);
        rules.check()?;
        let outs = [rules_version, players, tick_rate, input_bytes];
        let name = with(replay, |replay: &mut HostReplay| {
            let (name, version, players, tick_rate, input_bytes, ..) = &replay.setup;
            let figures = [*version, *players, *tick_rate, *input_bytes];
            outs.into_iter().zip(figures).try_for_each(|(mut out, figure)| out.set_if_wanted(figure))?;
            ticks.set_if_wanted(replay.ticks)?;
            Ok(name.clone())
        })?;
        rules.set(table::add(Bytes(name))?)
    }

    /// The setup of the game as bytes.
    fn ls2d_replay_setup(replay: u32, bytes: Out<'_, u32>) {
        let mut bytes = bytes;
        bytes.check()?;
        let setup = with(replay, |replay: &mut HostReplay| Ok(replay.setup.6.clone()))?;
        bytes.set(table::add(Bytes(setup))?)
    }

    /// Name (a bytes object) and number of a result in the file, such as a score. Results are in ascending order of
    /// their names, and are verified only if the verdict is `LS2D_MATCH`. `LS2D_NONE` if there are no more results.
    fn ls2d_replay_claim_at(replay: u32, index: u32, name: Out<'_, u32>, number: Out<'_, i64>) {
        let (mut name, mut number) = (name, number);
        name.check()?;
        let found = with(replay, |replay: &mut HostReplay| {
            let claims = replay.trailer.as_ref().map(|trailer| trailer.claims.as_slice()).unwrap_or_default();
            let index = usize::try_from(index).unwrap_or(usize::MAX);
            let (name, value) = claims.get(index).ok_or_else(Failure::none)?;
            number.set_if_wanted(*value)?;
            Ok(name.as_bytes().to_vec())
        })?;
        name.set(table::add(Bytes(found))?)
    }

    /// Writes the inputs of all players for the next tick to `inputs`, and, unless `absent` is null, a bit for each
    /// absent player to `absent`. Returns `LS2D_NONE` at the end.
    fn ls2d_replay_next(
        replay: u32,
        inputs: Out<'_, u8>,
        capacity: usize,
        size: Out<'_, usize>,
        absent: Out<'_, u64>,
    ) {
        let (mut inputs, mut size, mut absent) = (inputs, size, absent);
        with(replay, |replay: &mut HostReplay| {
            let bits = replay.run().ok_or_else(Failure::none)?.absent;
            inputs.set_all(capacity, &mut size, &replay.inputs())?;
            absent.set_if_wanted(bits)?;
            replay.tick += 1;
            replay.target = replay.tick;
            Ok(())
        })
    }

    /// Compares the hash of the game's state with the file. Call it before the first tick and after each tick, or,
    /// while seeking, for each `LS2D_REQUEST_CHECKSUM`.
    fn ls2d_replay_check(replay: u32, hash: In<'_, RawHash>) {
        let hash = hash.get()?.hash();
        with(replay, |replay: &mut HostReplay| replay.check(hash))
    }

    /// Adds a result of the game that the host has simulated. `ls2d_replay_verdict` compares the results with those in
    /// the file.
    fn ls2d_replay_claim(replay: u32, name: In<'_, u8>, name_length: usize, number: i64) {
        let name = name.text(name_length)?;
        with(replay, |replay: &mut HostReplay| claim(&mut replay.claims, name, number))
    }

    /// The verdict after the last tick, or after a checkpoint that differs. `hash` is the hash of the current state.
    fn ls2d_replay_verdict(replay: u32, hash: In<'_, RawHash>, verdict: Out<'_, RawVerdict>) {
        let mut verdict = verdict;
        let hash = hash.get()?.hash();
        let found = with(replay, |replay: &mut HostReplay| replay.verdict(hash))?;
        note(Failure::new(Status::Ok, found.to_string()));
        verdict.set(RawVerdict::of(&found))
    }
}
