//! The `lockstep2d` command.

use std::process::ExitCode;

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};

fn main() -> ExitCode {
    lockstep2d_cli::run::<Idle>()
}

/// Stands in for the sandbox until it is there: a game in which nothing happens.
struct Idle {
    tick: u64,
}

impl Game for Idle {
    type Setup = ();
    type Input = ();
    type Save = u64;

    const RULES: RulesId = RulesId { name: "lockstep2d", version: 0 };

    fn new((): &()) -> Result<Self, SetupError> {
        Ok(Idle { tick: 0 })
    }

    fn players(&self) -> u32 {
        0
    }

    fn tick_rate(&self) -> u32 {
        60
    }

    fn step(&mut self, _: &[()]) {
        self.tick += 1;
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of(&self.tick)
    }

    fn save(&self) -> u64 {
        self.tick
    }

    fn load(&mut self, save: &u64) {
        self.tick = *save;
    }

    fn work(&self, _: &[()]) -> u64 {
        1
    }
}
