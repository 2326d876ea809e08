//! How far ahead a tick has to look: what a body's velocity can do within it.
//!
//! What the pairs of a tick ask of each body and shape is worked out once and kept side by side in [`Outlook`]: most
//! pairs are too far apart to meet, and are seen to be so without a look at bodies, shapes or outlines.

use alloc::vec::Vec;

use super::config::Config;
use crate::body::{Body, Shape};
use crate::collision::{Manifold, ManifoldPoint, OneWay, Outline, Passage, PosedShape, margin_for, pass_by};
use crate::fx;
use crate::math::{Aabb, Fx, Length, Rot, Unit, Vec2, fx_mul, narrow, widen};

/// How a body moves at the start of a tick.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Motion {
    /// Centre of mass.
    centre: Vec2<Fx>,
    velocity: Vec2<Fx>,
    /// In rad/s.
    omega: Fx,
}

impl Motion {
    pub(super) fn of(body: &Body) -> Self {
        let omega = if body.spin == 0 { Fx::ZERO } else { body.angular_velocity() };
        Motion { centre: body.centre, velocity: body.velocity(), omega }
    }

    /// Of the point of the body that is at a world point, in m/s.
    pub(super) fn velocity_at(&self, point: Vec2<Fx>) -> Vec2<Fx> {
        if self.omega == 0 {
            return self.velocity;
        }
        self.velocity + (point - self.centre).perp().scale(self.omega)
    }

    /// How far the centre of mass moves in a tick.
    pub(super) fn shift(&self, tick_rate: u32) -> Vec2<Fx> {
        let rate = i64::from(tick_rate);
        Vec2::new(self.velocity.x / rate, self.velocity.y / rate)
    }

    /// By how much the body turns in a tick, in radians, without sign.
    pub(super) fn turn(&self, tick_rate: u32) -> Fx {
        self.omega.saturating_abs() / i64::from(tick_rate)
    }

    /// How far any point of a shape moves because its body turns: at most arm times angle, and at most from one
    /// side to the other.
    pub(super) fn turn_reach(&self, turn: Fx, posed: &PosedShape) -> Fx {
        if turn < Fx::DELTA * 64 {
            return Fx::ZERO;
        }
        let offset = posed.bounds.centre() - self.centre;
        if matches!(posed.outline, Outline::Circle { .. }) && offset == Vec2::ZERO {
            return Fx::ZERO;
        }
        let half = posed.bounds.extents();
        let reach = half
            .x
            .saturating_add(half.y)
            .saturating_add(offset.x.saturating_abs())
            .saturating_add(offset.y.saturating_abs());
        fx_mul(reach, turn.min(fx!(2)))
    }
}

/// The largest way in metres because of a turn that pairs tell from larger ones: they look ahead by 15 m at most.
const TURN_MAX: Fx = fx!(1024);

/// The box of a shape, how far it may come within the tick, and what its pairs have to know of it: one cache line.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Reach {
    pub(super) bounds: Aabb,
    /// Of the body's centre of mass.
    pub(super) shift: Vec2<Fx>,
    /// How far any point moves because the body turns.
    pub(super) turn: Fx,
    /// The slot of its body.
    pub(super) body: u32,
    pub(super) sensor: bool,
    pub(super) one_way: bool,
    pub(super) hit_events: bool,
}

impl Reach {
    /// Of a shape that does not move.
    fn at_rest(shape: &Shape, body: u32, bounds: Aabb) -> Self {
        Reach {
            bounds,
            shift: Vec2::ZERO,
            turn: Fx::ZERO,
            body,
            sensor: shape.is_sensor(),
            one_way: shape.one_way().is_some(),
            hit_events: shape.def.events.hit,
        }
    }

    /// Bound of the way by which any two points of two shapes approach each other in the tick, in metres.
    fn closing(&self, other: &Reach) -> Fx {
        // Speeds are below 2^9 m/s and turns at most TURN_MAX: the sum is far from the end of the range.
        let apart = |a: Fx, b: Fx| (b.to_bits() - a.to_bits()).abs();
        let shift = apart(self.shift.x, other.shift.x) + apart(self.shift.y, other.shift.y);
        Fx::from_bits(shift + self.turn.to_bits() + other.turn.to_bits())
    }

    /// How far the shape may overlap another, for its size, when they pass by each other.
    fn slack(&self) -> Fx {
        let half = self.bounds.extents();
        half.x.max(half.y) / 16
    }
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
            (reach.shift, reach.turn) = (Vec2::ZERO, Fx::ZERO);
        }
        self.motions.resize(body_slots, Motion::default());
    }

    /// Takes up a shape that has been posed.
    pub(super) fn place(&mut self, slot: u32, shape: &Shape, body: u32, bounds: Aabb) {
        if self.reaches.len() <= slot as usize {
            self.reaches.resize(slot as usize + 1, Reach::default());
        }
        self.reaches[slot as usize] = Reach::at_rest(shape, body, bounds);
    }

    /// Takes up where a shape has been moved to.
    pub(super) fn move_to(&mut self, slot: u32, bounds: Aabb) {
        self.reaches[slot as usize].bounds = bounds;
    }

    pub(super) fn set_motion(&mut self, body: u32, motion: Motion) {
        self.motions[body as usize] = motion;
        self.moving_bodies.push(body);
    }

    pub(super) fn set_reach(&mut self, shape: u32, shift: Vec2<Fx>, turn: Fx) {
        let reach = &mut self.reaches[shape as usize];
        (reach.shift, reach.turn) = (shift, turn.min(TURN_MAX));
        self.moving_shapes.push(shape);
    }

    pub(super) fn reach(&self, shape: u32) -> &Reach {
        &self.reaches[shape as usize]
    }

    pub(super) fn motion(&self, reach: &Reach) -> &Motion {
        &self.motions[reach.body as usize]
    }
}

/// What is the same for all pairs of a world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Horizon {
    tick_rate: i64,
    speculative: Length,
    touching: Fx,
}

impl Horizon {
    pub(super) fn of(config: &Config) -> Self {
        Horizon {
            tick_rate: config.tick_rate.into(),
            speculative: narrow(config.speculative_distance),
            touching: config.touching_distance(),
        }
    }
}

/// How two bodies approach: it decides how far ahead their contact has to look.
pub(super) struct Approach<'a> {
    horizon: &'a Horizon,
    a: &'a Reach,
    b: &'a Reach,
    /// Bound of the way by which any two points of the shapes approach each other in the tick, in metres.
    closing: Fx,
    pub(super) margin: Length,
}

/// Shapes that move against each other by less than this in a tick, in metres, do not pass by.
const PASSAGE_MIN: Fx = fx!(0.0001);

impl<'a> Approach<'a> {
    #[inline]
    pub(super) fn new(horizon: &'a Horizon, a: &'a Reach, b: &'a Reach) -> Self {
        let closing = a.closing(b);
        Approach { horizon, a, b, closing, margin: margin_for(horizon.speculative, closing) }
    }

    /// How far the shapes may overlap, in metres, when they pass by each other.
    fn slack(&self) -> Fx {
        self.horizon.touching.min(self.a.slack()).min(self.b.slack())
    }

    /// Drops the points that the bodies, at their present velocities, will not reach within the tick: shapes that
    /// pass by at speed must not catch on each other.
    pub(super) fn keep_reachable(
        &self,
        manifold: &mut Manifold,
        outlook: &Outlook,
        posed: (&PosedShape, &PosedShape),
    ) {
        let speculative = widen(self.horizon.speculative);
        let ahead = |point: &ManifoldPoint| widen(point.separation) > speculative;
        let fast = self.closing > PASSAGE_MIN;
        if self.margin == self.horizon.speculative || !(fast || manifold.points().iter().any(ahead)) {
            return;
        }
        let (motion_a, motion_b) = (outlook.motion(self.a), outlook.motion(self.b));
        let (origin, normal) = (manifold.origin, manifold.normal.widen());
        let approach_speed = |point: &ManifoldPoint| {
            let place = origin + point.anchor.widen();
            -(motion_b.velocity_at(place) - motion_a.velocity_at(place)).dot(normal)
        };
        // From this speed on a point closes by more than the least that counts.
        let at_passage_min = (PASSAGE_MIN.to_bits() + 1) * self.horizon.tick_rate;
        // A point that is not reached does nothing, so only one that is decides.
        let mut reached = [None; 2];
        let mut slot = reached.iter_mut();
        manifold.retain(|point| {
            let (separation, speed) = (widen(point.separation), approach_speed(point));
            if speed.to_bits() < at_passage_min && separation <= speculative {
                return true;
            }
            let closing = speed / self.horizon.tick_rate;
            let kept = separation <= speculative || separation <= closing.saturating_add(speculative);
            // A quarter more: a gap that just closes acts too.
            if kept && closing > PASSAGE_MIN && closing.saturating_add(closing / 4) > separation {
                if let Some(slot) = slot.next() {
                    *slot = Some((separation, closing));
                }
            }
            kept
        });
        if !fast || reached[0].is_none() {
            return;
        }
        let slack = self.slack();
        let shallow = |&&(separation, _): &&(Fx, Fx)| separation >= -slack;
        let closing = reached.iter().flatten().filter(shallow).map(|&(_, closing)| closing).max();
        if closing
            .is_some_and(|closing| self.passes_by((motion_a, motion_b), posed, manifold.normal, closing))
        {
            manifold.retain(|_| false);
        }
    }

    /// Whether one of the shapes lets the other pass through it.
    pub(super) fn lets_pass(
        &self,
        [(a, body_a, posed_a), (b, body_b, posed_b)]: [(&Shape, &Body, &PosedShape); 2],
        manifold: &Manifold,
        was_passing: bool,
    ) -> bool {
        let slack = self.slack();
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
        closing: Fx,
    ) -> bool {
        let rate = self.horizon.tick_rate;
        let velocity = motion_b.velocity_at(posed_b.centre) - motion_a.velocity_at(posed_a.centre);
        let turn = self.a.turn.saturating_add(self.b.turn);
        let shift = Vec2::new(velocity.x / rate, velocity.y / rate).narrow();
        let passage = Passage::new(shift, narrow(turn), narrow(self.slack()), narrow(closing / 8), normal);
        pass_by(posed_a, posed_b, &passage)
    }
}

/// The shape with its direction in world axes, if it is a one-way shape.
fn one_way<'a>(shape: &Shape, body: &Body, posed: &'a PosedShape) -> Option<OneWay<'a>> {
    let direction = shape.one_way().map(|angle| Rot::from_angle(body.angle() + angle).apply(Vec2::X))?;
    Some(OneWay { shape: posed, direction })
}
