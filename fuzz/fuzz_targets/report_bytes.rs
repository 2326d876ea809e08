//! Files for the comparison of reports, a few kilobytes each. See `bytes::report`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::{allocations, bytes::report};

#[global_allocator]
static ALLOCATOR: allocations::Counting = allocations::Counting;

/// Most bytes at one time: some worlds and their scratch, for a file of a few kilobytes.
const MEMORY_MAX: usize = 8 << 20;

fuzz_target!(|bytes: &[u8]| {
    let (_, peak) = allocations::peak_of(|| report::run(bytes));
    assert!(peak <= MEMORY_MAX, "{peak} bytes at one time");
});
