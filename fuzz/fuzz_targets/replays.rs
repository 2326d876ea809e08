//! Replays that no recorder has written: a verdict, never `Match`, in bounded time and memory. See `verdicts`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::{allocations, verdicts};

#[global_allocator]
static ALLOCATOR: allocations::Counting = allocations::Counting;

/// Most bytes that a file within the limits may make the verifier and the recorder allocate.
const MEMORY_MAX: usize = 256 << 20;

fuzz_target!(|bytes: &[u8]| {
    let (_, peak) = allocations::peak_of(|| verdicts::run(bytes));
    assert!(peak <= MEMORY_MAX, "{peak} bytes at one time");
});
