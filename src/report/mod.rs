//! Desync reports, and their comparison, which determines the side that diverged, the tick and the part of the state.
//!
//! A peer keeps a [`History`](crate::lockstep::History) of the last seconds. When it receives a hash that differs from
//! its own, its game can write a [`DesyncReport`]: the hashes and saves of the history, and the replay so far.
//! [`compare`] takes two reports or replays and simulates the confirmed inputs again. A side whose states differ from
//! this rerun has diverged from the rules. This works with two peers, too. Two snapshots are compared without a
//! simulation.
//!
//! [`bisect`] also examines a single file and finds the tick at which its trajectory diverges from the running
//! engine's. A [`Trace`] contains more data for this than a replay.
//!
//! In this module *tick t* is the state after *t* ticks, as in replays: tick 0 is the start. A *trajectory* is the
//! sequence of the states that one machine computed.

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
