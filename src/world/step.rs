//! One tick, as the algorithm reads.

use super::World;
use super::change::fattened;
use super::contacts;
use super::continuous;
use super::islands;
use super::manifolds;
use super::moves;
use super::outlook::{Motion, Way};
use super::pairs;
use super::phases::Sight;
use super::scratch::{Extents, Scratch};
use super::state::State;
use super::stats::{Phase, StepStats};
use super::stress;
use crate::body::{Body, BodyKind, Handle, Pose, WORLD_EXTENT_MAX};
use crate::math::{Aabb, Angle, Fx, Reciprocal, Vec2, fx_mul};
use crate::solver::{SolverBody, Tuning, turn_of};

impl World {
    /// Advances the world by one tick of `1 / tick_rate` seconds.
    pub fn step(&mut self) {
        if self.phases.is_some() {
            self.step_noting_phases();
        } else {
            self.advance(|_, _| {});
        }
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
        self.advance(|phase, _| begin(phase));
    }

    /// The algorithm; `begin` hears of each phase, and sees what it begins with.
    pub(super) fn advance(&mut self, mut begin: impl FnMut(Phase, Sight<'_>)) {
        let World { state, scratch, phases: _ } = self;
        let (state, packed) = state.for_step();
        let settings = state.config.solver;
        let tuning = Tuning::new(&settings, state.config.gravity, state.config.tick_rate);

        begin(Phase::BroadPhase, Sight::of(state, scratch));
        scratch.roster.refresh(state);
        refit_boxes(state, scratch);
        pairs::update(state, scratch);
        islands::wake_touched(state, scratch);
        scratch.roster.refresh(state);

        begin(Phase::NarrowPhase, Sight::of(state, scratch));
        manifolds::find_manifolds(state, scratch);

        begin(Phase::Prepare, Sight::of(state, scratch));
        let Scratch { solver, roster, found, .. } = scratch;
        solver.prepare_bodies(&state.bodies, &roster.bodies, &tuning);
        solver.prepare_joints(&state.joints, &roster.joints, &state.bodies, &tuning);
        solver.prepare_contacts(&found.touching, &found.manifolds, &state.contacts);

        begin(Phase::Solve, Sight { state, solver, roster, found });
        let first_sub_step = state.tick.wrapping_mul(settings.sub_steps.into());
        solver.threads.clone().install(|| {
            for index in 0..settings.sub_steps {
                solver.sub_step(first_sub_step.wrapping_add(index.into()), &tuning);
            }
            solver.apply_restitution(&tuning);
        });
        solver.store_impulses(&mut state.contacts, &mut state.joints);

        begin(Phase::Finalise, Sight::of(state, scratch));
        contacts::report(state, scratch);
        finalise_poses(state, scratch);
        stress::report(state, scratch, &tuning);

        begin(Phase::Sleep, Sight::of(state, scratch));
        islands::fall_asleep(state, scratch);

        begin(Phase::Report, Sight::of(state, scratch));
        moves::report(state, scratch, packed);
        count(state, scratch);
        // A count that a stranger's snapshot may start anywhere.
        state.tick = state.tick.wrapping_add(1);
    }
}

/// Gives every shape that may leave its fat box within the tick a new one.
fn refit_boxes(state: &mut State, scratch: &mut Scratch) {
    let State { bodies, shapes, config, .. } = state;
    let Scratch { roster, poses, broad_phase, changes, refitted, .. } = scratch;
    let per_second = Reciprocal::of_integer(config.tick_rate);
    refitted.clear();
    poses.outlook.begin(bodies.slot_count());
    for &slot in &roster.bodies {
        let body = bodies.at(slot);
        let motion = Motion::of(body, per_second);
        let (shift, turn) = (motion.shift, motion.turned());
        poses.outlook.set_motion(slot, motion);
        let course = Course::of(body, poses.extents(slot), shift, turn, config.speculative_distance);
        for &id in body.shapes() {
            let reach = poses.outlook.reach(id.slot());
            let (bounds, turn_reach) = (reach.bounds, motion.turn_reach(turn, reach));
            poses.outlook.set_reach(id.slot(), shift, turn_reach);
            let needed = course.around(bounds);
            let margin = config.margin_of(bounds);
            let fat = broad_phase.fat(id.slot());
            // A box that a fast shape has left behind would find pairs for ever, so it shrinks as well.
            let roomy = needed.expanded_nearby(margin.wrapping_mul_int(4));
            if !fat.contains(needed) || !roomy.contains(fat) {
                let fat = fattened(needed, margin);
                shapes.at_mut(id.slot()).fat = fat;
                refitted.push((id.slot(), fat));
                changes.shapes.push(id.slot());
                // The box of a kinematic body that has stopped leaves what it rests on.
                changes.resting |= !body.is_active();
            }
        }
    }
    broad_phase.set_many(refitted);
}

/// Where a body may get within a tick at its present velocity. Places are within the world and ways are short, so that no
/// sum overflows.
struct Course {
    /// By how much the lower and the upper corner of a box around its shapes move while it moves, with room for contacts
    /// that are only about to be.
    moved: [Vec2<Fx>; 2],
    /// How far its points move at most because it turns, in metres.
    turned: Vec2<Fx>,
    /// All that its shapes may cover where it is now, however it is turned.
    disc: Aabb,
}

impl Course {
    fn of(body: &Body, extents: Extents, shift: Vec2<Way>, turn: Fx, room: Fx) -> Self {
        let (shift, room) = (shift.widen(), Vec2::new(room, room));
        let turned = fx_mul(turn, extents.reach);
        Course {
            moved: [shift.min(Vec2::ZERO).wrapping_sub(room), shift.max(Vec2::ZERO).wrapping_add(room)],
            turned: Vec2::new(turned, turned),
            disc: Aabb::new(body.centre, body.centre).expanded_nearby(extents.radius),
        }
    }

    /// A box around a shape on its way.
    fn around(&self, bounds: Aabb) -> Aabb {
        let lower = bounds.lower.wrapping_sub(self.turned).max(self.disc.lower);
        let upper = bounds.upper.wrapping_add(self.turned).min(self.disc.upper);
        Aabb::new(lower.wrapping_add(self.moved[0]), upper.wrapping_add(self.moved[1]))
    }
}

/// Moves the bodies to where the solver has brought them, or fast ones as far as nothing stops them.
fn finalise_poses(state: &mut State, scratch: &mut Scratch) {
    let roster = core::mem::take(&mut scratch.roster.bodies);
    let mut bullets = core::mem::take(&mut scratch.bullets);
    bullets.clear();
    scratch.stats.impacts = 0;
    scratch.starts.clear();
    for &slot in &roster {
        let body = state.bodies.at(slot);
        scratch.starts.push(Pose { centre: body.centre, angle: body.angle });
        let (pose, turn) = finalise_body(state, scratch, slot);
        match continuous::sweep_of(state, scratch, slot, pose, turn) {
            None => move_body(state, scratch, slot, pose),
            Some(fast) if fast.is_bullet(state) => bullets.push(fast),
            // Stopped by fixed bodies alone, which are where they were: it need not wait for the others.
            Some(fast) => continuous::sweep(state, scratch, &fast),
        }
    }
    scratch.roster.bodies = roster;
    // In slot order, while everything else is where it will be.
    for bullet in &bullets {
        continuous::sweep(state, scratch, bullet);
    }
    scratch.bullets = bullets;
}

/// Takes over what the solver has found out about a body. Returns where it goes, and how far it turns in units of
/// 2^-32 turns.
fn finalise_body(state: &mut State, scratch: &mut Scratch, slot: u32) -> (Pose, i64) {
    let SolverBody { velocity, spin, shift, turn, .. } = *scratch.solver.body(slot);
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
        return (*target, turn);
    }
    let centre = body.centre + shift.widen();
    let edge = Vec2::new(WORLD_EXTENT_MAX, WORLD_EXTENT_MAX);
    let inside = centre.max(-edge).min(edge);
    scratch.solver.faults += u64::from(inside != centre);
    (Pose { centre: inside, angle: body.angle + Angle::from_turns(Fx::from_bits(turn)) }, turn)
}

/// Moves a body, its shapes and, where they leave them, their boxes.
pub(super) fn move_body(state: &mut State, scratch: &mut Scratch, slot: u32, pose: Pose) {
    let body = state.bodies.at_mut(slot);
    let (by, turned) = (pose.centre - body.centre, pose.angle != body.angle);
    if turned || by != Vec2::ZERO {
        (body.centre, body.angle) = (pose.centre, pose.angle);
        let body = state.bodies.at(slot);
        if turned {
            scratch.poses.move_body(state, body);
        } else {
            scratch.poses.shift_body(body, by);
        }
        cover_shapes(state, scratch, slot);
    }
}

/// Gives shapes that have left their fat box new ones, so that queries find them where they are.
fn cover_shapes(state: &mut State, scratch: &mut Scratch, slot: u32) {
    let State { bodies, shapes, config, .. } = state;
    for id in bodies.at(slot).shapes() {
        let bounds = scratch.poses.at(id.slot()).bounds;
        if !scratch.broad_phase.fat(id.slot()).contains(bounds) {
            let fat = fattened(bounds, config.margin_of(bounds));
            shapes.at_mut(id.slot()).fat = fat;
            scratch.broad_phase.set(id.slot(), fat);
            scratch.changes.shapes.push(id.slot());
        }
    }
}

fn count(state: &mut State, scratch: &mut Scratch) {
    let Scratch { solver, stats, found, roster, .. } = scratch;
    let faults = solver.faults + u64::from(state.pairs_left_out);
    state.faults = state.faults.saturating_add(faults);
    let count = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
    *stats = StepStats {
        bodies: count(roster.bodies.len()),
        joints: count(roster.joints.len()),
        pairs: count(state.contacts.len()),
        contacts: count(found.touching.len()),
        points: solver.warm_starts.points,
        points_kept: solver.warm_starts.kept,
        points_lost: solver.warm_starts.lost,
        axis_hits: found.sat.hint_hits,
        axis_searches: found.sat.searches,
        impacts: stats.impacts,
        faults,
    };
}
