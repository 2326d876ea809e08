use alloc::collections::BTreeMap;
use alloc::string::String;
use alloc::vec::Vec;

use super::bytes::Cursor;
use super::flaw::Flaw;
use super::format::{CLAIM_NAME_BYTES_MAX, CLAIMS_MAX};
use super::reader::ReadError;
use super::verdict::ClaimDifference;
use crate::hash::StateHash;

/// The last block of a complete file: what the file states about the end of the game.
///
/// ```
/// # use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::replay::{Limits, Recording, Trailer, VerifiedReplay};
/// # let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60).expect("a setup");
/// # (0..90).for_each(|_| recording.step(&[vec![]]).expect("one input"));
/// # let file = recording.finish().expect("no claims");
/// // A scoreboard shows at once what a file claims, and verifies it later.
/// let replay = VerifiedReplay::<Sandbox>::open(&file, &Limits::default())?;
/// let Trailer { ticks, claims, .. } = replay.trailer().expect("a complete file");
/// let score = claims.iter().find(|(name, _)| name == "score").map(|(_, score)| *score);
/// assert_eq!((*ticks, score), (90, None), "the sandbox has no score");
/// # Ok::<(), lockstep2d::replay::Verdict>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Trailer {
    /// Number of ticks in the game.
    pub ticks: u64,
    /// Hash of the state after the last tick.
    pub final_hash: StateHash,
    /// Hash of the header and the blocks of inputs.
    pub chain: StateHash,
    /// Results of the game, ascending by name.
    pub claims: Vec<(String, i64)>,
}

impl Trailer {
    /// Compares the trailer with the final hash and the claims of a game. Returns the first difference: the hash, or
    /// else the first differing claim in the order of the names.
    #[must_use]
    pub fn difference(&self, hash: StateHash, claims: &[(String, i64)]) -> Option<ClaimDifference> {
        // The caller has already compared the last checkpoint, which covers this state. A different hash therefore
        // means that the trailer is wrong, and not that the game has diverged.
        if self.final_hash != hash {
            return Some(ClaimDifference::FinalHash { claimed: self.final_hash, actual: hash });
        }
        let claimed = by_name(&self.claims);
        let actual = by_name(claims);
        let mut names: Vec<&str> = claimed.keys().chain(actual.keys()).copied().collect();
        names.sort_unstable();
        let name = names.into_iter().find(|name| claimed.get(name) != actual.get(name))?;
        let (claimed, actual) = (claimed.get(name).copied(), actual.get(name).copied());
        Some(ClaimDifference::Value { name: name.into(), claimed, actual })
    }
}

fn by_name(claims: &[(String, i64)]) -> BTreeMap<&str, i64> {
    claims.iter().map(|(name, value)| (name.as_str(), *value)).collect()
}

pub(super) fn read_claims(cursor: &mut Cursor<'_>) -> Result<Vec<(String, i64)>, ReadError> {
    let count_offset = cursor.offset();
    let count = cursor.varint()?;
    if count > CLAIMS_MAX {
        return Err(ReadError::Malformed { offset: count_offset, flaw: Flaw::Claims { count } });
    }
    let mut claims: Vec<(String, i64)> = Vec::new();
    for _ in 0..count {
        let offset = cursor.offset();
        let malformed = |flaw| ReadError::Malformed { offset, flaw };
        let length = cursor.varint()?;
        if length == 0 || length > CLAIM_NAME_BYTES_MAX {
            return Err(malformed(Flaw::ClaimName));
        }
        let name = usize::try_from(length).ok().and_then(|length| cursor.take(length));
        let (Some(name), Some(value)) = (name, cursor.i64()) else {
            return Err(malformed(Flaw::BlockCut));
        };
        let name = core::str::from_utf8(name).map_err(|_| malformed(Flaw::ClaimName))?;
        if claims.last().is_some_and(|(previous, _)| previous.as_str() >= name) {
            return Err(malformed(Flaw::ClaimOrder));
        }
        claims.push((name.into(), value));
    }
    Ok(claims)
}
