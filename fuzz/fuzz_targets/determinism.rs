//! Two worlds that execute the same commands must have equal states. See `lockstep`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::lockstep;

fuzz_target!(|bytes: &[u8]| lockstep::count(lockstep::run(bytes)));
