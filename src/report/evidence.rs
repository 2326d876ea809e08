//! [`Evidence`]: a file that tells something of how a game went.

use alloc::boxed::Box;
use alloc::collections::BTreeMap;
use alloc::vec::Vec;
use core::fmt;

use super::bytes::{REPORT_MAGIC, ReportError};
use super::desync::DesyncReport;
use crate::hash::StateHash;
use crate::replay::{self, Limits, Part, ReadError, Reader, checkpoint_hash};
use crate::world::{SnapshotError, World};

/// A file that can be compared with another one.
#[derive(Clone, Debug)]
pub enum Evidence {
    /// What a peer wrote when states differed.
    Report(Box<DesyncReport>),
    /// The bytes of a replay, which are judged when they are played.
    Replay(Vec<u8>),
    /// A world, from the bytes of a snapshot.
    World(Box<World>),
}

/// Bytes that are no evidence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EvidenceError {
    /// A report that is damaged.
    Report(ReportError),
    /// A snapshot that is damaged.
    World(SnapshotError),
    /// None of the three.
    Unknown,
}

impl fmt::Display for EvidenceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EvidenceError::Report(error) => write!(f, "a damaged report: {error}"),
            EvidenceError::World(error) => write!(f, "a damaged snapshot: {error}"),
            EvidenceError::Unknown => write!(f, "neither a report nor a replay nor a snapshot"),
        }
    }
}

impl core::error::Error for EvidenceError {}

impl Evidence {
    /// Reads a file: the first bytes tell which kind it is.
    ///
    /// # Errors
    /// [`EvidenceError`] for bytes that are none of the three.
    pub fn read(bytes: Vec<u8>, limits: &Limits) -> Result<Self, EvidenceError> {
        if bytes.starts_with(&replay::MAGIC) {
            return Ok(Evidence::Replay(bytes));
        }
        if bytes.starts_with(&REPORT_MAGIC) {
            let report = DesyncReport::from_bytes(&bytes, limits).map_err(EvidenceError::Report)?;
            return Ok(Evidence::Report(Box::new(report)));
        }
        match World::from_bytes(&bytes) {
            Ok(world) => Ok(Evidence::World(Box::new(world))),
            Err(SnapshotError::NotASnapshot) => Err(EvidenceError::Unknown),
            Err(error) => Err(EvidenceError::World(error)),
        }
    }
}

/// What one side knows of the course of a game.
#[derive(Default)]
pub(super) struct Known<'a> {
    pub(super) seats: &'a [u32],
    /// State hashes by their ticks.
    pub(super) states: BTreeMap<u64, StateHash>,
    /// Checkpoints of a replay, and the digest of the inputs up to each.
    checkpoints: BTreeMap<u64, (StateHash, StateHash)>,
    pub(super) saves: BTreeMap<u64, &'a [u8]>,
    /// Of a report without a replay, nothing.
    pub(super) replay: &'a [u8],
    /// How many ticks the replay has.
    pub(super) ticks: u64,
}

impl<'a> Known<'a> {
    pub(super) fn of_report(report: &'a DesyncReport, limits: &Limits) -> Result<Self, ReadError> {
        let mut known = Known::of_replay(report.replay(), limits)?;
        known.seats = report.seats();
        known.states.extend(report.history().iter().copied());
        known.saves = report.saves().iter().map(|(tick, save)| (*tick, save.as_slice())).collect();
        Ok(known)
    }

    pub(super) fn of_replay(replay: &'a [u8], limits: &Limits) -> Result<Self, ReadError> {
        let mut known = Known { replay, ..Known::default() };
        if replay.is_empty() {
            return Ok(known);
        }
        let mut reader = Reader::open(replay, limits)?;
        known.checkpoints.insert(0, (reader.start(), reader.inputs_digest()));
        while let Some(part) = reader.next_part()? {
            match part {
                Part::Inputs(block) => {
                    let checkpoint = (block.checkpoint, block.inputs_digest);
                    known.checkpoints.insert(reader.ticks(), checkpoint);
                }
                Part::Trailer(trailer) => drop(known.states.insert(trailer.ticks, trailer.final_hash)),
                Part::Cut => {}
            }
        }
        known.ticks = reader.ticks();
        Ok(known)
    }

    /// Whether this side had that state after so many ticks, if it has said so.
    pub(super) fn had(&self, tick: u64, state: StateHash) -> Option<bool> {
        let by_state = self.states.get(&tick).map(|known| *known == state);
        let by_checkpoint =
            self.checkpoints.get(&tick).map(|(known, inputs)| *known == checkpoint_hash(state, *inputs));
        match (by_state, by_checkpoint) {
            (Some(a), Some(b)) => Some(a && b),
            (known, None) | (None, known) => known,
        }
    }

    /// Whether both sides had the same state after so many ticks, if both have said so.
    pub(super) fn same(&self, other: &Self, tick: u64) -> Option<bool> {
        if let Some((a, b)) = self.states.get(&tick).zip(other.states.get(&tick)) {
            return Some(a == b);
        }
        let ((a, inputs_a), (b, inputs_b)) = self.checkpoints.get(&tick).zip(other.checkpoints.get(&tick))?;
        // With other digests (another interval in the header) the checkpoints cannot be compared.
        (inputs_a == inputs_b).then_some(a == b)
    }

    /// The last tick of which it has said anything.
    pub(super) fn last(&self) -> u64 {
        let last = |tick: Option<&u64>| tick.copied().unwrap_or(0);
        last(self.states.keys().next_back()).max(last(self.checkpoints.keys().next_back()))
    }

    /// All ticks of which it has said something.
    pub(super) fn ticks_known(&self) -> impl Iterator<Item = u64> {
        self.states.keys().chain(self.checkpoints.keys()).copied()
    }
}
