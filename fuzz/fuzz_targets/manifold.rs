//! Contacts of two shapes, compared with a search over all axes in big integers. See `manifolds`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::manifolds;

fuzz_target!(|bytes: &[u8]| {
    manifolds::run(bytes);
});
