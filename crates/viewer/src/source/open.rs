//! Opens a file of any supported kind as a source.

use std::fmt;

use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::replay::{Limits, Reader, Verdict};
use lockstep2d::report::{Evidence, EvidenceError};
use lockstep2d_shove::Shove;

use super::Source;
use super::replay::Replay;
use super::snapshot::Snapshot;
use crate::netplay;

/// Reason why a file cannot be shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OpenError {
    /// The file is a replay of which no tick can be played.
    Replay(Verdict),
    /// The file is damaged or of an unknown kind.
    File(EvidenceError),
    /// The file is a divergence report that contains no replay.
    EmptyReport,
}

impl fmt::Display for OpenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OpenError::Replay(verdict) => verdict.fmt(f),
            OpenError::File(error) => error.fmt(f),
            OpenError::EmptyReport => write!(f, "the report contains no replay: there is nothing to play"),
        }
    }
}

impl std::error::Error for OpenError {}

/// Opens a replay, a divergence report (the replay in it) or a snapshot. The first bytes of the file determine its
/// kind.
///
/// The bytes stay allocated until the program ends, because the source borrows them; a user does not open enough
/// files for this to matter.
///
/// # Errors
/// [`OpenError`] for other kinds of files, and for files that are damaged from the start.
pub fn open(name: &str, bytes: &'static [u8]) -> Result<Box<dyn Source>, OpenError> {
    let limits = Limits::default();
    match Evidence::read(bytes.to_vec(), &limits).map_err(OpenError::File)? {
        Evidence::Replay(_) => open_replay(name, bytes, &limits),
        Evidence::Report(report) if report.replay().is_empty() => Err(OpenError::EmptyReport),
        Evidence::Report(report) => open_replay(name, report.replay().to_vec().leak(), &limits),
        Evidence::World(world) => Ok(Box::new(Snapshot::new(name, *world))),
    }
}

fn open_replay(name: &str, bytes: &'static [u8], limits: &Limits) -> Result<Box<dyn Source>, OpenError> {
    let reader = Reader::open(bytes, limits).map_err(|error| OpenError::Replay(error.into()))?;
    if reader.header().rules_name == Shove::RULES.name {
        let replay = Replay::<Shove>::open(name, bytes, limits).map_err(OpenError::Replay)?;
        return Ok(Box::new(replay.decorated(netplay::decorate)));
    }
    // A replay of an unknown game is refused by the sandbox, with a reason.
    Ok(Box::new(Replay::<Sandbox>::open(name, bytes, limits).map_err(OpenError::Replay)?))
}
