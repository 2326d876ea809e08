//! Tests that use conversions that the crate does not export.
#![expect(clippy::indexing_slicing, reason = "a test fails by a panic")]

#[cfg(feature = "lockstep")]
mod host_games;
mod misuse;
mod random_calls;
mod scenes;

use lockstep2d::hash::StateHash;

use crate::{In, Out, RawHash, Status};

fn done(status: i32) {
    assert_eq!(status, Status::Ok as i32, "{}", crate::status::last_text());
}

fn hash_of(world: u32) -> StateHash {
    let mut hash = RawHash { low: 0, high: 0 };
    done(crate::ls2d_world_hash(world, Out::of(&mut hash)));
    hash.hash()
}

/// Copies the contents of a bytes object, and frees the object.
fn take(bytes: u32) -> Vec<u8> {
    let mut size = 0;
    done(crate::ls2d_bytes_size(bytes, Out::of(&mut size)));
    let mut copy = vec![0; size];
    done(crate::ls2d_bytes_copy(bytes, Out::all(&mut copy), size));
    done(crate::ls2d_free(bytes));
    copy
}

fn list_of(encoded: &[u8]) -> u32 {
    let mut list = 0;
    done(crate::ls2d_commands_new(Out::of(&mut list)));
    done(crate::ls2d_commands_decode(list, In::all(encoded), encoded.len()));
    list
}
