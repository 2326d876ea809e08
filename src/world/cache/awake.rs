//! The bodies and joints that a tick simulates.

use alloc::vec::Vec;
use core::ops::Range;

use smallvec::SmallVec;

use crate::body::{Body, BodyKind, Handle};
use crate::threads::part_of;
use crate::world::state::State;

/// Slots of the bodies and joints that a tick simulates, in ascending order.
#[derive(Clone, Debug, Default)]
pub(crate) struct AwakeSet {
    /// Enabled bodies that are kinematic, or dynamic and awake.
    bodies: Vec<u32>,
    /// Enabled joints between two enabled bodies, at least one of which is dynamic, awake and has mass. Filter joints
    /// are left out.
    joints: Vec<u32>,
    with_threshold: Vec<u32>,
    /// For each body slot, whether one of `joints` is attached to the body.
    held: Vec<bool>,
    is_current: bool,
    /// Whether there may be a kinematic body. After the last kinematic body is gone, the flag may stay true.
    may_have_kinematic: bool,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct SlotShare<'a> {
    pub(crate) bodies: &'a [u32],
    /// Ends of the slot ranges that the thread may write: body slots, then shape slots. The ends are exclusive.
    pub(crate) ends: [u32; 2],
}

impl AwakeSet {
    pub(crate) fn new(state: &State) -> Self {
        let mut set = AwakeSet::default();
        set.look_for_kinematic(state);
        set
    }

    /// Called when a body or joint was added, removed, changed, woken or put to sleep.
    pub(crate) fn invalidate(&mut self) {
        self.is_current = false;
    }

    pub(crate) fn body_changed(&mut self, body: &Body) {
        self.may_have_kinematic |= body.kind() == BodyKind::Kinematic;
        self.invalidate();
    }

    pub(crate) fn look_for_kinematic(&mut self, state: &State) {
        self.may_have_kinematic = state.bodies.iter().any(|(_, body)| body.kind() == BodyKind::Kinematic);
    }

    pub(crate) fn refresh(&mut self, state: &State) {
        if core::mem::replace(&mut self.is_current, true) {
            return;
        }
        self.bodies.clear();
        let simulated = state.bodies.iter().filter(|(_, body)| is_simulated(body));
        self.bodies.extend(simulated.map(|(id, _)| id.slot()));
        self.joints.clear();
        self.joints.extend(state.joints.iter().filter_map(|(id, joint)| {
            let (a, b) = joint.def().bodies();
            let (a, b) = (state.bodies.at(a.slot()), state.bodies.at(b.slot()));
            let is_solved = a.enabled && b.enabled && joint.is_solved();
            let moves = |body: &Body| is_awake(body) && body.has_mass();
            (is_solved && (moves(a) || moves(b))).then_some(id.slot())
        }));
        self.with_threshold.clear();
        let has_threshold = |&&slot: &&u32| state.joints.at(slot).def().threshold.is_set();
        self.with_threshold.extend(self.joints.iter().filter(has_threshold));
        self.held.clear();
        self.held.resize(state.bodies.slot_count(), false);
        for &joint in &self.joints {
            let (a, b) = state.joints.at(joint).def().bodies();
            self.held[a.slot() as usize] = true;
            self.held[b.slot() as usize] = true;
        }
    }

    pub(crate) fn bodies(&self) -> &[u32] {
        &self.bodies
    }

    /// Divides the bodies among threads. A shape of a body may be outside of the slot range of the body's thread.
    pub(crate) fn shares(&self, state: &State, count: usize) -> SmallVec<[SlotShare<'_>; 1]> {
        let mut shape_end = 0;
        let mut share = |number: usize| {
            let Range { start, end } = part_of(self.bodies.len(), 1, number, count);
            let next = if number + 1 == count { None } else { self.bodies.get(end) };
            let first_shape = next.and_then(|&slot| state.bodies.at(slot).shapes().first());
            shape_end = first_shape.map_or(shape_end, |id| id.slot().max(shape_end));
            let ends = next.map_or([u32::MAX; 2], |&slot| [slot, shape_end]);
            SlotShare { bodies: &self.bodies[start..end], ends }
        };
        (0..count).map(&mut share).collect()
    }

    pub(crate) fn joints(&self) -> &[u32] {
        &self.joints
    }

    pub(crate) fn joints_with_threshold(&self) -> &[u32] {
        &self.with_threshold
    }

    pub(crate) fn is_held(&self, body: u32) -> bool {
        self.held[body as usize]
    }

    pub(crate) fn may_have_kinematic(&self) -> bool {
        self.may_have_kinematic
    }
}

fn is_simulated(body: &Body) -> bool {
    body.enabled && body.kind() != BodyKind::Fixed && !body.is_asleep()
}

pub(crate) fn is_awake(body: &Body) -> bool {
    body.is_dynamic() && body.enabled && !body.is_asleep()
}
