//! Encoding of a report as bytes. `docs/FORMAT.md` gives the layout.

use alloc::vec::Vec;
use core::fmt;

use super::desync::{Body, DesyncReport};
use super::phases::PHASE_DIGESTS_MAX;
use crate::codec::DecodeError;
use crate::hash::{Envelope, EnvelopeError};
use crate::replay::{Limits, PLAYERS_MAX, RULES_NAME_BYTES_MAX};

/// The first eight bytes of a report.
pub const REPORT_MAGIC: [u8; 8] = *b"\x89L2R\r\n\x1a\n";

/// Version of the layout.
pub const REPORT_FORMAT_VERSION: u32 = 2;

const ENVELOPE: Envelope = Envelope { magic: REPORT_MAGIC, format: REPORT_FORMAT_VERSION };

/// Reason why bytes are not a report.
///
/// ```
/// # use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::{replay::Limits, report::{DesyncReport, ReportError, Trace}};
/// # let trace = Trace::<Sandbox>::start(&SandboxSetup::default(), 10)?;
/// let mut bytes = trace.report().to_bytes();
/// // A report that lost its last byte on the way.
/// bytes.pop();
/// let error = DesyncReport::from_bytes(&bytes, &Limits::default()).expect_err("a byte is missing");
/// assert!(matches!(error, ReportError::Length { announced, found } if announced == found + 1));
/// # Ok::<(), lockstep2d::replay::RecordError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReportError {
    /// The bytes do not start with [`REPORT_MAGIC`], or are too short.
    NotAReport,
    /// The layout has another version.
    Format {
        /// The version found.
        found: u32,
    },
    /// The report is longer than the reader allows.
    TooLong {
        /// Number of bytes.
        bytes: u64,
        /// Maximum number of bytes.
        max: u64,
    },
    /// The number of bytes differs from the header.
    Length {
        /// Length of the file according to its header, in bytes.
        announced: u64,
        /// Number of bytes found.
        found: u64,
    },
    /// The hash at the end does not match the bytes before it.
    Hash,
    /// The body does not decode.
    Decode(DecodeError),
    /// The body decodes, but no writer produces it.
    Invalid(ReportFlaw),
}

/// Flaw in the body of a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReportFlaw {
    /// The name of the rules is empty or too long.
    RulesName,
    /// There are more players than a game can have.
    Players,
    /// The seats are not in ascending order, or one of them does not exist.
    Seats,
    /// The list of hashes does not have one entry, known or unknown, for each seat.
    Hashes,
    /// The ticks of the history are not in ascending order.
    History,
    /// The saves are not in ascending order of ticks, or one is not in the history.
    Saves,
    /// The phase digests are not in ascending order of ticks, a tick is not in the history, or a tick has more than
    /// [`PHASE_DIGESTS_MAX`].
    Phases,
}

impl fmt::Display for ReportFlaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            ReportFlaw::RulesName => "the name of the rules is empty or too long",
            ReportFlaw::Players => "more players than a game can have",
            ReportFlaw::Seats => "the seats are not in ascending order, or one of them does not exist",
            ReportFlaw::Hashes => "there is not one hash for each seat",
            ReportFlaw::History => "the ticks of the history are not in ascending order",
            ReportFlaw::Saves => "the ticks of the saves are not ascending ticks of the history",
            ReportFlaw::Phases => {
                "the ticks of the phases are not ascending ticks of the history, or one has too many"
            }
        })
    }
}

impl fmt::Display for ReportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ReportError::NotAReport => write!(f, "not a report"),
            ReportError::Format { found } => {
                write!(f, "format version {found}, this engine reads {REPORT_FORMAT_VERSION}")
            }
            ReportError::TooLong { bytes, max } => write!(f, "{bytes} bytes, at most {max} are allowed"),
            ReportError::Length { announced, found } => {
                write!(f, "{found} bytes where {announced} are announced")
            }
            ReportError::Hash => write!(f, "the hash does not match the bytes"),
            ReportError::Decode(error) => error.fmt(f),
            ReportError::Invalid(flaw) => flaw.fmt(f),
        }
    }
}

impl core::error::Error for ReportError {}

impl From<EnvelopeError> for ReportError {
    fn from(error: EnvelopeError) -> Self {
        match error {
            EnvelopeError::Magic => ReportError::NotAReport,
            EnvelopeError::Format { found } => ReportError::Format { found },
            EnvelopeError::Length { announced, found } => ReportError::Length { announced, found },
            EnvelopeError::Hash => ReportError::Hash,
            EnvelopeError::Decode(error) => ReportError::Decode(error),
        }
    }
}

impl DesyncReport {
    /// Encodes the report as the bytes of a file.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        ENVELOPE.seal(self.semantics, &self.body)
    }

    /// Decodes a report that [`DesyncReport::to_bytes`] has encoded, if it is at most `limits.file_bytes` long. The
    /// saves and the replay in the report are not decoded or checked.
    ///
    /// # Errors
    /// [`ReportError`] for other bytes, and for a report longer than the limit.
    pub fn from_bytes(bytes: &[u8], limits: &Limits) -> Result<Self, ReportError> {
        let opened = ENVELOPE.open(bytes)?;
        let found = bytes.len() as u64;
        if found > limits.file_bytes {
            return Err(ReportError::TooLong { bytes: found, max: limits.file_bytes });
        }
        let body: Body = opened.decode()?;
        body.check().map_err(ReportError::Invalid)?;
        Ok(DesyncReport { semantics: opened.semantics, body })
    }
}

impl Body {
    fn check(&self) -> Result<(), ReportFlaw> {
        let Body { rules_name, players, seats, hashes, history, saves, phases, .. } = self;
        let ascending = |ticks: &[u64]| ticks.windows(2).all(|pair| pair[0] < pair[1]);
        if rules_name.is_empty() || rules_name.len() > RULES_NAME_BYTES_MAX as usize {
            return Err(ReportFlaw::RulesName);
        }
        if *players > PLAYERS_MAX {
            return Err(ReportFlaw::Players);
        }
        if seats.windows(2).any(|pair| pair[0] >= pair[1]) || seats.iter().any(|seat| seat >= players) {
            return Err(ReportFlaw::Seats);
        }
        if hashes.len() as u64 != u64::from(*players) {
            return Err(ReportFlaw::Hashes);
        }
        let known: Vec<u64> = history.iter().map(|(tick, _)| *tick).collect();
        if !ascending(&known) {
            return Err(ReportFlaw::History);
        }
        let saved: Vec<u64> = saves.iter().map(|(tick, _)| *tick).collect();
        if !ascending(&saved) || saved.iter().any(|tick| known.binary_search(tick).is_err()) {
            return Err(ReportFlaw::Saves);
        }
        let logged: Vec<u64> = phases.iter().map(|(tick, _)| *tick).collect();
        let is_known = |tick: &u64| known.binary_search(tick).is_ok();
        let too_many = phases.iter().any(|(_, tick)| tick.digests.len() > PHASE_DIGESTS_MAX);
        if !ascending(&logged) || !logged.iter().all(is_known) || too_many {
            return Err(ReportFlaw::Phases);
        }
        Ok(())
    }
}
