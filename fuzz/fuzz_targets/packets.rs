//! Packets to peers that wait, join, watch and play. See `bytes::packet`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::{allocations, bytes::packet};

#[global_allocator]
static ALLOCATOR: allocations::Counting = allocations::Counting;

/// Maximum memory in bytes: the largest state that one joining peer accepts (64 MiB), plus a little.
const MEMORY_MAX: usize = 80 << 20;

fuzz_target!(init: packet::keep_inputs_of_a_panic(), |bytes: &[u8]| {
    let (_, peak) = allocations::peak_of(|| packet::run(bytes));
    assert!(peak <= MEMORY_MAX, "{peak} bytes at one time, at most {MEMORY_MAX} are allowed");
});
