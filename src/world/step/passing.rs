//! Shapes that pass through a one-way platform of several shapes, such as the links of a chain.
//!
//! Each contact records whether its shapes pass through each other. A shape that leaves one link half-way would be caught
//! by the next one, whose contact begins with a deep overlap. It therefore passes through all shapes of the platform's
//! body with which its contacts begin.

use alloc::vec::Vec;

use crate::collision::{Contact, Pair};
use crate::world::cache::{MotionCache, Passing};

/// Replaces `passing` by the shapes that pass through one-way shapes, sorted.
pub(super) fn find(contacts: &[Contact], motion: &MotionCache, passing: &mut Vec<Passing>) {
    passing.clear();
    if !motion.may_have_one_way() {
        return;
    }
    for contact in contacts.iter().filter(|contact| contact.passing) {
        passing.extend(each_side(contact.shapes, motion));
    }
    passing.sort_unstable();
}

/// Whether one of two shapes passes through another one-way shape of the other one's body.
pub(super) fn is_beside(passing: &[Passing], pair: Pair, motion: &MotionCache) -> bool {
    !passing.is_empty() && each_side(pair, motion).any(|side| passing.binary_search(&side).is_ok())
}

fn each_side((a, b): Pair, motion: &MotionCache) -> impl Iterator<Item = Passing> {
    let side = |platform: u32, shape: u32| {
        let platform = motion.shape(platform);
        platform.one_way.then_some(Passing { platform: platform.body, shape })
    };
    [side(a, b), side(b, a)].into_iter().flatten()
}
