//! Replay files: recording, reading and verifying. Bytes in, bytes out; `docs/FORMAT.md` gives the layout.
//!
//! A replay is a setup and the inputs of every tick. [`Recording`] steps a game and writes one as it goes,
//! [`verify`] plays it again and answers with a [`Verdict`]. A [`Timeline`] goes to any tick of it, forwards and
//! backwards.
//!
//! # What `Match` means
//!
//! The file is whole, and under these rules and this engine its setup and its inputs lead, tick for tick, to the
//! end state and the claims that it states. This holds for any file from anywhere, because the verifier believes
//! nothing but the setup and the inputs: the rest it works out again and compares.
//!
//! # What it does not mean
//!
//! None of the hashes is keyed, so it does not say who played, or that a file is the one that was once recorded:
//! whoever can run the game can write another true replay. What cannot happen by accident, or by editing inputs
//! and repairing checksums, is a file that keeps the hashes of its original and tells another story. Every
//! checkpoint is a hash of the state *and* of all inputs so far ([`checkpoint_hash`]), so that even an input
//! which the game ignores is bound. To prove authorship, sign the file's bytes.
//!
//! # How little is believed
//!
//! [`Limits`] are checked before anything is allocated or stepped. A file is scanned to its end (lengths,
//! checksums, chain, run lengths) before the game is even started, so that a damaged one costs no simulation.

mod bytes;
mod flaw;
mod format;
mod header;
mod limits;
mod playback;
mod reader;
mod recorder;
mod recording;
mod rerun;
mod runs;
mod tick_inputs;
mod timeline;
mod verdict;

pub use flaw::Flaw;
pub use format::{
    CLAIM_NAME_BYTES_MAX, CLAIMS_MAX, FORMAT_VERSION, MAGIC, PLAYERS_MAX, RULES_NAME_BYTES_MAX,
    checkpoint_hash,
};
pub use header::Header;
pub use limits::{Limit, Limits};
pub use playback::{Playback, Step, verify};
pub use reader::{InputBlock, Part, ReadError, Reader, Trailer};
pub use recorder::{CHECKPOINT_INTERVAL, RecordError, Recorder};
pub use recording::Recording;
pub use rerun::Rerun;
pub use runs::{Run, Runs};
pub use tick_inputs::TickInputs;
pub use timeline::{
    KEYFRAMES_BYTES_MAX, KEYFRAMES_FORMAT_VERSION, KEYFRAMES_MAGIC, KeyframesError, KeyframesFlaw, SeekError,
    Timeline, TimelineOptions,
};
pub use verdict::{ClaimDifference, Mismatch, Verdict};
