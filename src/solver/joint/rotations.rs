//! How bodies with joints are turned, many at a time: plain loops, which a compiler makes vectors of.

use super::super::body::SolverBody;
use super::hinge::Turning;
use super::place::Turned;
use crate::lanes::{Kernel, Lanes, Quad};
use crate::math::{Angle, Fx, Rot};

/// How many bodies are turned at a time: a compiler makes a loop of them.
const BLOCK: usize = 32;

/// Turns bodies to where the solver has brought them.
pub(super) struct Rotations<'a> {
    pub(super) turning: &'a [Turning],
    /// All of these by the indices of bodies.
    pub(super) bodies: &'a [SolverBody],
    pub(super) turned: &'a mut [Turned],
    pub(super) quads: &'a mut [Quad],
    /// Whether any body is turned to another angle than before.
    pub(super) any: &'a mut bool,
}

impl<const N: usize> Kernel<N> for Rotations<'_> {
    #[inline(always)]
    fn run<L: Lanes<N>>(self) {
        let Rotations { turning, bodies, turned, quads, any } = self;
        for block in turning.chunks(BLOCK) {
            let mut angles = [Angle::ZERO; BLOCK];
            for (angle, body) in angles.iter_mut().zip(block) {
                let at = body.index as usize;
                let turns = body.turns_of(bodies[at].turn);
                turned[at].turns = turns;
                *angle = body.angle + Angle::from_turns(Fx::from_bits(turns));
                *any |= turned[at].angle != *angle;
            }
            let rotations = Rot::from_angles(&angles);
            for ((body, angle), rotation) in block.iter().zip(angles).zip(rotations) {
                let at = body.index as usize;
                (turned[at].angle, turned[at].rotation) = (angle, rotation);
                quads[at] = Quad([rotation.cos.to_bits(), rotation.sin.to_bits(), 0, 0]);
            }
        }
    }
}
