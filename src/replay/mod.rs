//! Replay files: recording, reading and verifying, on bytes in memory. `docs/FORMAT.md` gives the layout.
//!
//! A replay is a setup and the inputs of every tick. [`Recording`] steps a game and writes its replay. [`verify`]
//! simulates a replay and returns a [`Verdict`]. A [`Timeline`] seeks to any tick, forwards and backwards.
//!
//! # What `Match` means
//!
//! The file is complete. With these rules and this engine, its setup and its inputs lead to its end state and its
//! claims.
//!
//! The hashes have no key. The verdict `Match` does not prove who played: anyone who can run the game can write a valid
//! replay. To prove authorship, sign the file. A file with other inputs has other hashes, because each checkpoint
//! covers the state *and* the inputs so far ([`checkpoint_hash`]).
//!
//! # Untrusted files
//!
//! The [`Limits`] on work and bodies are checked at the start of the game and in every tick. The other limits are
//! checked before the start. A file is scanned to its end first, so that a damaged file costs no simulation.

mod bytes;
mod flaw;
mod format;
mod header;
mod limits;
mod metered;
mod raw_replay;
mod reader;
mod recorder;
mod recording;
mod runs;
mod tick_inputs;
mod timeline;
mod trailer;
mod verdict;
mod verified_replay;

pub use flaw::Flaw;
pub use format::{
    CLAIM_NAME_BYTES_MAX, CLAIMS_MAX, FORMAT_VERSION, MAGIC, PLAYERS_MAX, RULES_NAME_BYTES_MAX,
    checkpoint_hash,
};
pub use header::Header;
pub use limits::{LimitKind, Limits};
pub use metered::play_within;
pub use raw_replay::RawReplay;
pub use reader::{InputBlock, Part, ReadError, Reader};
pub use recorder::{CHECKPOINT_INTERVAL, RecordError, Recorder};
pub use recording::Recording;
pub use runs::{Run, Runs};
pub use tick_inputs::TickInputs;
pub use timeline::{
    KEYFRAMES_BYTES_MAX, KEYFRAMES_FORMAT_VERSION, KEYFRAMES_MAGIC, KeyframesError, KeyframesFlaw, SeekError,
    Timeline, TimelineOptions,
};
pub use trailer::Trailer;
pub use verdict::{ClaimDifference, Mismatch, Verdict};
pub use verified_replay::{Step, VerifiedReplay, verify};
