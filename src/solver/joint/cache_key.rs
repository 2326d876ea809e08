//! Cache key of the arrangement of joints for the solver. In most ticks the key is the same as in the last tick.

use alloc::vec::Vec;

use super::super::settings::Tuning;
use crate::simd::Machine;

/// Everything that the arrangement of joints depends on. The arrangement is the order in which joints are solved, the
/// kind of constraint of each joint, and the masses.
#[derive(Clone, Debug, Default)]
pub(super) struct CacheKey {
    /// `None` before the first tick.
    definitions: Option<Definitions>,
    /// Number of times that joints have been restored.
    returns: u64,
    /// The slots of the joints of the tick.
    joints: Vec<u32>,
    /// The slots of the bodies of the tick.
    bodies: Vec<u32>,
}

/// The parts of the last arrangement that are still valid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Validity {
    /// The whole arrangement.
    All,
    /// The arrangement except impulses and angles, which have been restored.
    Arrangement,
    Nothing,
}

/// The revisions of joints and bodies, the settings, the number of threads and the backend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Definitions {
    /// The revisions of joints and of bodies.
    pub(super) revisions: [u64; 2],
    pub(super) tuning: Tuning,
    /// Number of threads that solve the joints.
    pub(super) parts: usize,
    pub(super) machine: Machine,
}

impl CacheKey {
    /// Replaces the key by that of a new tick. Returns the parts of the arrangement that are still valid.
    pub(super) fn renew(
        &mut self,
        definitions: Definitions,
        returns: u64,
        joints: &[u32],
        bodies: &[u32],
    ) -> Validity {
        let returned = core::mem::replace(&mut self.returns, returns) != returns;
        let same = self.definitions == Some(definitions) && self.joints == joints && self.bodies == bodies;
        if !same {
            self.definitions = Some(definitions);
            self.joints.clear();
            self.joints.extend_from_slice(joints);
            self.bodies.clear();
            self.bodies.extend_from_slice(bodies);
        }
        match (same, returned) {
            (true, false) => Validity::All,
            (true, true) => Validity::Arrangement,
            (false, _) => Validity::Nothing,
        }
    }
}
