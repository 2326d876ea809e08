//! Replay files: recording, reading and verifying. All functions work on bytes in memory; `docs/FORMAT.md` gives the
//! layout.
//!
//! A replay is a setup and the inputs of every tick. [`Recording`] steps a game and writes its replay at the same time.
//! [`verify`] simulates a replay and returns a [`Verdict`]. A [`Timeline`] seeks to any tick, forwards and backwards.
//!
//! # What `Match` means
//!
//! The file is complete, and its setup and its inputs lead, tick by tick, to the end state and the claims that the file
//! states, under these rules and with this engine. This holds for a file from any source, because the verifier trusts
//! only the setup and the inputs: it recomputes everything else and compares.
//!
//! # What it does not mean
//!
//! None of the hashes is keyed, so a match does not prove who played or that the file is the original recording: anyone
//! who can run the game can write another valid replay. But a file with other inputs has other hashes than its
//! original, even if the checksums are repaired: every checkpoint is a hash of the state *and* of all inputs so far
//! ([`checkpoint_hash`]), so that it covers even an input that the game ignores. To prove authorship, sign the file's
//! bytes.
//!
//! # Untrusted files
//!
//! The [`Limits`] on work and bodies are checked when the game is started and in every tick, all others before the game
//! is started. A file is scanned to its end (lengths, checksums, chain, run lengths) before the game is started, so
//! that a damaged file costs no simulation.

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
pub(crate) use metered::play_within;
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
