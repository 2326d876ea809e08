//! Bounds and predicted motion of bodies and shapes.
//!
//! The narrow phase rejects most pairs because their shapes cannot meet within the tick. The data for this test is
//! contiguous, so that the test reads neither bodies nor outlines.

use alloc::vec::Vec;

use crate::body::{Body, Geometry, Handle, Shape};
use crate::collision::{PosedShape, arm_of, margin_for, may_meet};
use crate::fx;
use crate::math::{
    Aabb, Fx, Length, Reciprocal, Speed, Step, Unit, Vec2, convert, fx_mul, narrow, saturate, widen,
};
use crate::simd::prefetch;
use crate::threads::split_at_ends;
use crate::world::config::Config;
use fixed::FixedI32;
use fixed::types::extra::{U16, U24};

/// A displacement within a tick in metres. The range is ±128 m, the resolution 6e-8 m.
pub(crate) type Travel = FixedI32<U24>;

/// Motion of a body within a tick at its velocity at the start of the tick.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PredictedMotion {
    /// Centre of mass at the start of the tick.
    pub(crate) centre: Vec2<Fx>,
    /// Displacement of the centre of mass, at most 52 m on each axis (`SPEED_MAX`, 511 m/s, at 10 ticks a second).
    pub(crate) shift: Vec2<Travel>,
    /// Rotation in radians.
    pub(crate) turn: Travel,
}

impl PredictedMotion {
    /// Motion of a body at its current velocity. `per_second` is `1 / tick_rate`, the duration of a tick in seconds.
    #[inline]
    pub(crate) fn of(body: &Body, per_second: Reciprocal) -> Self {
        let step = |speed: Speed| per_second.times(speed);
        let shift = Vec2::new(step(body.velocity.x), step(body.velocity.y));
        let omega = |spin| -> FixedI32<U16> { body.mass.inverse_gyration.times(spin) };
        let turn = if body.spin == 0 { Travel::ZERO } else { per_second.times(omega(body.spin)) };
        PredictedMotion { centre: body.centre, shift, turn }
    }

    /// Displacement of the centre of mass in a fraction of the tick.
    pub(crate) fn shift_until(&self, fraction: Unit) -> Vec2<Fx> {
        self.shift.scale::<_, U24>(fraction).widen()
    }

    /// This motion, with the centre of mass moved to the position that it reaches at a fraction of the tick.
    pub(crate) fn advanced(&self, fraction: Unit) -> Self {
        PredictedMotion { centre: self.centre + self.shift_until(fraction), ..*self }
    }

    /// Displacement of a point of the body within the tick.
    pub(crate) fn shift_at(&self, point: Vec2<Fx>) -> Vec2<Travel> {
        if self.turn == 0 {
            return self.shift;
        }
        let arm: Vec2<Length> = (point - self.centre).narrow();
        self.shift + arm.perp().scale(self.turn)
    }

    /// Absolute value of the rotation in radians.
    pub(crate) fn turned(&self) -> Fx {
        widen(self.turn).saturating_abs()
    }

    /// Upper bound in metres of the movement of a shape's points, if the body rotates by `turn` radians: an upper bound
    /// of the lever arm times the angle, at most twice that lever arm. 0 for a disc about the centre of mass.
    pub(crate) fn turn_reach(&self, turn: Fx, shape: &ShapeMotion) -> Fx {
        if turn < Fx::DELTA * 64 || shape.disc {
            return Fx::ZERO;
        }
        let centre = shape.bounds.centre();
        // Shapes and centres of mass are within the world extent, so that no sum overflows.
        let offset = centre.wrapping_sub(self.centre);
        let half = shape.bounds.upper.wrapping_sub(centre);
        let aside = offset.x.wrapping_abs().wrapping_add(offset.y.wrapping_abs());
        let reach = half.x.wrapping_add(half.y).wrapping_add(aside);
        fx_mul(reach, turn.min(fx!(2)))
    }
}

/// Properties of a shape that the narrow phase reads for every pair: one cache line.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(crate) struct ShapeMotion {
    pub(crate) bounds: Aabb,
    shift: Vec2<Travel>,
    /// Upper bound in metres of the movement of points by the body's rotation.
    pub(crate) turn: Travel,
    /// Largest overlap in metres with which another shape may still pass by this shape (ghost-collision filter, one-way
    /// shapes).
    pub(crate) slack: Step,
    pub(crate) body: u32,
    /// Rounding radius: distance of the surface from the vertices.
    pub(crate) radius: Length,
    /// Whether the shape is a circle about its body's centre of mass.
    pub(crate) disc: bool,
    /// Whether the shape is solid and one of [`SmallBoxes`](crate::collision::SmallBoxes).
    pub(crate) small_box: bool,
    pub(crate) sensor: bool,
    pub(crate) one_way: bool,
    pub(crate) hit_events: bool,
    pub(crate) is_reported: bool,
}

const _: () = assert!(size_of::<ShapeMotion>() == 64);

impl ShapeMotion {
    fn at_rest(shape: &Shape, body: &Body, posed: &PosedShape) -> Self {
        let bounds = posed.bounds;
        let is_circle = matches!(shape.geometry(), Geometry::Circle { .. });
        ShapeMotion {
            bounds,
            shift: Vec2::ZERO,
            turn: Travel::ZERO,
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

    #[inline]
    pub(super) fn set_bounds(&mut self, bounds: Aabb) {
        (self.bounds, self.slack) = (bounds, slack_of(bounds));
    }

    /// `turn` is a bound in metres of the movement by rotation.
    #[inline]
    pub(crate) fn set_motion(&mut self, motion: &PredictedMotion, turn: Fx) {
        (self.shift, self.turn) = (motion.shift, narrow(turn));
    }

    #[inline]
    pub(crate) fn centre(&self) -> Vec2<Fx> {
        self.bounds.centre()
    }

    #[inline]
    pub(crate) fn offset_to(&self, other: &ShapeMotion) -> Vec2<Fx> {
        // Correct for shapes less than 2^30 m apart, even if a sum wraps around at the edge of the world.
        let twice = |shape: &ShapeMotion| shape.bounds.lower.wrapping_add(shape.bounds.upper);
        let Vec2 { x, y } = twice(other).wrapping_sub(twice(self));
        Vec2::new(x >> 1, y >> 1)
    }

    /// Half the sum of the sides of the bounds in metres, saturated.
    #[inline]
    pub(crate) fn extent(&self) -> Length {
        let size = self.bounds.upper - self.bounds.lower;
        narrow(size.x.saturating_add(size.y) >> 1)
    }

    /// Upper bound in metres of the approach of two shapes within the tick.
    #[inline]
    fn closing(&self, other: &ShapeMotion) -> Travel {
        let apart = |a: Travel, b: Travel| (i64::from(b.to_bits()) - i64::from(a.to_bits())).abs();
        let shift = apart(self.shift.x, other.shift.x) + apart(self.shift.y, other.shift.y);
        Travel::from_bits(saturate(shift + i64::from(self.turn.to_bits()) + i64::from(other.turn.to_bits())))
    }
}

pub(crate) struct MotionRange<'a> {
    first_body: u32,
    bodies: &'a mut [PredictedMotion],
    first_shape: u32,
    shapes: &'a mut [ShapeMotion],
}

impl MotionRange<'_> {
    pub(crate) fn holds(&self, slot: u32, body: &Body) -> bool {
        let holds = |first: u32, len: usize, slot: u32| slot >= first && ((slot - first) as usize) < len;
        holds(self.first_body, self.bodies.len(), slot)
            && body.shapes().iter().all(|id| holds(self.first_shape, self.shapes.len(), id.slot()))
    }

    #[inline]
    pub(crate) fn body_mut(&mut self, slot: u32) -> &mut PredictedMotion {
        &mut self.bodies[(slot - self.first_body) as usize]
    }

    #[inline]
    pub(crate) fn shape_mut(&mut self, slot: u32) -> &mut ShapeMotion {
        &mut self.shapes[(slot - self.first_shape) as usize]
    }
}

/// The value of [`ShapeMotion::slack`] for a shape with these bounds.
fn slack_of(bounds: Aabb) -> Step {
    let half = bounds.extents();
    narrow(half.x.max(half.y) / 16)
}

/// Distance limits of the narrow phase in metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Margins {
    pub(crate) speculative: Length,
    pub(crate) touching: Step,
    /// Distance in metres that shapes approach in a tick at [`IMPACT_SPEED`].
    pub(crate) impact: Step,
    /// Largest relative movement at which a contact keeps its manifold. For round shapes that may roll,
    /// `step/recycle.rs` uses another limit.
    pub(crate) kept: Length,
}

/// Approach speed in m/s above which a contact is an impact.
const IMPACT_SPEED: Fx = fx!(5);

impl Margins {
    pub(crate) fn of(config: &Config) -> Self {
        Margins {
            speculative: narrow(config.speculative_distance),
            touching: narrow(config.touching_distance()),
            impact: narrow(IMPACT_SPEED / i64::from(config.tick_rate)),
            kept: narrow(config.speculative_distance / 4),
        }
    }
}

/// Upper bound of the approach of two shapes within the tick, in metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClosingBound {
    distance: Travel,
    /// Shapes that are at most this far apart get contact points.
    pub(crate) margin: Length,
}

/// Smallest approach within a tick, in metres, for which the ghost-collision filter checks whether shapes pass by each
/// other.
pub(crate) const GHOST_TRAVEL_MIN: Step = Step::lit("0.0001");

impl ClosingBound {
    #[inline]
    pub(crate) fn of(margins: &Margins, a: &ShapeMotion, b: &ShapeMotion) -> Self {
        let distance = a.closing(b);
        ClosingBound { distance, margin: margin_for(margins.speculative, distance) }
    }

    #[inline]
    pub(crate) fn rest_of(self, distance: Length) -> Length {
        distance.saturating_sub(convert(self.distance))
    }

    #[inline]
    pub(crate) fn is_fast(self) -> bool {
        self.distance > GHOST_TRAVEL_MIN
    }

    #[inline]
    pub(crate) fn is_longer_than(self, distance: Step) -> bool {
        self.distance > distance
    }

    #[inline]
    pub(crate) fn may_meet(self, a: &ShapeMotion, b: &ShapeMotion) -> bool {
        may_meet(a.bounds, b.bounds, self.margin)
    }
}

/// Bounds and predicted motion of bodies and shapes, by slot. Bodies outside of the awake set have no motion.
#[derive(Clone, Debug, Default)]
pub(crate) struct MotionCache {
    bodies: Vec<PredictedMotion>,
    shapes: Vec<ShapeMotion>,
    moving_bodies: Vec<u32>,
    /// Whether there may be a sensor. After the last sensor is gone, the flag stays true.
    may_have_sensors: bool,
    /// Whether there may be a one-way shape. After the last one is gone, the flag stays true.
    may_have_one_way: bool,
}

impl MotionCache {
    /// Resets predicted motion to rest. `last_moving` lists the shapes that moved in the last tick.
    pub(super) fn begin(&mut self, body_slots: usize, last_moving: impl Iterator<Item = u32>) {
        for slot in self.moving_bodies.drain(..) {
            self.bodies[slot as usize] = PredictedMotion::default();
        }
        for slot in last_moving {
            let shape = &mut self.shapes[slot as usize];
            (shape.shift, shape.turn) = (Vec2::ZERO, Travel::ZERO);
        }
        self.bodies.resize(body_slots, PredictedMotion::default());
    }

    pub(super) fn set_shape(&mut self, slot: u32, shape: &Shape, body: &Body, posed: &PosedShape) {
        if self.shapes.len() <= slot as usize {
            self.shapes.resize(slot as usize + 1, ShapeMotion::default());
        }
        self.shapes[slot as usize] = ShapeMotion::at_rest(shape, body, posed);
        self.may_have_sensors |= shape.is_sensor();
        self.may_have_one_way |= shape.one_way().is_some();
    }

    /// Divides the shapes into ranges that end at the given slots.
    pub(super) fn split_shapes(
        &mut self,
        ends: impl Iterator<Item = usize>,
    ) -> impl Iterator<Item = &mut [ShapeMotion]> {
        split_at_ends(&mut self.shapes, ends)
    }

    /// Divides bodies and shapes into ranges. Each item of `ends` has the end of a range of body slots and of a range
    /// of shape slots.
    pub(crate) fn split(
        &mut self,
        ends: impl Iterator<Item = [u32; 2]> + Clone,
    ) -> impl Iterator<Item = MotionRange<'_>> {
        let firsts = core::iter::once([0, 0]).chain(ends.clone());
        let bodies = split_at_ends(&mut self.bodies, ends.clone().map(|[body, _]| body as usize));
        let shapes = split_at_ends(&mut self.shapes, ends.map(|[_, shape]| shape as usize));
        let parts = firsts.zip(bodies).zip(shapes);
        parts.map(|(([first_body, first_shape], bodies), shapes)| MotionRange {
            first_body,
            bodies,
            first_shape,
            shapes,
        })
    }

    pub(crate) fn whole(&mut self) -> MotionRange<'_> {
        MotionRange { first_body: 0, bodies: &mut self.bodies, first_shape: 0, shapes: &mut self.shapes }
    }

    /// Records the bodies whose motion the next tick has to reset.
    pub(super) fn bodies_move(&mut self, bodies: &[u32]) {
        self.moving_bodies.extend_from_slice(bodies);
    }

    pub(crate) fn may_have_sensors(&self) -> bool {
        self.may_have_sensors
    }

    pub(crate) fn may_have_one_way(&self) -> bool {
        self.may_have_one_way
    }

    pub(crate) fn shape(&self, slot: u32) -> &ShapeMotion {
        &self.shapes[slot as usize]
    }

    pub(crate) fn motion(&self, shape: &ShapeMotion) -> &PredictedMotion {
        &self.bodies[shape.body as usize]
    }

    #[inline]
    pub(crate) fn prefetch(&self, shape: u32) {
        prefetch(&self.shapes[shape as usize]);
    }

    #[inline]
    pub(crate) fn prefetch_motions(&self, a: &ShapeMotion, b: &ShapeMotion) {
        prefetch(self.motion(a));
        prefetch(self.motion(b));
    }
}
