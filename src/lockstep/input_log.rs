#[cfg(test)]
mod tests;
use alloc::vec::Vec;
use core::fmt;

use serde::{Serialize, de::DeserializeOwned};

use crate::codec;

/// Reason why inputs cannot be logged.
///
/// ```
/// use lockstep2d::lockstep::{InputError, InputLog};
/// let mut log = InputLog::<u8>::new(2);
/// // The game has two players, but only one input is passed.
/// assert_eq!(log.push(&[5]), Err(InputError::Count { players: 2, inputs: 1 }));
/// assert_eq!(log.ticks(), 0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputError {
    /// The number of inputs is not the number of players.
    Count {
        /// Number of players.
        players: u32,
        /// Number of inputs.
        inputs: u64,
    },
    /// The bytes are not the canonical encoding of one input for each player.
    NotCanonical,
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            InputError::Count { players, inputs } => write!(f, "{inputs} inputs for {players} players"),
            InputError::NotCanonical => write!(f, "the inputs do not survive encoding and decoding"),
        }
    }
}

impl core::error::Error for InputError {}

/// The inputs of all players for one tick, as canonical bytes and as decoded from them.
///
/// An encoding may be lossy. Step a game with the decoded inputs, because peers and verifiers receive the bytes.
///
/// ```
/// use lockstep2d::lockstep::EncodedInputs;
/// /// The stick is sent without its lowest bits, as drift of a worn pad changes them all the time.
/// #[derive(serde::Serialize, serde::Deserialize, Debug, PartialEq)]
/// #[serde(from = "i8", into = "i8")]
/// struct Stick(i8);
/// # impl Clone for Stick { fn clone(&self) -> Self { Stick(self.0) } }
/// impl From<i8> for Stick { fn from(sent: i8) -> Self { Stick(sent * 16) } }
/// impl From<Stick> for i8 { fn from(stick: Stick) -> i8 { stick.0 / 16 } }
/// // The player's own machine simulates the decoded inputs too.
/// let inputs = EncodedInputs::new(&[Stick(100)], 1)?;
/// assert_eq!((inputs.bytes(), inputs.inputs()), (&[6][..], &[Stick(96)][..]));
/// # Ok::<(), lockstep2d::lockstep::InputError>(())
/// ```
#[derive(Clone, Debug)]
pub struct EncodedInputs<I> {
    bytes: Vec<u8>,
    inputs: Vec<I>,
}

impl<I: Serialize + DeserializeOwned> EncodedInputs<I> {
    /// Encodes the inputs of all players, then decodes the bytes.
    ///
    /// # Errors
    /// [`InputError`] if the number of inputs is not the number of players, or if the bytes do not decode to inputs
    /// with the same encoding.
    pub fn new(inputs: &[I], players: u32) -> Result<Self, InputError> {
        Self::from_bytes(encode_checked(inputs, players)?, players)
    }

    pub(crate) fn from_bytes(bytes: Vec<u8>, players: u32) -> Result<Self, InputError> {
        let inputs = decode_inputs(&bytes, players)?;
        Ok(EncodedInputs { bytes, inputs })
    }

    /// Encodes and decodes the inputs of all players. Returns `None` if the bytes equal those of `last`.
    ///
    /// # Errors
    /// As [`EncodedInputs::new`].
    pub(crate) fn new_after(
        last: Option<&Self>,
        inputs: &[I],
        players: u32,
    ) -> Result<Option<Self>, InputError> {
        let bytes = encode_checked(inputs, players)?;
        if last.is_some_and(|last| last.bytes == bytes) {
            return Ok(None);
        }
        Self::from_bytes(bytes, players).map(Some)
    }

    /// Canonical bytes of the inputs, one after the other.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The decoded inputs, to step a game with.
    #[must_use]
    pub fn inputs(&self) -> &[I] {
        &self.inputs
    }
}

fn encode_checked<I: Serialize>(inputs: &[I], players: u32) -> Result<Vec<u8>, InputError> {
    let count = inputs.len() as u64;
    if count == u64::from(players) {
        Ok(encode_inputs(inputs))
    } else {
        Err(InputError::Count { players, inputs: count })
    }
}

fn encode_inputs<I: Serialize>(inputs: &[I]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for input in inputs {
        codec::encode_into(input, &mut bytes);
    }
    bytes
}

pub(crate) fn decode_inputs<I>(bytes: &[u8], players: u32) -> Result<Vec<I>, InputError>
where
    I: Serialize + DeserializeOwned,
{
    // With the list length in front, the bytes are the canonical encoding of a list.
    let mut list = u64::from(players).to_le_bytes().to_vec();
    list.extend_from_slice(bytes);
    let inputs: Vec<I> = codec::decode(&list).map_err(|_| InputError::NotCanonical)?;
    if encode_inputs(&inputs) == bytes { Ok(inputs) } else { Err(InputError::NotCanonical) }
}

/// The inputs of all ticks so far. Consecutive ticks with equal inputs are stored once.
///
/// ```
/// use lockstep2d::lockstep::InputLog;
///
/// let mut log = InputLog::<u8>::new(2);
/// log.push(&[1, 0])?;
/// log.push(&[1, 0])?;
/// log.truncate(1); // a rollback: tick 1 was mispredicted
/// log.push(&[1, 7])?;
/// assert_eq!(log.get(1), Some(&[1, 7][..]));
/// # Ok::<(), lockstep2d::lockstep::InputError>(())
/// ```
#[derive(Clone, Debug)]
pub struct InputLog<I> {
    players: u32,
    runs: Vec<LoggedRun<I>>,
}

#[derive(Clone, Debug)]
struct LoggedRun<I> {
    end: u64,
    inputs: EncodedInputs<I>,
}

impl<I: Serialize + DeserializeOwned> InputLog<I> {
    /// Creates an empty log.
    #[must_use]
    pub fn new(players: u32) -> Self {
        InputLog { players, runs: Vec::new() }
    }

    /// Number of logged ticks.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.runs.last().map_or(0, |run| run.end)
    }

    /// Number of runs: sequences of consecutive ticks with equal inputs, which are stored once.
    #[must_use]
    pub fn runs(&self) -> usize {
        self.runs.len()
    }

    /// Logs the inputs of the next tick. Returns the inputs as decoded from their bytes, to step the game with.
    ///
    /// # Errors
    /// [`InputError`] if the inputs cannot be logged. The log is then unchanged.
    pub fn push(&mut self, inputs: &[I]) -> Result<&[I], InputError> {
        let last = self.runs.last().map(|run| &run.inputs);
        let new = EncodedInputs::new_after(last, inputs, self.players)?;
        Ok(self.extend(new))
    }

    /// Logs the encoded inputs of the next tick, and returns them decoded.
    ///
    /// # Errors
    /// [`InputError::Count`] if the number of inputs is not the number of players. The log is then unchanged.
    pub fn push_encoded(&mut self, inputs: &EncodedInputs<I>) -> Result<&[I], InputError>
    where
        I: Clone,
    {
        let count = inputs.inputs().len() as u64;
        if count != u64::from(self.players) {
            return Err(InputError::Count { players: self.players, inputs: count });
        }
        let is_same = self.runs.last().is_some_and(|run| run.inputs.bytes() == inputs.bytes());
        Ok(self.extend((!is_same).then(|| inputs.clone())))
    }

    /// Adds a tick with the inputs `new`, or with those of the previous tick if `new` is `None`. Returns the inputs of
    /// the tick.
    fn extend(&mut self, new: Option<EncodedInputs<I>>) -> &[I] {
        let end = self.ticks() + 1;
        match (new, self.runs.last_mut()) {
            (Some(inputs), _) => self.runs.push(LoggedRun { end, inputs }),
            (None, Some(run)) => run.end = end,
            (None, None) => {}
        }
        self.runs.last().map_or(&[], |run| run.inputs.inputs())
    }

    /// The inputs of a tick, counted from 0.
    #[must_use]
    pub fn get(&self, tick: u64) -> Option<&[I]> {
        self.get_encoded(tick).map(EncodedInputs::inputs)
    }

    /// The inputs of a tick, counted from 0, with their bytes.
    #[must_use]
    pub fn get_encoded(&self, tick: u64) -> Option<&EncodedInputs<I>> {
        let index = self.runs.partition_point(|run| run.end <= tick);
        self.runs.get(index).map(|run| &run.inputs)
    }

    /// Keeps the first `ticks` ticks.
    pub fn truncate(&mut self, ticks: u64) {
        let keep = self.runs.partition_point(|run| run.end <= ticks);
        let start = keep.checked_sub(1).map_or(0, |before| self.runs[before].end);
        if let Some(run) = self.runs.get_mut(keep) {
            run.end = ticks;
        }
        self.runs.truncate(if start < ticks { keep + 1 } else { keep });
    }
}
