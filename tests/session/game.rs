//! A game whose state is a hash of all inputs.

use lockstep2d::session::{Request, Session, Tick, TickInputs};

pub(crate) fn mix(hash: u64, value: u64) -> u64 {
    let mixed = hash.rotate_left(23) ^ value.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (mixed ^ mixed >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    mixed ^ mixed >> 32
}

/// Hashes the inputs of a tick. Predicted inputs count like received ones.
pub(crate) fn mix_inputs(hash: u64, inputs: &TickInputs) -> u64 {
    let hash = inputs.bytes().iter().fold(hash, |hash, &byte| mix(hash, u64::from(byte)));
    mix(hash, inputs.absent())
}

pub(crate) const START: u64 = 1;

/// A game in which `states[t]` is the state before tick `t`.
#[derive(Debug)]
pub(crate) struct Game {
    pub(crate) states: Vec<u64>,
    saved: Vec<(Tick, u64)>,
    /// Number of simulated ticks, including repeated ones.
    pub(crate) simulated: u64,
    /// The tick in which a wrong state is computed on purpose.
    pub(crate) mistake: Option<Tick>,
}

impl Game {
    pub(crate) fn new() -> Self {
        Game { states: vec![START], saved: Vec::new(), simulated: 0, mistake: None }
    }

    /// Fulfils all requests of a session. Fails on a request that cannot be fulfilled.
    pub(crate) fn fulfil(&mut self, session: &mut Session) -> Result<(), String> {
        while let Some(request) = session.next_request() {
            match request {
                Request::Save { tick } => {
                    let state = self.state(tick)?;
                    self.saved.retain(|(saved, _)| *saved < tick);
                    self.saved.push((tick, state));
                }
                Request::Load { tick } => {
                    let &(_, state) = self
                        .saved
                        .iter()
                        .find(|(saved, _)| *saved == tick)
                        .ok_or(format!("no state {tick}"))?;
                    self.states.truncate(tick as usize);
                    self.states.push(state);
                }
                Request::Advance { tick, inputs } => {
                    if self.states.len() != tick as usize + 1 {
                        return Err(format!("tick {tick} after {} ticks", self.states.len() - 1));
                    }
                    let state = mix_inputs(self.state(tick)?, &inputs);
                    self.states.push(state ^ u64::from(self.mistake == Some(tick)));
                    self.simulated += 1;
                }
                Request::Checksum { tick } => {
                    let state = self.saved.iter().find(|(saved, _)| *saved == tick);
                    let &(_, state) = state.ok_or(format!("no state {tick} to compare"))?;
                    session.report_hash(tick, u128::from(state));
                }
                Request::Forget { tick } => self.saved.retain(|(saved, _)| *saved >= tick),
            }
        }
        Ok(())
    }

    fn state(&self, tick: Tick) -> Result<u64, String> {
        self.states.get(tick as usize).copied().ok_or(format!("state {tick} is not played"))
    }

    pub(crate) fn is_broken(&self) -> bool {
        self.mistake.is_some()
    }

    pub(crate) fn kept(&self) -> usize {
        self.saved.len()
    }
}
