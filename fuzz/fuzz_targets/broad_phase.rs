//! Worlds that differ only in their broad phase must have equal states. See `broad_phases`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::broad_phases;

fuzz_target!(|bytes: &[u8]| {
    broad_phases::run(bytes);
});
