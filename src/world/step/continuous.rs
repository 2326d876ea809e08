//! Continuous collision: fast bodies are swept from their old pose to the one that the solver has computed. They stop
//! where they first overlap too deeply with a shape that they might otherwise pass through.
//!
//! Speculative contacts stop most fast bodies. The sweep also stops bodies whose motion these contacts cannot predict,
//! such as rotating rods and bodies that gain speed within the tick. A stopped body keeps its velocity and continues in
//! the next tick.
//!
//! Bodies with [`Continuous::Kinematic`] are also swept against kinematic bodies, once these have been moved. Whether
//! such a body is fast is judged relative to the kinematic body, so that a body on a platform or in a drum is not held
//! back. A kinematic body that stops a body carries it for the rest of the tick. If such a body sleeps, it wakes in the
//! tick in which a kinematic body would pass through it.

use core::ops::ControlFlow;

use super::motion::{at_start, made_motion, predicted_motion};
use crate::body::{Body, BodyKind, Continuous, Handle, Pose, WORLD_EXTENT_MAX};
use crate::collision::{
    Pair, SupportShape, Sweep, TimeOfImpact, is_open, normal_at, pass_direction, time_of_impact,
};
use crate::fx;
use crate::math::{Aabb, Angle, Fx, Unit, Vec2, fx_mul};
use crate::world::cache::{Extents, MotionCache, Scratch, SweptBody, WorkMeter};
use crate::world::movement::move_body;
use crate::world::state::State;

/// A body is not fast, however thin it is, if none of its points moves further than this distance, in metres, in a
/// tick.
const SWEPT_MIN: Fx = fx!(0.0005);

/// Work units of a search for a time of impact, which takes some 2 µs, or up to 10 µs for long thin shapes that rotate.
const IMPACT_WORK: u64 = 16;

/// Number of shapes near a sweep that together cost one work unit.
const VISITS_PER_WORK: u64 = 8;

/// The sweep of a body that may be fast. A body is fast if one of its points may move further than both [`SWEPT_MIN`]
/// and half of the inner radius of its thinnest solid shape. `turn` is in units of 2^-32 turns.
pub(super) fn swept_body(
    slot: u32,
    body: &Body,
    extents: &Extents,
    end: Pose,
    turn: i64,
    may_have_kinematic: bool,
) -> Option<SweptBody> {
    if !body.is_dynamic() || body.settings.continuous == Continuous::Off {
        return None;
    }
    let limit = SWEPT_MIN.max(extents.core / 2);
    let shift = end.centre - body.centre;
    let turned = match turn {
        0 => Fx::ZERO,
        _ => fx_mul(Angle::turns_to_radians(turn).saturating_abs(), extents.reach),
    };
    let is_fast = shift.is_longer_than(limit.saturating_sub(turned));
    let may_be_relative = sees_kinematic(body) && may_have_kinematic;
    (is_fast || may_be_relative).then_some(SweptBody {
        slot,
        sweep: Sweep { start: body.centre, end: end.centre, turn },
        end,
        is_fast,
    })
}

/// Whether a body is fast relative to a kinematic body.
fn is_fast_relative(extents: &Extents, &Sweep { start, end, turn }: &Sweep, obstacle: &Sweep) -> bool {
    let limit = SWEPT_MIN.max(extents.core / 2);
    let shift = end - carried(obstacle, start, Fx::ZERO);
    let turned = Angle::turns_to_radians(turn.saturating_sub(obstacle.turn)).saturating_abs();
    shift.is_longer_than(limit.saturating_sub(fx_mul(turned, extents.reach)))
}

/// Position of a point at the end of the tick, if a body carries it from a fraction of the tick on.
fn carried(sweep: &Sweep, point: Vec2<Fx>, fraction: Fx) -> Vec2<Fx> {
    let (before, turned_before) = sweep.at(fraction);
    let (after, turned_after) = sweep.at(Fx::ONE);
    let local = turned_before.apply_inverse_wide(point - sweep.start - before);
    sweep.start + after + turned_after.apply_wide(local)
}

pub(super) fn sweep(state: &mut State, scratch: &mut Scratch, swept: &SweptBody) {
    let mut meter = scratch.meter;
    let (pose, is_impact) = swept_pose(state, scratch, swept, &mut meter);
    scratch.meter = meter;
    scratch.results.stats.impacts += u32::from(is_impact);
    move_body(state, scratch, swept.slot, pose);
}

/// The pose after the sweep, and whether there is an impact.
pub(super) fn swept_pose(
    state: &State,
    scratch: &Scratch,
    swept: &SweptBody,
    meter: &mut WorkMeter,
) -> (Pose, bool) {
    let impact = first_impact(state, scratch, swept, meter);
    (impact.map_or(swept.end, |impact| pose_after(state, scratch, swept, impact)), impact.is_some())
}

/// The impact on an obstacle, ordered by fraction, then by the slot of the obstacle's shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Impact {
    fraction: Fx,
    obstacle: u32,
}

/// The pose of a body after an impact. A kinematic obstacle carries the body for the rest of the tick. A dynamic
/// obstacle does not.
fn pose_after(state: &State, scratch: &Scratch, swept: &SweptBody, impact: Impact) -> Pose {
    let Sweep { start, end, turn } = swept.sweep;
    let body = state.bodies.at(swept.slot);
    let mut angle = body.angle + Angle::from_wide_turns(turn, impact.fraction);
    let mut centre = start + (end - start).scale(impact.fraction);
    if state.body_of(impact.obstacle).kind() == BodyKind::Kinematic {
        let (_, obstacle) = obstacle_of(state, scratch, impact.obstacle);
        let rest = Fx::ONE - impact.fraction;
        if sees_kinematic(body) {
            centre = carried(&obstacle, centre, impact.fraction);
            angle += Angle::from_wide_turns(obstacle.turn, rest);
        } else {
            centre += (obstacle.end - obstacle.start).scale(rest);
        }
        let locks = body.settings.locks;
        centre.x = if locks.x { start.x } else { centre.x };
        centre.y = if locks.y { start.y } else { centre.y };
        angle = if body.turns() { angle } else { body.angle };
    }
    let edge = Vec2::new(WORLD_EXTENT_MAX, WORLD_EXTENT_MAX);
    Pose { centre: centre.max(-edge).min(edge), angle }
}

/// The first obstacle on a sweep. An exhausted meter ends the search early.
fn first_impact(
    state: &State,
    scratch: &Scratch,
    swept: &SweptBody,
    meter: &mut WorkMeter,
) -> Option<Impact> {
    let shapes = &scratch.shapes;
    let body = state.bodies.at(swept.slot);
    let sees_moving = is_bullet(body) || sees_kinematic(body);
    let extents = shapes.poses().extents(swept.slot);
    // Box around the body's shapes at the start of the sweep, at any rotation.
    let disc = Aabb::new(body.centre, body.centre).expanded(extents.radius);
    let mut first: Option<Impact> = None;
    for id in body.shapes() {
        if meter.is_exhausted() {
            return None;
        }
        let mut visited = 0u64;
        let motion = shapes.motion();
        if motion.shape(id.slot()).sensor {
            continue;
        }
        let posed = shapes.poses().at(id.slot());
        // Lazy, because most fast bodies are far from all obstacles.
        let mut support_and_target = None;
        let start = if swept.sweep.turn == 0 { posed.bounds } else { disc };
        let area = start.swept(swept.sweep.end - swept.sweep.start);
        let visit = |other| {
            visited += 1;
            let other_shape = motion.shape(other);
            let obstacle = state.bodies.at(other_shape.body);
            // A moving obstacle was somewhere else during the tick: its current bounds do not rule it out.
            let is_near =
                other_shape.bounds.overlaps(area) || (sees_moving && obstacle.kind() != BodyKind::Fixed);
            if is_near && stops(body, obstacle) && may_stop(state, scratch, id.slot(), other) {
                let (there, movement) = obstacle_of(state, scratch, other);
                let is_fast = match obstacle.kind() {
                    BodyKind::Kinematic if !is_bullet(body) => {
                        is_fast_relative(&extents, &swept.sweep, &movement)
                    }
                    _ => swept.is_fast,
                };
                if !is_fast {
                    return ControlFlow::Continue(());
                }
                let &mut (support, target) = support_and_target.get_or_insert_with(|| {
                    let support = SupportShape::of(posed, body.centre);
                    (support, target_of(&support))
                });
                if !shapes.poses().at(other).is_solid_from(body.centre + support.middle()) {
                    return ControlFlow::Continue(());
                }
                if !meter.spend(IMPACT_WORK) {
                    return ControlFlow::Break(());
                }
                let stopping = stop(
                    state,
                    motion,
                    [other, id.slot()],
                    (&there, &movement),
                    (&support, &swept.sweep),
                    target,
                );
                let impact = stopping.map(|fraction| Impact { fraction, obstacle: other });
                first = first.into_iter().chain(impact).min();
            }
            ControlFlow::Continue(())
        };
        if sees_moving {
            shapes.broad_phase().each_overlap(area, visit);
        } else {
            shapes.broad_phase().each_overlap_of(true, area, visit);
        }
        // Counts the visits only after the search, which may therefore exceed the budget. One search visits each shape
        // of the world at most once.
        meter.spend(1 + visited / VISITS_PER_WORK);
    }
    first
}

/// Separation, in metres, at which [`time_of_impact`] stops a shape. It is negative: the shape overlaps the obstacle by
/// a quarter of the shape's inner radius, but by at most 5 mm.
fn target_of(support: &SupportShape) -> Fx {
    -(support.inner_radius() / 4).min(fx!(0.005))
}

/// Fraction of the tick at which an obstacle stops a shape. `shapes` are the slots of the obstacle and of the shape.
fn stop(
    state: &State,
    motion: &MotionCache,
    shapes: [u32; 2],
    (there, movement): (&SupportShape, &Sweep),
    (support, sweep): (&SupportShape, &Sweep),
    target: Fx,
) -> Option<Fx> {
    let fraction = match time_of_impact(there, movement, support, sweep, target) {
        TimeOfImpact::Hit { fraction } => Some(fraction),
        // The shapes do not touch before this fraction. A fraction of 0 is ignored, so that the body does not get
        // stuck.
        TimeOfImpact::Failed { fraction } => Some(fraction).filter(|&fraction| fraction > 0),
        TimeOfImpact::Separated | TimeOfImpact::Overlapped => None,
    };
    fraction.filter(|&fraction| {
        !has_one_way(motion, shapes) || {
            let normal = normal_at((there, movement), (support, sweep), fraction);
            normal.is_none_or(|normal| !lets_pass(state, shapes, normal))
        }
    })
}

/// Whether a kinematic body passes over a sleeping body that has to wake for it. The sleeping body has to wake if a
/// sweep would stop it in the awake state.
pub(super) fn wakes(state: &State, scratch: &mut Scratch, (a, b): Pair) -> bool {
    let (own, other) = if state.body_of(a).is_asleep() { (a, b) } else { (b, a) };
    let (body, obstacle) = (state.body_of(own), state.body_of(other));
    let is_swept = state.config.continuous && sees_kinematic(body) && obstacle.kind() == BodyKind::Kinematic;
    if !is_swept || !may_stop(state, scratch, own, other) {
        return false;
    }
    let [slot, other_slot] = [own, other].map(|shape| state.shapes.at(shape).body().slot());
    let Scratch { shapes, meter, .. } = scratch;
    let poses = shapes.poses();
    let (rest, movement) = (Sweep::fixed(body.centre), predicted_motion(state, other_slot));
    let support = SupportShape::of(poses.at(own), body.centre);
    let may_meet = is_fast_relative(&poses.extents(slot), &rest, &movement)
        && poses.at(other).is_solid_from(body.centre + support.middle());
    may_meet && meter.spend(IMPACT_WORK) && {
        let there = SupportShape::of(poses.at(other), obstacle.centre);
        let target = target_of(&support);
        stop(state, poses.motion(), [other, own], (&there, &movement), (&support, &rest), target).is_some()
    }
}

/// A shape at the start of the tick, relative to its body's centre, and the movement of the body within the tick.
fn obstacle_of(state: &State, scratch: &Scratch, shape: u32) -> (SupportShape, Sweep) {
    let body = state.body_of(shape);
    let support = SupportShape::of(scratch.shapes.poses().at(shape), body.centre);
    if body.kind() == BodyKind::Fixed {
        return (support, Sweep::fixed(body.centre));
    }
    let mut movement = made_motion(state, scratch, state.shapes.at(shape).body().slot());
    if body.is_dynamic() {
        // A dynamic body may turn several times within a tick. A sweep against it would need too many steps.
        movement.turn = Angle::from_turns(Fx::from_bits(movement.turn)).to_turns().to_bits();
    }
    (at_start(support, &movement), movement)
}

fn stops(body: &Body, obstacle: &Body) -> bool {
    match obstacle.kind() {
        BodyKind::Fixed => true,
        BodyKind::Kinematic if sees_kinematic(body) => true,
        BodyKind::Kinematic | BodyKind::Dynamic => is_bullet(body) && !is_bullet(obstacle),
    }
}

pub(super) fn sees_kinematic(body: &Body) -> bool {
    body.settings.continuous == Continuous::Kinematic
}

/// Bullets are also swept against moving bodies that are not bullets.
pub(super) fn is_bullet(body: &Body) -> bool {
    body.settings.continuous == Continuous::Bullet
}

fn may_stop(state: &State, scratch: &Scratch, a: u32, b: u32) -> bool {
    let pair = (a.min(b), a.max(b));
    let is_passing = || {
        if !has_one_way(scratch.shapes.motion(), [a, b]) {
            return false;
        }
        let found = state.contacts.binary_search_by_key(&pair, |contact| contact.shapes);
        found.is_ok_and(|index| state.contacts[index].passing)
    };
    !state.shapes.at(b).is_sensor() && scratch.pairs.non_colliding.may_touch(state, pair) && !is_passing()
}

fn has_one_way(motion: &MotionCache, shapes: [u32; 2]) -> bool {
    shapes.into_iter().any(|shape| motion.shape(shape).one_way)
}

/// Whether one of two shapes is a one-way shape that lets the other one pass. The normal points from A to B.
fn lets_pass(state: &State, [a, b]: [u32; 2], normal: Vec2<Unit>) -> bool {
    let is_open_to = |shape: u32, normal: Vec2<Unit>| {
        let direction = state.shapes.at(shape).one_way();
        direction.is_some_and(|angle| is_open(pass_direction(state.body_of(shape).angle + angle), normal))
    };
    is_open_to(a, normal) || is_open_to(b, -normal)
}
