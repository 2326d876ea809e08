use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;
use core::marker::PhantomData;

use super::bytes::put_varint;
use super::format::{
    BLOCK_BYTES_MAX, BLOCK_HEAD_BYTES, BLOCK_TICKS_MAX, CLAIM_NAME_BYTES_MAX, CLAIMS_MAX, HASH_BYTES,
    PLAYERS_MAX, RULES_NAME_BYTES_MAX, SETUP_BYTES_MAX, checkpoint_hash, checksum, kind, link,
};
use super::header::Header;
use super::runs::Run;
use crate::codec;
use crate::hash::StateHash;
use crate::lockstep::{EncodedInputs, Game, InputError};

/// Recommended checkpoint interval: one second at 60 Hz. With a longer interval, a crash loses more ticks, and a
/// divergence is located less precisely. With a shorter interval, the file is longer: each block takes 29 bytes in
/// addition to its runs.
pub const CHECKPOINT_INTERVAL: u32 = 60;

const VARINT_BYTES_MAX: usize = 5;

/// Reason why a game or a tick cannot be recorded.
///
/// ```
/// use lockstep2d::lockstep::{InputError, Sandbox, SandboxSetup};
/// use lockstep2d::replay::{RecordError, Recording};
/// let setup = SandboxSetup::default();
/// assert_eq!(Recording::<Sandbox>::start(&setup, 0).err(), Some(RecordError::CheckpointInterval { ticks: 0 }));
/// // A tick with inputs of two players is not recorded, because the game has one player.
/// let mut recording = Recording::<Sandbox>::start(&setup, 60)?;
/// let wrong = InputError::Count { players: 1, inputs: 2 };
/// assert_eq!(recording.step(&[vec![], vec![]]), Err(RecordError::Inputs(wrong)));
/// assert_eq!(recording.ticks(), 0);
/// # Ok::<(), RecordError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RecordError {
    /// The name of the rules is empty or too long.
    RulesName,
    /// The game has more players than a replay can hold.
    Players {
        /// Number of players.
        count: u32,
    },
    /// The game's tick rate is zero.
    TickRate,
    /// The checkpoint interval is zero or too long.
    CheckpointInterval {
        /// The interval in ticks.
        ticks: u32,
    },
    /// The setup changes when it is encoded and decoded.
    Setup,
    /// The game cannot start from the setup.
    SetupRefused {
        /// Reason given by the game.
        why: String,
    },
    /// The encoded setup is too long.
    SetupLength {
        /// Length in bytes.
        bytes: u64,
    },
    /// The inputs cannot be recorded.
    Inputs(InputError),
    /// The block could exceed its maximum payload.
    BlockLength {
        /// Upper bound of the payload in bytes.
        bytes: u64,
    },
    /// The block is full, and [`Recorder::checkpoint`] was not called.
    CheckpointDue,
    /// Two claims have the same name, a name is empty or too long, or there are too many claims.
    Claims,
}

impl fmt::Display for RecordError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RecordError::RulesName => {
                write!(f, "the name of the rules is not 1 to {RULES_NAME_BYTES_MAX} bytes long")
            }
            RecordError::Players { count } => {
                write!(f, "{count} players, at most {PLAYERS_MAX} are possible")
            }
            RecordError::TickRate => write!(f, "a tick rate of zero"),
            RecordError::CheckpointInterval { ticks } => {
                write!(f, "a checkpoint interval of {ticks} ticks, expected 1 to {BLOCK_TICKS_MAX}")
            }
            RecordError::Setup => write!(f, "the setup changes when it is encoded and decoded"),
            RecordError::SetupRefused { why } => write!(f, "the setup cannot start a game: {why}"),
            RecordError::SetupLength { bytes } => {
                write!(f, "a setup of {bytes} bytes, at most {SETUP_BYTES_MAX} are possible")
            }
            RecordError::Inputs(error) => write!(f, "{error}"),
            RecordError::BlockLength { bytes } => {
                write!(f, "a block of {bytes} bytes, at most {BLOCK_BYTES_MAX} are possible")
            }
            RecordError::CheckpointDue => {
                write!(f, "the block is full, its checkpoint must be given before the next tick")
            }
            RecordError::Claims => write!(
                f,
                "at most {CLAIMS_MAX} claims with different names of 1 to {CLAIM_NAME_BYTES_MAX} bytes are possible"
            ),
        }
    }
}

impl core::error::Error for RecordError {}

/// Writes the replay of a game that the caller steps. [`Recording`](super::Recording) also steps the game.
///
/// Append the bytes from [`Recorder::take_bytes`] to a file. They end with the header or a complete block, so the file
/// is a prefix of a replay at any time. If the game uses rollback, record only confirmed ticks.
///
/// ```
/// use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
/// use lockstep2d::replay::{CHECKPOINT_INTERVAL, Limits, Recorder, Verdict, verify};
/// let (mut recorder, mut game) = Recorder::<Sandbox>::start(&SandboxSetup::default(), CHECKPOINT_INTERVAL)?;
/// for _ in 0..90 {
///     // Steps the game with the inputs as a verifier decodes them.
///     game.step(recorder.record(&[vec![]])?);
///     if recorder.is_checkpoint_due() {
///         recorder.checkpoint(game.state_hash());
///     }
/// }
/// let file = recorder.finish(&game)?;
/// assert!(matches!(verify::<Sandbox>(&file, &Limits::default()), Verdict::Match { ticks: 90, .. }));
/// # Ok::<(), lockstep2d::replay::RecordError>(())
/// ```
pub struct Recorder<G: Game> {
    players: u32,
    checkpoint_interval: u32,
    /// Header and complete blocks that have not been taken.
    finished: Vec<u8>,
    chain: StateHash,
    inputs_digest: StateHash,
    /// Encoded runs of the current block, except the last one.
    runs: Vec<u8>,
    last_run: Option<(EncodedInputs<G::Input>, u32)>,
    block_ticks: u32,
    ticks: u64,
    game: PhantomData<fn(&G)>,
}

impl<G: Game> Clone for Recorder<G> {
    fn clone(&self) -> Self {
        Recorder {
            finished: self.finished.clone(),
            runs: self.runs.clone(),
            last_run: self.last_run.clone(),
            ..*self
        }
    }
}

impl<G: Game> Recorder<G> {
    /// Starts the game and its replay.
    ///
    /// The setup is encoded, and the game starts from the decoded bytes, as it does when the replay is verified.
    ///
    /// # Errors
    /// [`RecordError`] if the setup cannot start a game, or a replay cannot represent the game.
    pub fn start(setup: &G::Setup, checkpoint_interval: u32) -> Result<(Self, G), RecordError> {
        let setup = codec::encode(setup);
        let (game, header) = first_state::<G>(&setup, checkpoint_interval)?;

        let mut finished = header.encode();
        let inputs_digest = StateHash::of_bytes(&finished);
        let start = checkpoint_hash(game.state_hash(), inputs_digest);
        finished.extend_from_slice(&start.0.to_le_bytes());
        let chain = StateHash::of_bytes(&finished);
        finished.extend_from_slice(&checksum(chain));

        let recorder = Recorder {
            players: header.players,
            checkpoint_interval,
            finished,
            chain,
            inputs_digest,
            runs: Vec::new(),
            last_run: None,
            block_ticks: 0,
            ticks: 0,
            game: PhantomData,
        };
        Ok((recorder, game))
    }

    /// Number of recorded ticks.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.ticks
    }

    /// Records the inputs of the next tick. Returns these inputs as they will be decoded when the replay is verified;
    /// step the game with the returned inputs.
    ///
    /// # Errors
    /// [`RecordError`] if the inputs cannot be recorded. Do not play the tick.
    pub fn record(&mut self, inputs: &[G::Input]) -> Result<&[G::Input], RecordError> {
        if self.is_checkpoint_due() {
            return Err(RecordError::CheckpointDue);
        }
        let last = self.last_run.as_ref().map(|(run, _)| run);
        let new = EncodedInputs::new_after(last, inputs, self.players).map_err(RecordError::Inputs)?;
        self.extend(new)
    }

    /// Records encoded inputs of the next tick.
    ///
    /// # Errors
    /// [`RecordError`] if the inputs cannot be recorded.
    pub fn record_encoded(&mut self, inputs: &EncodedInputs<G::Input>) -> Result<(), RecordError> {
        if self.is_checkpoint_due() {
            return Err(RecordError::CheckpointDue);
        }
        let count = inputs.inputs().len() as u64;
        if count != u64::from(self.players) {
            return Err(RecordError::Inputs(InputError::Count { players: self.players, inputs: count }));
        }
        let is_same = self.last_run.as_ref().is_some_and(|(run, _)| run.bytes() == inputs.bytes());
        self.extend((!is_same).then(|| inputs.clone()))?;
        Ok(())
    }

    /// Adds a tick with `new` inputs, or with the inputs of the tick before if `new` is `None`. Returns the inputs of
    /// the tick.
    fn extend(&mut self, new: Option<EncodedInputs<G::Input>>) -> Result<&[G::Input], RecordError> {
        if let Some(new) = new {
            let bytes = self.block_length_with(&new);
            if bytes > BLOCK_BYTES_MAX as usize {
                return Err(RecordError::BlockLength { bytes: bytes as u64 });
            }
            if let Some((run, ticks)) = self.last_run.replace((new, 0)) {
                Run::write(ticks, run.bytes(), &mut self.runs);
            }
        }
        self.block_ticks += 1;
        self.ticks += 1;
        Ok(self.last_run.as_mut().map_or(&[], |(run, ticks)| {
            *ticks += 1;
            run.inputs()
        }))
    }

    /// Whether the block is full and needs [`Recorder::checkpoint`] before the next tick.
    #[must_use]
    pub fn is_checkpoint_due(&self) -> bool {
        self.block_ticks == self.checkpoint_interval
    }

    /// Finishes the block if it is full; does nothing otherwise. `state` is the state hash after the last recorded
    /// tick.
    pub fn checkpoint(&mut self, state: StateHash) {
        if self.is_checkpoint_due() {
            self.finish_block(state);
        }
    }

    /// Takes the finished bytes, to be appended to the file.
    #[must_use]
    pub fn take_bytes(&mut self) -> Vec<u8> {
        core::mem::take(&mut self.finished)
    }

    /// Returns the bytes that have not been taken, followed by the current block, which ends with a checkpoint of
    /// `state`. All bytes taken so far and the returned bytes together are a replay without a trailer. The recorder is
    /// unchanged.
    #[must_use]
    pub fn so_far(&self, state: StateHash) -> Vec<u8> {
        let mut copy = self.clone();
        if copy.block_ticks > 0 {
            copy.finish_block(state);
        }
        copy.finished
    }

    /// Writes the last block and the trailer, and returns the bytes that have not been taken.
    ///
    /// # Errors
    /// [`RecordError::Claims`] if the game's claims cannot be recorded.
    pub fn finish(mut self, game: &G) -> Result<Vec<u8>, RecordError> {
        let claims = encode_claims(game.claims())?;
        let state = game.state_hash();
        if self.block_ticks > 0 {
            self.finish_block(state);
        }
        let mut payload = Vec::new();
        payload.extend_from_slice(&self.ticks.to_le_bytes());
        payload.extend_from_slice(&state.0.to_le_bytes());
        payload.extend_from_slice(&self.chain.0.to_le_bytes());
        payload.extend_from_slice(&claims);
        self.append_block(kind::TRAILER, &payload);
        Ok(self.finished)
    }

    /// Upper bound of the block's payload in bytes, if a run of these inputs is added.
    fn block_length_with(&self, added: &EncodedInputs<G::Input>) -> usize {
        let run_length = |encoded: &EncodedInputs<G::Input>| encoded.bytes().len() + 2 * VARINT_BYTES_MAX;
        let previous = self.last_run.as_ref().map_or(0, |(encoded, _)| run_length(encoded));
        self.runs.len() + previous + run_length(added) + HASH_BYTES
    }

    fn finish_block(&mut self, state: StateHash) {
        let mut payload = core::mem::take(&mut self.runs);
        if let Some((run, ticks)) = self.last_run.take() {
            Run::write(ticks, run.bytes(), &mut payload);
        }
        self.block_ticks = 0;
        self.inputs_digest = link(self.inputs_digest, &payload);
        let checkpoint = checkpoint_hash(state, self.inputs_digest);
        payload.extend_from_slice(&checkpoint.0.to_le_bytes());
        self.append_block(kind::INPUTS, &payload);
    }

    fn append_block(&mut self, kind: u8, payload: &[u8]) {
        let length = u32::try_from(payload.len()).expect("a length that was checked");
        let mut block = Vec::with_capacity(BLOCK_HEAD_BYTES + payload.len());
        block.extend_from_slice(&length.to_le_bytes());
        block.push(kind);
        block.extend_from_slice(payload);
        self.chain = link(self.chain, &block);
        self.finished.extend_from_slice(&block);
        self.finished.extend_from_slice(&checksum(self.chain));
    }
}

fn first_state<G: Game>(setup: &[u8], checkpoint_interval: u32) -> Result<(G, Header<'_>), RecordError> {
    let rules_name = G::RULES.name;
    if rules_name.is_empty() || rules_name.len() > RULES_NAME_BYTES_MAX as usize {
        return Err(RecordError::RulesName);
    }
    if checkpoint_interval == 0 || checkpoint_interval > BLOCK_TICKS_MAX {
        return Err(RecordError::CheckpointInterval { ticks: checkpoint_interval });
    }
    if setup.len() > SETUP_BYTES_MAX as usize {
        return Err(RecordError::SetupLength { bytes: setup.len() as u64 });
    }
    let decoded: G::Setup = codec::decode(setup).map_err(|_| RecordError::Setup)?;
    if codec::encode(&decoded) != setup {
        return Err(RecordError::Setup);
    }
    let game = G::new(&decoded).map_err(|error| RecordError::SetupRefused { why: error.why })?;
    let (players, tick_rate) = (game.players(), game.tick_rate());
    if players > PLAYERS_MAX {
        return Err(RecordError::Players { count: players });
    }
    if tick_rate == 0 {
        return Err(RecordError::TickRate);
    }
    let header = Header {
        semantics: crate::SEMANTICS,
        rules_version: G::RULES.version,
        players,
        tick_rate,
        checkpoint_interval,
        rules_name,
        setup,
    };
    Ok((game, header))
}

fn encode_claims(mut claims: Vec<(String, i64)>) -> Result<Vec<u8>, RecordError> {
    claims.sort();
    let are_distinct = claims.windows(2).all(|pair| pair[0].0 != pair[1].0);
    let are_named =
        claims.iter().all(|(name, _)| !name.is_empty() && name.len() <= CLAIM_NAME_BYTES_MAX as usize);
    let count = u32::try_from(claims.len()).unwrap_or(u32::MAX);
    if count > CLAIMS_MAX || !are_distinct || !are_named {
        return Err(RecordError::Claims);
    }
    let mut bytes = Vec::new();
    put_varint(count, &mut bytes);
    for (name, value) in &claims {
        put_varint(u32::try_from(name.len()).unwrap_or(u32::MAX), &mut bytes);
        bytes.extend_from_slice(name.as_bytes());
        bytes.extend_from_slice(&value.to_le_bytes());
    }
    Ok(bytes)
}
