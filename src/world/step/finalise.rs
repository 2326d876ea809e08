use super::continuous;
use crate::body::{Arena, ArenaRange, Body, BodyKind, Handle, Pose, Shape, ShapeId, WORLD_EXTENT_MAX};
use crate::collision::BroadPhase;
use crate::math::{Angle, Fx, Vec2};
use crate::solver::{Faults, Solver, SolverBody, turn_of};
use crate::threads::split_at_ends;
use crate::world::cache::{Extents, Finalised, PoseRange, Scratch, SweptBody};
use crate::world::movement::{cover_shape, move_body};
use crate::world::state::State;

/// Moves the awake bodies. Fast bodies stop at their first impact.
pub(super) fn finalise_poses(state: &mut State, scratch: &mut Scratch) {
    scratch.results.stats.impacts = 0;
    scratch.sweeps.relative.clear();
    scratch.sweeps.bullets.clear();
    scratch.sweeps.left_boxes.clear();
    let starts = scratch.awake.bodies().len();
    scratch.sweeps.starts.resize(starts, Pose { centre: Vec2::ZERO, angle: Angle::ZERO });
    scratch.solver.faults +=
        run_shares(state, scratch, |share, slots, sources| share.finalise_bodies(slots, sources));
    if scratch.solver.parts > 1 {
        sweep_bodies(state, scratch);
        run_shares(state, scratch, |share, _, sources| share.move_stopped(sources));
    }
    let finalised = core::mem::take(&mut scratch.finalised);
    finalised.iter().for_each(|finalised| complete(state, scratch, finalised));
    scratch.finalised = finalised;
    for index in 0..scratch.sweeps.relative.len() {
        let body = scratch.sweeps.relative[index];
        continuous::sweep(state, scratch, &body);
    }
    // Bullets can be stopped by bodies that move, so they are swept after all other bodies, in slot order.
    for index in 0..scratch.sweeps.bullets.len() {
        let bullet = scratch.sweeps.bullets[index];
        continuous::sweep(state, scratch, &bullet);
    }
}

fn run_shares(
    state: &mut State,
    scratch: &mut Scratch,
    work: impl Fn(&mut FinaliseShare<'_>, &[u32], &Sources<'_>) -> Faults + Sync,
) -> Faults {
    let Scratch { awake, shapes: cache, solver, finalised, sweeps, .. } = scratch;
    let shares = awake.shares(state, solver.parts);
    finalised.resize_with(shares.len(), Finalised::default);
    let starts = shares.iter().scan(0, |end, share| {
        *end += share.bodies.len();
        Some(*end)
    });
    let starts = split_at_ends(&mut sweeps.starts, starts);
    let State { bodies, shapes, config, .. } = state;
    let bodies = bodies.split(shares.iter().map(|share| share.ends[0]));
    let (poses, extents, broad_phase) = cache.split(shares.iter().map(|share| share.ends[1]));
    let is_continuous = config.continuous;
    let may_have_kinematic = awake.may_have_kinematic();
    let sources = Sources { shapes, solver, extents, broad_phase, is_continuous, may_have_kinematic };
    let parts = shares.iter().zip(bodies).zip(poses).zip(starts).zip(finalised);
    solver.threads.run_team(parts, |((((share, bodies), poses), starts), finalised), _| {
        work(&mut FinaliseShare { bodies, poses, starts, finalised }, share.bodies, &sources)
    })
}

/// Sweeps the fast bodies that only fixed bodies can stop, on several threads: these sweeps do not depend on the end
/// poses of other bodies.
fn sweep_bodies(state: &State, scratch: &mut Scratch) {
    let mut finalised = core::mem::take(&mut scratch.finalised);
    if finalised.iter().any(|finalised| !finalised.swept.is_empty()) {
        let meter = scratch.meter;
        let source = &*scratch;
        let spent = source.solver.threads.run_team(finalised.iter_mut(), |finalised, _| {
            let mut own = meter;
            for swept in finalised.swept.drain(..) {
                let (pose, is_impact) = continuous::swept_pose(state, source, &swept, &mut own);
                finalised.moved.push((swept.slot, pose));
                finalised.impacts += u32::from(is_impact);
            }
            own.spent() - meter.spent()
        });
        scratch.meter.spend(spent);
    }
    scratch.finalised = finalised;
}

struct Sources<'a> {
    shapes: &'a Arena<Shape, ShapeId>,
    solver: &'a Solver,
    /// Extents of bodies, indexed by slot.
    extents: &'a [Extents],
    broad_phase: &'a BroadPhase,
    is_continuous: bool,
    may_have_kinematic: bool,
}

struct FinaliseShare<'a> {
    bodies: ArenaRange<'a, Body>,
    poses: PoseRange<'a>,
    /// Poses at the start of the tick, in the order of the awake bodies.
    starts: &'a mut [Pose],
    finalised: &'a mut Finalised,
}

impl FinaliseShare<'_> {
    /// Copies the velocities of the share's bodies from the solver, moves the bodies that are not fast, and lists the
    /// fast ones.
    fn finalise_bodies(&mut self, slots: &[u32], sources: &Sources<'_>) -> Faults {
        self.finalised.clear();
        let mut faults = 0;
        for (index, &slot) in slots.iter().enumerate() {
            let body = self.bodies.at_mut(slot);
            self.starts[index] = Pose { centre: body.centre, angle: body.angle };
            let was_settled = body.rest_ticks.has_settled();
            let end = finalise_body(body, sources.solver.body(slot), &mut faults);
            if body.rest_ticks.has_settled() && !was_settled {
                self.finalised.settled.push(slot);
            }
            match sources.swept_body(slot, body, &end) {
                None => self.move_body(slot, end.pose, sources),
                Some(fast) if continuous::is_bullet(body) => self.finalised.bullets.push(fast),
                Some(fast) if continuous::sees_kinematic(body) => self.finalised.relative.push(fast),
                Some(fast) => self.finalised.swept.push(fast),
            }
        }
        faults
    }

    fn move_stopped(&mut self, sources: &Sources<'_>) -> Faults {
        for index in 0..self.finalised.moved.len() {
            let (slot, pose) = self.finalised.moved[index];
            self.move_body(slot, pose, sources);
        }
        0
    }

    #[inline]
    fn move_body(&mut self, slot: u32, pose: Pose, sources: &Sources<'_>) {
        let FinaliseShare { bodies, poses, finalised, .. } = self;
        let body = bodies.at_mut(slot);
        if !poses.holds(body) {
            finalised.others.push((slot, pose));
        } else if poses.move_body(body, pose, sources.shapes) {
            let has_left = |slot: &u32| !sources.broad_phase.fat(*slot).contains(poses.bounds(*slot));
            finalised.left_boxes.extend(body.shapes().iter().map(|id| id.slot()).filter(has_left));
        }
    }
}

impl Sources<'_> {
    fn swept_body(&self, slot: u32, body: &Body, end: &FinalPose) -> Option<SweptBody> {
        if !self.is_continuous {
            return None;
        }
        let extents = &self.extents[slot as usize];
        continuous::swept_body(slot, body, extents, end.pose, end.turn, self.may_have_kinematic)
    }
}

/// Does the part of a share's work whose result depends on the order of the shares. Runs on the calling thread, for one
/// share after the other.
fn complete(state: &mut State, scratch: &mut Scratch, finalised: &Finalised) {
    for &slot in &finalised.settled {
        scratch.pairs.changes.body_changed(state.bodies.at(slot));
    }
    finalised.left_boxes.iter().for_each(|&shape| cover_shape(state, scratch, shape));
    for &(slot, pose) in &finalised.others {
        move_body(state, scratch, slot, pose);
    }
    // With several threads, `swept` is empty here. A single thread sweeps and moves each body immediately, while the
    // body is in the processor's cache.
    finalised.swept.iter().for_each(|swept| continuous::sweep(state, scratch, swept));
    scratch.results.stats.impacts += finalised.impacts;
    scratch.sweeps.relative.extend_from_slice(&finalised.relative);
    scratch.sweeps.bullets.extend_from_slice(&finalised.bullets);
}

struct FinalPose {
    pose: Pose,
    /// Rotation in the tick in units of 2^-32 turns, including whole turns.
    turn: i64,
}

/// Copies a body's velocities from the solver, and clears its force, torque and target. Returns the pose to which the
/// body has to be moved.
fn finalise_body(body: &mut Body, solved: &SolverBody, faults: &mut Faults) -> FinalPose {
    let SolverBody { velocity, spin, shift, turn, .. } = *solved;
    body.velocity = velocity;
    body.spin = spin;
    body.hold_locked_axes();
    body.force = Vec2::ZERO;
    body.torque = Fx::ZERO;
    if body.kind() == BodyKind::Kinematic && !body.is_moving() && !body.rest_ticks.has_settled() {
        body.rest_ticks.settle();
    }
    let turn = turn_of(turn, body.mass.inverse_gyration);
    if let Some(target) = body.target.take() {
        body.stop();
        return FinalPose { pose: *target, turn };
    }
    let centre = body.centre + shift.widen();
    let edge = Vec2::new(WORLD_EXTENT_MAX, WORLD_EXTENT_MAX);
    let inside = centre.max(-edge).min(edge);
    *faults += u64::from(inside != centre);
    let angle = body.angle + Angle::from_turns(Fx::from_bits(turn));
    FinalPose { pose: Pose { centre: inside, angle }, turn }
}
