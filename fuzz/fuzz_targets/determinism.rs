//! Scenes and commands in two worlds that must not differ. See `lockstep`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::lockstep;

fuzz_target!(|bytes: &[u8]| lockstep::count(lockstep::run(bytes)));
