//! The worker of a game that aborts its process on the input [`FATAL`].

use std::process::ExitCode;

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};

/// Input that aborts the process, unless the environment variable `FRAGILE_RECORDS` is set.
const FATAL: u8 = 13;

struct Fragile(u64);

impl Game for Fragile {
    type Setup = u64;
    type Input = u8;
    type Save = u64;
    const RULES: RulesId = RulesId { name: "fragile", version: 1 };

    fn new(start: &u64) -> Result<Self, SetupError> {
        Ok(Fragile(*start))
    }

    fn players(&self) -> u32 {
        1
    }

    fn tick_rate(&self) -> u32 {
        60
    }

    fn step(&mut self, inputs: &[u8]) {
        if inputs == [FATAL] && std::env::var_os("FRAGILE_RECORDS").is_none() {
            std::process::abort();
        }
        self.0 += inputs.iter().map(|input| u64::from(*input)).sum::<u64>();
    }

    fn state_hash(&self) -> StateHash {
        StateHash(self.0.into())
    }

    fn save(&self) -> u64 {
        self.0
    }

    fn load(&mut self, save: &u64) {
        self.0 = *save;
    }

    fn work(&self, _: &[u8]) -> u64 {
        1
    }
}

/// Runs the worker. With the arguments `record INPUT`, prints a replay of one tick with this input instead.
fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().collect();
    let Some([_, input]) = arguments.get(1..3).filter(|words| words[0] == "record") else {
        return lockstep2d_worker::run::<Fragile>();
    };
    match record(input) {
        Some(()) => ExitCode::SUCCESS,
        None => ExitCode::FAILURE,
    }
}

fn record(input: &str) -> Option<()> {
    use std::io::Write;
    let mut recording = lockstep2d::replay::Recording::<Fragile>::start(&0, 60).ok()?;
    recording.step(&[input.parse().ok()?]).ok()?;
    std::io::stdout().write_all(&recording.finish().ok()?).ok()
}
