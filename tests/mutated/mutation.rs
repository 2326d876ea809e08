//! Mutations of files: accidental damage, and edits that respect the format.

use lockstep2d::hash::StateHash;
use lockstep2d::math::Rng;

/// Size in bytes of a checksum in a replay.
const CHECKSUM: usize = 8;
/// Size in bytes of the hash at the end of a snapshot.
const HASH: usize = 16;
/// Size in bytes of the header of a snapshot: magic, format, semantics and length.
const SNAPSHOT_HEADER: usize = 24;
const TRAILER: u8 = 3;
const CHAIN: std::ops::Range<usize> = 24..40;
/// Numbers that readers may handle wrongly as lengths: 0 and small numbers, powers of two, and the limits of types.
const EDGES: [u64; 12] =
    [0, 1, 2, 127, 128, 255, 65_535, 1 << 20, 1 << 24, (1 << 31) - 1, 0xffff_ffff, u64::MAX];

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Mutation {
    Bits,
    Bytes,
    Cut,
    Splice,
    Duplicate,
    Remove,
    Swap,
    Length,
}

const ALL: [Mutation; 8] = [
    Mutation::Bits,
    Mutation::Bytes,
    Mutation::Cut,
    Mutation::Splice,
    Mutation::Duplicate,
    Mutation::Remove,
    Mutation::Swap,
    Mutation::Length,
];

/// Applies a random mutation. [`Mutation::Splice`] copies a piece of one of the `others`.
pub(crate) fn mutate(rng: &mut Rng, file: &mut Vec<u8>, others: &[Vec<u8>]) -> Mutation {
    let mutation = ALL[below(rng, ALL.len())];
    let length = file.len();
    match mutation {
        Mutation::Bits => {
            for _ in 0..1 + below(rng, 4) {
                file[below(rng, length)] ^= 1 << rng.below(8);
            }
        }
        Mutation::Bytes => {
            let at = below(rng, length);
            let end = (at + 1 + below(rng, 8)).min(length);
            file[at..end].iter_mut().for_each(|byte| *byte = rng.next_u32().to_le_bytes()[0]);
        }
        Mutation::Cut => {
            let places = boundaries(file);
            let at = if rng.below(2) == 0 { below(rng, length) } else { places[below(rng, places.len())] };
            file.truncate(at);
        }
        Mutation::Splice => {
            let other = &others[below(rng, others.len())];
            let (at, from) = (below(rng, length), below(rng, other.len()));
            if rng.below(2) == 0 {
                // Joins the beginning of one file and the end of another.
                file.truncate(at);
                file.extend_from_slice(&other[from..]);
            } else {
                let count = (1 + below(rng, 200)).min(other.len() - from).min(length - at);
                file[at..at + count].copy_from_slice(&other[from..from + count]);
            }
        }
        Mutation::Duplicate => {
            let (start, end) = part(rng, file);
            let copy = file[start..end].to_vec();
            file.splice(end..end, copy);
        }
        Mutation::Remove => {
            let (start, end) = part(rng, file);
            file.drain(start..end);
        }
        Mutation::Swap => {
            let (start, end) = part(rng, file);
            let middle = start + below(rng, end - start + 1);
            file[start..end].rotate_left(middle - start);
        }
        Mutation::Length => {
            // Overwrites bytes by a number, at a random place or at the beginning of a part, where length fields are.
            let places = boundaries(file);
            let part = places[below(rng, places.len())];
            let at = [part, below(rng, length), below(rng, length.min(100))][below(rng, 3)].min(length);
            let number = match rng.below(3) {
                0 => EDGES[below(rng, EDGES.len())],
                1 => rng.next_u64() >> rng.below(64),
                _ => (length - below(rng, length.min(64))) as u64,
            };
            let width = [1, 2, 4, 8][below(rng, 4)].min(length - at);
            file[at..at + width].copy_from_slice(&number.to_le_bytes()[..width]);
        }
    }
    mutation
}

/// Random number below `bound`, or 0 if `bound` is 0.
pub(crate) fn below(rng: &mut Rng, bound: usize) -> usize {
    usize::try_from(rng.below_u64(bound as u64)).unwrap_or(0)
}

/// A random range of the file. In half of the cases, it is exactly one part: see [`boundaries`].
fn part(rng: &mut Rng, file: &[u8]) -> (usize, usize) {
    let places = boundaries(file);
    if rng.below(2) == 0 && places.len() > 1 {
        let first = below(rng, places.len() - 1);
        return (places[first], places[first + 1]);
    }
    let start = below(rng, file.len());
    (start, (start + 1 + below(rng, 100)).min(file.len()))
}

/// Beginnings of the parts of a replay or snapshot, followed by the length of the file.
fn boundaries(file: &[u8]) -> Vec<usize> {
    let mut places = vec![0];
    if is_snapshot(file) {
        places.extend([SNAPSHOT_HEADER, file.len().saturating_sub(HASH)]);
    } else if let Some(mut at) = replay_header(file) {
        while at + CHECKSUM <= file.len() {
            at += CHECKSUM;
            places.push(at);
            let Some(length) = number(file, at) else { break };
            at += 5 + length;
        }
    }
    places.retain(|place| *place < file.len());
    places.sort_unstable();
    places.push(file.len());
    places
}

fn is_snapshot(file: &[u8]) -> bool {
    file.starts_with(b"LS2DWRLD")
}

fn number(file: &[u8], at: usize) -> Option<usize> {
    let bytes = file.get(at..)?.first_chunk()?;
    usize::try_from(u32::from_le_bytes(*bytes)).ok()
}

/// Offset of the checksum after the header.
fn replay_header(file: &[u8]) -> Option<usize> {
    Some(56 + number(file, 32)? + number(file, 36)?)
}

/// Recomputes the checksums and hashes that a forger can repair without the game.
pub(crate) fn repair(file: &mut [u8]) {
    if is_snapshot(file) { repair_snapshot(file) } else { repair_replay(file).unwrap_or(()) }
}

fn repair_snapshot(file: &mut [u8]) {
    let Some(body) = file.len().checked_sub(SNAPSHOT_HEADER + HASH) else { return };
    let end = file.len() - HASH;
    file[SNAPSHOT_HEADER - 8..SNAPSHOT_HEADER].copy_from_slice(&(body as u64).to_le_bytes());
    let hash = StateHash::of_bytes(&file[..end]).0;
    file[end..].copy_from_slice(&hash.to_le_bytes());
}

fn repair_replay(file: &mut [u8]) -> Option<()> {
    let mut at = replay_header(file)?;
    let mut chain = StateHash::of_bytes(file.get(..at)?).0;
    loop {
        file.get_mut(at..at + CHECKSUM)?.copy_from_slice(&chain.to_le_bytes()[..CHECKSUM]);
        at += CHECKSUM;
        let payload = at + 5..at + 5 + number(file, at)?;
        if *file.get(at + 4)? == TRAILER && payload.len() >= CHAIN.end {
            file.get_mut(payload.clone())?[CHAIN].copy_from_slice(&chain.to_le_bytes());
        }
        let block = StateHash::of_bytes(file.get(at..payload.end)?).0;
        chain = StateHash::of_bytes(&[chain.to_le_bytes(), block.to_le_bytes()].concat()).0;
        at = payload.end;
    }
}
