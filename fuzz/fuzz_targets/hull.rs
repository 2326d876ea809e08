//! Compares the convex hull of points with its definition. See `hulls`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::hulls;

fuzz_target!(|bytes: &[u8]| {
    hulls::run(bytes);
});
