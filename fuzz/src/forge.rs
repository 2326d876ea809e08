//! Forges replays: splits a file into the parts that `docs/FORMAT.md` specifies, changes them, and corrects all
//! checksums.

use lockstep2d::hash::StateHash;

use crate::source::Source;

#[path = "../../tests/replay/forge.rs"]
#[allow(dead_code, reason = "the tests of the library use more of it")]
mod forged;

pub(crate) use forged::Forged;
use forged::{CHAIN, TRAILER};

impl Forged {
    /// Makes one random change to the replay.
    pub(crate) fn change(&mut self, source: &mut Source<'_>) {
        let index = source.below(self.blocks.len());
        match source.below(8) {
            0 => mutate(source, &mut self.header),
            1 | 2 if !self.blocks.is_empty() => mutate(source, &mut self.blocks[index].1),
            3 if !self.blocks.is_empty() => drop(self.blocks.remove(index)),
            4 if !self.blocks.is_empty() && self.blocks.len() < 50 => {
                let copy = self.blocks[index].clone();
                self.blocks.push(copy);
            }
            5 if !self.blocks.is_empty() => {
                let other = source.below(self.blocks.len());
                self.blocks.swap(index, other);
            }
            6 if !self.blocks.is_empty() => self.blocks[index].0 = source.byte() % 5,
            _ => {
                let payload = (0..source.below(40)).map(|_| source.byte()).collect();
                self.blocks.insert(index, (1 + source.byte() % 3, payload));
            }
        }
    }
}

/// Corrects the checksums and the chain hash of bytes that have the structure of a replay.
pub fn repair(file: &mut Vec<u8>) {
    let length = |file: &[u8], at: usize| {
        let bytes = file.get(at..at + 4)?.first_chunk()?;
        usize::try_from(u32::from_le_bytes(*bytes)).ok()
    };
    let seal = |file: &mut Vec<u8>, at: usize, chain: u128| {
        let sum = chain.to_le_bytes();
        file.get_mut(at..at + 8).map(|place| place.copy_from_slice(&sum[..8]))
    };
    let Some(mut at) = length(file, 32).zip(length(file, 36)).map(|(name, setup)| 56 + name + setup) else {
        return;
    };
    let Some(header) = file.get(..at) else { return };
    let mut chain = StateHash::of_bytes(header).0;
    while seal(file, at, chain).is_some() {
        at += 8;
        let Some(payload) = length(file, at) else { return };
        let end = at + 5 + payload;
        if end > file.len() {
            return;
        }
        if file[at + 4] == TRAILER && payload >= CHAIN.end {
            file[at + 5..end][CHAIN].copy_from_slice(&chain.to_le_bytes());
        }
        let block = StateHash::of_bytes(&file[at..end]).0;
        chain = StateHash::of_bytes(&[chain.to_le_bytes(), block.to_le_bytes()].concat()).0;
        at = end;
    }
}

/// Makes one random change: changes, inserts, removes or copies a few bytes, or truncates `bytes`.
pub fn mutate(source: &mut Source<'_>, bytes: &mut Vec<u8>) {
    let at = source.below(bytes.len());
    match source.below(7) {
        _ if bytes.is_empty() => bytes.push(source.byte()),
        0 => bytes[at] ^= 1 << source.below(8),
        1 => bytes[at] = source.byte(),
        2 => {
            // Writes a number near a limit, with 8, 4 or 2 bytes, as fields have.
            let number = source.edge().to_bits().to_le_bytes();
            let width = source.pick(&[8, 4, 2]).min(bytes.len() - at);
            bytes[at..at + width].copy_from_slice(&number[..width]);
        }
        3 => bytes.truncate(at),
        4 => bytes.insert(at, source.byte()),
        5 => drop(bytes.remove(at)),
        _ => {
            let (from, width) = (source.below(bytes.len()), source.below(32));
            let copy = bytes[from..(from + width).min(bytes.len())].to_vec();
            let end = (at + copy.len()).min(bytes.len());
            bytes[at..end].copy_from_slice(&copy[..end - at]);
        }
    }
}
