//! Cache key of the arrangement of joints. The arrangement rarely changes from tick to tick.

use alloc::vec::Vec;

use super::super::settings::Tuning;
use crate::simd::Machine;

/// Everything on which the arrangement of the joints (batches, colours and blocks) depends: which joints and bodies
/// take part, their definitions, the settings, and the threads.
#[derive(Clone, Debug, Default)]
pub(super) struct CacheKey {
    /// `None` before the first tick.
    definitions: Option<Definitions>,
    /// [`Arena::returns`](crate::body::Arena::returns) of the joints. It changes when impulses or angles are edited or
    /// restored.
    returns: u64,
    joints: Vec<u32>,
    bodies: Vec<u32>,
}

/// Parts of the last arrangement that are still valid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Validity {
    All,
    /// Everything except impulses and angles, which an edit or a restore has changed.
    Arrangement,
    Nothing,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Definitions {
    pub(super) revisions: [u64; 2],
    pub(super) tuning: Tuning,
    /// Number of threads that solve the joints.
    pub(super) parts: usize,
    pub(super) machine: Machine,
}

impl CacheKey {
    /// Replaces the key and returns what is still valid.
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
