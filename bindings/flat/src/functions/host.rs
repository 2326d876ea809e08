//! Replays of games whose rules are in another language: the game plays, and this library keeps the file.
//!
//! A checkpoint is a hash of the state, which the game computes, and of all inputs so far. To verify a file, the game
//! plays its inputs and passes its hashes.

use std::collections::VecDeque;

use lockstep2d::codec;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::replay::{
    ClaimDifference, Limits, Mismatch, Part, Reader, Recorder, Verdict, checkpoint_hash,
};

use super::replay::{finished, limits_of};
use crate::border::{In, Out};
use crate::describe::api;
use crate::numbers::RawHash;
use crate::records::{RawLimits, RawVerdict};
use crate::status::{Failure, Outcome, Status, note, value};
use crate::table::{self, Bytes, with};

/// Setup of a host's game: rules, players, tick rate, bytes of an input, hash of the first state, the game's own setup.
type HostSetup = (Vec<u8>, u32, u32, u32, u32, StateHash, Vec<u8>);

/// Players, tick rate and state hash of a game that the host plays, for its recorder.
struct HostGame {
    players: u32,
    tick_rate: u32,
    hash: StateHash,
}

impl Game for HostGame {
    type Setup = HostSetup;
    type Input = Vec<u8>;
    type Save = StateHash;

    const RULES: RulesId = RulesId { name: "host", version: 1 };

    fn new(setup: &HostSetup) -> Result<Self, SetupError> {
        let &(_, _, players, tick_rate, _, hash, _) = setup;
        Ok(HostGame { players, tick_rate, hash })
    }

    fn players(&self) -> u32 {
        self.players
    }

    fn tick_rate(&self) -> u32 {
        self.tick_rate
    }

    fn step(&mut self, _: &[Vec<u8>]) {}

    fn state_hash(&self) -> StateHash {
        self.hash
    }

    fn save(&self) -> StateHash {
        self.hash
    }

    fn load(&mut self, save: &StateHash) {
        self.hash = *save;
    }

    fn work(&self, _: &[Vec<u8>]) -> u64 {
        1
    }
}

/// A recorder of a host's game until it is finished.
pub(crate) struct HostRecorder {
    recorder: Option<Recorder<HostGame>>,
    game: HostGame,
    input_bytes: usize,
}

impl HostRecorder {
    fn get(&mut self) -> Outcome<&mut Recorder<HostGame>> {
        self.recorder.as_mut().ok_or_else(finished)
    }

    /// The inputs of all players from their bytes.
    fn inputs(&self, bytes: &[u8]) -> Outcome<Vec<Vec<u8>>> {
        let players = usize::try_from(self.game.players).unwrap_or(usize::MAX);
        let expected = players.saturating_mul(self.input_bytes);
        if bytes.len() != expected {
            let text = format!("{} bytes of inputs, {expected} are expected", bytes.len());
            return Err(Failure::new(Status::Inputs, text));
        }
        Ok(bytes.chunks_exact(self.input_bytes).map(<[u8]>::to_vec).collect())
    }
}

/// Ticks with the same inputs.
struct Run {
    ticks: u32,
    inputs: Vec<u8>,
}

/// A checkpoint: number of ticks, stored hash, and digest of the inputs.
type Checkpoint = (u64, StateHash, StateHash);

/// A replay that a host plays.
pub(crate) struct HostReplay {
    setup: HostSetup,
    runs: VecDeque<Run>,
    checkpoints: VecDeque<Checkpoint>,
    /// The final hash, if the file is complete.
    end: Option<StateHash>,
    tick: u64,
    ticks: u64,
    last_equal: Option<u64>,
    failed: Option<Verdict>,
}

impl HostReplay {
    fn open(file: &[u8], limits: &Limits) -> Result<Self, Verdict> {
        let mut reader = Reader::open(file, limits)?;
        let setup = Self::read_setup(&reader)?;
        let input_bytes = usize::try_from(setup.4).unwrap_or(usize::MAX);
        let inputs_length = usize::try_from(setup.2).unwrap_or(usize::MAX).saturating_mul(input_bytes);
        let mut replay = HostReplay {
            setup,
            runs: VecDeque::new(),
            checkpoints: VecDeque::from([(0, reader.start(), reader.inputs_digest())]),
            end: None,
            tick: 0,
            ticks: 0,
            last_equal: None,
            failed: None,
        };
        while let Some(part) = reader.next_part()? {
            match part {
                Part::Inputs(block) => {
                    let mut runs = block.runs();
                    while let Some(run) = runs.next_run()? {
                        let inputs = replay.decode(run.encoded, input_bytes, inputs_length);
                        let flaw = lockstep2d::replay::Flaw::Inputs;
                        let inputs = inputs.ok_or(Verdict::Malformed { offset: run.offset, flaw })?;
                        replay.runs.push_back(Run { ticks: run.ticks, inputs });
                    }
                    replay.checkpoints.push_back((reader.ticks(), block.checkpoint, block.inputs_digest));
                }
                Part::Trailer(trailer) => replay.end = Some(trailer.final_hash),
                Part::Cut => {}
            }
        }
        replay.ticks = reader.ticks();
        Ok(replay)
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
        setup.ok_or(Verdict::Malformed { offset: 0, flaw: lockstep2d::replay::Flaw::Setup })
    }

    /// Decodes the inputs of a run, a list of bytes for each player, and returns the bytes of all players one after
    /// another.
    fn decode(&self, encoded: &[u8], input_bytes: usize, length: usize) -> Option<Vec<u8>> {
        let mut list = u64::from(self.setup.2).to_le_bytes().to_vec();
        list.extend_from_slice(encoded);
        let inputs: Vec<Vec<u8>> = codec::decode(&list).ok()?;
        let valid = inputs.iter().all(|input| input.len() == input_bytes);
        let inputs = inputs.concat();
        (valid && inputs.len() == length).then_some(inputs)
    }

    /// The inputs of the next tick.
    fn next(&mut self) -> Option<Vec<u8>> {
        let run = self.runs.front_mut()?;
        run.ticks -= 1;
        self.tick += 1;
        let done = run.ticks == 0;
        let inputs = run.inputs.clone();
        if done {
            self.runs.pop_front();
        }
        Some(inputs)
    }

    /// Compares the state after the ticks so far with the checkpoint, if there is one here.
    fn check(&mut self, hash: StateHash) {
        let here = |&&(ticks, _, _): &&Checkpoint| ticks == self.tick;
        let Some(&(ticks, stored, digest)) = self.checkpoints.front().filter(here) else { return };
        self.checkpoints.pop_front();
        if checkpoint_hash(hash, digest) == stored {
            self.last_equal = Some(ticks);
        } else if self.failed.is_none() {
            self.failed = Some(Verdict::Diverged { last_equal: self.last_equal, first_different: ticks });
        }
    }

    /// The verdict after the last tick.
    fn verdict(&mut self, hash: StateHash) -> Outcome<Verdict> {
        self.check(hash);
        if let Some(failed) = &self.failed {
            return Ok(failed.clone());
        }
        let unchecked = self.checkpoints.front().map(|&(ticks, _, _)| ticks);
        if self.tick < self.ticks || unchecked.is_some_and(|ticks| ticks < self.ticks) {
            return Err(value("the number of ticks played before the verdict", self.tick));
        }
        let ticks = self.ticks;
        Ok(match self.end {
            None => Verdict::Incomplete { ticks, hash },
            Some(claimed) if claimed != hash => {
                let difference = ClaimDifference::FinalHash { claimed, actual: hash };
                Verdict::ClaimMismatch { ticks, hash, difference }
            }
            Some(_) => Verdict::Match { ticks, hash },
        })
    }
}

api! {
    /// Starts a recorder for a game with rules of its own. `rules` is the name of the rules in UTF-8, `setup` what the
    /// first tick depends on, `start` the hash of the state before it. There is a checkpoint every `interval` ticks.
    fn ls2d_recorder_new(
        rules: In<'_, u8>,
        rules_length: usize,
        rules_version: u32,
        players: u32,
        tick_rate: u32,
        input_bytes: u32,
        setup: In<'_, u8>,
        setup_size: usize,
        start: In<'_, RawHash>,
        interval: u32,
        recorder: Out<'_, u32>,
    ) {
        let mut recorder = recorder;
        recorder.check()?;
        if !(1..=512).contains(&input_bytes) || !(1..=64).contains(&players) {
            return Err(value("players or bytes of an input", format!("{players}, {input_bytes}")));
        }
        let rules = rules.text(rules_length)?.as_bytes().to_vec();
        let setup = setup.slice(setup_size)?.to_vec();
        let start = start.get()?.hash();
        let setup = (rules, rules_version, players, tick_rate, input_bytes, start, setup);
        let (started, game) = Recorder::<HostGame>::start(&setup, interval)?;
        let input_bytes = usize::try_from(input_bytes).unwrap_or(usize::MAX);
        recorder.set(table::add(HostRecorder { recorder: Some(started), game, input_bytes })?)
    }

    /// Records the final inputs of the next tick: those of all players, one after another. Writes 1 to `due` if
    /// `ls2d_recorder_checkpoint` has to follow with the hash of the state after this tick.
    fn ls2d_recorder_record(recorder: u32, inputs: In<'_, u8>, size: usize, due: Out<'_, u32>) {
        let mut due = due;
        with(recorder, |recorder: &mut HostRecorder| {
            let inputs = recorder.inputs(inputs.slice(size)?)?;
            let recorder = recorder.get()?;
            recorder.record(&inputs)?;
            due.set_if_wanted(recorder.is_checkpoint_due().into())
        })
    }

    /// Passes the hash of the state after the last recorded tick. Without a checkpoint due, nothing happens.
    fn ls2d_recorder_checkpoint(recorder: u32, hash: In<'_, RawHash>) {
        let hash = hash.get()?.hash();
        with(recorder, |recorder: &mut HostRecorder| {
            recorder.get()?.checkpoint(hash);
            Ok(())
        })
    }

    /// Takes the bytes that are finished, to be appended to the file.
    fn ls2d_recorder_take(recorder: u32, bytes: Out<'_, u32>) {
        let mut bytes = bytes;
        bytes.check()?;
        let taken = with(recorder, |recorder: &mut HostRecorder| Ok(recorder.get()?.take_bytes()))?;
        bytes.set(table::add(Bytes(taken))?)
    }

    /// Ends a replay with the hash of the last state, and returns the bytes that have not been taken yet.
    fn ls2d_recorder_finish(recorder: u32, hash: In<'_, RawHash>, bytes: Out<'_, u32>) {
        let mut bytes = bytes;
        bytes.check()?;
        let hash = hash.get()?.hash();
        let rest = with(recorder, |recorder: &mut HostRecorder| {
            recorder.game.hash = hash;
            let taken = recorder.recorder.take().ok_or_else(finished)?;
            Ok(taken.finish(&recorder.game)?)
        })?;
        bytes.set(table::add(Bytes(rest))?)
    }

    /// Opens a replay of a game with rules of its own, from any source. If it cannot be played, its verdict is written,
    /// the handle is 0, and the result is `LS2D_RECORD`.
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
        match HostReplay::open(data.slice(size)?, &limits) {
            Ok(opened) => replay.set(table::add(opened)?),
            Err(found) => {
                verdict.set_if_wanted(RawVerdict::of(&found))?;
                Err(Failure::new(Status::Record, found.to_string()))
            }
        }
    }

    /// Name of the rules as bytes. The other figures of the header are written where a pointer is not null.
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

    /// The inputs of all players for the next tick, as `players` times `input_bytes` bytes. `LS2D_NONE` at the end.
    fn ls2d_replay_next(replay: u32, inputs: Out<'_, u8>, capacity: usize, size: Out<'_, usize>) {
        let (mut inputs, mut size) = (inputs, size);
        with(replay, |replay: &mut HostReplay| {
            let (players, bytes) = (replay.setup.2, replay.setup.4);
            let needed = usize::try_from(players.saturating_mul(bytes)).unwrap_or(usize::MAX);
            if capacity < needed {
                size.set(needed)?;
                return Err(Failure::new(Status::Buffer, format!("inputs have {needed} bytes")));
            }
            let next = replay.next().ok_or_else(Failure::none)?;
            inputs.set_all(capacity, &mut size, &next)
        })
    }

    /// Passes the hash of the state before the first tick, and after each tick.
    fn ls2d_replay_check(replay: u32, hash: In<'_, RawHash>) {
        let hash = hash.get()?.hash();
        with(replay, |replay: &mut HostReplay| {
            replay.check(hash);
            Ok(())
        })
    }

    /// The verdict after the last tick, with the hash of the last state.
    fn ls2d_replay_verdict(replay: u32, hash: In<'_, RawHash>, verdict: Out<'_, RawVerdict>) {
        let mut verdict = verdict;
        let hash = hash.get()?.hash();
        let found = with(replay, |replay: &mut HostReplay| replay.verdict(hash))?;
        note(Failure::new(Status::Ok, found.to_string()));
        verdict.set(RawVerdict::of(&found))
    }
}
