//! Contacts: what is remembered of a pair of shapes from tick to tick.

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
    /// The same along the tangent: its share of what both points have in common.
    pub(crate) tangent: Speed,
}

impl Contact {
    pub(crate) fn new(shapes: Pair) -> Self {
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
    #[inline]
    pub(crate) fn impulse_of(&self, feature: Feature) -> Option<PointImpulse> {
        match self.points {
            [first, _] if self.count > 0 && first.feature == feature.0 => Some(first),
            [_, second] if self.count > 1 && second.feature == feature.0 => Some(second),
            _ => None,
        }
    }

    /// Forgets the impulses.
    #[inline]
    pub(crate) fn clear_points(&mut self) {
        self.count = 0;
        self.points = [PointImpulse::default(); 2];
        self.rolling = Speed::ZERO;
    }

    /// Remembers the impulses of one point or two.
    #[inline]
    pub(crate) fn remember(&mut self, points: [PointImpulse; 2], count: u8, rolling: Speed) {
        (self.points, self.count, self.rolling) = (points, count, rolling);
    }
}
