//! Packets for peers who wait, join, watch and play. See `bytes::packet`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::{allocations, bytes::packet};

#[global_allocator]
static ALLOCATOR: allocations::Counting = allocations::Counting;

/// Most bytes at one time: the largest state that a newcomer takes (64 MiB), and little besides.
const MEMORY_MAX: usize = 80 << 20;

fuzz_target!(init: packet::keep_inputs_of_a_panic(), |bytes: &[u8]| {
    let (_, peak) = allocations::peak_of(|| packet::run(bytes));
    assert!(peak <= MEMORY_MAX, "{peak} bytes at one time");
});
