//! Copies of the state: in memory for rollback, as bytes for files and networks, as digests for comparison, and as a
//! readable view for reports.
//!
//! Data that every tick changes (poses, velocities, fat boxes, impulses) is packed into buffers, whose layout is
//! described at the top of `bodies.rs` and `constraints.rs`. The other data of bodies, shapes, joints and islands is
//! copied in pages of 32 slots, which snapshots share as long as nothing in them changes (`body/arena/pages.rs`).
//! Sleeping contacts are packed and shared as a whole (`sleeping_contacts.rs`). A snapshot stores its digests. Those of
//! the buffers are computed when the buffers are written, those of pages and sleeping contacts once for all snapshots
//! that share them.

mod bodies;
mod bytes;
mod constraints;
mod digest;
mod encoding;
mod packing;
mod phase_log;
mod restore;
mod rollback;
mod save;
mod sleeping_contacts;
mod state_view;
#[cfg(test)]
mod tests;
mod validate;

pub use bytes::SnapshotError;
pub(crate) use digest::HashedState;
pub use digest::{Section, WorldDigest};
pub use phase_log::PhaseDigest;
pub(crate) use phase_log::PhaseLog;
pub use rollback::Snapshot;
pub(crate) use sleeping_contacts::SleepingContacts;
pub use validate::Violation;
