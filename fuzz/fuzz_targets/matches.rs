//! Peers in the middle of a match who get what nobody sent, in bounded memory. See `matches`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::{allocations, matches};

#[global_allocator]
static ALLOCATOR: allocations::Counting = allocations::Counting;

/// Most bytes at one time: the largest state that one newcomer takes (64 MiB), and little besides.
const MEMORY_MAX: usize = 80 << 20;

fuzz_target!(|bytes: &[u8]| {
    let (_, peak) = allocations::peak_of(|| matches::run(bytes));
    assert!(peak <= MEMORY_MAX, "{peak} bytes at one time");
});
