//! What a peer writes when states differ, and what two of such files tell together: who departed, when and where.
//!
//! A peer keeps a [`History`](crate::lockstep::History) of the last seconds. When a hash of another peer is not its own,
//! it writes a [`DesyncReport`]: hashes and saves of these ticks, and the replay so far. [`compare`] takes two reports,
//! replays or snapshots and plays the confirmed inputs again. A side whose states are not those of this rerun has
//! departed from the rules; that is known with two peers, too.
//!
//! [`bisect`] asks the same of a single file: where did its course leave that of the running engine? For that a [`Trace`]
//! has more than a replay.
//!
//! In everything here *tick t* is the state after *t* ticks, as in replays: tick 0 is the start.

mod bisect;
mod bytes;
mod compare;
mod comparison;
mod desync;
mod duel;
mod evidence;
mod origin;
mod phases;
mod rerun;
mod stage;
mod suspect;
mod trace;

pub use bisect::bisect;
pub use bytes::{REPORT_FORMAT_VERSION, REPORT_MAGIC, ReportError, ReportFlaw};
pub use compare::{CompareError, compare};
pub use comparison::{Blame, Comparison, Course, Explanation, InputDifference, Side, Thing};
pub use desync::{Desync, DesyncReport, Group, SAVES_BYTES_MAX};
pub use evidence::{Evidence, EvidenceError};
pub use phases::{PHASE_DIGESTS_MAX, TickPhases};
pub use stage::Stage;
pub use trace::{Trace, TraceError};
