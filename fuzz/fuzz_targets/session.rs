//! Changed packets for sessions. See `bytes::session`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::bytes::session;

fuzz_target!(|bytes: &[u8]| {
    session::run(bytes);
});
