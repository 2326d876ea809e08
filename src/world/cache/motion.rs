//! Bounds and predicted motion of bodies and shapes.
//!
//! The narrow phase rejects most pairs because their shapes are too far apart to meet within the tick. The data for
//! that test is computed once per tick and stored contiguously, so that the test reads neither bodies nor outlines.

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

/// A displacement within a tick in metres: ±128, resolution 6e-8.
pub(crate) type Travel = FixedI32<U24>;

/// Motion of a body within a tick at its velocity at the start of the tick.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PredictedMotion {
    /// Centre of mass at the start of the tick.
    pub(crate) centre: Vec2<Fx>,
    /// Displacement of the centre of mass: at most 52 m on each axis.
    pub(crate) shift: Vec2<Travel>,
    /// Rotation of the body, in radians.
    pub(crate) turn: Travel,
}

impl PredictedMotion {
    /// The motion of a body in one tick. `per_second` is `1 / tick_rate`.
    #[inline]
    pub(crate) fn of(body: &Body, per_second: Reciprocal) -> Self {
        let step = |speed: Speed| per_second.times(speed);
        let shift = Vec2::new(step(body.velocity.x), step(body.velocity.y));
        let omega = |spin| -> FixedI32<U16> { body.mass.inverse_gyration.times(spin) };
        let turn = if body.spin == 0 { Travel::ZERO } else { per_second.times(omega(body.spin)) };
        PredictedMotion { centre: body.centre, shift, turn }
    }

    /// Displacement of the centre of mass from the start of the tick to a fraction of it.
    pub(crate) fn shift_until(&self, fraction: Unit) -> Vec2<Fx> {
        self.shift.scale::<_, U24>(fraction).widen()
    }

    /// Returns this motion with the centre of mass moved to its position at a fraction of the tick.
    pub(crate) fn advanced(&self, fraction: Unit) -> Self {
        PredictedMotion { centre: self.centre + self.shift_until(fraction), ..*self }
    }

    /// Displacement by the end of the tick of the body's point that is at `point` at the start.
    pub(crate) fn shift_at(&self, point: Vec2<Fx>) -> Vec2<Travel> {
        if self.turn == 0 {
            return self.shift;
        }
        let arm: Vec2<Length> = (point - self.centre).narrow();
        self.shift + arm.perp().scale(self.turn)
    }

    /// Size of the rotation in radians.
    pub(crate) fn turned(&self) -> Fx {
        widen(self.turn).saturating_abs()
    }

    /// Upper bound of the distance by which the body's rotation by `turn` radians moves any point of a shape: lever arm
    /// times angle, and at most twice the lever arm.
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

/// Bounds and predicted motion of a shape, and the properties that the narrow phase reads for every pair: one cache
/// line.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(crate) struct ShapeMotion {
    pub(crate) bounds: Aabb,
    /// Displacement of the body's centre of mass.
    shift: Vec2<Travel>,
    /// Upper bound of the distance by which the body's rotation moves any point of the shape.
    pub(crate) turn: Travel,
    /// Largest overlap in metres at which the ghost-collision filter may treat the shape as passing by another one. The
    /// limit of a pair is the smallest of the limits of both shapes and the touching distance.
    pub(crate) slack: Step,
    /// Slot of the body.
    pub(crate) body: u32,
    /// Distance of the surface from the vertices.
    pub(crate) radius: Length,
    /// Whether the shape is a circle about its body's centre of mass, which rotation does not change.
    pub(crate) disc: bool,
    /// Whether the shape is solid and one of [`SmallBoxes`](crate::collision::SmallBoxes).
    pub(crate) small_box: bool,
    pub(crate) sensor: bool,
    pub(crate) one_way: bool,
    pub(crate) hit_events: bool,
    /// Whether the shape is a sensor or has contact events.
    pub(crate) is_reported: bool,
}

const _: () = assert!(size_of::<ShapeMotion>() == 64);

impl ShapeMotion {
    /// A shape that does not move.
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

    /// Sets the bounds of a shape that has been moved.
    #[inline]
    pub(super) fn set_bounds(&mut self, bounds: Aabb) {
        (self.bounds, self.slack) = (bounds, slack_of(bounds));
    }

    /// Sets the predicted motion: the translation of the shape's body, and the largest distance `turn`, in metres, by
    /// which the body's rotation moves any point of the shape.
    #[inline]
    pub(crate) fn set_motion(&mut self, motion: &PredictedMotion, turn: Fx) {
        (self.shift, self.turn) = (motion.shift, narrow(turn));
    }

    /// The centre of the bounds, which is the centre of a shape that is a box.
    #[inline]
    pub(crate) fn centre(&self) -> Vec2<Fx> {
        self.bounds.centre()
    }

    /// The vector from the centre of the bounds to the centre of another shape's bounds.
    #[inline]
    pub(crate) fn offset_to(&self, other: &ShapeMotion) -> Vec2<Fx> {
        // Right for shapes less than 2^30 m apart, even if a sum wraps around at the edge of the world.
        let twice = |shape: &ShapeMotion| shape.bounds.lower.wrapping_add(shape.bounds.upper);
        let Vec2 { x, y } = twice(other).wrapping_sub(twice(self));
        Vec2::new(x >> 1, y >> 1)
    }

    /// Half the sum of the sides of the bounds in metres, saturated: no point of the shape is farther from their
    /// centre.
    #[inline]
    pub(crate) fn extent(&self) -> Length {
        // Wraps around only for shapes of fixed bodies whose sides add up to 2^31 m or more.
        let size = self.bounds.upper.wrapping_sub(self.bounds.lower);
        narrow(size.x.wrapping_add(size.y) >> 1)
    }

    /// Upper bound of the distance by which any two points of two shapes approach each other within the tick, in
    /// metres.
    #[inline]
    fn closing(&self, other: &ShapeMotion) -> Travel {
        let apart = |a: Travel, b: Travel| (i64::from(b.to_bits()) - i64::from(a.to_bits())).abs();
        let shift = apart(self.shift.x, other.shift.x) + apart(self.shift.y, other.shift.y);
        Travel::from_bits(saturate(shift + i64::from(self.turn.to_bits()) + i64::from(other.turn.to_bits())))
    }
}

/// Bounds and predicted motion of the bodies and shapes in ranges of slots.
pub(crate) struct MotionRange<'a> {
    /// First slot of the bodies.
    first_body: u32,
    bodies: &'a mut [PredictedMotion],
    /// First slot of the shapes.
    first_shape: u32,
    shapes: &'a mut [ShapeMotion],
}

impl MotionRange<'_> {
    /// Whether a body and all of its shapes are in the ranges.
    pub(crate) fn holds(&self, slot: u32, body: &Body) -> bool {
        let holds = |first: u32, len: usize, slot: u32| slot >= first && ((slot - first) as usize) < len;
        holds(self.first_body, self.bodies.len(), slot)
            && body.shapes().iter().all(|id| holds(self.first_shape, self.shapes.len(), id.slot()))
    }

    /// The motion of a body of the range.
    #[inline]
    pub(crate) fn body_mut(&mut self, slot: u32) -> &mut PredictedMotion {
        &mut self.bodies[(slot - self.first_body) as usize]
    }

    /// A shape of the range.
    #[inline]
    pub(crate) fn shape_mut(&mut self, slot: u32) -> &mut ShapeMotion {
        &mut self.shapes[(slot - self.first_shape) as usize]
    }
}

/// Largest overlap in metres at which a shape with these bounds may still pass by another one.
fn slack_of(bounds: Aabb) -> Step {
    let half = bounds.extents();
    narrow(half.x.max(half.y) / 16)
}

/// Speculative distance, touching distance and related limits of a world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Margins {
    pub(crate) speculative: Length,
    pub(crate) touching: Step,
    /// Distance in metres by which shapes approach each other in a tick at [`IMPACT_SPEED`].
    pub(crate) impact: Step,
    /// Upper limit, for shapes of any size, of the relative movement at which a contact keeps its manifold, in metres.
    /// It does not apply to a round shape on a body that is not dynamic.
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

/// Upper bound of the approach of two shapes within the tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClosingBound {
    /// Bound of the distance by which any two points of the shapes approach each other, in metres.
    distance: Travel,
    /// Speculative margin of the pair in metres: shapes that are at most this far apart get contact points.
    pub(crate) margin: Length,
}

/// Approach within a tick, in metres, above which the ghost-collision filter checks whether two shapes pass by each
/// other.
pub(crate) const GHOST_TRAVEL_MIN: Step = Step::lit("0.0001");

impl ClosingBound {
    #[inline]
    pub(crate) fn of(margins: &Margins, a: &ShapeMotion, b: &ShapeMotion) -> Self {
        let distance = a.closing(b);
        ClosingBound { distance, margin: margin_for(margins.speculative, distance) }
    }

    /// A distance minus the bound of the approach within the tick.
    #[inline]
    pub(crate) fn rest_of(self, distance: Length) -> Length {
        distance.saturating_sub(convert(self.distance))
    }

    /// Whether the shapes approach each other so fast that the ghost-collision filter may apply.
    #[inline]
    pub(crate) fn is_fast(self) -> bool {
        self.distance > GHOST_TRAVEL_MIN
    }

    /// Whether the shapes may approach each other by more than a distance.
    #[inline]
    pub(crate) fn is_longer_than(self, distance: Step) -> bool {
        self.distance > distance
    }

    /// Whether the shapes are so near that they may meet within the tick.
    #[inline]
    pub(crate) fn may_meet(self, a: &ShapeMotion, b: &ShapeMotion) -> bool {
        may_meet(a.bounds, b.bounds, self.margin)
    }
}

/// Bounds and predicted motion of all shapes and bodies, by slot. Bodies that are not in the awake set do not move.
#[derive(Clone, Debug, Default)]
pub(crate) struct MotionCache {
    bodies: Vec<PredictedMotion>,
    shapes: Vec<ShapeMotion>,
    /// Slots of the bodies that move.
    moving_bodies: Vec<u32>,
    /// Whether there may be a sensor. Never false while there is one.
    may_have_sensors: bool,
}

impl MotionCache {
    /// Starts a tick: resets all predicted motion to rest, and makes room for `body_slots` bodies. `last_moving` lists
    /// the shapes whose motion was predicted for the last tick.
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

    /// Adds or replaces a shape that has been posed.
    pub(super) fn set_shape(&mut self, slot: u32, shape: &Shape, body: &Body, posed: &PosedShape) {
        if self.shapes.len() <= slot as usize {
            self.shapes.resize(slot as usize + 1, ShapeMotion::default());
        }
        self.shapes[slot as usize] = ShapeMotion::at_rest(shape, body, posed);
        self.may_have_sensors |= shape.is_sensor();
    }

    /// Divides the shapes into ranges of slots, which end at the given slots.
    pub(super) fn split_shapes(
        &mut self,
        ends: impl Iterator<Item = usize>,
    ) -> impl Iterator<Item = &mut [ShapeMotion]> {
        split_at_ends(&mut self.shapes, ends)
    }

    /// Divides bodies and shapes into ranges of slots, for threads that predict their motion. Each range ends at the
    /// given slots of a body and of a shape.
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

    /// All bodies and shapes.
    pub(crate) fn whole(&mut self) -> MotionRange<'_> {
        MotionRange { first_body: 0, bodies: &mut self.bodies, first_shape: 0, shapes: &mut self.shapes }
    }

    /// Records the bodies whose motion has been predicted, so that the next tick can reset it.
    pub(super) fn bodies_move(&mut self, bodies: &[u32]) {
        self.moving_bodies.extend_from_slice(bodies);
    }

    /// Whether the world may have sensors.
    pub(crate) fn may_have_sensors(&self) -> bool {
        self.may_have_sensors
    }

    /// The shape in an occupied slot.
    pub(crate) fn shape(&self, slot: u32) -> &ShapeMotion {
        &self.shapes[slot as usize]
    }

    /// The predicted motion of a shape's body.
    pub(crate) fn motion(&self, shape: &ShapeMotion) -> &PredictedMotion {
        &self.bodies[shape.body as usize]
    }

    /// Prefetches a shape.
    #[inline]
    pub(crate) fn prefetch(&self, shape: u32) {
        prefetch(&self.shapes[shape as usize]);
    }

    /// Prefetches the motions of the bodies of two shapes.
    #[inline]
    pub(crate) fn prefetch_motions(&self, a: &ShapeMotion, b: &ShapeMotion) {
        prefetch(self.motion(a));
        prefetch(self.motion(b));
    }
}
