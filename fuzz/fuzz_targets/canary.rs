//! A planted fault that must be found, which proves that the harness works. See `lockstep::run_with_a_fault`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::lockstep;

fuzz_target!(|bytes: &[u8]| {
    lockstep::run_with_a_fault(bytes);
});
