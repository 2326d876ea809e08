//! The joints that each thread solves. Each thread has a part of the hinges of every colour. One of the threads also
//! solves all other joints, while the others wait.

use super::super::context::{SolverPass, StepContext};
use super::block::Blocks;
use super::hinge::{HingeSet, HingeShare, Poses, Turning};
use super::list::JointList;
use super::pose::BodyRotation;
use super::rotations::Rotations;
use crate::math::{Unit, mul};
use crate::simd::Quad;
use crate::threads::TeamLock;

pub(in crate::solver) struct JointSplit<'a> {
    pub(super) is_empty: bool,
    pub(super) own: OwnJoints<'a>,
    pub(super) parts: &'a mut [HingeShare],
    pub(super) rotations: TeamLock<BodyRotations<'a>>,
}

pub(in crate::solver) struct JointShare<'a, 'set> {
    is_empty: bool,
    /// `None` for all threads but one.
    own: Option<&'a mut OwnJoints<'set>>,
    part: &'a mut HingeShare,
    rotations: &'a TeamLock<BodyRotations<'set>>,
}

/// All joints except coloured hinges.
pub(super) struct OwnJoints<'a> {
    pub(super) hinges: &'a mut HingeSet,
    pub(super) list: &'a mut JointList,
    pub(super) blocks: &'a mut Blocks,
    pub(super) turning: &'a [Turning],
    /// For each body of the tick, its index in `turning` plus 1; 0 if the body has no joint.
    pub(super) places: &'a [u32],
    /// Bodies of anchored hinges (see [`HingeShare`]).
    pub(super) anchored: &'a [u32],
}

pub(super) struct BodyRotations<'a> {
    pub(super) body_rotations: &'a mut [BodyRotation],
    pub(super) quads: &'a mut [Quad],
}

impl BodyRotations<'_> {
    fn poses(&self) -> Poses<'_> {
        Poses { quads: self.quads, body_rotations: self.body_rotations }
    }
}

impl<'set> JointSplit<'set> {
    pub(in crate::solver) fn shares(&mut self) -> impl Iterator<Item = JointShare<'_, 'set>> {
        let JointSplit { is_empty, own, parts, rotations } = self;
        let (is_empty, mut own, rotations) = (*is_empty, Some(own), &*rotations);
        parts.iter_mut().map(move |part| JointShare { is_empty, own: own.take(), part, rotations })
    }
}

impl JointShare<'_, '_> {
    /// Updates the arms and gains of all joints to the current poses. Hinges are only marked: their next operation
    /// updates them.
    pub(in crate::solver) fn refresh(&mut self, context: &StepContext<'_>) {
        if self.is_empty {
            return;
        }
        if let Some(own) = &mut self.own {
            own.refresh(&mut self.rotations.write(), context);
        }
        self.part.expire();
        context.wait();
    }

    /// Predicts the rotations in this sub-step from the velocities at the end of the last sub-step.
    pub(in crate::solver) fn predict_rotations(&mut self, context: &StepContext<'_>) {
        if self.is_empty {
            return;
        }
        if let Some(own) = &mut self.own {
            own.predict_rotations(&mut self.rotations.write(), context);
        }
        context.wait();
    }

    pub(in crate::solver) fn warm_start(&mut self, context: &StepContext<'_>) {
        if self.is_empty {
            return;
        }
        let rotations = self.rotations.read();
        if let Some(OwnJoints { list, hinges, .. }) = &mut self.own {
            list.warm_start(context);
            hinges.warm_start(rotations.poses(), context);
        }
        context.wait();
        self.part.warm_start(rotations.poses(), context);
        if let Some(OwnJoints { blocks, hinges, list, turning, places, .. }) = &mut self.own {
            blocks.start_sub_step(hinges, list, |body, spin| {
                turning[places[body as usize] as usize - 1].ahead_of_wide(spin)
            });
        }
    }

    pub(in crate::solver) fn solve(&mut self, pass: impl SolverPass, context: &StepContext<'_>) {
        if self.is_empty {
            return;
        }
        let rotations = self.rotations.read();
        let poses = rotations.poses();
        if let Some(OwnJoints { list, hinges, blocks, .. }) = &mut self.own {
            list.solve(pass.kind(), context);
            hinges.solve(pass, poses, context);
            blocks.solve(pass.kind(), hinges, list, poses, context);
        }
        context.wait();
        self.part.solve(pass, poses, context);
    }
}

impl OwnJoints<'_> {
    fn refresh(&mut self, rotations: &mut BodyRotations<'_>, context: &StepContext<'_>) {
        let &StepContext { machine, bodies, tuning, .. } = context;
        let BodyRotations { body_rotations, quads } = rotations;
        machine.run(Rotations { turning: self.turning, bodies, body_rotations, quads });
        self.blocks.expire();
        self.hinges.expire();
        self.list.refresh(bodies, body_rotations, tuning);
    }

    fn predict_rotations(&self, rotations: &mut BodyRotations<'_>, context: &StepContext<'_>) {
        let &StepContext { bodies, tuning, .. } = context;
        let OwnJoints { turning, places, anchored, .. } = self;
        let mut predict = |body: &Turning, stretch: Stretch, turn_max: Unit| {
            let spin = bodies[body.index as usize].get().spin;
            let turn = body.ahead_of(spin).clamp(-turn_max, turn_max);
            let (across, squared): (Unit, Unit) = (mul(stretch.half, turn), mul(turn, turn));
            let along: Unit = mul(stretch.sixth, squared);
            let Quad(numbers) = &mut rotations.quads[body.index as usize];
            [numbers[2], numbers[3]] = [across.to_bits(), along.to_bits()];
        };
        let [joint, anchored_joint] = [tuning.joint, tuning.anchored].map(|softness| {
            let stretch = softness.stretch();
            Stretch { half: stretch / 2, sixth: stretch / 6 }
        });
        turning.iter().for_each(|body| predict(body, joint, TURN_MAX));
        for &index in *anchored {
            predict(&turning[places[index as usize] as usize - 1], anchored_joint, ANCHORED_TURN_MAX);
        }
    }
}

/// Coefficients for the average of a lever ratio `e` over a rotation `t`: `e + half t (-e_y, e_x) - sixth t^2 e`. `half`
/// and `sixth` are 1/2 and 1/6 times [`Softness::stretch`], the factor by which joints overestimate the rotation.
#[derive(Clone, Copy)]
struct Stretch {
    half: Unit,
    sixth: Unit,
}

/// Largest rotation, in radians, over which lever ratios are averaged. The average is used only to measure velocities;
/// impulses act along the lever ratio at the start of the sub-step. This difference may add energy if an iteration does
/// not solve all joints exactly. In the test with stars of bodies on free hinges at 60 Hz, the energy does not rise
/// above its initial value with this limit, and rises to 1.56 times this value with 0.1 radians (`docs/DESIGN.md`).
const TURN_MAX: Unit = Unit::lit("0.04");

/// The limit that replaces [`TURN_MAX`] for a body whose only joint is an anchored hinge. One iteration solves such a
/// hinge exactly.
const ANCHORED_TURN_MAX: Unit = Unit::lit("0.25");
