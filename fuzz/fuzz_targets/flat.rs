//! Calls of the flat API with valid and invalid arguments. See `lockstep2d_flat::fuzzing`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_flat::{fuzzing, ls2d_object_count};

fuzz_target!(|bytes: &[u8]| {
    let _ = fuzzing::run(bytes);
    assert_eq!(ls2d_object_count(), 0, "an object is not freed");
});
