//! One tick, as the algorithm reads.

use super::World;
use super::change::fattened;
use super::contacts;
use super::continuous;
use super::events::MoveEvent;
use super::islands;
use super::look_ahead::Motion;
use super::pairs;
use super::scratch::Scratch;
use super::state::State;
use super::stats::{Phase, StepStats};
use super::stress;
use crate::body::{BodyKind, Handle, Pose, WORLD_EXTENT_MAX};
use crate::math::{Angle, Fx, Vec2};
use crate::solver::{SolverBody, Tuning, turn_of};

impl World {
    /// Advances the world by one tick of `1 / tick_rate` seconds.
    pub fn step(&mut self) {
        self.step_observed(|_| {});
    }

    /// [`World::step`], telling an observer which phase begins: what a profile is made of. The engine has no clock.
    ///
    /// ```
    /// # use lockstep2d::world::World;
    /// let mut phases = Vec::new();
    /// World::default().step_observed(|phase| phases.push(phase));
    /// assert_eq!(phases.len(), 7);
    /// ```
    pub fn step_observed(&mut self, mut begin: impl FnMut(Phase)) {
        let World { state, scratch } = self;
        let state = &mut **state;
        let settings = state.config.solver;
        let tuning = Tuning::new(&settings, state.config.gravity, state.config.tick_rate);

        begin(Phase::BroadPhase);
        scratch.roster.refresh(state);
        refit_boxes(state, scratch);
        pairs::update(state, scratch);
        islands::wake_touched(state, scratch);
        scratch.roster.refresh(state);

        begin(Phase::NarrowPhase);
        contacts::find_manifolds(state, scratch);

        begin(Phase::Prepare);
        let Scratch { solver, roster, touching, manifolds, .. } = scratch;
        solver.prepare_bodies(&state.bodies, &roster.bodies, &tuning);
        solver.prepare_joints(&state.joints, &roster.joints, &state.bodies, &tuning);
        solver.prepare_contacts(touching, manifolds, &state.contacts, &state.bodies, &tuning);

        begin(Phase::Solve);
        for index in 0..settings.sub_steps {
            solver.sub_step(
                state.tick.wrapping_mul(settings.sub_steps.into()).wrapping_add(index.into()),
                &tuning,
            );
        }
        solver.apply_restitution(&tuning);
        solver.store_impulses(&mut state.contacts, &mut state.joints);

        begin(Phase::Finalise);
        contacts::report(state, scratch);
        finalise_poses(state, scratch);
        stress::report(state, scratch, &tuning);

        begin(Phase::Sleep);
        islands::fall_asleep(state, scratch);

        begin(Phase::Report);
        report_moves(state, scratch);
        count(state, scratch);
        // A count that a stranger's snapshot may start anywhere.
        state.tick = state.tick.wrapping_add(1);
    }
}

/// Gives every shape that may leave its fat box within the tick a new one.
fn refit_boxes(state: &mut State, scratch: &mut Scratch) {
    let State { bodies, shapes, config, .. } = state;
    for &slot in &scratch.roster.bodies {
        let body = bodies.at(slot);
        let motion = Motion::of(body, config.tick_rate);
        for &id in body.shapes() {
            let posed = scratch.poses.at(id.slot());
            let reach = motion.turn_reach(posed, body).saturating_add(config.speculative_distance);
            let needed = posed.bounds.expanded(reach).swept(motion.shift);
            let fat = &mut shapes.at_mut(id.slot()).fat;
            // A box that a fast shape has left behind would find pairs for ever, so it shrinks as well.
            let roomy = needed.expanded(config.fat_margin.saturating_mul_int(4));
            if !fat.contains(needed) || !roomy.contains(*fat) {
                *fat = fattened(needed, config.fat_margin);
                scratch.broad_phase.set(id.slot(), *fat);
                scratch.changes.shapes.push(id.slot());
                // The box of a kinematic body that has stopped leaves what it rests on.
                scratch.changes.resting |= !body.is_active();
            }
        }
    }
}

/// Moves the bodies to where the solver has brought them, or fast ones as far as nothing stops them.
fn finalise_poses(state: &mut State, scratch: &mut Scratch) {
    let roster = core::mem::take(&mut scratch.roster.bodies);
    let mut swept = core::mem::take(&mut scratch.swept);
    swept.clear();
    scratch.stats.impacts = 0;
    let pose_of =
        |&slot: &u32| Pose { centre: state.bodies.at(slot).centre, angle: state.bodies.at(slot).angle };
    scratch.starts.clear();
    scratch.starts.extend(roster.iter().map(pose_of));
    for &slot in &roster {
        let (pose, turn) = finalise_body(state, scratch, slot);
        match continuous::sweep_of(state, scratch, slot, pose, turn) {
            Some(fast) => swept.push(fast),
            None => move_body(state, scratch, slot, pose),
        }
    }
    scratch.roster.bodies = roster;
    continuous::sweep(state, scratch, &swept);
    scratch.swept = swept;
}

/// Takes over what the solver has found out about a body. Returns where it goes, and how far it turns in units of
/// 2^-32 turns.
fn finalise_body(state: &mut State, scratch: &mut Scratch, slot: u32) -> (Pose, i64) {
    let SolverBody { velocity, spin, shift, turn } = *scratch.solver.body(slot);
    let body = state.bodies.at_mut(slot);
    body.velocity = velocity;
    body.spin = spin;
    body.hold_locked_axes();
    body.force = Vec2::ZERO;
    body.torque = Fx::ZERO;
    if body.kind() == BodyKind::Kinematic && !body.is_moving() && body.rest_ticks == 0 {
        body.rest_ticks = 1;
        scratch.changes.body(body);
    }
    let turn = turn_of(turn, body.mass.inverse_gyration);
    if let Some(target) = body.target.take() {
        body.stop();
        return (target, turn);
    }
    let centre = body.centre + shift.widen();
    let edge = Vec2::new(WORLD_EXTENT_MAX, WORLD_EXTENT_MAX);
    let inside = centre.max(-edge).min(edge);
    scratch.solver.faults += u64::from(inside != centre);
    (Pose { centre: inside, angle: body.angle + Angle::from_wide_turns(turn, Fx::ONE) }, turn)
}

/// Moves a body, its shapes and, where they leave them, their boxes.
pub(super) fn move_body(state: &mut State, scratch: &mut Scratch, slot: u32, pose: Pose) {
    let body = state.bodies.at_mut(slot);
    if (body.centre, body.angle) != (pose.centre, pose.angle) {
        (body.centre, body.angle) = (pose.centre, pose.angle);
        scratch.poses.pose_body(state, state.bodies.at(slot));
        cover_shapes(state, scratch, slot);
    }
}

/// Gives shapes that have left their fat box new ones, so that queries find them where they are.
fn cover_shapes(state: &mut State, scratch: &mut Scratch, slot: u32) {
    let State { bodies, shapes, config, .. } = state;
    for id in bodies.at(slot).shapes() {
        let bounds = scratch.poses.at(id.slot()).bounds;
        let fat = &mut shapes.at_mut(id.slot()).fat;
        if !fat.contains(bounds) {
            *fat = fattened(bounds, config.fat_margin);
            scratch.broad_phase.set(id.slot(), *fat);
            scratch.changes.shapes.push(id.slot());
        }
    }
}

/// Lists the bodies that have moved or fallen asleep.
fn report_moves(state: &State, scratch: &mut Scratch) {
    let Scratch { roster, solver, events, .. } = scratch;
    for &slot in &roster.bodies {
        let (body, solved) = (state.bodies.at(slot), solver.body(slot));
        let fell_asleep = body.is_asleep();
        if fell_asleep || solved.shift != Vec2::ZERO || solved.turn != 0 {
            let (id, position, angle) = (state.bodies.handle_at(slot), body.position(), body.angle());
            events.moved.push(MoveEvent { body: id, position, angle, fell_asleep });
        }
    }
}

fn count(state: &mut State, scratch: &mut Scratch) {
    let Scratch { solver, sat, stats, touching, roster, .. } = scratch;
    let faults = solver.faults + u64::from(state.pairs_left_out);
    state.faults = state.faults.saturating_add(faults);
    let count = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
    *stats = StepStats {
        bodies: count(roster.bodies.len()),
        joints: count(roster.joints.len()),
        pairs: count(state.contacts.len()),
        contacts: count(touching.len()),
        points: solver.warm_starts.points,
        points_kept: solver.warm_starts.kept,
        points_lost: solver.warm_starts.lost,
        axis_hits: sat.hint_hits,
        axis_searches: sat.searches,
        impacts: stats.impacts,
        faults,
    };
}
