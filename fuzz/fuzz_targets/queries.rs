//! Queries of changing worlds. See `questions`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::questions;

fuzz_target!(|bytes: &[u8]| {
    questions::run(bytes);
});
