use alloc::vec::Vec;

use crate::body::Handle;
use crate::math::{Fx, Vec2};
use crate::solver::{Joint, Solver, Threshold, ThresholdAction, Tuning};
use crate::world::cache::Scratch;
use crate::world::events::JointEvent;
use crate::world::islands::joints_changed;
use crate::world::state::State;

/// Reports joints that exceeded their threshold in the last sub-step, and removes those that break.
pub(super) fn report_joints(state: &mut State, scratch: &mut Scratch, tuning: &Tuning) {
    let Scratch { awake, results, solver, .. } = scratch;
    // Joints break so rarely that this list is not kept in the scratch memory.
    let mut broken = Vec::new();
    for &slot in awake.joints_with_threshold() {
        let joint = state.joints.at(slot);
        if let Some((force, torque)) = excess(state, solver, joint, tuning) {
            let broke = joint.def().threshold.action == ThresholdAction::Break;
            let id = state.joints.handle_at(slot);
            results.events.joints.push(JointEvent { joint: id, force, torque, broke });
            if broke {
                broken.push(id);
            }
        }
    }
    let mut parted = Vec::new();
    for id in broken {
        if let Some(joint) = state.joints.remove(id) {
            let bodies = joint.def().bodies();
            scratch.joint_links.remove(id, bodies);
            parted.extend(<[_; 2]>::from(bodies));
        }
    }
    joints_changed(state, scratch, parted);
    scratch.awake.refresh(state);
}

/// Force in N and torque in N m of a joint that exceeds its threshold.
fn excess(state: &State, solver: &mut Solver, joint: &Joint, tuning: &Tuning) -> Option<(Vec2<Fx>, Fx)> {
    let Threshold { force: force_max, torque: torque_max, action: _ } = joint.def().threshold;
    let (a, b) = joint.def().bodies();
    let (a, b) = (state.bodies.at(a.slot()), state.bodies.at(b.slot()));
    let (force, torque) = solver.reaction(joint, (a, b), tuning);
    let exceeds = force_max.is_some_and(|limit| force.length() > limit)
        || torque_max.is_some_and(|limit| torque.saturating_abs() > limit);
    exceeds.then_some((force, torque))
}
