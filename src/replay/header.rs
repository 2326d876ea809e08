use alloc::vec::Vec;

use super::bytes::Cursor;
use super::flaw::Flaw;
use super::format::{FORMAT_VERSION, MAGIC, PLAYERS_MAX, RULES_NAME_BYTES_MAX, checksum};
use super::limits::{LimitKind, Limits};
use super::reader::ReadError;
use crate::hash::StateHash;

/// The header of a replay.
///
/// ```
/// # use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::replay::{Header, Limits, Reader, Recording};
/// # let recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60).expect("a setup");
/// # let file = recording.finish().expect("few claims");
/// // A list of files shows the game of each. The header is read without playing any tick.
/// let reader = Reader::open(&file, &Limits::default())?;
/// let Header { rules_name, players, tick_rate, .. } = reader.header();
/// assert_eq!((*rules_name, *players, *tick_rate), ("sandbox", 1, 60));
/// # Ok::<(), lockstep2d::replay::ReadError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header<'a> {
    /// Version of the engine's semantics, [`SEMANTICS`](crate::SEMANTICS).
    pub semantics: u32,
    /// Version of the game's rules.
    pub rules_version: u32,
    /// Number of players.
    pub players: u32,
    /// Ticks per second.
    pub tick_rate: u32,
    /// Ticks in a block of inputs. The last block may have fewer.
    pub checkpoint_interval: u32,
    /// Name of the game's rules.
    pub rules_name: &'a str,
    /// Canonical bytes of the game's setup.
    pub setup: &'a [u8],
}

/// Offsets of header fields in the file, for verdicts.
pub(super) mod offset {
    pub(in crate::replay) const PLAYERS: u64 = 20;
    pub(in crate::replay) const TICK_RATE: u64 = 24;
    pub(in crate::replay) const CHECKPOINT_INTERVAL: u64 = 28;
    pub(in crate::replay) const RULES_NAME_LENGTH: u64 = 32;
    pub(in crate::replay) const RULES_NAME: u64 = 40;
}

/// A header, with the initial hashes for the rest of the file.
#[derive(Clone, Debug)]
pub(super) struct ReadHeader<'a> {
    pub(super) header: Header<'a>,
    /// The checkpoint hash before the first tick.
    pub(super) start: StateHash,
    pub(super) inputs_digest: StateHash,
    pub(super) chain: StateHash,
    /// Length of the header in bytes, including its checksum.
    pub(super) length: usize,
}

impl<'a> Header<'a> {
    pub(super) fn setup_offset(&self) -> u64 {
        offset::RULES_NAME + self.rules_name.len() as u64
    }

    /// Encodes the header up to the checkpoint hash before the first tick, which covers these bytes. The caller has
    /// checked the lengths.
    pub(super) fn encode(&self) -> Vec<u8> {
        let Header { semantics, rules_version, players, tick_rate, checkpoint_interval, rules_name, setup } =
            *self;
        let length = |bytes: &[u8]| u32::try_from(bytes.len()).expect("a length that was checked");
        let numbers = [
            FORMAT_VERSION,
            semantics,
            rules_version,
            players,
            tick_rate,
            checkpoint_interval,
            length(rules_name.as_bytes()),
            length(setup),
        ];
        let mut bytes = MAGIC.to_vec();
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        bytes.extend_from_slice(rules_name.as_bytes());
        bytes.extend_from_slice(setup);
        bytes
    }

    pub(super) fn read(file: &'a [u8], limits: &Limits) -> Result<ReadHeader<'a>, ReadError> {
        let malformed = |offset, flaw| Err(ReadError::Malformed { offset, flaw });
        let cut = || ReadError::Malformed { offset: file.len() as u64, flaw: Flaw::HeaderCut };
        let mut cursor = Cursor::new(file, 0);

        if !file.starts_with(&MAGIC) && !MAGIC.starts_with(file) {
            return malformed(0, Flaw::Magic);
        }
        let _: [u8; MAGIC.len()] = cursor.array().ok_or_else(cut)?;
        let version = cursor.u32().ok_or_else(cut)?;
        if version != FORMAT_VERSION {
            return Err(ReadError::OtherFormat { version });
        }
        let semantics = cursor.u32().ok_or_else(cut)?;
        let rules_version = cursor.u32().ok_or_else(cut)?;
        let players = cursor.u32().ok_or_else(cut)?;
        let tick_rate = cursor.u32().ok_or_else(cut)?;
        let checkpoint_interval = cursor.u32().ok_or_else(cut)?;
        let name_length = cursor.u32().ok_or_else(cut)?;
        let setup_length = cursor.u32().ok_or_else(cut)?;
        if name_length == 0 || name_length > RULES_NAME_BYTES_MAX {
            return malformed(offset::RULES_NAME_LENGTH, Flaw::RulesName);
        }
        LimitKind::SetupBytes.check(setup_length, limits.setup_bytes)?;

        let name = take(&mut cursor, name_length).ok_or_else(cut)?;
        let setup = take(&mut cursor, setup_length).ok_or_else(cut)?;
        let inputs_digest = StateHash::of_bytes(before(file, &cursor));
        let start = StateHash(cursor.u128().ok_or_else(cut)?);
        let chain = StateHash::of_bytes(before(file, &cursor));
        let checksum_offset = cursor.offset();
        if cursor.array().ok_or_else(cut)? != checksum(chain) {
            return malformed(checksum_offset, Flaw::HeaderChecksum);
        }

        let Ok(rules_name) = core::str::from_utf8(name) else {
            return malformed(offset::RULES_NAME, Flaw::RulesName);
        };
        let length = before(file, &cursor).len();
        let header =
            Header { semantics, rules_version, players, tick_rate, checkpoint_interval, rules_name, setup };
        header.check(limits)?;
        Ok(ReadHeader { header, start, inputs_digest, chain, length })
    }

    fn check(&self, limits: &Limits) -> Result<(), ReadError> {
        let malformed = |offset, flaw| Err(ReadError::Malformed { offset, flaw });
        if self.players > PLAYERS_MAX {
            return malformed(offset::PLAYERS, Flaw::Players { count: self.players });
        }
        if self.tick_rate == 0 {
            return malformed(offset::TICK_RATE, Flaw::TickRate);
        }
        if self.checkpoint_interval == 0 {
            return malformed(offset::CHECKPOINT_INTERVAL, Flaw::CheckpointInterval);
        }
        LimitKind::Players.check(self.players, limits.players)?;
        LimitKind::BlockTicks.check(self.checkpoint_interval, limits.block_ticks)
    }
}

fn take<'a>(cursor: &mut Cursor<'a>, count: u32) -> Option<&'a [u8]> {
    cursor.take(usize::try_from(count).ok()?)
}

fn before<'a>(file: &'a [u8], cursor: &Cursor<'_>) -> &'a [u8] {
    let passed = usize::try_from(cursor.offset()).expect("an offset inside a slice");
    &file[..passed]
}
