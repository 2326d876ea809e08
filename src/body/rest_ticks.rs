//! Counter of ticks at rest.

use serde::{Deserialize, Serialize};

/// Ticks for which a body has been at rest, depending on its kind:
///
/// | kind | value |
/// |---|---|
/// | fixed | 0 |
/// | kinematic | 1 after a tick at rest, until the body moves or an edit wakes it; otherwise 0 |
/// | dynamic | ticks in which the body was slow enough to sleep, since the last reset; at most [`ticks_to_sleep`] |
///
/// [`ticks_to_sleep`]: crate::world::Config::ticks_to_sleep
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct RestTicks(u32);

impl RestTicks {
    pub(crate) const NONE: Self = RestTicks(0);

    pub(crate) const fn to_bits(self) -> u32 {
        self.0
    }

    pub(crate) const fn from_bits(bits: u32) -> Self {
        RestTicks(bits)
    }

    pub(crate) fn reset(&mut self) {
        self.0 = 0;
    }

    /// Counts a tick in which a dynamic body was slow.
    pub(crate) fn count(&mut self, limit: u32) {
        self.0 = self.0.saturating_add(1).min(limit);
    }

    /// Whether a dynamic body has been slow for `limit` ticks.
    pub(crate) const fn has_reached(self, limit: u32) -> bool {
        self.0 == limit
    }

    /// Records a tick in which a kinematic body was at rest.
    pub(crate) fn settle(&mut self) {
        self.0 = 1;
    }

    /// Whether a kinematic body has been at rest for a tick.
    pub(crate) const fn has_settled(self) -> bool {
        self.0 != 0
    }
}
