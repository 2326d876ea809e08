//! One-way platforms.
//!
//! Let `p` be the pass direction, `m` the contact normal from the platform to the other shape, and `s` the separation
//! of the two shapes along `p`. The other shape
//!
//! ```text
//! continues to pass  if it was passing, overlaps, and s < -slack
//! else is stopped    if m.p >= 1/2: it is on the side that `p` points to
//! else passes
//! ```
//!
//! A shape that turns round half-way falls back through the platform. A shape that has passed is supported as soon as
//! it is out of the platform. Without the slack, a platform might let through a shape that slides onto it from another
//! platform with a small overlap.

use crate::collision::manifold::Manifold;
use crate::collision::shape::posed::{Outline, PosedShape};
use crate::math::{Angle, Fx, Rot, Unit, Vec2, widen};

/// A one-way platform and its pass direction in world axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OneWay<'a> {
    pub(crate) shape: &'a PosedShape,
    pub(crate) direction: Vec2<Unit>,
}

/// The direction in which other shapes pass, in world axes. `angle` is its angle in the world.
pub(crate) fn pass_direction(angle: Angle) -> Vec2<Unit> {
    Rot::from_angle(angle).apply(Vec2::X)
}

/// Whether a platform lets a touching shape pass. The contact normal points from the platform to the shape.
pub(crate) fn is_open(pass_direction: Vec2<Unit>, normal: Vec2<Unit>) -> bool {
    let upright: Unit = normal.dot(pass_direction);
    upright < Unit::lit("0.5")
}

impl OneWay<'_> {
    /// Whether the platform lets `other` pass. The manifold's normal points to `other`.
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
        is_open(self.direction, manifold.normal)
    }

    /// Separation of the shapes along the pass direction, in metres. Negative until the other shape has passed
    /// completely.
    fn separation_from(&self, other: &PosedShape) -> Fx {
        let direction = self.direction.widen();
        let between = (other.centre - self.shape.centre).dot(direction);
        between
            .saturating_sub(reach(&other.outline, -direction))
            .saturating_sub(reach(&self.shape.outline, direction))
    }
}

/// Extent of an outline from its centre along a direction.
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
