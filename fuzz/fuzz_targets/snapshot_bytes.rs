//! Snapshot files of a few kilobytes for the decoder of worlds. See `bytes::snapshot`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::{allocations, bytes::snapshot};

#[global_allocator]
static ALLOCATOR: allocations::Counting = allocations::Counting;

/// Maximum memory in bytes. A run with a small file needs two worlds and their scratch memory.
const MEMORY_MAX: usize = 4 << 20;

fuzz_target!(|bytes: &[u8]| {
    let (_, peak) = allocations::peak_of(|| snapshot::run(bytes));
    assert!(peak <= MEMORY_MAX, "{peak} bytes at one time, at most {MEMORY_MAX} are allowed");
});
