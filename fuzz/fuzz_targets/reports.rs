//! Comparison of correct, changed and forged reports. See `reports`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::{allocations, reports};

#[global_allocator]
static ALLOCATOR: allocations::Counting = allocations::Counting;

/// Maximum memory in bytes to compare two files that are within the limits.
const MEMORY_MAX: usize = 256 << 20;

fuzz_target!(|bytes: &[u8]| {
    let (_, peak) = allocations::peak_of(|| reports::run(bytes));
    assert!(peak <= MEMORY_MAX, "{peak} bytes at one time, at most {MEMORY_MAX} are allowed");
});
