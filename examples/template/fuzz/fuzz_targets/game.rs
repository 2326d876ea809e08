//! Plays arbitrary inputs in all variants of the determinism check.
#![no_main]

use std::fs;

use libfuzzer_sys::fuzz_target;
use lockstep2d::check::{CheckError, CheckOptions, check, inputs_from_bytes};
use my_game::{MyGame, Setup};

const PLAYERS: u32 = 2;
/// Maximum length in ticks of a log of inputs. Longer logs take more time and rarely find more failures.
const TICKS_MAX: usize = 300;

fuzz_target!(|bytes: &[u8]| {
    let mut inputs = inputs_from_bytes::<MyGame>(PLAYERS, bytes);
    inputs.truncate(TICKS_MAX);
    match check::<MyGame>(&Setup::default(), &inputs, &CheckOptions::default()) {
        Ok(_) => {}
        Err(CheckError::Failed(failure)) => {
            let name = "failure.replay";
            let written = fs::write(name, &failure.replay).map_or("not written", |()| name);
            panic!("{failure}\nthe replay file: {written}");
        }
        Err(error) => panic!("{error}"),
    }
});
