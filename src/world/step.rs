//! One tick, as the algorithm reads.

use super::World;
use super::look_ahead::{Approach, Motion};
use super::scratch::Scratch;
use super::state::State;
use super::stats::StepStats;
use crate::body::{BodyKind, Handle, WORLD_EXTENT_MAX};
use crate::collision::{Manifold, Pair, Proxy, collide, match_pairs};
use crate::math::{Fx, Vec2, widen};
use crate::solver::{SolverBody, Surface, TouchingPair, Tuning, turned};

impl World {
    /// Advances the world by one tick of `1 / tick_rate` seconds.
    pub fn step(&mut self) {
        let World { state, scratch } = self;
        let settings = state.config.solver;
        let tuning = Tuning::new(&settings, state.config.gravity, state.config.tick_rate);

        scratch.poses.ensure(state);
        if refit_boxes(state, scratch) | core::mem::take(&mut scratch.pairs_changed) {
            update_pairs(state, scratch);
        }
        find_manifolds(state, scratch);

        scratch.solver.prepare_bodies(&state.bodies, &tuning);
        scratch.solver.prepare_joints(&state.joints, &state.bodies);
        let Scratch { solver, touching, manifolds, .. } = scratch;
        solver.prepare_contacts(touching, manifolds, &state.contacts, &state.bodies, &tuning);
        for index in 0..settings.sub_steps {
            solver.sub_step(
                state.tick.wrapping_mul(settings.sub_steps.into()).wrapping_add(index.into()),
                &tuning,
            );
        }
        solver.apply_restitution(&tuning);
        solver.store_impulses(&mut state.contacts, &mut state.joints);

        report_events(state, scratch);
        finalise_poses(state, scratch);
        count(state, scratch);
        // A count that a stranger's snapshot may start anywhere.
        state.tick = state.tick.wrapping_add(1);
    }
}

/// Gives every shape that may leave its fat box within the tick a new one. Says whether any changed.
fn refit_boxes(state: &mut State, scratch: &Scratch) -> bool {
    let State { bodies, shapes, config, .. } = state;
    let mut changed = false;
    for (_, body) in bodies.iter().filter(|(_, body)| body.kind() != BodyKind::Fixed) {
        let motion = Motion::of(body, config.tick_rate);
        for &id in body.shapes() {
            let posed = scratch.poses.at(id.slot());
            let reach = motion.turn_reach(posed, body).saturating_add(config.speculative_distance);
            let needed = posed.bounds.expanded(reach).swept(motion.shift);
            let fat = &mut shapes.at_mut(id.slot()).fat;
            // A box that a fast shape has left behind would find pairs for ever, so it shrinks as well.
            let roomy = needed.expanded(config.fat_margin.saturating_mul_int(4));
            if !fat.contains(needed) || !roomy.contains(*fat) {
                *fat = needed.expanded(config.fat_margin);
                changed = true;
            }
        }
    }
    changed
}

/// Broad phase: brings the contacts in line with the pairs of fat boxes.
fn update_pairs(state: &mut State, scratch: &mut Scratch) {
    let Scratch { broad_phase, proxies, pairs, joined, merged, ended, sources, hints, old_hints, .. } =
        scratch;
    proxies.clear();
    proxies.extend(state.shapes.iter().map(|(id, shape)| Proxy { slot: id.slot(), fat: shape.fat }));
    joined.clear();
    let keeping_apart = state.joints.iter().filter(|(_, joint)| !joint.def().collide_connected());
    joined.extend(keeping_apart.map(|(_, joint)| {
        let (a, b) = joint.def().bodies();
        (a.slot().min(b.slot()), a.slot().max(b.slot()))
    }));
    joined.sort_unstable();
    let limit = state.config.pair_limit as usize;
    state.pairs_left_out = broad_phase.pairs(proxies, |pair| may_collide(state, joined, pair), limit, pairs);
    match_pairs(&mut state.contacts, pairs, merged, sources, ended);

    core::mem::swap(hints, old_hints);
    hints.clear();
    let hint_of = |&source: &u32| old_hints.get(source as usize).copied().unwrap_or_default();
    hints.extend(sources.iter().map(hint_of));
}

/// Whether two shapes may have a contact: they are of different bodies, one of which is dynamic, no joint keeps
/// these apart, and their filters accept each other.
pub(super) fn may_collide(state: &State, joined: &[Pair], (a, b): Pair) -> bool {
    let (shape_a, shape_b) = (state.shapes.at(a), state.shapes.at(b));
    let (slot_a, slot_b) = (shape_a.body().slot(), shape_b.body().slot());
    if slot_a == slot_b || !shape_a.filter().accepts(shape_b.filter()) {
        return false;
    }
    let (body_a, body_b) = (state.bodies.at(slot_a), state.bodies.at(slot_b));
    let moved = body_a.is_dynamic() || body_b.is_dynamic();
    moved && joined.binary_search(&(slot_a.min(slot_b), slot_a.max(slot_b))).is_err()
}

/// Narrow phase: a manifold for every contact, and the list of those that have points.
fn find_manifolds(state: &mut State, scratch: &mut Scratch) {
    scratch.hints.resize(state.contacts.len(), Default::default());
    scratch.manifolds.clear();
    scratch.touching.clear();
    scratch.sat = Default::default();
    let mut contacts = core::mem::take(&mut state.contacts);
    for (index, contact) in (0u32..).zip(&mut contacts) {
        let (a, b) = contact.shapes;
        let (posed_a, posed_b) = (scratch.poses.at(a), scratch.poses.at(b));
        let (shape_a, shape_b) = (state.shapes.at(a), state.shapes.at(b));
        let (slot_a, slot_b) = (shape_a.body().slot(), shape_b.body().slot());
        let (body_a, body_b) = (state.bodies.at(slot_a), state.bodies.at(slot_b));
        let approach = Approach::new(state, (body_a, posed_a), (body_b, posed_b));
        let hint = &mut scratch.hints[index as usize];
        let mut manifold = collide(posed_a, posed_b, approach.margin, hint, &mut scratch.sat);
        contact.passing = approach.lets_pass((shape_a, shape_b), &manifold, contact.passing);
        if contact.passing {
            manifold = Manifold::NONE;
        }
        approach.keep_reachable(&mut manifold);
        if !manifold.points().is_empty() {
            let surface = Surface::between(
                (shape_a.material(), posed_a.outline.radius()),
                (shape_b.material(), posed_b.outline.radius()),
            );
            scratch.touching.push(TouchingPair { contact: index, bodies: (slot_a, slot_b), surface });
        }
        scratch.manifolds.push(manifold);
    }
    state.contacts = contacts;
}

/// Turns changes of touching into events. A pair touches if it is near at the start of the tick, or if the solver
/// has pushed it apart since: a fast bounce may begin and end between two ticks.
fn report_events(state: &mut State, scratch: &mut Scratch) {
    let Scratch { events, manifolds, ended, solver, .. } = scratch;
    events.clear();
    events.contact_end.append(&mut state.removed_contacts);
    let gone = ended.iter().filter(|contact| contact.touching);
    events.contact_end.extend(gone.map(|contact| state.contact_event(contact)));
    ended.clear();
    let (near, apart) = (state.config.touching_distance(), state.config.speculative_distance);
    let mut contacts = core::mem::take(&mut state.contacts);
    for (index, (contact, manifold)) in contacts.iter_mut().zip(manifolds.iter()).enumerate() {
        let separation = manifold.points().iter().map(|point| widen(point.separation)).min();
        let within = |distance: Fx| separation.is_some_and(|separation| separation <= distance);
        let touching = solver.pushed[index] || within(if contact.touching { apart } else { near });
        if touching != contact.touching {
            contact.touching = touching;
            let list = if touching { &mut events.contact_begin } else { &mut events.contact_end };
            list.push(state.contact_event(contact));
        }
        if separation.is_none() {
            contact.clear_points();
        }
    }
    state.contacts = contacts;
    events.contact_end.sort_unstable();
}

/// Moves the bodies to where the solver has brought them.
fn finalise_poses(state: &mut State, scratch: &mut Scratch) {
    let mut faults = 0;
    for (id, body) in state.bodies.iter_mut().filter(|(_, body)| body.kind() != BodyKind::Fixed) {
        let SolverBody { velocity, spin, shift, turn } = scratch.solver.bodies[id.slot() as usize];
        body.velocity = velocity;
        body.spin = spin;
        body.force = Vec2::ZERO;
        body.torque = Fx::ZERO;
        let centre = body.centre + shift.widen();
        body.centre = centre
            .max(Vec2::new(-WORLD_EXTENT_MAX, -WORLD_EXTENT_MAX))
            .min(Vec2::new(WORLD_EXTENT_MAX, WORLD_EXTENT_MAX));
        faults += u64::from(body.centre != centre);
        body.angle = turned(body.angle, turn, body.mass.inverse_gyration);
    }
    scratch.solver.faults += faults;
    for (id, body) in state.bodies.iter() {
        let SolverBody { shift, turn, .. } = scratch.solver.bodies[id.slot() as usize];
        // A body at rest outside the world is put back too.
        if shift != Vec2::ZERO || turn != 0 || faults > 0 {
            scratch.poses.pose_body(state, body);
        }
    }
}

fn count(state: &mut State, scratch: &mut Scratch) {
    let Scratch { solver, sat, stats, touching, .. } = scratch;
    let faults = solver.faults + u64::from(state.pairs_left_out);
    state.faults = state.faults.saturating_add(faults);
    let count = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
    *stats = StepStats {
        pairs: count(state.contacts.len()),
        contacts: count(touching.len()),
        points: solver.warm_starts.points,
        points_kept: solver.warm_starts.kept,
        points_lost: solver.warm_starts.lost,
        axis_hits: sat.hint_hits,
        axis_searches: sat.searches,
        faults,
    };
}
