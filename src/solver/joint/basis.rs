//! What the arrangement of joints for the solver depends on, and how much of the last one still holds.

use alloc::vec::Vec;

use super::super::settings::Tuning;

/// All that it depends on what is solved as what, in which order and with which masses: mostly it is the same from tick
/// to tick.
#[derive(Clone, Debug, Default)]
pub(super) struct Basis {
    /// `None` if nothing is known.
    definitions: Option<Definitions>,
    /// How often joints had returned to what they were.
    returns: u64,
    /// The slots of the joints and of the bodies that something moves.
    joints: Vec<u32>,
    bodies: Vec<u32>,
}

/// What is known of the joints of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Known {
    /// Everything is as the last tick has left it.
    All,
    /// But for impulses and turns, which have been restored.
    Arrangement,
    Nothing,
}

/// The revisions of joints and bodies, and the settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Definitions {
    pub(super) joints: u64,
    pub(super) bodies: u64,
    pub(super) tuning: Tuning,
}

impl Basis {
    /// Takes another one. Says what is still true.
    pub(super) fn renew(
        &mut self,
        definitions: Definitions,
        returns: u64,
        joints: &[u32],
        bodies: &[u32],
    ) -> Known {
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
            (true, false) => Known::All,
            (true, true) => Known::Arrangement,
            (false, _) => Known::Nothing,
        }
    }
}
