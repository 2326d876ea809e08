//! A file, whatever it is, as something to look at.

use std::fmt;

use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::replay::{Limits, Reader, Verdict};
use lockstep2d::report::{Evidence, EvidenceError};
use lockstep2d_shove::Shove;

use super::Source;
use super::replay::Replay;
use super::snapshot::Snapshot;
use crate::versus;

/// A file that cannot be shown, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OpenError {
    /// A replay that cannot be played at all.
    Replay(Verdict),
    /// Something else that is damaged or unknown.
    File(EvidenceError),
    /// A report of a divergence that has no replay in it.
    EmptyReport,
}

impl fmt::Display for OpenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OpenError::Replay(verdict) => verdict.fmt(f),
            OpenError::File(error) => error.fmt(f),
            OpenError::EmptyReport => write!(f, "a report without a replay: there is nothing to play"),
        }
    }
}

impl std::error::Error for OpenError {}

/// Opens a replay, a report of a divergence (the replay in it) or a snapshot. The first bytes tell which it is.
///
/// The bytes live as long as the program: what is shown borrows them, and a person does not open thousands.
///
/// # Errors
/// [`OpenError`] for anything else, and for what is damaged from the start.
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
        return Ok(Box::new(replay.decorated(versus::decorate)));
    }
    // What no game here plays, the sandbox refuses with a reason.
    Ok(Box::new(Replay::<Sandbox>::open(name, bytes, limits).map_err(OpenError::Replay)?))
}
