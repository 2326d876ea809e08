//! Shapes that are solid from one side: which of them let a character pass.
//!
//! A character passes if it comes from the open side, or if it has been passing and still overlaps the shape. The
//! character's state lists the shapes that it overlaps at the end of a move. A shape that overlaps the character in the
//! next move and is not in the list has moved over the character in the meantime, and pushes it out.

use alloc::vec::Vec;

use super::QueryFilter;
use super::character::MoverState;
use super::walk::Walk;
use crate::body::{Geometry, Shape, ShapeId, Sides};
use crate::collision::{SupportShape, distance, is_open, pass_direction};
use crate::math::{Fx, Unit, Vec2};

impl Walk<'_> {
    /// Whether the character passes through a shape, given the normal of the shape's surface, and the separation in
    /// metres, which is negative if the two overlap.
    pub(super) fn passes(&self, id: ShapeId, normal: Vec2<Unit>, separation: Fx) -> bool {
        let Some(shape) = self.world.shape(id) else { return true };
        let is_open = || self.open_direction(shape).is_some_and(|direction| is_open(direction, normal));
        // Queries do not find links from their open side. But a character that passes through a chain meets the end of
        // the next link, and has to pass through that link too.
        let goes_on = || self.was_passing(id) && (self.is_deep(separation) || is_open());
        shape.one_way().is_some() && is_open() || is_solid_from_one_side(shape) && goes_on()
    }

    /// Direction in world axes in which a shape lets others pass. `None` if it is solid from all sides.
    fn open_direction(&self, shape: &Shape) -> Option<Vec2<Unit>> {
        let body = self.world.body(shape.body())?;
        match (shape.one_way(), shape.geometry()) {
            (Some(angle), _) => Some(pass_direction(body.angle() + angle)),
            (None, Geometry::Link { a, b, sides: Sides::Right, .. }) => {
                Some(body.rotation().apply(-(*b - *a).normalized()?.perp()))
            }
            _ => None,
        }
    }

    /// Whether the character was passing through a shape at the end of the last move. If the list is full, it may lack
    /// shapes, so the result is `true` for every shape.
    fn was_passing(&self, id: ShapeId) -> bool {
        let listed = &self.from.passing;
        listed.iter().all(Option::is_some) || listed.iter().flatten().any(|&other| self.is_one(id, other))
    }

    /// Whether two shapes are one obstacle: the same shape, or one-sided links of one body. A character that passes
    /// through one link of a chain also meets the end of the next link, and must pass through that link too.
    fn is_one(&self, a: ShapeId, b: ShapeId) -> bool {
        let link_of = |id| self.world.shape(id).filter(|&shape| is_one_sided(shape)).map(Shape::body);
        a == b || link_of(a).is_some() && link_of(a) == link_of(b)
    }

    /// Whether an overlap exceeds the slack: a character that has just come onto ground may overlap it by less. The
    /// slack has the same purpose as in [`OneWay`].
    ///
    /// [`OneWay`]: crate::collision::OneWay
    fn is_deep(&self, separation: Fx) -> bool {
        separation < -self.world.state.config.touching_distance()
    }

    /// The shapes solid from one side that the character overlaps by more than the slack, in slot order. Ignores the
    /// mask of the filter, because a game may leave a platform out of it for some ticks to let the character drop
    /// through.
    pub(super) fn passing(&self) -> [Option<ShapeId>; MoverState::PASSING_MAX] {
        let (posed, origin) = (self.probe.posed(), self.probe.position());
        let own = SupportShape::of(&posed, origin);
        let mut found = Vec::new();
        let filter = QueryFilter { mask: u64::MAX, ..self.filter };
        self.world.each_overlapping(posed.bounds, filter, |id, other| {
            if self.world.shape(id).is_some_and(is_solid_from_one_side)
                && self.is_deep(distance(&SupportShape::of(other, origin), &own).distance)
            {
                found.push(id);
            }
        });
        // The broad phase finds shapes in no defined order.
        found.sort_unstable();
        let mut listed = [None; MoverState::PASSING_MAX];
        for id in found {
            let Some(free) = listed.iter().position(Option::is_none) else { break };
            if !listed.iter().flatten().any(|&before| self.is_one(id, before)) {
                listed[free] = Some(id);
            }
        }
        listed
    }
}

fn is_one_sided(shape: &Shape) -> bool {
    matches!(shape.geometry(), Geometry::Link { sides: Sides::Right, .. })
}

fn is_solid_from_one_side(shape: &Shape) -> bool {
    shape.one_way().is_some() || is_one_sided(shape)
}
