//! Recorded, changed and forged replays for the verifier. See `verdicts`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::{allocations, verdicts};

#[global_allocator]
static ALLOCATOR: allocations::Counting = allocations::Counting;

/// Maximum memory in bytes to verify a file that is within the limits.
const MEMORY_MAX: usize = 256 << 20;

fuzz_target!(|bytes: &[u8]| {
    let (_, peak) = allocations::peak_of(|| verdicts::run(bytes));
    assert!(peak <= MEMORY_MAX, "{peak} bytes at one time, at most {MEMORY_MAX} are allowed");
});
