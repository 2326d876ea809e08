//! The constants of replay format 1, and its three hashes.
//!
//! ```text
//! link(d, bytes)  = XXH3-128(d | XXH3-128(bytes))
//!
//! chain           starts as XXH3-128(header), then link(chain, block)          what the file is
//! inputs digest   starts as XXH3-128(header up to `start`), then link(.., runs) what was played
//! checkpoint      XXH3-128(state hash | inputs digest)                          what came of it
//! ```

use crate::hash::StateHash;

/// The first eight bytes of a replay file.
///
/// Modelled on PNG's: a byte above 127, a line break of each kind and an end-of-file character, so that a
/// transfer which rewrites text is found at once.
pub const MAGIC: [u8; 8] = *b"\x89L2D\r\n\x1a\n";

/// The version of the layout. Any other is [`Unverifiable`](super::Verdict::Unverifiable).
pub const FORMAT_VERSION: u32 = 1;

/// Most players a game may have.
pub const PLAYERS_MAX: u32 = 64;

/// Longest name of a game's rules, in bytes.
pub const RULES_NAME_BYTES_MAX: u32 = 64;

/// Most claims in a trailer. A claim is for a scoreboard, not for a save game.
pub const CLAIMS_MAX: u32 = 256;

/// Longest name of a claim, in bytes.
pub const CLAIM_NAME_BYTES_MAX: u32 = 64;

/// Most ticks in a block a recorder writes: a minute at 60 Hz, and a crash loses at most one block.
pub(super) const BLOCK_TICKS_MAX: u32 = 3600;

/// Largest payload of a block a recorder writes: room for a tick that spawns some 50 000 bodies.
pub(super) const BLOCK_BYTES_MAX: u32 = 16 << 20;

/// Largest setup a recorder writes: a generous level.
pub(super) const SETUP_BYTES_MAX: u32 = 16 << 20;

/// The kinds of blocks. A reader of version 1 refuses every other, and 2 too, which is set aside for keyframes:
/// saved states to seek by, which version 1 does not write.
pub(super) mod kind {
    pub(in crate::replay) const INPUTS: u8 = 1;
    pub(in crate::replay) const TRAILER: u8 = 3;
}

/// Bytes of a block before its payload: length (4) and kind (1).
pub(super) const BLOCK_HEAD_BYTES: usize = 5;

/// Bytes of a header's or block's checksum.
pub(super) const CHECKSUM_BYTES: usize = 8;

/// Bytes of a 128-bit hash.
pub(super) const HASH_BYTES: usize = 16;

/// What a replay stores of a state: the state's hash bound to everything that led there.
///
/// The state hash alone would not notice a changed input that the game ignores.
#[must_use]
pub fn checkpoint_hash(state: StateHash, inputs_digest: StateHash) -> StateHash {
    StateHash::of_digests([state, inputs_digest])
}

/// Carries a running digest over more bytes.
pub(super) fn link(digest: StateHash, bytes: &[u8]) -> StateHash {
    StateHash::of_digests([digest, StateHash::of_bytes(bytes)])
}

/// The checksum that is stored for a chain: its low 64 bits. Every checksum so covers all bytes before it, and
/// blocks cannot be dropped, swapped or repeated unnoticed.
pub(super) fn checksum(chain: StateHash) -> [u8; CHECKSUM_BYTES] {
    let [a, b, c, d, e, f, g, h, ..] = chain.0.to_le_bytes();
    [a, b, c, d, e, f, g, h]
}
