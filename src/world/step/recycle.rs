//! Contact recycling: the movement up to which a contact keeps its manifold.

use crate::body::{Body, BodyKind};
use crate::collision::{Contact, KeptManifold, KeptSide, Manifold};
use crate::math::{Length, Vec2};
use crate::world::cache::{ClosingBound, Margins, Recycled, ShapeMotion};
use crate::world::state::State;

/// The shapes of a contact, and the limits within which it keeps its manifold and lever arms.
pub(super) struct Recycling<'a> {
    bodies: [&'a Body; 2],
    shapes: [&'a ShapeMotion; 2],
    extents: [Length; 2],
    /// Whether a round shape may roll: one of the bodies is not dynamic or turns.
    rolls: bool,
    /// Change of a lever arm, in metres, up to which the contact keeps the arm.
    arm_tolerance: Length,
    /// Movement of the shapes since their manifold was computed, in metres, up to which the contact keeps the manifold.
    /// Negative if the shapes move too fast.
    movement_max: Length,
}

impl<'a> Recycling<'a> {
    /// A lever arm is kept while it changes by at most a 64th of the smaller shape's extent. A manifold is kept while
    /// the relative movement, including that in this tick, is at most that 64th and at most a quarter of the
    /// speculative distance.
    ///
    /// If a round shape may roll, both limits are a 256th of that 64th. Otherwise an outdated normal would stop a slow
    /// ball at a seam between two blocks, and would let a roly-poly toy lean or swing ever higher. Between dynamic
    /// bodies that hardly turn the limits are not reduced, because plates on rollers are stable only if lever arms are
    /// kept.
    ///
    /// Nothing is kept on a kinematic body that turns, because lever arms that lag behind give the wrong velocity at
    /// the contact: on a body that turns at 1 rad/s, a crate of 4 m x 2 m would creep by 35 mm/s.
    #[inline]
    pub(super) fn new(
        state: &'a State,
        margins: &Margins,
        closing: ClosingBound,
        shapes: [&'a ShapeMotion; 2],
        count: u8,
    ) -> Self {
        let bodies = shapes.map(|shape| state.bodies.at(shape.body));
        let extents = shapes.map(ShapeMotion::extent);
        let is_round = count < 2 && (shapes[0].radius > 0 || shapes[1].radius > 0);
        let rolls = is_round && bodies.into_iter().any(|body| !body.is_dynamic() || body.is_turning());
        let is_rotor = |body: &Body| body.kind() == BodyKind::Kinematic && body.is_turning();
        let [a, b] = bodies;
        let arm_tolerance: Length = match a.turns_with(b) || is_rotor(a) || is_rotor(b) {
            true => Length::ZERO,
            false => extents[0].min(extents[1]) >> 6,
        };
        let most = if rolls { arm_tolerance >> 8 } else { arm_tolerance.min(margins.kept) };
        Recycling { bodies, shapes, extents, rolls, arm_tolerance, movement_max: closing.rest_of(most) }
    }

    /// The kept manifold at the current poses. `None` if the shapes have to be collided.
    #[inline]
    pub(super) fn recycle(&self, contact: &Contact) -> Option<Recycled> {
        let [a, b] = self.shapes;
        if self.movement_max <= 0 || a.one_way || b.one_way {
            return None;
        }
        let side = |side: usize| KeptSide {
            pose: self.bodies[side].pose(),
            reach: if self.shapes[side].disc { Length::ZERO } else { self.extents[side] },
        };
        let kept = &contact.kept;
        let separations = kept.separations_at([side(0), side(1)], contact.count, self.movement_max)?;
        // Computes the origin from a dynamic body, because the lever arm of a fixed body may be out of range.
        let [a, b] = self.bodies;
        let (centre, arm) = if b.is_dynamic() { (b.centre, kept.arm_b) } else { (a.centre, kept.arm_a) };
        Some(Recycled { origin: centre.wrapping_add(arm.widen()), separations })
    }

    #[inline]
    pub(super) fn keep(&self, contact: &mut Contact, manifold: &Manifold) {
        let tolerance = |shape: &ShapeMotion| match shape.disc || self.rolls {
            // The lever arm of a circle follows from the normal, so it is kept up to the same movement as the manifold.
            true => self.movement_max.max(Length::ZERO),
            false => self.arm_tolerance,
        };
        contact.keep(manifold, self.bodies, self.shapes.map(tolerance));
    }

    /// Keeps a manifold at the time of impact. `moved` has the displacements of the bodies from the start of the tick
    /// until then.
    pub(super) fn keep_impact(&self, contact: &mut Contact, manifold: &Manifold, moved: [Vec2<Length>; 2]) {
        contact.kept = KeptManifold::at_impact(manifold, self.bodies.map(Body::pose), moved);
    }
}
