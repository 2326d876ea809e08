//! Recorders for games whose rules are written in another language: the calling program, the host, simulates the game.
//!
//! A checkpoint contains one hash, computed from the host's state hash and all inputs so far.

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::replay::{CLAIM_NAME_BYTES_MAX, CLAIMS_MAX, Recorder};

use super::replay::finished;
use crate::border::{In, Out};
use crate::describe::api;
use crate::numbers::RawHash;
use crate::status::{Failure, Outcome, Status, value};
use crate::table::{self, with};

/// Rules (name, version), players, tick rate, bytes of an input, hash of the first state, the game's own setup.
pub(super) type HostSetup = (Vec<u8>, u32, u32, u32, u32, StateHash, Vec<u8>);

/// Placeholder for the game that the host simulates, because a [`Recorder`] needs a [`Game`].
pub(super) struct HostGame {
    players: u32,
    tick_rate: u32,
    hash: StateHash,
    claims: Vec<(String, i64)>,
}

impl Game for HostGame {
    type Setup = HostSetup;
    /// The bytes of an input; empty if nobody plays the seat.
    type Input = Vec<u8>;
    type Save = StateHash;

    const RULES: RulesId = RulesId { name: "host", version: 1 };

    fn new(setup: &HostSetup) -> Result<Self, SetupError> {
        let &(_, _, players, tick_rate, _, hash, _) = setup;
        Ok(HostGame { players, tick_rate, hash, claims: Vec::new() })
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

    fn claims(&self) -> Vec<(String, i64)> {
        self.claims.clone()
    }
}

/// A recorder of a host's game. Its field `recorder` is `None` once the recording is finished.
pub(crate) struct HostRecorder {
    recorder: Option<Recorder<HostGame>>,
    game: HostGame,
    input_bytes: usize,
}

impl HostRecorder {
    fn get(&mut self) -> Outcome<&mut Recorder<HostGame>> {
        self.recorder.as_mut().ok_or_else(finished)
    }

    /// Splits `bytes` into the inputs of all players. The input of an absent player is empty.
    fn inputs(&self, bytes: &[u8], absent: u64) -> Outcome<Vec<Vec<u8>>> {
        let players = usize::try_from(self.game.players).unwrap_or(usize::MAX);
        let expected = players.saturating_mul(self.input_bytes);
        if bytes.len() != expected {
            let text = format!("{} bytes of inputs, {expected} are expected", bytes.len());
            return Err(Failure::new(Status::Inputs, text));
        }
        let inputs = bytes.chunks_exact(self.input_bytes).enumerate().map(|(seat, input)| {
            if absent >> seat & 1 == 0 {
                return Ok(input.to_vec());
            }
            let is_zero = input.iter().all(|&byte| byte == 0);
            let failure = || Failure::new(Status::Inputs, format!("seat {seat} is absent and has an input"));
            is_zero.then(Vec::new).ok_or_else(failure)
        });
        inputs.collect()
    }
}

/// Whether the number of players and the number of bytes of an input are in range.
pub(super) fn are_possible(players: u32, input_bytes: u32) -> bool {
    (1..=64).contains(&players) && (1..=512).contains(&input_bytes)
}

/// Adds a named result of a game.
pub(super) fn claim(claims: &mut Vec<(String, i64)>, name: &str, number: i64) -> Outcome {
    let length = u32::try_from(name.len()).unwrap_or(u32::MAX);
    if !(1..=CLAIM_NAME_BYTES_MAX).contains(&length) {
        return Err(value("the length of a name of a claim", length));
    }
    if u32::try_from(claims.len()).is_ok_and(|count| count >= CLAIMS_MAX) {
        return Err(value("the number of claims", claims.len() + 1));
    }
    if claims.iter().any(|(other, _)| other == name) {
        return Err(Failure::new(Status::Value, format!("there is already a claim {name:?}")));
    }
    claims.push((name.to_owned(), number));
    Ok(())
}

api! {
    /// Starts a recorder for a game with its own rules. `rules` is the name of the rules in UTF-8, `setup` the data
    /// from which the game makes its first state, and `start` the hash of that state. There is a checkpoint every
    /// `interval` ticks.
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
        if !are_possible(players, input_bytes) {
            return Err(value("the numbers of players and input bytes", format!("{players} and {input_bytes}")));
        }
        let rules = rules.text(rules_length)?.as_bytes().to_vec();
        let setup = setup.slice(setup_size)?.to_vec();
        let start = start.get()?.hash();
        let setup = (rules, rules_version, players, tick_rate, input_bytes, start, setup);
        let (started, game) = Recorder::<HostGame>::start(&setup, interval)?;
        let input_bytes = usize::try_from(input_bytes).unwrap_or(usize::MAX);
        recorder.set(table::add(HostRecorder { recorder: Some(started), game, input_bytes })?)
    }

    /// Records the inputs of the next tick, which cannot be changed later: `input_bytes` bytes for each player, in the
    /// order of the players. `absent` has a bit for each absent player; the input of such a player has to be zeros.
    /// Writes 1 to `due`, unless this pointer is null, if the caller then has to pass the hash of the state after this
    /// tick to `ls2d_recorder_checkpoint`; otherwise 0.
    fn ls2d_recorder_record(
        recorder: u32,
        inputs: In<'_, u8>,
        size: usize,
        absent: u64,
        due: Out<'_, u32>,
    ) {
        let mut due = due;
        due.check_if_wanted()?;
        with(recorder, |recorder: &mut HostRecorder| {
            let inputs = recorder.inputs(inputs.slice(size)?, absent)?;
            let recorder = recorder.get()?;
            recorder.record(&inputs)?;
            due.set_if_wanted(recorder.is_checkpoint_due().into())
        })
    }

    /// Passes the hash of the state after the last recorded tick, for the checkpoint that `ls2d_recorder_record` has
    /// announced as due. The call has no effect if no checkpoint is due.
    fn ls2d_recorder_checkpoint(recorder: u32, hash: In<'_, RawHash>) {
        let hash = hash.get()?.hash();
        with(recorder, |recorder: &mut HostRecorder| {
            recorder.get()?.checkpoint(hash);
            Ok(())
        })
    }

    /// Returns the bytes finished since the last call, which the caller appends to the file.
    fn ls2d_recorder_take(recorder: u32, bytes: Out<'_, u32>) {
        let mut bytes = bytes;
        bytes.check()?;
        let take = || with(recorder, |recorder: &mut HostRecorder| Ok(recorder.get()?.take_bytes()));
        bytes.set(table::add_taken(take)?)
    }

    /// Adds a result of the game, such as a score: a name of 1 to 64 bytes of UTF-8, and a number. A replay has at most
    /// 256 results, and their names must differ. The results can be read without playing the replay.
    fn ls2d_recorder_claim(recorder: u32, name: In<'_, u8>, name_length: usize, number: i64) {
        let name = name.text(name_length)?;
        with(recorder, |recorder: &mut HostRecorder| {
            recorder.get()?;
            claim(&mut recorder.game.claims, name, number)
        })
    }

    /// Returns the bytes that `ls2d_recorder_finish` would return now, and goes on with the recording. After the bytes
    /// taken so far, they complete a replay of the ticks so far, whose last state has the hash `hash`.
    fn ls2d_recorder_so_far(recorder: u32, hash: In<'_, RawHash>, bytes: Out<'_, u32>) {
        let mut bytes = bytes;
        bytes.check()?;
        let hash = hash.get()?.hash();
        let take = |recorder: &mut HostRecorder| {
            let copy = recorder.get()?.clone();
            recorder.game.hash = hash;
            Ok(copy.finish(&recorder.game)?)
        };
        bytes.set(table::add_taken(|| with(recorder, take))?)
    }

    /// Ends a replay with the hash of the last state, and returns the remaining bytes.
    fn ls2d_recorder_finish(recorder: u32, hash: In<'_, RawHash>, bytes: Out<'_, u32>) {
        let mut bytes = bytes;
        bytes.check()?;
        let hash = hash.get()?.hash();
        let take = |recorder: &mut HostRecorder| {
            recorder.game.hash = hash;
            let taken = recorder.recorder.take().ok_or_else(finished)?;
            Ok(taken.finish(&recorder.game)?)
        };
        bytes.set(table::add_taken(|| with(recorder, take))?)
    }
}
