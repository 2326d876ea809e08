//! Checks a game: plays a log of inputs in many ways that must make no difference, and says which of them does.
//!
//! [`check`] takes a [`Game`] and an input log. It plays the log straight, and beside it in every [`Way`] of
//! [`Options::ways`]: once more from the start, through bytes at every tick, rolled back by 1 to 8 ticks, with caches
//! dropped, on other threads and so on. After every tick all of them must have the same hash. If one has not, there is a
//! [`Failure`]: the way, the tick, the fields that differ, and a replay that is as short as it could be made.
//!
//! ```
//! use lockstep2d::{check::{self, Options}, lockstep::{Game, Sandbox, SandboxSetup}, math::Rng};
//!
//! let inputs = check::random_inputs::<Sandbox>(1, 20, &mut Rng::new(7));
//! let checked = check::check::<Sandbox>(&SandboxSetup::default(), &inputs, &Options::default())?;
//! assert_eq!(checked.ticks, 20);
//! # Ok::<(), check::CheckError>(())
//! ```
//!
//! [`random_inputs`] and [`inputs_from_bytes`] make logs for any game, for plain tests and for a fuzzer;
//! [`check_replay`] takes a replay instead. `docs/FUZZING.md` says what each failure means.
//!
//! # What it does not do
//!
//! A panic of the game's code is not caught: it passes through to the caller, whose test or fuzzer reports it with its
//! input. What needs another machine, compiler or process is not seen either.

mod checker;
mod exchange;
mod failure;
mod finding;
mod lane;
mod log;
mod minimise;
mod options;
mod rollback;
mod source;

pub use checker::{Checked, Checker};
pub use failure::{CheckError, Failure};
pub use finding::{Fault, Finding, Guess};
pub use options::{Depths, Options, Phases, Way};
pub use source::{inputs_from_bytes, random_inputs};

use alloc::boxed::Box;
use alloc::vec::Vec;

use crate::lockstep::Game;
use crate::replay::{Recorder, Verdict};
use log::{INTERVAL, Log, Logged};

/// Plays a game from a setup with the inputs of every tick, in every [`Way`] of the options.
///
/// With the default options that costs some twenty plain runs of the log. `inputs` has a list for each tick, with an
/// input for each player.
///
/// # Errors
/// [`CheckError::Failed`] with what is wrong with the game; [`CheckError::Record`] if no game starts from this setup, or
/// the inputs are not one for each player: what no replay can hold.
pub fn check<G: Game>(
    setup: &G::Setup,
    inputs: &[Vec<G::Input>],
    options: &Options,
) -> Result<Checked, CheckError> {
    let (_, game) = Recorder::<G>::start(setup, INTERVAL)?;
    let mut log = Log::<G>::new(game.players());
    for inputs in inputs {
        log.push(inputs)?;
    }
    check_log(setup, &log, options)
}

/// The same for the setup and the inputs of a replay, whatever its checkpoints say, from [`Options::from`] to
/// [`Options::to`].
///
/// # Errors
/// As [`check`]; [`CheckError::Replay`] if the file is no replay of this game or costs more than the limits allow.
pub fn check_replay<G: Game>(file: &[u8], options: &Options) -> Result<Checked, CheckError> {
    let Logged { setup, log } = log::read::<G>(file, &options.limits, options.to)?;
    match check_log(&setup, &log, options) {
        Err(CheckError::Failed(failure)) => Err(match failure.finding.fault {
            Fault::Verdict(verdict @ Verdict::LimitExceeded { .. }) => CheckError::Replay(verdict),
            _ => CheckError::Failed(failure),
        }),
        result => result,
    }
}

fn check_log<G: Game>(setup: &G::Setup, log: &Log<G>, options: &Options) -> Result<Checked, CheckError> {
    match minimise::run(setup, log, options) {
        Ok(checked) => Ok(checked),
        Err(finding) => Err(CheckError::Failed(Box::new(minimise::minimise(setup, log, *finding, options)))),
    }
}
