//! Desync reports, and comparisons that find the side that diverged, the tick and the part of the state.
//!
//! A peer keeps a [`History`](crate::lockstep::History) of the last seconds. When a peer receives a hash that differs
//! from its own, it can write a [`DesyncReport`]: hashes and saves of the history, and the replay so far. [`compare`]
//! takes two reports or replays and simulates their inputs again. A side whose states differ from this rerun has
//! diverged.
//!
//! [`bisect`] can also compare a single file with the running engine. A [`Trace`] has more data for this than a replay.
//!
//! Here *tick t* is the state after *t* ticks, and a *trajectory* is the sequence of states that one machine computed.

mod bisect;
mod bytes;
mod candidate;
mod compare;
mod comparison;
mod desync;
mod evidence;
mod origin;
mod phases;
mod replay_comparison;
mod replayed;
mod stage;
mod trace;

pub use bisect::bisect;
pub use bytes::{REPORT_FORMAT_VERSION, REPORT_MAGIC, ReportError, ReportFlaw};
pub use compare::{CompareError, compare};
pub use comparison::{Blame, Comparison, Explanation, InputDifference, Side, Subject, Trajectory};
pub use desync::{Desync, DesyncReport, Group, SAVES_BYTES_MAX};
pub use evidence::{Evidence, EvidenceError};
pub use phases::{PHASE_DIGESTS_MAX, TickPhases};
pub use stage::Stage;
pub use trace::{Trace, TraceError};
