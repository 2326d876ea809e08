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
/// Modelled on the PNG signature: a byte above 127, both kinds of line break and an end-of-file character, so that a
/// transfer that converts text is detected at once.
pub const MAGIC: [u8; 8] = *b"\x89L2D\r\n\x1a\n";

/// Version of the layout. A file of any other version is [`Unverifiable`](super::Verdict::Unverifiable).
pub const FORMAT_VERSION: u32 = 1;

/// Maximum number of players in a game.
pub const PLAYERS_MAX: u32 = 64;

/// Maximum length of the name of a game's rules, in bytes.
pub const RULES_NAME_BYTES_MAX: u32 = 64;

/// Maximum number of claims in a trailer. Claims are results of a game, such as a score.
pub const CLAIMS_MAX: u32 = 256;

/// Maximum length of the name of a claim, in bytes.
pub const CLAIM_NAME_BYTES_MAX: u32 = 64;

/// Maximum number of ticks in a block that a recorder writes: one minute at 60 Hz. A crash loses at most one block.
pub(super) const BLOCK_TICKS_MAX: u32 = 3600;

/// Maximum payload of a block that a recorder writes, in bytes: enough for a tick that spawns about 50 000 bodies.
pub(super) const BLOCK_BYTES_MAX: u32 = 16 << 20;

/// Maximum setup that a recorder writes, in bytes: enough for a large level.
pub(super) const SETUP_BYTES_MAX: u32 = 16 << 20;

/// Kinds of blocks. A reader of version 1 refuses all other kinds, including 2, which is reserved for keyframes: saved
/// states for seeking, which version 1 does not write.
pub(super) mod kind {
    pub(in crate::replay) const INPUTS: u8 = 1;
    pub(in crate::replay) const TRAILER: u8 = 3;
}

/// Size of a block's head in bytes: length (4) and kind (1).
pub(super) const BLOCK_HEAD_BYTES: usize = 5;

/// Size of the checksum of a header or block, in bytes.
pub(super) const CHECKSUM_BYTES: usize = 8;

/// Size of a 128-bit hash in bytes.
pub(super) const HASH_BYTES: usize = 16;

/// Hash that a replay stores for a state: the state hash combined with the digest of all inputs so far.
///
/// The state hash alone would miss a changed input that the game ignores.
#[must_use]
pub fn checkpoint_hash(state: StateHash, inputs_digest: StateHash) -> StateHash {
    StateHash::of_digests([state, inputs_digest])
}

/// Extends a running digest by more bytes.
pub(super) fn link(digest: StateHash, bytes: &[u8]) -> StateHash {
    StateHash::of_digests([digest, StateHash::of_bytes(bytes)])
}

/// Stored checksum of a chain: its low 64 bits. Since a chain covers the header and all blocks so far, dropped, swapped
/// or repeated blocks are detected.
pub(super) fn checksum(chain: StateHash) -> [u8; CHECKSUM_BYTES] {
    let [a, b, c, d, e, f, g, h, ..] = chain.0.to_le_bytes();
    [a, b, c, d, e, f, g, h]
}
