//! Compares operations of `lockstep2d::math` with exact fractions. See `maths`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::maths;

fuzz_target!(|bytes: &[u8]| {
    maths::run(bytes);
});
