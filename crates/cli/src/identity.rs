//! [`game_digest`]: the identity of a game, which does not depend on how its replay was written.

use blake3::{Hash, Hasher};
use lockstep2d::replay::{Limits, Part, Reader};

/// Precedes everything that is hashed, so that no other use of BLAKE3 gives the same digest.
const DOMAIN: &[u8] = b"lockstep2d game 1";

/// The BLAKE3 of rules, setup and inputs, as FORMAT.md defines it. `None` for a file that is damaged.
///
/// Blocks, checkpoints and the trailer do not count. The inputs are those of the complete blocks, so a file that ends
/// before its trailer has the digest of the game up to there.
pub(crate) fn game_digest(file: &[u8], limits: &Limits) -> Option<Hash> {
    let mut reader = Reader::open(file, limits).ok()?;
    let mut hasher = Hasher::new();
    let header = reader.header();
    hasher.update(DOMAIN);
    hasher.update(&header.semantics.to_le_bytes());
    hasher.update(&header.rules_version.to_le_bytes());
    add_bytes(&mut hasher, header.rules_name.as_bytes());
    add_bytes(&mut hasher, header.setup);
    // Runs that a block has split are joined again.
    let mut run: Option<(u64, &[u8])> = None;
    while let Some(part) = reader.next_part().ok()? {
        let Part::Inputs(block) = part else { break };
        let mut runs = block.runs();
        while let Some(next) = runs.next_run().ok()? {
            let ticks = u64::from(next.ticks);
            run = match run {
                Some((before, encoded)) if encoded == next.encoded => Some((before + ticks, encoded)),
                _ => {
                    add_run(&mut hasher, run);
                    Some((ticks, next.encoded))
                }
            };
        }
    }
    add_run(&mut hasher, run);
    Some(hasher.finalize())
}

fn add_run(hasher: &mut Hasher, run: Option<(u64, &[u8])>) {
    if let Some((ticks, encoded)) = run {
        hasher.update(&ticks.to_le_bytes());
        add_bytes(hasher, encoded);
    }
}

/// Adds bytes with their length, so that no two sequences of parts are the same bytes.
fn add_bytes(hasher: &mut Hasher, bytes: &[u8]) {
    let length = u64::try_from(bytes.len()).unwrap_or(u64::MAX);
    hasher.update(&length.to_le_bytes()).update(bytes);
}
