//! A scene with a deliberate fault, which the harness must find. See `lockstep::run_with_a_fault`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::lockstep;

fuzz_target!(|bytes: &[u8]| {
    lockstep::run_with_a_fault(bytes);
});
