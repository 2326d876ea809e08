//! Contacts: pairs of shapes that persist from tick to tick.

use serde::{Deserialize, Serialize};

use super::kept_manifold::KeptManifold;
use super::manifold::{Feature, Manifold, ManifoldPoint};
use crate::body::Body;
use crate::math::{Fx, Length, Speed, Step, Vec2};

/// A pair of shape slots, the smaller one first.
pub(crate) type Pair = (u32, u32);

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Contact {
    /// Shape slots, the smaller first. Contacts are sorted by this key.
    pub(crate) shapes: Pair,
    /// Whether the shapes touched in the last tick. If one of them is a sensor: whether they overlapped at the end of
    /// the last tick.
    pub(crate) touching: bool,
    /// Whether a one-way platform lets the other shape pass: see `one_way.rs`.
    pub(crate) passing: bool,
    /// Number of points with stored impulses.
    pub(crate) count: u8,
    pub(crate) points: [PointImpulse; 2],
    pub(crate) kept: KeptManifold,
    /// Accumulated angular impulse of rolling resistance, times `(mA + mB) / s` with the inverse masses `mA` and `mB`:
    /// see `solver/contact/rolling.rs` for the scale `s`.
    pub(crate) rolling: Speed,
}

/// Impulses of a contact point, for the warm start of the next tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct PointImpulse {
    pub(crate) feature: u16,
    /// Normal impulse times the sum of the inverse masses `mA + mB`: `p = L / D` of `solver/row.rs`.
    pub(crate) normal: Speed,
    /// Tangent impulse times `mA + mB`: this point's share of the friction impulse of both points.
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
            kept: KeptManifold::NONE,
            rolling: Speed::ZERO,
        }
    }

    pub(crate) fn points(&self) -> &[PointImpulse] {
        &self.points[..usize::from(self.count.min(2))]
    }

    #[inline]
    pub(crate) fn impulse_of(&self, feature: Feature) -> Option<PointImpulse> {
        match self.points {
            [first, _] if self.count > 0 && first.feature == feature.0 => Some(first),
            [_, second] if self.count > 1 && second.feature == feature.0 => Some(second),
            _ => None,
        }
    }

    #[inline]
    pub(crate) fn clear_points(&mut self) {
        self.count = 0;
        self.points = [PointImpulse::default(); 2];
        self.kept = KeptManifold::NONE;
        self.rolling = Speed::ZERO;
    }

    /// Stores a manifold for the next ticks. If the previous manifold has the same points and does not belong to a time
    /// of impact, small changes of the lever arms are ignored: a coordinate that changed by at most `tolerances` (in
    /// metres) keeps its previous value.
    #[inline]
    pub(crate) fn keep(&mut self, manifold: &Manifold, bodies: [&Body; 2], tolerances: [Length; 2]) {
        let last = self.kept;
        self.kept = KeptManifold::new(manifold, bodies.map(Body::pose));
        let features = self.points().iter().map(|point| point.feature);
        if last.can_be_kept() && features.eq(manifold.points().iter().map(|point| point.feature.0)) {
            self.kept.keep_arms_of(&last, tolerances);
        }
    }

    /// Kept manifold with the given separations, and with its first point at `origin`.
    #[inline]
    pub(crate) fn kept_manifold(&self, origin: Vec2<Fx>, separations: [Step; 2]) -> Manifold {
        let point = |i: usize, anchor: Vec2<Length>| ManifoldPoint {
            anchor,
            separation: separations[i],
            feature: Feature(self.points[i].feature),
        };
        let points = [point(0, Vec2::ZERO), point(1, self.kept.to_second)];
        Manifold::of_points(self.kept.normal, origin, points, self.count)
    }

    #[inline]
    pub(crate) fn store_impulses(&mut self, points: [PointImpulse; 2], count: u8, rolling: Speed) {
        (self.points, self.count, self.rolling) = (points, count, rolling);
    }
}
