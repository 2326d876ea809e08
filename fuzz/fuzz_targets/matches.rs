//! A running match whose peers receive forged packets. Its memory must stay within a limit. See `matches`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::{allocations, matches};

#[global_allocator]
static ALLOCATOR: allocations::Counting = allocations::Counting;

/// Maximum memory in bytes.
const MEMORY_MAX: usize = 16 << 20;

fuzz_target!(|bytes: &[u8]| {
    let (_, peak) = allocations::peak_of(|| matches::run(bytes));
    assert!(peak <= MEMORY_MAX, "{peak} bytes at one time, at most {MEMORY_MAX} are allowed");
});
