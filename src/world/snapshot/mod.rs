//! Copies of the state: in memory for rollback, as bytes for files and networks, as digests, and as a readable view.
//!
//! A snapshot has its own copy of the data that ticks change (poses, velocities, fat boxes, impulses), packed into
//! buffers: see `bodies.rs` and `constraints.rs`. The other data of bodies, shapes, joints and islands is copied in
//! pages of 32 slots. A page that has not changed since the last snapshot is shared, not copied again
//! (`body/arena/pages.rs`). Sleeping contacts are shared as one list (`sleeping_contacts.rs`). Each snapshot hashes its
//! buffers; shared data is hashed once for all snapshots that share it.

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
