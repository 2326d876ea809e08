//! The worker of the sandbox game.

use std::process::ExitCode;

use lockstep2d::lockstep::Sandbox;

fn main() -> ExitCode {
    lockstep2d_worker::run::<Sandbox>()
}
