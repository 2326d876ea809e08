//! Names of bodies in reports.

use alloc::format;
use alloc::string::String;
use core::fmt;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::arena::BodyId;
use super::error::WorldError;

/// Largest length of a name in bytes.
const LENGTH_MAX: usize = 16;

/// Name of a body: 1 to 16 ASCII letters, digits, `-` and `_`. Reports show it after the handle, as in `13v0 ball`. The
/// name is part of the state, so that reports from all machines contain it. Names need not be unique.
///
/// ```
/// use lockstep2d::{body::{BodyDef, Name}, world::World};
/// let mut world = World::default();
/// let ball = world.spawn(&BodyDef::fixed().name(Name::new("ball")?), &[])?;
/// assert_eq!(world.body_label(ball), "0v0 ball");
/// assert!(Name::new("two words").is_err());
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Name {
    /// Padded with zeros.
    bytes: [u8; LENGTH_MAX],
}

pub(crate) fn label(id: BodyId, name: Option<Name>) -> String {
    name.map_or_else(|| format!("{id}"), |name| format!("{id} {name}"))
}

impl Name {
    /// Creates a name.
    ///
    /// # Errors
    /// [`WorldError::NameInvalid`] if the text is not 1 to 16 allowed characters.
    pub fn new(text: &str) -> Result<Self, WorldError> {
        let mut bytes = [0; LENGTH_MAX];
        let room = bytes.get_mut(..text.len()).ok_or(WorldError::NameInvalid)?;
        room.copy_from_slice(text.as_bytes());
        let name = Name { bytes };
        name.validate()?;
        // A zero byte at the end of the text would look like padding.
        if name.as_str() == text { Ok(name) } else { Err(WorldError::NameInvalid) }
    }

    /// The name as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let length = self.bytes.iter().position(|&byte| byte == 0).unwrap_or(LENGTH_MAX);
        core::str::from_utf8(&self.bytes[..length]).unwrap_or_default()
    }

    /// Checks the bytes, which may have been decoded from an untrusted file.
    pub(crate) fn validate(&self) -> Result<(), WorldError> {
        let text = self.as_str().as_bytes();
        let is_allowed = |byte: &u8| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_');
        let is_padded = self.bytes[text.len()..].iter().all(|&byte| byte == 0);
        let valid = !text.is_empty() && text.iter().all(is_allowed) && is_padded;
        if valid { Ok(()) } else { Err(WorldError::NameInvalid) }
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl fmt::Debug for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}

/// A name is text in human-readable formats, and 16 bytes in binary formats.
impl Serialize for Name {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if serializer.is_human_readable() {
            serializer.serialize_str(self.as_str())
        } else {
            self.bytes.serialize(serializer)
        }
    }
}

impl<'de> Deserialize<'de> for Name {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if deserializer.is_human_readable() {
            let text = String::deserialize(deserializer)?;
            Name::new(&text).map_err(D::Error::custom)
        } else {
            Ok(Name { bytes: Deserialize::deserialize(deserializer)? })
        }
    }
}
