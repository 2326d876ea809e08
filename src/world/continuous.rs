//! Continuous collision: fast bodies are swept from where they were to where the solver has brought them, and stop
//! where they first come too deep into something that they might pass through.
//!
//! Speculative contacts already stop most of what is fast; this catches what they cannot foresee, such as turning
//! rods and speed gained within the tick. A body that is stopped keeps its velocity and goes on in the next tick,
//! when the contact is there from the start. It loses the rest of its movement, so that time seems to stand still for
//! it for part of a tick.

use super::pairs::may_touch;
use super::scratch::Scratch;
use super::state::State;
use super::step::move_body;
use crate::body::{Body, BodyKind, Continuous, Handle, Pose, WORLD_EXTENT_MAX};
use crate::collision::{Core, Sweep, TimeOfImpact, time_of_impact};
use crate::fx;
use crate::math::{Aabb, Angle, Fx, Rot, Vec2, fx_mul};

/// A body that has not been moved yet, because it may have moved too far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Swept {
    slot: u32,
    sweep: Sweep,
    end: Pose,
}

impl Swept {
    /// Whether it is swept against what moves as well, and so after that has been moved.
    pub(super) fn is_bullet(&self, state: &State) -> bool {
        is_bullet(state.bodies.at(self.slot))
    }
}

/// A body that moves less than this in a tick, in metres, is not swept however thin it is.
const SWEPT_MIN: Fx = fx!(0.0005);

/// The sweep of a body, if it moves so far that it may pass through something: some point of it more than half of the
/// radius inside its thinnest shape.
pub(super) fn sweep_of(state: &State, scratch: &Scratch, slot: u32, end: Pose, turn: i64) -> Option<Swept> {
    let body = state.bodies.at(slot);
    if !state.config.continuous || !body.is_dynamic() || body.settings.continuous == Continuous::Off {
        return None;
    }
    let extents = scratch.poses.extents(slot);
    let limit = SWEPT_MIN.max(extents.core / 2);
    let shift = end.centre - body.centre;
    let turned = match turn {
        0 => Fx::ZERO,
        _ => fx_mul(Angle::turns_to_radians(turn).saturating_abs(), extents.reach),
    };
    let fast = shift.is_longer_than(limit.saturating_sub(turned));
    fast.then_some(Swept { slot, sweep: Sweep { start: body.centre, end: end.centre, turn }, end })
}

/// Moves a fast body as far as it can go.
pub(super) fn sweep(state: &mut State, scratch: &mut Scratch, swept: &Swept) {
    let impact = first_impact(state, scratch, swept);
    let pose = impact.map_or(swept.end, |impact| pose_after(state, scratch, swept, impact));
    scratch.stats.impacts += u32::from(impact.is_some());
    move_body(state, scratch, swept.slot, pose);
}

/// What stops a body, and at which fraction of the tick. Of two at the same time, the one in the smaller slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Impact {
    fraction: Fx,
    /// The shape that it meets.
    obstacle: u32,
}

/// Where an impact leaves a body: where it is met, and from there along with what is kinematic, which does not wait for
/// it. A dynamic obstacle has moved because of the impact.
fn pose_after(state: &State, scratch: &Scratch, swept: &Swept, impact: Impact) -> Pose {
    let Sweep { start, end, turn } = swept.sweep;
    let angle = state.bodies.at(swept.slot).angle + Angle::from_wide_turns(turn, impact.fraction);
    let mut centre = start + (end - start).scale(impact.fraction);
    if state.body_of(impact.obstacle).kind() == BodyKind::Kinematic {
        let (_, obstacle) = obstacle_of(state, scratch, impact.obstacle);
        centre += (obstacle.end - obstacle.start).scale(Fx::ONE - impact.fraction);
    }
    let edge = Vec2::new(WORLD_EXTENT_MAX, WORLD_EXTENT_MAX);
    Pose { centre: centre.max(-edge).min(edge), angle }
}

/// What first stops a body on its way.
fn first_impact(state: &State, scratch: &Scratch, swept: &Swept) -> Option<Impact> {
    let body = state.bodies.at(swept.slot);
    // All that its shapes cover where it starts, however it is turned.
    let disc = Aabb::new(body.centre, body.centre).expanded(scratch.poses.extents(swept.slot).radius);
    let mut first: Option<Impact> = None;
    for id in body.shapes() {
        let outlook = &scratch.poses.outlook;
        if outlook.reach(id.slot()).sensor {
            continue;
        }
        let posed = scratch.poses.at(id.slot());
        // Found when the first obstacle is: most fast bodies are far from any.
        let mut known = None;
        let start = if swept.sweep.turn == 0 { posed.bounds } else { disc };
        let area = start.swept(swept.sweep.end - swept.sweep.start);
        let is_bullet = is_bullet(body);
        let obstacles = if is_bullet { &scratch.broad_phase } else { &scratch.fixed };
        obstacles.each_overlap(area, |other| {
            let reach = outlook.reach(other);
            let obstacle = state.bodies.at(reach.body);
            // What moves is not where it was on the way.
            let near = reach.bounds.overlaps(area) || (is_bullet && obstacle.kind() != BodyKind::Fixed);
            let solid = near && scratch.poses.at(other).is_solid_from(posed.centre);
            if solid && stops(body, obstacle) && may_stop(state, scratch, id.slot(), other) {
                let (there, movement) = obstacle_of(state, scratch, other);
                let &mut (core, target) = known.get_or_insert_with(|| {
                    let core = Core::of(posed, body.centre);
                    // Half as deep as it would have to be for its centre to be on the surface, but not more than 5 mm.
                    (core, -(core.inner_radius() / 4).min(fx!(0.005)))
                });
                let fraction = match time_of_impact((&there, &movement), (&core, &swept.sweep), target) {
                    TimeOfImpact::Hit { fraction } => Some(fraction),
                    // Never so late that something may have been passed, but a body has to go on.
                    TimeOfImpact::Failed { fraction } => Some(fraction).filter(|&fraction| fraction > 0),
                    TimeOfImpact::Separated | TimeOfImpact::Overlapped => None,
                };
                let impact = fraction.map(|fraction| Impact { fraction, obstacle: other });
                first = first.into_iter().chain(impact).min();
            }
            core::ops::ControlFlow::Continue(())
        });
    }
    first
}

/// A shape as it was posed at the start of the tick about its body's centre, and the movement of that body.
fn obstacle_of(state: &State, scratch: &Scratch, shape: u32) -> (Core, Sweep) {
    let body = state.body_of(shape);
    let core = Core::of(scratch.poses.at(shape), body.centre);
    let stands = (core, Sweep::fixed(body.centre));
    if body.kind() == BodyKind::Fixed {
        return stands;
    }
    let slot = state.shapes.at(shape).body().slot();
    let Ok(index) = scratch.roster.bodies.binary_search(&slot) else { return stands };
    let start = scratch.starts[index];
    // The shorter way round: what turns more than half a turn in a tick is not seen to.
    let turn = (body.angle - start.angle).to_turns().to_bits();
    let core = core.rotated(Rot::from_angle(start.angle - body.angle));
    (core, Sweep { start: start.centre, end: body.centre, turn })
}

/// Whether a body is swept against another.
fn stops(body: &Body, obstacle: &Body) -> bool {
    obstacle.kind() == BodyKind::Fixed || (is_bullet(body) && !is_bullet(obstacle))
}

fn is_bullet(body: &Body) -> bool {
    body.settings.continuous == Continuous::Bullet
}

fn may_stop(state: &State, scratch: &Scratch, a: u32, b: u32) -> bool {
    let pair = (a.min(b), a.max(b));
    // Whether a one-way shape lets the other pass was decided at the start of the tick.
    let passing = || {
        if ![a, b].iter().any(|&shape| scratch.poses.outlook.reach(shape).one_way) {
            return false;
        }
        let known = state.contacts.binary_search_by_key(&pair, |contact| contact.shapes);
        known.is_ok_and(|index| state.contacts[index].passing)
    };
    !state.shapes.at(b).is_sensor() && may_touch(state, &scratch.joined, pair) && !passing()
}
