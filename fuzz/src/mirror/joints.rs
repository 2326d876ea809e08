//! Joints and their impulses.

use lockstep2d::body::BodyId;
use lockstep2d::math::Angle;
use lockstep2d::solver::JointDef;
use serde::{Deserialize, Serialize};

use super::{Handle, IMPULSE_MAX, REACH_MAX, State, pair, speed, vector};
use crate::generator::serde_handle::Handle as _;
use crate::joints;
use crate::source::Source;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Joint {
    def: JointDef,
    impulses: [i32; 6],
    turns: i64,
}

fn body_id((slot, generation): Handle) -> BodyId {
    BodyId::of_bytes(u64::from(generation) << 32 | u64::from(slot))
}

impl Joint {
    pub(super) fn rename(&mut self, old: Handle, new: Handle) {
        for end in [&mut self.def.body_a, &mut self.def.body_b] {
            if *end == body_id(old) {
                *end = body_id(new);
            }
        }
    }
}

impl State {
    pub(super) fn alter_joint(&mut self, source: &mut Source<'_>) -> Option<()> {
        if source.one_in(3) {
            let (a, b) = (self.bodies.pick(source)?, self.bodies.pick(source)?);
            let ends = (body_id(self.bodies.handle(a)), body_id(self.bodies.handle(b)));
            let def = joints::joint(source, ends.0, ends.1);
            self.joints.add(Joint { def, impulses: [0; 6], turns: 0 });
        }
        let index = self.joints.pick(source)?;
        let joint = self.joints.get(index)?;
        match source.below(9) {
            0 | 1 => joint.impulses = [0; 6].map(|_: i32| speed(source, IMPULSE_MAX)),
            // One in eight anchors may be beyond the limit for a moving body.
            2 => {
                let reach = if source.one_in(8) { 1 << 62 } else { REACH_MAX };
                joint.def.frame_a.anchor = vector(pair(source, -reach, reach));
            }
            3 => joint.def.frame_b.anchor = vector(pair(source, -REACH_MAX, REACH_MAX)),
            4 => joint.def.frame_a.angle = Angle::from_bits(source.word() as u32),
            5 => joint.def = joints::finish(source, joint.def),
            6 => joint.turns = source.within(i64::MIN, i64::MAX),
            _ => joint.def.kind = joints::kind(source),
        }
        Some(())
    }
}
