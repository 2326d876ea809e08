//! Bodies and shapes as the pairs of a tick see them: where they are, and how far they may come.
//!
//! What the pairs of a tick ask of each body and shape is worked out once and kept side by side: most pairs are too far
//! apart to meet, and are seen to be so without a look at bodies, shapes or outlines.

use alloc::vec::Vec;

use crate::body::{Body, Geometry, Handle, Shape};
use crate::collision::{PosedShape, arm_of};
use crate::fx;
use crate::lanes::prefetch;
use crate::math::{Aabb, Fx, Length, Reciprocal, Speed, Step, Vec2, fx_mul, narrow, saturate, widen};
use fixed::FixedI32;
use fixed::types::extra::{U16, U24};

/// A way within a tick in metres: ±128, resolution 6e-8.
pub(super) type Way = FixedI32<U24>;

/// How a body moves in a tick, at its velocity at the start.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Motion {
    /// Centre of mass.
    pub(super) centre: Vec2<Fx>,
    /// How far that moves: at most 52 m.
    pub(super) shift: Vec2<Way>,
    /// By how much the body turns, in radians.
    pub(super) turn: Way,
}

impl Motion {
    #[inline]
    pub(super) fn of(body: &Body, per_second: Reciprocal) -> Self {
        let step = |speed: Speed| per_second.times(speed);
        let shift = Vec2::new(step(body.velocity.x), step(body.velocity.y));
        let omega = |spin| -> FixedI32<U16> { body.mass.inverse_gyration.times(spin) };
        let turn = if body.spin == 0 { Way::ZERO } else { per_second.times(omega(body.spin)) };
        Motion { centre: body.centre, shift, turn }
    }

    /// How far the point of the body that is at a world point moves.
    pub(super) fn shift_at(&self, point: Vec2<Fx>) -> Vec2<Way> {
        if self.turn == 0 {
            return self.shift;
        }
        let arm: Vec2<Length> = (point - self.centre).narrow();
        self.shift + arm.perp().scale(self.turn)
    }

    /// By how much the body turns, in radians, without sign.
    pub(super) fn turned(&self) -> Fx {
        widen(self.turn).saturating_abs()
    }

    /// How far any point of a shape moves because its body turns: at most arm times angle, and at most from one
    /// side to the other.
    pub(super) fn turn_reach(&self, turn: Fx, shape: &Reach) -> Fx {
        if turn < Fx::DELTA * 64 || shape.disc {
            return Fx::ZERO;
        }
        let centre = shape.bounds.centre();
        // Shapes and centres are in the world: nothing here overflows.
        let offset = centre.wrapping_sub(self.centre);
        let half = shape.bounds.upper.wrapping_sub(centre);
        let aside = offset.x.wrapping_abs().wrapping_add(offset.y.wrapping_abs());
        let reach = half.x.wrapping_add(half.y).wrapping_add(aside);
        fx_mul(reach, turn.min(fx!(2)))
    }
}

/// The box of a shape, how far it may come within the tick, and what its pairs have to know of it: one cache line.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(crate) struct Reach {
    pub(super) bounds: Aabb,
    /// Of the body's centre of mass.
    shift: Vec2<Way>,
    /// How far any point moves because the body turns.
    pub(super) turn: Way,
    /// How far the shape may overlap another, for its size, when they pass by each other.
    pub(super) slack: Step,
    /// The slot of its body.
    pub(super) body: u32,
    /// How far the surface is from the vertices.
    pub(super) radius: Length,
    /// Whether it is a circle about its body's centre of mass: to turn that changes nothing.
    pub(super) disc: bool,
    /// Whether it is solid, and one of [`SmallBoxes`](crate::collision::SmallBoxes).
    pub(super) small_box: bool,
    pub(super) sensor: bool,
    pub(super) one_way: bool,
    pub(super) hit_events: bool,
    /// Whether events tell what it touches.
    pub(super) is_reported: bool,
}

const _: () = assert!(size_of::<Reach>() == 64);

impl Reach {
    /// Of a shape that does not move.
    fn at_rest(shape: &Shape, body: &Body, posed: &PosedShape) -> Self {
        let bounds = posed.bounds;
        let is_circle = matches!(shape.geometry(), Geometry::Circle { .. });
        Reach {
            bounds,
            shift: Vec2::ZERO,
            turn: Way::ZERO,
            slack: slack_of(bounds),
            body: shape.body().slot(),
            radius: narrow(posed.outline.radius()),
            disc: is_circle && arm_of(&shape.def, body) == Vec2::ZERO,
            small_box: posed.as_small_box().is_some() && !shape.is_sensor(),
            sensor: shape.is_sensor(),
            one_way: shape.one_way().is_some(),
            hit_events: shape.def.events.hit,
            is_reported: shape.is_sensor() || shape.def.events.contact,
        }
    }

    /// The centre of its box: of a shape that is a box, its centre.
    #[inline]
    pub(super) fn centre(&self) -> Vec2<Fx> {
        self.bounds.centre()
    }

    /// From its centre to that of another, which is in the world like it.
    #[inline]
    pub(super) fn way_to(&self, other: &Reach) -> Vec2<Fx> {
        let twice = |reach: &Reach| reach.bounds.lower.wrapping_add(reach.bounds.upper);
        let Vec2 { x, y } = twice(other).wrapping_sub(twice(self));
        Vec2::new(x >> 1, y >> 1)
    }

    /// Bound of the way by which any two points of two shapes approach each other in the tick, in metres.
    #[inline]
    pub(super) fn closing(&self, other: &Reach) -> Way {
        let apart = |a: Way, b: Way| (i64::from(b.to_bits()) - i64::from(a.to_bits())).abs();
        let shift = apart(self.shift.x, other.shift.x) + apart(self.shift.y, other.shift.y);
        Way::from_bits(saturate(shift + i64::from(self.turn.to_bits()) + i64::from(other.turn.to_bits())))
    }
}

/// How far a shape in a box may overlap another when they pass by each other, in metres.
fn slack_of(bounds: Aabb) -> Step {
    let half = bounds.extents();
    narrow(half.x.max(half.y) / 16)
}

/// Bodies and shapes as the pairs of a tick see them, by slot. What has no place in the roster does not move.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outlook {
    motions: Vec<Motion>,
    reaches: Vec<Reach>,
    /// Which of them may not be at rest.
    moving_bodies: Vec<u32>,
    moving_shapes: Vec<u32>,
}

impl Outlook {
    /// Puts everything at rest, for a tick with so many slots for bodies.
    pub(super) fn begin(&mut self, body_slots: usize) {
        for slot in self.moving_bodies.drain(..) {
            self.motions[slot as usize] = Motion::default();
        }
        for slot in self.moving_shapes.drain(..) {
            let reach = &mut self.reaches[slot as usize];
            (reach.shift, reach.turn) = (Vec2::ZERO, Way::ZERO);
        }
        self.motions.resize(body_slots, Motion::default());
    }

    /// Takes up a shape that has been posed.
    pub(super) fn place(&mut self, slot: u32, shape: &Shape, body: &Body, posed: &PosedShape) {
        if self.reaches.len() <= slot as usize {
            self.reaches.resize(slot as usize + 1, Reach::default());
        }
        self.reaches[slot as usize] = Reach::at_rest(shape, body, posed);
    }

    /// Takes up where a shape has been moved to.
    pub(super) fn move_to(&mut self, slot: u32, bounds: Aabb) {
        let reach = &mut self.reaches[slot as usize];
        (reach.bounds, reach.slack) = (bounds, slack_of(bounds));
    }

    pub(super) fn set_motion(&mut self, body: u32, motion: Motion) {
        self.motions[body as usize] = motion;
        self.moving_bodies.push(body);
    }

    pub(super) fn set_reach(&mut self, shape: u32, shift: Vec2<Way>, turn: Fx) {
        let reach = &mut self.reaches[shape as usize];
        (reach.shift, reach.turn) = (shift, narrow(turn));
        self.moving_shapes.push(shape);
    }

    pub(super) fn reach(&self, shape: u32) -> &Reach {
        &self.reaches[shape as usize]
    }

    /// Asks for what will soon be looked at.
    #[inline]
    pub(super) fn prefetch(&self, shape: u32) {
        prefetch(&self.reaches[shape as usize]);
    }

    /// Asks for how the bodies of two shapes move.
    #[inline]
    pub(super) fn prefetch_motions(&self, a: &Reach, b: &Reach) {
        prefetch(self.motion(a));
        prefetch(self.motion(b));
    }

    pub(super) fn motion(&self, reach: &Reach) -> &Motion {
        &self.motions[reach.body as usize]
    }
}
