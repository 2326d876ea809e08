//! Checks a game: plays a log of inputs in many variants that must not change the result, and reports the first fault.
//!
//! [`check`] plays the inputs of a [`Game`] in a reference run, and at the same time in the [`CheckOptions::variants`]:
//! once more in the same way, reloaded at every tick, rolled back by 1 to 8 ticks, with cleared caches, on other thread
//! counts and so on. The variants must reach the state hashes of the reference run. Otherwise the result is a
//! [`Failure`]: the variant, the tick, the fields that differ, and a minimised replay.
//!
//! ```
//! use lockstep2d::{check::{self, CheckOptions}, lockstep::{Game, Sandbox, SandboxSetup}, math::Rng};
//!
//! let inputs = check::random_inputs::<Sandbox>(1, 20, &mut Rng::new(7));
//! let checked = check::check::<Sandbox>(&SandboxSetup::default(), &inputs, &CheckOptions::default())?;
//! assert_eq!(checked.ticks, 20);
//! # Ok::<(), check::CheckError>(())
//! ```
//!
//! [`random_inputs`] and [`inputs_from_bytes`] make logs for any game, for plain tests and for a fuzzer.
//! [`check_replay`] takes a replay instead. `docs/FUZZING.md` lists causes and remedies.
//!
//! # Limitations
//!
//! A check does not catch panics of the game's code, and does not detect differences between machines, compilers or
//! processes.

mod byte_swap;
mod checker;
mod failure;
mod finding;
mod log;
mod minimise;
mod options;
mod replica;
mod rollback;
mod source;

pub use checker::{Checked, Checker};
pub use failure::{CheckError, Failure};
pub use finding::{Fault, Finding, Guess};
pub use options::{CheckOptions, Depths, Phases, Variant};
pub use source::{inputs_from_bytes, random_inputs};

use alloc::boxed::Box;
use alloc::vec::Vec;

use crate::lockstep::Game;
use crate::replay::{CHECKPOINT_INTERVAL, Recorder, Verdict};
use log::{Log, Logged};

/// Plays a game with the inputs of every tick, in every [`Variant`] of the options.
///
/// With the default options, a check takes as long as about twenty plain runs of the log. For a log of at most 24
/// ticks, it may take as long as 200. `inputs` has a list for each tick, with an input for each player.
///
/// # Errors
/// [`CheckError::Failed`] with the fault of the game. [`CheckError::Record`] if the setup cannot start a game, or if a
/// replay cannot represent the setup or the inputs, for example because there is not exactly one input per player.
pub fn check<G: Game>(
    setup: &G::Setup,
    inputs: &[Vec<G::Input>],
    options: &CheckOptions,
) -> Result<Checked, CheckError> {
    let (_, game) = Recorder::<G>::start(setup, CHECKPOINT_INTERVAL)?;
    let mut log = Log::<G>::new(game.players());
    for inputs in inputs {
        log.push(inputs)?;
    }
    minimise::run(setup, &log, options).map_err(|finding| failed(setup, &log, *finding, options))
}

/// Checks a game with the inputs of a replay, from [`CheckOptions::from`] to [`CheckOptions::to`]. The check ignores
/// the checkpoints of the replay.
///
/// # Errors
/// [`CheckError::Failed`] with the fault of the game. [`CheckError::Replay`] if the file is not a replay of this game,
/// its setup cannot start a game, or the check costs more than the limits allow.
pub fn check_replay<G: Game>(file: &[u8], options: &CheckOptions) -> Result<Checked, CheckError> {
    let Logged { setup, log } = log::read::<G>(file, &options.limits, options.to)?;
    minimise::run(&setup, &log, options).map_err(|finding| match finding.fault {
        Fault::Verdict(verdict @ Verdict::LimitExceeded { .. }) => CheckError::Replay(verdict),
        _ => failed(&setup, &log, *finding, options),
    })
}

fn failed<G: Game>(setup: &G::Setup, log: &Log<G>, finding: Finding, options: &CheckOptions) -> CheckError {
    CheckError::Failed(Box::new(minimise::minimise(setup, log, finding, options)))
}
