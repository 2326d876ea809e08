//! Encoding of keyframes in a file beside a replay. `docs/FORMAT.md` gives the layout.

use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

use serde::de::Visitor;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::keyframes::{Keyframe, Keyframes};
use crate::codec::DecodeError;
use crate::hash::{Envelope, EnvelopeError, StateHash};
use crate::lockstep::Game;

/// The first eight bytes of a file of keyframes.
pub const KEYFRAMES_MAGIC: [u8; 8] = *b"\x89L2K\r\n\x1a\n";

/// Version of the layout.
pub const KEYFRAMES_FORMAT_VERSION: u32 = 1;

/// Maximum size of all keyframes together, in bytes. It keeps the file of keyframes below
/// [`DECODE_BYTES_MAX`](crate::codec::DECODE_BYTES_MAX).
pub const KEYFRAMES_BYTES_MAX: usize = 192 << 20;

const ENVELOPE: Envelope = Envelope { magic: KEYFRAMES_MAGIC, format: KEYFRAMES_FORMAT_VERSION };

/// Reason why bytes are not keyframes of this replay.
///
/// ```
/// # use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::replay::{KeyframesError, Limits, Recording, Timeline, TimelineOptions};
/// # let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60).expect("a setup");
/// # (0..90).for_each(|_| recording.step(&[vec![]]).expect("one input"));
/// # let file = recording.finish().expect("no claims");
/// let mut timeline = Timeline::<Sandbox>::open(&file, &TimelineOptions::default(), &Limits::default())?;
/// // Keyframes only save time. Without them, the replay is simulated.
/// assert_eq!(timeline.use_keyframes(b"something else"), Err(KeyframesError::NotKeyframes));
/// assert!(timeline.seek(90).is_ok());
/// # Ok::<(), lockstep2d::replay::Verdict>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum KeyframesError {
    /// The bytes do not start with [`KEYFRAMES_MAGIC`], or are too short.
    NotKeyframes,
    /// The layout has another version.
    Format {
        /// The version found.
        found: u32,
    },
    /// An engine with other semantics made the keyframes.
    Semantics {
        /// The semantics found.
        found: u32,
    },
    /// The keyframes belong to another game, or to another version of its rules.
    Rules {
        /// The name found.
        name: String,
        /// The version found.
        version: u32,
    },
    /// The keyframes belong to another replay, or the bytes of the replay have changed.
    OtherReplay,
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
    Invalid(KeyframesFlaw),
}

/// Flaw in keyframes that decode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyframesFlaw {
    /// The interval is zero.
    Interval,
    /// The ticks are not strictly ascending multiples of the interval, from 1 to the end of the replay.
    Ticks,
    /// The replay has no checkpoint at one of the ticks.
    Checkpoint,
}

impl fmt::Display for KeyframesFlaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            KeyframesFlaw::Interval => "an interval of zero",
            KeyframesFlaw::Ticks => "the ticks are not ascending multiples of the interval within the replay",
            KeyframesFlaw::Checkpoint => "a keyframe at a tick without a checkpoint in the replay",
        })
    }
}

impl fmt::Display for KeyframesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            KeyframesError::NotKeyframes => write!(f, "this is not a file of keyframes"),
            KeyframesError::Format { found } => {
                write!(f, "format version {found}, this engine reads {KEYFRAMES_FORMAT_VERSION}")
            }
            KeyframesError::Semantics { found } => {
                write!(f, "made with engine semantics {found}, this program has {}", crate::SEMANTICS)
            }
            KeyframesError::Rules { name, version } => {
                write!(
                    f,
                    "made with the rules {name:?} version {version}, which are not those of this program"
                )
            }
            KeyframesError::OtherReplay => write!(f, "the keyframes belong to another replay"),
            KeyframesError::Length { announced, found } => {
                write!(f, "{found} bytes where {announced} are announced")
            }
            KeyframesError::Hash => write!(f, "the hash does not match the bytes"),
            KeyframesError::Decode(error) => error.fmt(f),
            KeyframesError::Invalid(flaw) => flaw.fmt(f),
        }
    }
}

impl core::error::Error for KeyframesError {}

impl From<EnvelopeError> for KeyframesError {
    fn from(error: EnvelopeError) -> Self {
        match error {
            EnvelopeError::Magic => KeyframesError::NotKeyframes,
            EnvelopeError::Format { found } => KeyframesError::Format { found },
            EnvelopeError::Length { announced, found } => KeyframesError::Length { announced, found },
            EnvelopeError::Hash => KeyframesError::Hash,
            EnvelopeError::Decode(error) => KeyframesError::Decode(error),
        }
    }
}

#[derive(Serialize, Deserialize)]
pub(super) struct Body {
    rules_name: String,
    rules_version: u32,
    replay: StateHash,
    pub(super) interval: u64,
    saves: Vec<(u64, Save)>,
}

/// Canonical bytes of a save, encoded like a list of u8 but processed as one slice.
struct Save(Vec<u8>);

impl Serialize for Save {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_bytes(&self.0)
    }
}

impl<'de> Deserialize<'de> for Save {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_byte_buf(SaveBytes)
    }
}

struct SaveBytes;

impl Visitor<'_> for SaveBytes {
    type Value = Save;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the bytes of a save")
    }

    fn visit_bytes<E>(self, bytes: &[u8]) -> Result<Save, E> {
        Ok(Save(bytes.into()))
    }

    fn visit_byte_buf<E>(self, bytes: Vec<u8>) -> Result<Save, E> {
        Ok(Save(bytes))
    }
}

pub(super) fn encode<G: Game>(replay: &[u8], keyframes: &Keyframes<'_>) -> Vec<u8> {
    let at_checkpoints = keyframes.iter().filter(|frame| frame.position.inputs.finished_block().is_some());
    let body = Body {
        rules_name: G::RULES.name.into(),
        rules_version: G::RULES.version,
        replay: StateHash::of_bytes(replay),
        interval: keyframes.interval(),
        saves: at_checkpoints.map(|frame| (frame.position.tick, Save(frame.save.clone()))).collect(),
    };
    ENVELOPE.seal(crate::SEMANTICS, &body)
}

/// Decodes the body. Checks all of it except the saves, and whether their ticks have checkpoints in the replay.
pub(super) fn decode<G: Game>(replay: &[u8], bytes: &[u8]) -> Result<Body, KeyframesError> {
    let opened = ENVELOPE.open(bytes)?;
    if opened.semantics != crate::SEMANTICS {
        return Err(KeyframesError::Semantics { found: opened.semantics });
    }
    let body: Body = opened.decode()?;
    if (body.rules_name.as_str(), body.rules_version) != (G::RULES.name, G::RULES.version) {
        return Err(KeyframesError::Rules { name: body.rules_name, version: body.rules_version });
    }
    if body.replay != StateHash::of_bytes(replay) {
        return Err(KeyframesError::OtherReplay);
    }
    let ticks = body.saves.iter().map(|(tick, _)| *tick);
    let before = [0].into_iter().chain(ticks.clone());
    if body.interval == 0 {
        return Err(KeyframesError::Invalid(KeyframesFlaw::Interval));
    }
    if before.zip(ticks).any(|(before, tick)| before >= tick || tick % body.interval != 0) {
        return Err(KeyframesError::Invalid(KeyframesFlaw::Ticks));
    }
    Ok(body)
}

/// Inserts the saves of a file into `keyframes`. If they exceed the memory budget, `keyframes` doubles its interval and
/// removes some of them.
pub(super) fn place(body: Body, ticks: u64, keyframes: &mut Keyframes<'_>) -> Result<(), KeyframesError> {
    let mut position = keyframes.first().position.clone();
    for (tick, Save(save)) in body.saves {
        while position.tick < tick.min(ticks) && matches!(position.inputs.next_tick(), Ok(Some(_))) {
            position.tick += 1;
        }
        if position.tick != tick {
            return Err(KeyframesError::Invalid(KeyframesFlaw::Ticks));
        }
        if position.inputs.finished_block().is_none() {
            return Err(KeyframesError::Invalid(KeyframesFlaw::Checkpoint));
        }
        keyframes.insert(Keyframe { position: position.clone(), save });
    }
    Ok(())
}
