//! Compares the contact of two shapes with a slow search in big integers. See `manifolds`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::manifolds;

fuzz_target!(|bytes: &[u8]| {
    manifolds::run(bytes);
});
