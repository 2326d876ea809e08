//! [`Reader`]: reads the structure of a replay, block by block, independently of the game.
//!
//! The reader checks lengths, checksums, the chain hash, the runs, the order of the blocks, and the number of ticks and
//! the claims in the trailer.

use core::fmt;

use super::bytes::Cursor;
use super::flaw::Flaw;
use super::format::{BLOCK_HEAD_BYTES, CHECKSUM_BYTES, HASH_BYTES, checksum, kind, link};
use super::header::{Header, ReadHeader};
use super::limits::{LimitKind, Limits};
use super::runs::Runs;
use super::trailer::{Trailer, read_claims};
use crate::hash::StateHash;

/// Reason why a file cannot be read to its end.
///
/// ```
/// use lockstep2d::replay::{Flaw, Limits, ReadError, Reader};
/// assert!(matches!(
///     Reader::open(b"GIF89a, a picture", &Limits::default()),
///     Err(ReadError::Malformed { offset: 0, flaw: Flaw::Magic }),
/// ));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReadError {
    /// The bytes are not what a recorder writes.
    Malformed {
        /// Offset in the file.
        offset: u64,
        /// The flaw at this offset.
        flaw: Flaw,
    },
    /// The file exceeds a limit.
    LimitExceeded {
        /// The limit.
        limit: LimitKind,
        /// Value in the file.
        value: u64,
        /// Maximum allowed value.
        max: u64,
    },
    /// The file has another version of the format.
    OtherFormat {
        /// Version of the file.
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

/// A part of the file after the header.
///
/// ```
/// # use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::replay::{Limits, Part, Reader, Recording};
/// # let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60).expect("a setup");
/// # (0..90).for_each(|_| recording.step(&[vec![]]).expect("one input"));
/// # let file = recording.finish().expect("no claims");
/// // Finds out whether a file is complete, or its recorder was killed.
/// let mut reader = Reader::open(&file[..file.len() - 1], &Limits::default())?;
/// let mut is_complete = false;
/// while let Some(part) = reader.next_part()? {
///     is_complete |= matches!(part, Part::Trailer(_));
/// }
/// assert_eq!((is_complete, reader.ticks()), (false, 90));
/// # Ok::<(), lockstep2d::replay::ReadError>(())
/// ```
#[derive(Clone, Debug)]
pub enum Part<'a> {
    /// A block with the inputs of consecutive ticks.
    Inputs(InputBlock<'a>),
    /// The end of a complete file.
    Trailer(Trailer),
    /// The file ends before the end of its trailer: its recorder was stopped or is still running.
    Cut,
}

/// A block of inputs.
///
/// ```
/// # use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::replay::{InputBlock, Limits, Part, Reader, Recording};
/// # let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60).expect("a setup");
/// # (0..90).for_each(|_| recording.step(&[vec![]]).expect("one input"));
/// # let file = recording.finish().expect("no claims");
/// let mut reader = Reader::open(&file, &Limits::default())?;
/// // A checkpoint each second, and one at the end.
/// let mut blocks = vec![];
/// while let Some(Part::Inputs(InputBlock { ticks, .. })) = reader.next_part()? {
///     blocks.push(ticks);
/// }
/// assert_eq!(blocks, [60, 30]);
/// # Ok::<(), lockstep2d::replay::ReadError>(())
/// ```
#[derive(Clone, Debug)]
pub struct InputBlock<'a> {
    /// Number of ticks, at least one.
    pub ticks: u32,
    /// Checkpoint after the block's last tick.
    pub checkpoint: StateHash,
    /// Digest of the setup and the inputs up to the block's last tick.
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

/// Reads a replay from the bytes of a file.
///
/// ```
/// # use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::replay::{Limits, Reader, Recording};
/// # let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60).expect("a setup");
/// # (0..90).for_each(|_| recording.step(&[vec![]]).expect("one input"));
/// # let file = recording.finish().expect("no claims");
/// // Determines the length of a replay. All blocks are checked, and none is played.
/// let mut reader = Reader::open(&file, &Limits::default())?;
/// while reader.next_part()?.is_some() {}
/// assert_eq!(reader.ticks() / u64::from(reader.header().tick_rate), 1, "second");
/// # Ok::<(), lockstep2d::replay::ReadError>(())
/// ```
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

/// The kinds of block allowed next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Next {
    InputsOrTrailer,
    /// The last block had fewer ticks than the checkpoint interval, so no other block of inputs may follow.
    Trailer,
    Nothing,
}

impl<'a> Reader<'a> {
    /// Reads the header.
    ///
    /// # Errors
    /// [`ReadError`] if the header is malformed or of another format version, or the file exceeds `limits`.
    pub fn open(file: &'a [u8], limits: &Limits) -> Result<Self, ReadError> {
        LimitKind::FileBytes.check(file.len() as u64, limits.file_bytes)?;
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

    /// Checkpoint before the first tick.
    #[must_use]
    pub fn start(&self) -> StateHash {
        self.start
    }

    /// Digest of the setup and the inputs read so far.
    #[must_use]
    pub fn inputs_digest(&self) -> StateHash {
        self.inputs_digest
    }

    /// Number of ticks read so far.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.ticks
    }

    /// Offset of the next block in the file.
    #[must_use]
    pub fn offset(&self) -> u64 {
        self.offset as u64
    }

    /// Returns the next part of the file, or `None` after a [`Part::Trailer`] or [`Part::Cut`].
    ///
    /// # Errors
    /// [`ReadError`] if the block is malformed or exceeds a limit. Further calls return the same error.
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

    /// Reads the next block and checks its checksum; `None` if the file ends before the end of the block.
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
        LimitKind::BlockBytes.check(length, self.limits.block_bytes)?;
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
        LimitKind::Ticks.check(total, self.limits.ticks)?;

        self.ticks = total;
        self.inputs_digest = link(self.inputs_digest, encoded);
        if ticks < self.header.checkpoint_interval {
            self.next = Next::Trailer;
        }
        let checkpoint = StateHash(u128::from_le_bytes(*stored));
        Ok(InputBlock { ticks, checkpoint, inputs_digest: self.inputs_digest, runs })
    }

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
        let claims = read_claims(&mut cursor)?;
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

/// A block whose checksum matches.
struct Block<'a> {
    kind: u8,
    payload: &'a [u8],
    payload_offset: u64,
    /// Chain hash of the file up to and including this block.
    chain: StateHash,
    end: usize,
}
