//! Logs: the inputs of every tick. Logs that are derived from one another share the inputs in memory.

use alloc::rc::Rc;
use alloc::vec;
use alloc::vec::Vec;

use super::failure::CheckError;
use crate::codec;
use crate::lockstep::{EncodedInputs, Game, InputError, decode_inputs};
use crate::replay::{
    CHECKPOINT_INTERVAL, Flaw, Limits, RawReplay, ReadError, Reader, Recording, TickInputs, Verdict,
};

pub(super) type Inputs<G> = Rc<[<G as Game>::Input]>;

pub(super) struct Log<G: Game> {
    pub(super) players: u32,
    /// Ticks between checkpoints of recorded replays.
    pub(super) interval: u32,
    pub(super) ticks: Vec<Inputs<G>>,
}

impl<G: Game> Log<G> {
    pub(super) fn new(players: u32) -> Self {
        Log { players, interval: CHECKPOINT_INTERVAL, ticks: Vec::new() }
    }

    pub(super) fn push(&mut self, inputs: &[G::Input]) -> Result<(), InputError> {
        let inputs = EncodedInputs::new(inputs, self.players)?;
        self.ticks.push(inputs.inputs().into());
        Ok(())
    }

    pub(super) fn of(&self, ticks: Vec<Inputs<G>>) -> Self {
        Log { ticks, ..*self }
    }

    pub(super) fn len(&self) -> u64 {
        self.ticks.len() as u64
    }

    pub(super) fn nothing(&self) -> Inputs<G> {
        vec![G::Input::default(); self.players as usize].into()
    }

    /// Records a replay, up to the first tick that cannot be recorded. Empty if the setup cannot start a game.
    pub(super) fn record(&self, setup: &G::Setup) -> Vec<u8> {
        let Ok(mut recording) = Recording::<G>::start(setup, self.interval) else {
            return Vec::new();
        };
        let mut file = Vec::new();
        for inputs in &self.ticks {
            if recording.step(inputs).is_err() {
                break;
            }
        }
        file.extend(recording.take_bytes());
        file.extend(recording.finish().unwrap_or_default());
        file
    }
}

pub(super) struct Logged<G: Game> {
    pub(super) setup: G::Setup,
    pub(super) log: Log<G>,
}

/// Reads the first `to` ticks of a replay.
pub(super) fn read<G: Game>(file: &[u8], limits: &Limits, to: u64) -> Result<Logged<G>, CheckError> {
    // Opening the replay checks the whole file, except the encoding of the inputs.
    let players = RawReplay::<G>::open(file, limits)?.game().players();
    let refused = |error: ReadError| CheckError::Replay(error.into());
    let mut ticks = TickInputs::open(file, limits).map_err(refused)?;
    let reader = Reader::open(file, limits).map_err(refused)?;
    let no_setup = |_| Verdict::Malformed { offset: 0, flaw: Flaw::Setup };
    let setup = codec::decode(reader.header().setup).map_err(no_setup)?;
    let interval = reader.header().checkpoint_interval;
    let mut log = Log::<G> { players, interval, ticks: Vec::new() };
    let mut last: Option<(&[u8], Inputs<G>)> = None;
    while log.len() < to {
        let Some(run) = ticks.next_tick().map_err(refused)? else {
            break;
        };
        let known =
            last.as_ref().filter(|(encoded, _)| *encoded == run.encoded).map(|(_, inputs)| inputs.clone());
        let inputs = match known {
            Some(inputs) => inputs,
            None => decode_inputs(run.encoded, players)
                .map_err(|_| Verdict::Malformed { offset: run.offset, flaw: Flaw::Inputs })?
                .into(),
        };
        last = Some((run.encoded, inputs.clone()));
        log.ticks.push(inputs);
    }
    Ok(Logged { setup, log })
}
