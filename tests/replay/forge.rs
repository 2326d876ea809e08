//! Splits a replay as `docs/FORMAT.md` specifies, without the library, and repairs checksums and chain hash. It cannot
//! repair checkpoints and the final hash, because these require the game.

use lockstep2d::hash::StateHash;

pub(crate) const INPUTS: u8 = 1;
pub(crate) const KEYFRAME: u8 = 2;
pub(crate) const TRAILER: u8 = 3;

/// Byte range of the chain hash in the trailer's payload.
pub(crate) const CHAIN: std::ops::Range<usize> = 24..40;

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Forged {
    pub(crate) header: Vec<u8>,
    /// Kind and payload.
    pub(crate) blocks: Vec<(u8, Vec<u8>)>,
}

impl Forged {
    pub(crate) fn take_apart(file: &[u8]) -> Self {
        let u32_at = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
        let mut at = 40 + u32_at(32) + u32_at(36) + 16;
        let header = file[..at].to_vec();
        at += 8;
        let mut blocks = Vec::new();
        while at < file.len() {
            let length = u32_at(at);
            blocks.push((file[at + 4], file[at + 5..at + 5 + length].to_vec()));
            at += 5 + length + 8;
        }
        assert_eq!(at, file.len(), "expected the last block to end at the end of the file");
        Forged { header, blocks }
    }

    /// Bytes of the file with every checksum and the chain hash repaired.
    pub(crate) fn put_together(&self) -> Vec<u8> {
        let mut file = self.header.clone();
        let mut chain = StateHash::of_bytes(&file).0;
        file.extend(&chain.to_le_bytes()[..8]);
        for (kind, payload) in &self.blocks {
            let mut block = u32::try_from(payload.len()).unwrap().to_le_bytes().to_vec();
            block.push(*kind);
            block.extend(payload);
            if *kind == TRAILER && payload.len() >= CHAIN.end {
                block[5..][CHAIN].copy_from_slice(&chain.to_le_bytes());
            }
            let block_hash = StateHash::of_bytes(&block).0;
            chain = StateHash::of_bytes(&[chain.to_le_bytes(), block_hash.to_le_bytes()].concat()).0;
            file.extend(&block);
            file.extend(&chain.to_le_bytes()[..8]);
        }
        file
    }

    pub(crate) fn payload(&mut self, index: usize) -> &mut Vec<u8> {
        &mut self.blocks[index].1
    }

    pub(crate) fn trailer(&mut self) -> &mut Vec<u8> {
        &mut self.blocks.last_mut().unwrap().1
    }

    pub(crate) fn set_ticks(&mut self, ticks: u64) {
        self.trailer()[..8].copy_from_slice(&ticks.to_le_bytes());
    }
}

/// Bytes of a file after a change, with all checksums repaired.
pub(crate) fn forge(file: &[u8], change: impl FnOnce(&mut Forged)) -> Vec<u8> {
    let mut forged = Forged::take_apart(file);
    change(&mut forged);
    forged.put_together()
}
