//! Contacts: what is remembered of a pair of shapes from tick to tick.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::broad_phase::Pair;
use super::manifold::Feature;
use crate::math::Speed;

/// A pair of shapes whose fat boxes overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Contact {
    /// Shape slots, the smaller first. Contacts are sorted by them.
    pub(crate) shapes: Pair,
    /// Whether the shapes touch, as the events last said.
    pub(crate) touching: bool,
    /// Whether one of the shapes lets the other pass: see `one_way.rs`.
    pub(crate) passing: bool,
    /// How many points have impulses.
    pub(crate) count: u8,
    pub(crate) points: [PointImpulse; 2],
    /// The angular impulse against rolling, times `(mA + mB) / s`: see `solver/rolling.rs`.
    pub(crate) rolling: Speed,
}

/// The impulse of a contact point, to start the next tick from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct PointImpulse {
    pub(crate) feature: u16,
    /// `p = L / D`, the impulse times `mA + mB`: it does not depend on the lever arms.
    pub(crate) normal: Speed,
    /// The same along the tangent.
    pub(crate) tangent: Speed,
}

impl Contact {
    fn new(shapes: Pair) -> Self {
        Contact {
            shapes,
            touching: false,
            passing: false,
            count: 0,
            points: [PointImpulse::default(); 2],
            rolling: Speed::ZERO,
        }
    }

    /// The points that have impulses.
    pub(crate) fn points(&self) -> &[PointImpulse] {
        &self.points[..usize::from(self.count.min(2))]
    }

    /// The impulse carried over for a feature, if it was there in the last tick.
    pub(crate) fn impulse_of(&self, feature: Feature) -> Option<PointImpulse> {
        self.points().iter().copied().find(|point| point.feature == feature.0)
    }

    /// Forgets the impulses.
    pub(crate) fn clear_points(&mut self) {
        self.count = 0;
        self.points = [PointImpulse::default(); 2];
        self.rolling = Speed::ZERO;
    }

    /// Remembers the impulse of a point.
    pub(crate) fn push_point(&mut self, point: PointImpulse) {
        self.points[usize::from(self.count)] = point;
        self.count += 1;
    }
}

/// Brings the contacts in line with the pairs of this tick, both sorted. New pairs get a contact without impulses;
/// contacts whose pair is gone are moved to `ended`. `sources` says for each contact where it was before,
/// `u32::MAX` for a new one.
pub(crate) fn match_pairs(
    contacts: &mut Vec<Contact>,
    pairs: &[Pair],
    merged: &mut Vec<Contact>,
    sources: &mut Vec<u32>,
    ended: &mut Vec<Contact>,
) {
    merged.clear();
    sources.clear();
    let mut old = contacts.iter().copied().zip(0u32..).peekable();
    for &pair in pairs {
        while let Some((gone, _)) = old.next_if(|(contact, _)| contact.shapes < pair) {
            ended.push(gone);
        }
        let same = old.next_if(|(contact, _)| contact.shapes == pair);
        let (contact, source) = same.unwrap_or((Contact::new(pair), u32::MAX));
        merged.push(contact);
        sources.push(source);
    }
    ended.extend(old.map(|(gone, _)| gone));
    core::mem::swap(contacts, merged);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_that_stay_keep_their_impulses() {
        let mut kept = Contact::new((1, 2));
        kept.push_point(PointImpulse { feature: 3, normal: Speed::ONE, tangent: Speed::ZERO });
        let mut contacts = alloc::vec![Contact::new((0, 5)), kept, Contact::new((2, 3))];
        let (mut merged, mut sources, mut ended) = (Vec::new(), Vec::new(), Vec::new());
        match_pairs(&mut contacts, &[(0, 1), (1, 2), (4, 9)], &mut merged, &mut sources, &mut ended);
        assert_eq!(sources, [u32::MAX, 1, u32::MAX]);
        assert_eq!(contacts, [Contact::new((0, 1)), kept, Contact::new((4, 9))]);
        assert_eq!(ended, [Contact::new((0, 5)), Contact::new((2, 3))]);
    }
}
