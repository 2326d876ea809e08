//! Peers in the middle of a match who get what nobody sent. See `packets`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lockstep2d_fuzz::packets;

fuzz_target!(|bytes: &[u8]| {
    packets::run(bytes);
});
