//! Which events a shape takes part in.

use serde::{Deserialize, Serialize};

/// Which events a shape takes part in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct EventSwitches {
    /// Beginning and end of contacts; of a pair of shapes, either one's is enough.
    pub contact: bool,
    /// Hits: contacts that push after an approach faster than [`crate::world::Config::hit_speed`]; of a pair, either
    /// one's is enough.
    pub hit: bool,
    /// Being noticed by sensors.
    pub sensor: bool,
}

impl Default for EventSwitches {
    /// All but hits.
    fn default() -> Self {
        EventSwitches { contact: true, hit: false, sensor: true }
    }
}
