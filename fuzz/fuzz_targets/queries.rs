//! Queries of changing worlds must not depend on the broad phase. See `questions`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::questions;

fuzz_target!(|bytes: &[u8]| {
    questions::run(bytes);
});
