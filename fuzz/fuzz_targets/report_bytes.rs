//! Report files of a few kilobytes for the comparison. See `bytes::report`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::{allocations, bytes::report};

#[global_allocator]
static ALLOCATOR: allocations::Counting = allocations::Counting;

/// Maximum memory in bytes. The comparison of two small files needs several worlds and their scratch memory.
const MEMORY_MAX: usize = 8 << 20;

fuzz_target!(|bytes: &[u8]| {
    let (_, peak) = allocations::peak_of(|| report::run(bytes));
    assert!(peak <= MEMORY_MAX, "{peak} bytes at one time, at most {MEMORY_MAX} are allowed");
});
