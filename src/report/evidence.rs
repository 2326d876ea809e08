//! [`Evidence`]: a file that tells something of how a game went.

use alloc::boxed::Box;
use alloc::collections::BTreeMap;
use alloc::vec::Vec;
use core::fmt;

use super::bytes::{REPORT_MAGIC, ReportError};
use super::desync::DesyncReport;
use super::phases::TickPhases;
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

/// What somebody says of a state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Said {
    hash: StateHash,
    /// Of a checkpoint, the digest of the inputs that it binds as well.
    inputs: Option<StateHash>,
}

impl Said {
    /// Whether it is said of the state with that hash.
    pub(super) fn is(&self, state: StateHash) -> bool {
        self.hash == self.inputs.map_or(state, |inputs| checkpoint_hash(state, inputs))
    }
}

/// What one side knows of the course of a game.
#[derive(Default)]
pub(super) struct Known<'a> {
    pub(super) seats: &'a [u32],
    /// State hashes by their ticks.
    pub(super) states: BTreeMap<u64, StateHash>,
    /// Checkpoints of a replay.
    checkpoints: BTreeMap<u64, Said>,
    pub(super) saves: BTreeMap<u64, &'a [u8]>,
    /// How the tick went that led there.
    pub(super) phases: BTreeMap<u64, &'a TickPhases>,
    /// Whether this side is the running engine, which has whatever the rerun has.
    is_rerun: bool,
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
        known.phases = report.phases().iter().map(|(tick, phases)| (*tick, phases)).collect();
        Ok(known)
    }

    /// The running engine, playing the inputs that another side knows.
    pub(super) fn of_rerun(&self) -> Self {
        Known { replay: self.replay, ticks: self.ticks, is_rerun: true, ..Known::default() }
    }

    pub(super) fn of_replay(replay: &'a [u8], limits: &Limits) -> Result<Self, ReadError> {
        let mut known = Known { replay, ..Known::default() };
        if replay.is_empty() {
            return Ok(known);
        }
        let mut reader = Reader::open(replay, limits)?;
        let start = Said { hash: reader.start(), inputs: Some(reader.inputs_digest()) };
        known.checkpoints.insert(0, start);
        while let Some(part) = reader.next_part()? {
            match part {
                Part::Inputs(block) => {
                    let checkpoint = Said { hash: block.checkpoint, inputs: Some(block.inputs_digest) };
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
        if self.is_rerun {
            return Some(true);
        }
        let by_checkpoint = self.checkpoints.get(&tick).is_none_or(|said| said.is(state));
        self.said(tick).map(|said| said.is(state) && by_checkpoint)
    }

    /// What this side has said of its state after so many ticks.
    pub(super) fn said(&self, tick: u64) -> Option<Said> {
        let state = self.states.get(&tick).map(|state| Said { hash: *state, inputs: None });
        state.or_else(|| self.checkpoints.get(&tick).copied())
    }

    /// Whether both sides had the same state after so many ticks, if both have said so.
    pub(super) fn same(&self, other: &Self, tick: u64) -> Option<bool> {
        if let Some((a, b)) = self.states.get(&tick).zip(other.states.get(&tick)) {
            return Some(a == b);
        }
        let (a, b) = self.checkpoints.get(&tick).zip(other.checkpoints.get(&tick))?;
        // With other digests (another interval in the header) the checkpoints cannot be compared.
        (a.inputs == b.inputs).then_some(a.hash == b.hash)
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
