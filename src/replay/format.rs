//! Constants and hash definitions of replay format 1.
//!
//! ```text
//! link(d, bytes)  = XXH3-128(d | XXH3-128(bytes))
//!
//! chain           starts as XXH3-128(header), then link(chain, block)           covers the file except its checksums
//! inputs digest   starts as XXH3-128(header up to `start`), then link(.., runs) covers the setup and all inputs
//! checkpoint      XXH3-128(state hash | inputs digest)                          covers the inputs and the state
//! ```

use crate::hash::StateHash;

/// The first eight bytes of a replay file.
///
/// Like the PNG signature, they have a byte above 127, both kinds of line break and an end-of-file character, to detect
/// a transfer that converts text.
pub const MAGIC: [u8; 8] = *b"\x89L2D\r\n\x1a\n";

/// Version of the layout. A file of any other version is [`Unverifiable`](super::Verdict::Unverifiable).
pub const FORMAT_VERSION: u32 = 1;

/// Maximum number of players in a game.
pub const PLAYERS_MAX: u32 = 64;

/// Maximum length of the name of a game's rules, in bytes.
pub const RULES_NAME_BYTES_MAX: u32 = 64;

/// Maximum number of claims, the results of a game such as a score, in a trailer.
pub const CLAIMS_MAX: u32 = 256;

/// Maximum length of the name of a claim, in bytes.
pub const CLAIM_NAME_BYTES_MAX: u32 = 64;

/// Maximum number of ticks in a recorded block: one minute at 60 Hz.
pub(super) const BLOCK_TICKS_MAX: u32 = 3600;

/// Maximum payload of a recorded block in bytes, enough for a tick that spawns about 50 000 bodies.
pub(super) const BLOCK_BYTES_MAX: u32 = 16 << 20;

/// Maximum recorded setup in bytes.
pub(super) const SETUP_BYTES_MAX: u32 = 16 << 20;

/// Kinds of blocks. A reader of version 1 refuses other kinds, including 2, which is reserved for saved states.
pub(super) mod kind {
    pub(in crate::replay) const INPUTS: u8 = 1;
    pub(in crate::replay) const TRAILER: u8 = 3;
}

/// Number of bytes before the payload of a block: length (4) and kind (1).
pub(super) const BLOCK_HEAD_BYTES: usize = 5;

pub(super) const CHECKSUM_BYTES: usize = 8;

pub(super) const HASH_BYTES: usize = 16;

/// Hash that a replay stores for a state.
///
/// The hash covers the inputs so far and the state. The state hash alone would not reveal a changed input that the game
/// ignores.
#[must_use]
pub fn checkpoint_hash(state: StateHash, inputs_digest: StateHash) -> StateHash {
    StateHash::of_digests([state, inputs_digest])
}

pub(super) fn link(digest: StateHash, bytes: &[u8]) -> StateHash {
    StateHash::of_digests([digest, StateHash::of_bytes(bytes)])
}

/// Stored checksum of a chain: its low 64 bits. A chain covers the header and the blocks so far, and thereby their
/// order.
pub(super) fn checksum(chain: StateHash) -> [u8; CHECKSUM_BYTES] {
    let [a, b, c, d, e, f, g, h, ..] = chain.0.to_le_bytes();
    [a, b, c, d, e, f, g, h]
}
