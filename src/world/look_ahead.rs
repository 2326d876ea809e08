//! How far ahead a tick has to look: what a body's velocity can do within it.
//!
//! What the pairs of a tick ask of each body and shape is worked out once and kept side by side in [`Outlook`]: most
//! pairs are too far apart to meet, and are seen to be so without a look at bodies, shapes or outlines.

use alloc::vec::Vec;

use super::config::Config;
use crate::body::{Body, Geometry, Handle, Shape};
use crate::collision::{
    Manifold, ManifoldPoint, OneWay, Passage, PosedShape, arm_of, margin_for, may_meet, pass_by,
};
use crate::fx;
use crate::lanes::prefetch;
use crate::math::{
    Aabb, Fx, Length, Reciprocal, Rot, Speed, Step, Unit, Vec2, convert, fx_mul, narrow, saturate, widen,
};
use fixed::FixedI32;
use fixed::types::extra::{LeEqU32, U16, U24, U27};

/// A way within a tick in metres: ±128, resolution 6e-8.
pub(super) type Way = FixedI32<U24>;

/// How a body moves in a tick, at its velocity at the start.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Motion {
    /// Centre of mass.
    centre: Vec2<Fx>,
    /// How far that moves: at most 52 m.
    pub(super) shift: Vec2<Way>,
    /// By how much the body turns, in radians.
    turn: Way,
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
    fn shift_at(&self, point: Vec2<Fx>) -> Vec2<Way> {
        if self.turn == 0 {
            return self.shift;
        }
        let arm: Vec2<Length> = (point - self.centre).narrow();
        self.shift + arm.perp().scale(self.turn)
    }

    /// By how much the body turns, in radians, without sign.
    pub(super) fn turn(&self) -> Fx {
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

/// By how much two bodies approach each other in a tick at a point of their contact, along the normal. With `x` the
/// shift, `t` the turn and `r` the arm of each,
///
/// ```text
/// n.(xA - xB) + tA (rA x n) - tB (rB x n)
/// ```
///
/// where `r` is the arm of the manifold's origin and the anchor together: each point adds `(tA - tB) (anchor x n)`. In
/// units of `Step` that do not saturate.
#[inline]
pub(super) fn approach(
    a: &Motion,
    b: &Motion,
    manifold: &Manifold,
) -> impl Fn(&ManifoldPoint) -> i64 + use<> {
    let n = (raw(manifold.normal.x), raw(manifold.normal.y));
    // Shifts are at most 52 m, arms and anchors 725 m, and turns 128 rad: products of two have at most 62 bits.
    let dot = (raw(a.shift.x) - raw(b.shift.x)) * n.0 + (raw(a.shift.y) - raw(b.shift.y)) * n.1;
    let lever = move |r: Vec2<Length>| (raw(r.x) * n.1 - raw(r.y) * n.0) >> Unit::FRAC_NBITS;
    let turned = move |turn: Way, lever: i64| (raw(turn) * lever) >> TURN_BITS;
    let by_turn = |motion: &Motion| {
        if motion.turn == 0 || motion.centre == manifold.origin {
            return 0;
        }
        // Both are in the world.
        turned(motion.turn, lever(manifold.origin.wrapping_sub(motion.centre).narrow()))
    };
    let common = (dot >> (Way::FRAC_NBITS + Unit::FRAC_NBITS - Step::FRAC_NBITS)) + by_turn(a) - by_turn(b);
    let turn = a.turn.saturating_sub(b.turn);
    move |point| common + turned(turn, lever(point.anchor))
}

/// The bits of a number, with room for a product.
fn raw<A: LeEqU32>(x: FixedI32<A>) -> i64 {
    i64::from(x.to_bits())
}

/// The fraction bits of a product of a turn and a lever that a step does not have.
const TURN_BITS: u32 = Way::FRAC_NBITS + Length::FRAC_NBITS - Step::FRAC_NBITS;

/// The box of a shape, how far it may come within the tick, and what its pairs have to know of it: one cache line.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(crate) struct Reach {
    pub(super) bounds: Aabb,
    /// Of the body's centre of mass.
    shift: Vec2<Way>,
    /// How far any point moves because the body turns.
    turn: Way,
    /// How far the shape may overlap another, for its size, when they pass by each other.
    slack: Step,
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
    fn closing(&self, other: &Reach) -> Way {
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

    /// Asks for what it takes to tell which points of two shapes will be reached, if they move against each other.
    #[inline]
    pub(super) fn prefetch_motions(&self, closing: Closing, a: &Reach, b: &Reach) {
        if closing.is_fast() {
            prefetch(self.motion(a));
            prefetch(self.motion(b));
        }
    }

    pub(super) fn motion(&self, reach: &Reach) -> &Motion {
        &self.motions[reach.body as usize]
    }
}

/// What is the same for all pairs of a world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Horizon {
    speculative: Length,
    touching: Step,
}

impl Horizon {
    pub(super) fn of(config: &Config) -> Self {
        Horizon {
            speculative: narrow(config.speculative_distance),
            touching: narrow(config.touching_distance()),
        }
    }
}

/// How far two shapes may come towards each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closing {
    /// Bound of the way by which any two points of the shapes approach each other in the tick, in metres.
    way: Way,
    /// How far ahead their contact has to look, in metres.
    pub(super) margin: Length,
}

impl Closing {
    #[inline]
    pub(super) fn of(horizon: &Horizon, a: &Reach, b: &Reach) -> Self {
        let way = a.closing(b);
        Closing { way, margin: margin_for(horizon.speculative, way) }
    }

    /// Whether the shapes move so fast against each other that they may pass by.
    #[inline]
    fn is_fast(self) -> bool {
        self.way > PASSAGE_MIN
    }

    /// Whether the shapes are so near that they may meet within the tick.
    #[inline]
    pub(super) fn may_meet(self, a: &Reach, b: &Reach) -> bool {
        may_meet(a.bounds, b.bounds, self.margin)
    }
}

/// How two bodies approach.
pub(super) struct Approach<'a> {
    pub(super) horizon: &'a Horizon,
    pub(super) a: &'a Reach,
    pub(super) b: &'a Reach,
    pub(super) closing: Closing,
}

/// Shapes that move against each other by less than this in a tick, in metres, do not pass by.
const PASSAGE_MIN: Step = Step::lit("0.0001");

impl Approach<'_> {
    /// How far the shapes may overlap, in metres, when they pass by each other.
    fn slack(&self) -> Step {
        self.horizon.touching.min(self.a.slack).min(self.b.slack)
    }

    /// Drops the points that the bodies, at their present velocities, will not reach within the tick: shapes that
    /// pass by at speed must not catch on each other.
    #[inline(always)]
    pub(super) fn keep_reachable<'p>(
        &self,
        manifold: &mut Manifold,
        outlook: &Outlook,
        posed: impl FnOnce() -> (&'p PosedShape, &'p PosedShape),
    ) {
        let speculative: Step = convert(self.horizon.speculative);
        let ahead = |point: &ManifoldPoint| point.separation > speculative;
        if self.closing.is_fast() || manifold.points().iter().any(ahead) {
            self.drop_unreached(manifold, outlook, posed);
        }
    }

    #[inline(never)]
    fn drop_unreached<'p>(
        &self,
        manifold: &mut Manifold,
        outlook: &Outlook,
        posed: impl FnOnce() -> (&'p PosedShape, &'p PosedShape),
    ) {
        let motions = (outlook.motion(self.a), outlook.motion(self.b));
        let closing_at = approach(motions.0, motions.1, manifold);
        let (speculative, slack) = (raw::<U27>(convert(self.horizon.speculative)), raw(self.slack()));
        // A point that is not reached does nothing, and a deep one does not pass by: only others decide.
        let mut most = 0;
        manifold.retain(|point| {
            let separation = raw(point.separation);
            if separation < -slack {
                return true;
            }
            let closing = closing_at(point);
            let kept = separation <= speculative.max(closing + speculative);
            // A quarter more: a gap that just closes acts too.
            if kept && closing + closing / 4 > separation {
                most = most.max(closing);
            }
            kept
        });
        let most = Step::from_bits(saturate(most));
        if most > PASSAGE_MIN && self.passes_by(motions, posed(), manifold.normal, most) {
            *manifold = Manifold::NONE;
        }
    }

    /// Whether one of the shapes lets the other pass through it.
    pub(super) fn lets_pass(
        &self,
        [(a, body_a, posed_a), (b, body_b, posed_b)]: [(&Shape, &Body, &PosedShape); 2],
        manifold: &Manifold,
        was_passing: bool,
    ) -> bool {
        let slack = widen(self.slack());
        one_way(a, body_a, posed_a).is_some_and(|a| a.lets_pass(posed_b, manifold, was_passing, slack))
            || one_way(b, body_b, posed_b)
                .is_some_and(|b| b.lets_pass(posed_a, &manifold.swapped(), was_passing, slack))
    }

    /// Whether the shapes pass by each other, within the slack, although a contact closes by some way in the tick.
    fn passes_by(
        &self,
        (motion_a, motion_b): (&Motion, &Motion),
        (posed_a, posed_b): (&PosedShape, &PosedShape),
        normal: Vec2<Unit>,
        closing: Step,
    ) -> bool {
        let shift = motion_b.shift_at(posed_b.centre) - motion_a.shift_at(posed_a.centre);
        let turn = convert(self.a.turn.saturating_add(self.b.turn));
        let passage =
            Passage::new(shift.convert(), turn, convert(self.slack()), convert(closing / 8), normal);
        pass_by(posed_a, posed_b, &passage)
    }
}

/// The shape with its direction in world axes, if it is a one-way shape.
fn one_way<'a>(shape: &Shape, body: &Body, posed: &'a PosedShape) -> Option<OneWay<'a>> {
    let direction = shape.one_way().map(|angle| Rot::from_angle(body.angle() + angle).apply(Vec2::X))?;
    Some(OneWay { shape: posed, direction })
}
