//! Contacts of two shapes at changing relative positions must not depend on caches. See `pairs`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::pairs;

fuzz_target!(|bytes: &[u8]| {
    pairs::run(bytes);
});
