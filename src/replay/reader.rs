//! [`Reader`]: the structure of a replay, block by block, without knowing the game.
//!
//! Everything that can be judged without stepping the game is judged here: lengths, checksums, the chain, run
//! lengths, the order of the blocks, the trailer's counts.

use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

use super::bytes::Cursor;
use super::flaw::Flaw;
use super::format::{
    BLOCK_HEAD_BYTES, CHECKSUM_BYTES, CLAIM_NAME_BYTES_MAX, CLAIMS_MAX, HASH_BYTES, checksum, kind, link,
};
use super::header::{Header, ReadHeader};
use super::limits::{Limit, Limits};
use super::runs::Runs;
use crate::hash::StateHash;

/// Why a file, or the rest of it, cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReadError {
    /// No recorder writes such bytes.
    Malformed {
        /// Where in the file.
        offset: u64,
        /// What is wrong there.
        flaw: Flaw,
    },
    /// The file is larger than the reader allows.
    LimitExceeded {
        /// In what.
        limit: Limit,
        /// What the file has.
        value: u64,
        /// What is allowed.
        max: u64,
    },
    /// The file has another version of the format.
    OtherFormat {
        /// Its version.
        version: u32,
    },
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ReadError::Malformed { offset, flaw } => write!(f, "at byte {offset}: {flaw}"),
            ReadError::LimitExceeded { limit, value, max } => {
                write!(f, "{value} {limit}, at most {max} are allowed")
            }
            ReadError::OtherFormat { version } => write!(f, "version {version} of the file format"),
        }
    }
}

impl core::error::Error for ReadError {}

/// What follows the header, one after the other.
#[derive(Clone, Debug)]
pub enum Part<'a> {
    /// The inputs of some ticks.
    Inputs(InputBlock<'a>),
    /// The end of a complete file.
    Trailer(Trailer),
    /// The file ends before its trailer: a recorder was stopped, or is still at work.
    Cut,
}

/// A block of inputs.
#[derive(Clone, Debug)]
pub struct InputBlock<'a> {
    /// How many ticks it has, at least one.
    pub ticks: u32,
    /// The checkpoint after its last tick.
    pub checkpoint: StateHash,
    /// The digest of all inputs up to its last tick.
    pub inputs_digest: StateHash,
    runs: Runs<'a>,
}

impl<'a> InputBlock<'a> {
    /// The runs of the block.
    #[must_use]
    pub fn runs(&self) -> Runs<'a> {
        self.runs.clone()
    }
}

/// What the file says about its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Trailer {
    /// Ticks of the game.
    pub ticks: u64,
    /// The hash of the state after the last tick.
    pub final_hash: StateHash,
    /// The hash of the header and all blocks of inputs.
    pub chain: StateHash,
    /// What the game reports of itself, in ascending order of the names.
    pub claims: Vec<(String, i64)>,
}

/// Reads a replay from the bytes of a file.
#[derive(Clone, Debug)]
pub struct Reader<'a> {
    file: &'a [u8],
    limits: Limits,
    header: Header<'a>,
    start: StateHash,
    offset: usize,
    chain: StateHash,
    inputs_digest: StateHash,
    ticks: u64,
    next: Next,
}

/// What the next block may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Next {
    InputsOrTrailer,
    /// After a block with fewer ticks than the interval.
    Trailer,
    Nothing,
}

impl<'a> Reader<'a> {
    /// Reads the header.
    ///
    /// # Errors
    /// [`ReadError`] when the header is not one, or announces more than `limits` allow.
    pub fn open(file: &'a [u8], limits: &Limits) -> Result<Self, ReadError> {
        Limit::FileBytes.check(file.len() as u64, limits.file_bytes)?;
        let ReadHeader { header, start, inputs_digest, chain, length } = Header::read(file, limits)?;
        Ok(Reader {
            file,
            limits: limits.clone(),
            header,
            start,
            offset: length,
            chain,
            inputs_digest,
            ticks: 0,
            next: Next::InputsOrTrailer,
        })
    }

    /// The header.
    #[must_use]
    pub fn header(&self) -> &Header<'a> {
        &self.header
    }

    /// The checkpoint before the first tick.
    #[must_use]
    pub fn start(&self) -> StateHash {
        self.start
    }

    /// The digest of the setup and all inputs read so far.
    #[must_use]
    pub fn inputs_digest(&self) -> StateHash {
        self.inputs_digest
    }

    /// Ticks read so far.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.ticks
    }

    /// Where the next block begins.
    #[must_use]
    pub fn offset(&self) -> u64 {
        self.offset as u64
    }

    /// The next block, and `None` after a [`Part::Trailer`] or [`Part::Cut`].
    ///
    /// # Errors
    /// [`ReadError`] when the block is not one, or is larger than allowed. Asked again, the answer is the same.
    pub fn next_part(&mut self) -> Result<Option<Part<'a>>, ReadError> {
        if self.next == Next::Nothing {
            return Ok(None);
        }
        let Some(block) = self.frame()? else {
            self.next = Next::Nothing;
            return Ok(Some(Part::Cut));
        };
        let part = match block.kind {
            kind::TRAILER => Part::Trailer(self.trailer(&block)?),
            _ => Part::Inputs(self.inputs(&block)?),
        };
        self.offset = block.end;
        self.chain = block.chain;
        Ok(Some(part))
    }

    /// The next block's payload, or `None` when the file ends before the block does.
    fn frame(&self) -> Result<Option<Block<'a>>, ReadError> {
        let start = self.offset as u64;
        let rest = &self.file[self.offset..];
        let mut cursor = Cursor::new(rest, start);
        let (Some(length), Some([kind])) = (cursor.u32(), cursor.array()) else {
            return Ok(None);
        };
        if !matches!(kind, kind::INPUTS | kind::TRAILER) {
            return Err(ReadError::Malformed { offset: start + 4, flaw: Flaw::BlockKind { kind } });
        }
        Limit::BlockBytes.check(length, self.limits.block_bytes)?;
        let Ok(length) = usize::try_from(length) else {
            return Ok(None);
        };
        let (payload_offset, payload) = (cursor.offset(), cursor.take(length));
        let (checksum_offset, stored) = (cursor.offset(), cursor.array());
        let (Some(payload), Some(stored)) = (payload, stored) else {
            return Ok(None);
        };
        let chain = link(self.chain, &rest[..BLOCK_HEAD_BYTES + length]);
        if stored != checksum(chain) {
            return Err(ReadError::Malformed { offset: checksum_offset, flaw: Flaw::BlockChecksum });
        }
        let end = self.offset + BLOCK_HEAD_BYTES + length + CHECKSUM_BYTES;
        Ok(Some(Block { kind, payload, payload_offset, chain, end }))
    }

    fn inputs(&mut self, block: &Block<'a>) -> Result<InputBlock<'a>, ReadError> {
        let malformed = |flaw| ReadError::Malformed { offset: block.payload_offset, flaw };
        if self.next == Next::Trailer {
            return Err(malformed(Flaw::BlockAfterLast));
        }
        let (encoded, stored) =
            block.payload.split_last_chunk::<HASH_BYTES>().ok_or(malformed(Flaw::BlockCut))?;
        let runs = Runs::new(encoded, block.payload_offset);
        let ticks = self.count_ticks(runs.clone(), block.payload_offset)?;
        let total = self.ticks + u64::from(ticks);
        Limit::Ticks.check(total, self.limits.ticks)?;

        self.ticks = total;
        self.inputs_digest = link(self.inputs_digest, encoded);
        if ticks < self.header.checkpoint_interval {
            self.next = Next::Trailer;
        }
        let checkpoint = StateHash(u128::from_le_bytes(*stored));
        Ok(InputBlock { ticks, checkpoint, inputs_digest: self.inputs_digest, runs })
    }

    /// Walks over all runs of a block.
    fn count_ticks(&self, mut runs: Runs<'a>, offset: u64) -> Result<u32, ReadError> {
        let interval = self.header.checkpoint_interval;
        let mut ticks: u32 = 0;
        while let Some(run) = runs.next_run()? {
            let total = u64::from(ticks) + u64::from(run.ticks);
            ticks =
                u32::try_from(total).ok().filter(|total| *total <= interval).ok_or(ReadError::Malformed {
                    offset: run.offset,
                    flaw: Flaw::BlockTicks { ticks: total, interval },
                })?;
        }
        if ticks == 0 { Err(ReadError::Malformed { offset, flaw: Flaw::EmptyBlock }) } else { Ok(ticks) }
    }

    fn trailer(&mut self, block: &Block<'a>) -> Result<Trailer, ReadError> {
        let malformed = |offset, flaw| Err(ReadError::Malformed { offset, flaw });
        let start = block.payload_offset;
        let mut cursor = Cursor::new(block.payload, start);
        let cut = ReadError::Malformed { offset: start, flaw: Flaw::BlockCut };
        let (Some(ticks), Some(final_hash), Some(chain)) = (cursor.u64(), cursor.u128(), cursor.u128())
        else {
            return Err(cut);
        };
        if ticks != self.ticks {
            return malformed(start, Flaw::Ticks { trailer: ticks, blocks: self.ticks });
        }
        if chain != self.chain.0 {
            return malformed(start + 24, Flaw::Chain);
        }
        let claims = claims(&mut cursor)?;
        if !cursor.is_empty() {
            return malformed(cursor.offset(), Flaw::TrailerLength);
        }
        let after = self.file.len() - block.end;
        if after > 0 {
            return malformed(block.end as u64, Flaw::TrailingBytes { count: after as u64 });
        }
        self.next = Next::Nothing;
        Ok(Trailer { ticks, final_hash: StateHash(final_hash), chain: StateHash(chain), claims })
    }
}

/// A block whose checksum holds.
struct Block<'a> {
    kind: u8,
    payload: &'a [u8],
    payload_offset: u64,
    /// The chain with this block in it.
    chain: StateHash,
    end: usize,
}

fn claims(cursor: &mut Cursor<'_>) -> Result<Vec<(String, i64)>, ReadError> {
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
