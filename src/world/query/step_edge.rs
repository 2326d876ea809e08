use super::character::SLOPE_ROUNDING;
use super::mover_planes::MoverPlane;
use super::walk::Walk;
use crate::collision::SKIN;
use crate::fx;
use crate::math::{Fx, Vec2};

/// There must be ground at this distance in metres behind the edge of a step.
const STEP_DEPTH: Fx = fx!(0.02);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Surface {
    Ground,
    /// The edge of a step, which the character slides up.
    Step,
    /// A slope that is too steep to stand on.
    Steep,
    /// A wall or a ceiling.
    Wall,
}

impl Walk<'_> {
    pub(super) fn surface(&self, plane: &MoverPlane) -> Surface {
        if self.mover.is_ground(plane.normal) {
            Surface::Ground
        } else if self.on_ground && self.is_step(plane) {
            Surface::Step
        } else if plane.normal.y > 0 {
            Surface::Steep
        } else {
            Surface::Wall
        }
    }

    /// Whether there is ground just behind a surface, at most the step height above the feet, with room to stand on it.
    fn is_step(&self, plane: &MoverPlane) -> bool {
        let Vec2 { x, y } = plane.normal;
        // A ceiling, whose normal points down, is no step. Rounding may tilt the normal of a wall slightly downwards.
        if y < -SLOPE_ROUNDING || x == 0 || self.mover.step_max() == Fx::ZERO {
            return false;
        }
        let bounds = self.probe.posed().bounds;
        let feet = bounds.lower.y;
        let onwards = if x < 0 { STEP_DEPTH } else { -STEP_DEPTH };
        let top = feet.saturating_add(self.mover.step_max());
        let above = Vec2::new(plane.point.x.saturating_add(onwards), top);
        let here = Vec2::new(bounds.centre().x, top);
        if self.world.cast_ray_any(here, above - here, self.filter) {
            return false;
        }
        // A character that is just leaving an edge may have its feet above the edge by the distance that casts keep.
        let down = Vec2::new(Fx::ZERO, -(SKIN + SKIN) - self.mover.step_max());
        let found = self.world.cast_ray(above, down, self.filter);
        // Ground far below the touched point may be the floor under a table.
        let is_edge = |ground: Vec2<Fx>| plane.point.y <= ground.y.saturating_add(STEP_DEPTH);
        found.is_some_and(|hit| {
            self.mover.is_ground(hit.normal)
                && is_edge(hit.point)
                && self.has_room(hit.point.y - feet, onwards)
        })
    }

    /// Whether the character can rise by a height and then move onwards without meeting anything but ground.
    fn has_room(&self, height: Fx, onwards: Fx) -> bool {
        let up = Vec2::new(Fx::ZERO, height.saturating_add(SKIN + SKIN).max(Fx::ZERO));
        if self.cast_from(&self.probe, up).is_some() {
            return false;
        }
        let raised = self.probe.at(self.probe.position() + up);
        let met = self.cast_from(&raised, Vec2::new(onwards, Fx::ZERO));
        met.is_none_or(|(_, plane)| self.mover.is_ground(plane.normal))
    }
}
