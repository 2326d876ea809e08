//! A minimal game whose state depends on all inputs so far.

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};

/// The game. Its state is one number.
#[derive(Clone, Debug)]
pub struct Memory {
    sum: u64,
}

impl Game for Memory {
    type Setup = ();
    type Input = u8;
    type Save = u64;

    const RULES: RulesId = RulesId { name: "memory", version: 1 };

    fn new((): &()) -> Result<Self, SetupError> {
        Ok(Memory { sum: 1 })
    }

    fn players(&self) -> u32 {
        3
    }

    fn tick_rate(&self) -> u32 {
        20
    }

    fn step(&mut self, inputs: &[u8]) {
        for input in inputs {
            self.sum = self.sum.wrapping_mul(31).wrapping_add(u64::from(*input));
        }
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of(&self.sum)
    }

    fn save(&self) -> u64 {
        self.sum
    }

    fn load(&mut self, save: &u64) {
        self.sum = *save;
    }

    fn work(&self, _: &[u8]) -> u64 {
        1
    }

    fn absent() -> u8 {
        255
    }
}
