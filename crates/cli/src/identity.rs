//! [`GameDigest`]: the identity of a game, which does not depend on how its replay was written.

use std::fmt;

use blake3::Hasher;
use lockstep2d::SEMANTICS;
use lockstep2d::lockstep::Game;
use lockstep2d::replay::{Limits, Mismatch, Part, ReadError, Reader, Verdict};

/// Prefix of the hashed bytes, which separates this digest from other uses of BLAKE3.
const DOMAIN: &[u8] = b"lockstep2d game 1";

/// The BLAKE3 digest of the semantics version of the engine, and of the rules, setup and inputs of a game. FORMAT.md
/// defines it.
///
/// The digest does not depend on block boundaries, checkpoints or the trailer. The digest of an incomplete file is that
/// of the game up to the last complete block. [`Signatures`](crate::signature::Signatures) has an example.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GameDigest(blake3::Hash);

impl GameDigest {
    /// Computes the digest of a replay of the game `G`, without simulating it.
    ///
    /// # Errors
    /// [`Verdict::Malformed`] for a damaged file; [`Verdict::LimitExceeded`] for a file that exceeds a limit;
    /// [`Verdict::Unverifiable`] for a file with another format version, other semantics or other rules.
    pub fn of_replay<G: Game>(replay: &[u8], limits: &Limits) -> Result<Self, Verdict> {
        let reader = Reader::open(replay, limits)?;
        let header = reader.header();
        match mismatch::<G>(header.semantics, header.rules_name, header.rules_version) {
            Some(why) => Err(Verdict::Unverifiable { why }),
            None => Ok(Self::of_any(replay, limits)?),
        }
    }

    /// Computes the digest of a replay of any game.
    pub(crate) fn of_any(replay: &[u8], limits: &Limits) -> Result<Self, ReadError> {
        let mut reader = Reader::open(replay, limits)?;
        let mut hasher = Hasher::new();
        let header = reader.header();
        hasher.update(DOMAIN);
        hasher.update(&header.semantics.to_le_bytes());
        hasher.update(&header.rules_version.to_le_bytes());
        add_bytes(&mut hasher, header.rules_name.as_bytes());
        add_bytes(&mut hasher, header.setup);
        // Joins runs of equal inputs that were split at the end of a block.
        let mut run: Option<(u64, &[u8])> = None;
        while let Some(part) = reader.next_part()? {
            let Part::Inputs(block) = part else { break };
            let mut runs = block.runs();
            while let Some(next) = runs.next_run()? {
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
        Ok(GameDigest(hasher.finalize()))
    }

    /// The 32 bytes of the digest.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8; 32] {
        self.0.as_bytes()
    }
}

/// Shows the digest as 64 hexadecimal digits in lower case.
impl fmt::Display for GameDigest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// Returns why a program for the game `G` cannot verify a replay with these semantics and rules, or `None` if it can.
pub(crate) fn mismatch<G: Game>(semantics: u32, name: &str, version: u32) -> Option<Mismatch> {
    if semantics != SEMANTICS {
        return Some(Mismatch::Semantics { file: semantics, here: SEMANTICS });
    }
    let (file, here) = ((name.into(), version), (G::RULES.name.into(), G::RULES.version));
    (file != here).then_some(Mismatch::Rules { file, here })
}

fn add_run(hasher: &mut Hasher, run: Option<(u64, &[u8])>) {
    if let Some((ticks, encoded)) = run {
        hasher.update(&ticks.to_le_bytes());
        add_bytes(hasher, encoded);
    }
}

/// Hashes the length of `bytes`, then `bytes`. Because of the lengths, the hashed data of two different games are never
/// equal.
fn add_bytes(hasher: &mut Hasher, bytes: &[u8]) {
    let length = u64::try_from(bytes.len()).unwrap_or(u64::MAX);
    hasher.update(&length.to_le_bytes()).update(bytes);
}
