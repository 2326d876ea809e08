use alloc::boxed::Box;
use alloc::collections::BTreeMap;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

use super::bytes::{REPORT_MAGIC, ReportError};
use super::desync::DesyncReport;
use super::phases::TickPhases;
use crate::hash::StateHash;
use crate::replay::{self, Limits, Part, ReadError, Reader, checkpoint_hash};
use crate::world::{SnapshotError, World};

/// A file that can be compared with another file.
#[derive(Clone, Debug)]
pub enum Evidence {
    /// The report of a peer on a desync, or of a [`Trace`](super::Trace).
    Report(Box<DesyncReport>),
    /// The bytes of a replay, which are not checked yet.
    Replay(Vec<u8>),
    /// The world of a snapshot.
    World(Box<World>),
}

/// Reason why bytes cannot be read as [`Evidence`].
///
/// ```
/// use lockstep2d::{replay::Limits, report::{Evidence, EvidenceError}, world::World};
/// // A tool opens files of all three kinds: reports, replays and snapshots.
/// let limits = Limits::default();
/// assert!(matches!(Evidence::read(World::default().to_bytes(), &limits), Ok(Evidence::World(_))));
/// assert_eq!(Evidence::read(b"GIF89a".to_vec(), &limits).err(), Some(EvidenceError::Unknown));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EvidenceError {
    /// A report that is damaged, too long, or has another format.
    Report(ReportError),
    /// A snapshot that is damaged, or has another format or other semantics.
    World(SnapshotError),
    /// The bytes are neither a report nor a replay nor a snapshot.
    Unknown,
}

impl fmt::Display for EvidenceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EvidenceError::Report(error @ ReportError::Format { .. }) => {
                write!(f, "a report of another version: {error}")
            }
            EvidenceError::Report(error) => write!(f, "a damaged report: {error}"),
            EvidenceError::World(
                error @ (SnapshotError::Format { .. } | SnapshotError::Semantics { .. }),
            ) => {
                write!(f, "a snapshot of another version: {error}")
            }
            EvidenceError::World(error) => write!(f, "a damaged snapshot: {error}"),
            EvidenceError::Unknown => write!(f, "neither a report nor a replay nor a snapshot"),
        }
    }
}

impl core::error::Error for EvidenceError {}

impl Evidence {
    /// Reads a file, whose kind follows from its first bytes.
    ///
    /// # Errors
    /// [`EvidenceError`] unless the bytes are a readable report or snapshot, or start like a replay. The rest of a
    /// replay is not checked.
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

/// A hash that a file states for a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Said {
    hash: StateHash,
    /// `None` if `hash` is a state hash. If `hash` is a checkpoint, the digest of the inputs, which a checkpoint covers
    /// in addition to the state.
    inputs: Option<StateHash>,
}

impl Said {
    pub(super) fn is(&self, state: StateHash) -> bool {
        self.hash == self.inputs.map_or(state, |inputs| checkpoint_hash(state, inputs))
    }
}

#[derive(Default)]
pub(super) struct SideEvidence<'a> {
    pub(super) seats: &'a [u32],
    pub(super) states: BTreeMap<u64, StateHash>,
    checkpoints: BTreeMap<u64, Said>,
    pub(super) saves: BTreeMap<u64, &'a [u8]>,
    /// Phase digests of the step that led to a tick.
    pub(super) phases: BTreeMap<u64, &'a TickPhases>,
    /// Whether this side is the running engine.
    is_rerun: bool,
    pub(super) replay: &'a [u8],
    pub(super) ticks: u64,
    /// The claims of a complete replay, by name.
    pub(super) claims: Option<BTreeMap<String, i64>>,
}

impl<'a> SideEvidence<'a> {
    pub(super) fn of_report(report: &'a DesyncReport, limits: &Limits) -> Result<Self, ReadError> {
        let mut known = SideEvidence::of_replay(report.replay(), limits)?;
        known.seats = report.seats();
        known.states.extend(report.history().iter().copied());
        known.saves = report.saves().iter().map(|(tick, save)| (*tick, save.as_slice())).collect();
        known.phases = report.phases().iter().map(|(tick, phases)| (*tick, phases)).collect();
        Ok(known)
    }

    /// The evidence of the running engine, which simulates the inputs of this side.
    pub(super) fn of_rerun(&self) -> Self {
        SideEvidence { replay: self.replay, ticks: self.ticks, is_rerun: true, ..SideEvidence::default() }
    }

    pub(super) fn of_replay(replay: &'a [u8], limits: &Limits) -> Result<Self, ReadError> {
        let mut known = SideEvidence { replay, ..SideEvidence::default() };
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
                Part::Trailer(trailer) => {
                    known.states.insert(trailer.ticks, trailer.final_hash);
                    known.claims = Some(trailer.claims.into_iter().collect());
                }
                Part::Cut => {}
            }
        }
        known.ticks = reader.ticks();
        Ok(known)
    }

    /// Whether this side had this state after `tick` ticks; `None` if the side states no hash for that tick.
    pub(super) fn had(&self, tick: u64, state: StateHash) -> Option<bool> {
        if self.is_rerun {
            return Some(true);
        }
        let by_checkpoint = self.checkpoints.get(&tick).is_none_or(|said| said.is(state));
        self.said(tick).map(|said| said.is(state) && by_checkpoint)
    }

    pub(super) fn said(&self, tick: u64) -> Option<Said> {
        let state = self.states.get(&tick).map(|state| Said { hash: *state, inputs: None });
        state.or_else(|| self.checkpoints.get(&tick).copied())
    }

    /// Whether both sides had the same state after `tick` ticks; `None` if that is unknown.
    pub(super) fn same(&self, other: &Self, tick: u64) -> Option<bool> {
        if let Some((a, b)) = self.states.get(&tick).zip(other.states.get(&tick)) {
            return Some(a == b);
        }
        let (a, b) = self.checkpoints.get(&tick).zip(other.checkpoints.get(&tick))?;
        // Checkpoints with different input digests cannot be compared. The digests of equal inputs differ if, for
        // example, the checkpoint intervals differ.
        (a.inputs == b.inputs).then_some(a.hash == b.hash)
    }

    pub(super) fn last(&self) -> u64 {
        let last = |tick: Option<&u64>| tick.copied().unwrap_or(0);
        last(self.states.keys().next_back()).max(last(self.checkpoints.keys().next_back()))
    }

    pub(super) fn ticks_known(&self) -> impl Iterator<Item = u64> {
        self.states.keys().chain(self.checkpoints.keys()).copied()
    }
}
