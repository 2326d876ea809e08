//! Reports that no peer has written: an error or a comparison, in bounded time and memory. See `reports`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::{allocations, reports};

#[global_allocator]
static ALLOCATOR: allocations::Counting = allocations::Counting;

/// Most bytes that two files within the limits may make a comparison allocate.
const MEMORY_MAX: usize = 256 << 20;

fuzz_target!(|bytes: &[u8]| {
    let (_, peak) = allocations::peak_of(|| reports::run(bytes));
    assert!(peak <= MEMORY_MAX, "{peak} bytes at one time");
});
