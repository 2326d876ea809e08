//! Forged snapshots for the decoder of worlds. See `snapshots`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::snapshots;

fuzz_target!(|bytes: &[u8]| {
    snapshots::run(bytes);
});
