//! One-way shapes: whether what touches one passes through it.
//!
//! With `p` the direction into which things may pass, `m` the normal of the contact from the one-way shape to the other
//! and `s` the separation of the two along `p`, the other one
//!
//! ```text
//! goes on passing    if it was passing, overlaps, and s < -slack
//! else is stopped    if m.p >= 1/2: it is on the side that `p` points to
//! else passes
//! ```
//!
//! So a decision is sticky while it matters: what turns round half-way falls back, and what has come through is held
//! as soon as it is out, but for a slack that lets things slide from one platform to the next.

use super::manifold::Manifold;
use super::pose::{Outline, PosedShape};
use crate::math::{Fx, Unit, Vec2, widen};

/// A shape with the direction into which things may pass through it, in world axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OneWay<'a> {
    pub(crate) shape: &'a PosedShape,
    pub(crate) direction: Vec2<Unit>,
}

impl OneWay<'_> {
    /// Whether `other` passes. The manifold's normal points from the one-way shape to it.
    pub(crate) fn lets_pass(
        &self,
        other: &PosedShape,
        manifold: &Manifold,
        was_passing: bool,
        slack: Fx,
    ) -> bool {
        let points = manifold.points();
        if points.is_empty() {
            return false;
        }
        let overlaps = points.iter().any(|point| point.separation <= 0);
        if was_passing && overlaps && self.separation_from(other) < -slack {
            return true;
        }
        let upright: Unit = manifold.normal.dot(self.direction);
        upright < Unit::lit("0.5")
    }

    /// How far the other shape is above this one in the direction: negative while it is not all through.
    fn separation_from(&self, other: &PosedShape) -> Fx {
        let direction = self.direction.widen();
        let between = (other.centre - self.shape.centre).dot(direction);
        between
            .saturating_sub(reach(&other.outline, -direction))
            .saturating_sub(reach(&self.shape.outline, direction))
    }
}

/// How far an outline reaches from its centre in a direction.
fn reach(outline: &Outline, direction: Vec2<Fx>) -> Fx {
    match outline {
        Outline::Circle { radius } => widen(*radius),
        Outline::Segment { a, b } => a.dot(direction).max(b.dot(direction)),
        Outline::Link(link) => link.a.dot(direction).max(link.b.dot(direction)),
        Outline::Polygon(hull) => {
            let furthest = hull.vertices().iter().map(|vertex| vertex.widen().dot(direction)).max();
            furthest.unwrap_or(Fx::ZERO).saturating_add(widen(hull.radius))
        }
    }
}
