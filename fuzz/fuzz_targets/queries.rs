//! Queries of changing worlds, compared with brute force and with distances. See `questions`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::questions;

fuzz_target!(|bytes: &[u8]| {
    questions::run(bytes);
});
