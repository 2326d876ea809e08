//! Contacts: the state of a pair of shapes that persists from tick to tick.

use serde::{Deserialize, Serialize};

use super::manifold::Feature;
#[cfg(doc)]
use crate::math::Length;
use crate::math::Speed;

/// A pair of shape slots, the smaller one first.
pub(crate) type Pair = (u32, u32);

/// A pair of shapes whose fat AABBs overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Contact {
    /// Shape slots, the smaller first. Contacts are sorted by this key.
    pub(crate) shapes: Pair,
    /// Whether the shapes touch, as last reported by the contact events.
    pub(crate) touching: bool,
    /// Whether one shape is a one-way platform that lets the other pass: see `one_way.rs`.
    pub(crate) passing: bool,
    /// Number of points with accumulated impulses.
    pub(crate) count: u8,
    pub(crate) points: [PointImpulse; 2],
    /// Lever arms of the points, which are kept from tick to tick.
    pub(crate) arms: KeptArms,
    /// Accumulated angular impulse of rolling resistance, times `(mA + mB) / s`: see `solver/contact/rolling.rs`.
    pub(crate) rolling: Speed,
}

/// Accumulated impulse of a contact point, for the warm start of the next tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct PointImpulse {
    pub(crate) feature: u16,
    /// Normal impulse times `mA + mB`: `p = L / D` of `solver/row.rs`. It does not depend on the lever arms.
    pub(crate) normal: Speed,
    /// Tangent impulse with the same scale: this point's share of the total friction of both points.
    pub(crate) tangent: Speed,
}

/// The lever arms of a contact, in world axes: the vectors from A's centre of mass to both points, and the vector from
/// B's centre of mass to A's. Each coordinate is in units of 2^-17 m, of which the low 16 bits are stored as a signed
/// number. A vector is stored as `x + 2^16 y`.
///
/// The arms are kept while the shapes hardly move relative to each other. With arms that follow every movement, a stack
/// that leans would turn itself further: columns of more than 40 boxes fall. With kept arms, columns of 100 boxes stand
/// (`docs/DESIGN.md`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct KeptArms(pub(crate) [i32; 3]);

impl Contact {
    pub(crate) fn new(shapes: Pair) -> Self {
        Contact {
            shapes,
            touching: false,
            passing: false,
            count: 0,
            points: [PointImpulse::default(); 2],
            arms: KeptArms::default(),
            rolling: Speed::ZERO,
        }
    }

    /// Points with accumulated impulses.
    pub(crate) fn points(&self) -> &[PointImpulse] {
        &self.points[..usize::from(self.count.min(2))]
    }

    /// Accumulated impulse of a feature, if the feature was in contact in the last tick.
    #[inline]
    pub(crate) fn impulse_of(&self, feature: Feature) -> Option<PointImpulse> {
        match self.points {
            [first, _] if self.count > 0 && first.feature == feature.0 => Some(first),
            [_, second] if self.count > 1 && second.feature == feature.0 => Some(second),
            _ => None,
        }
    }

    /// Clears the accumulated impulses.
    #[inline]
    pub(crate) fn clear_points(&mut self) {
        self.count = 0;
        self.points = [PointImpulse::default(); 2];
        self.arms = KeptArms::default();
        self.rolling = Speed::ZERO;
    }

    /// Stores the accumulated impulses of up to two points.
    #[inline]
    pub(crate) fn store_impulses(&mut self, points: [PointImpulse; 2], count: u8, rolling: Speed) {
        (self.points, self.count, self.rolling) = (points, count, rolling);
    }
}
