//! Rotations of bodies with joints, in loops over many bodies that the compiler vectorises.

use core::cell::Cell;

use super::super::body::SolverBody;
use super::hinge::Turning;
use super::pose::BodyRotation;
use crate::math::{Angle, Fx, Rot};
use crate::simd::{Kernel, Lanes, Quad};

const BLOCK: usize = 16;

pub(super) struct Rotations<'a> {
    pub(super) turning: &'a [Turning],
    /// Indexed by body, like the next two fields.
    pub(super) bodies: &'a [Cell<SolverBody>],
    pub(super) body_rotations: &'a mut [BodyRotation],
    pub(super) quads: &'a mut [Quad],
}

impl<const N: usize> Kernel<N> for Rotations<'_> {
    #[inline(always)]
    fn run<L: Lanes<N>>(self) {
        let Rotations { turning, bodies, body_rotations, quads } = self;
        for block in turning.chunks(BLOCK) {
            let mut angles = [Angle::ZERO; BLOCK];
            for (angle, body) in angles.iter_mut().zip(block) {
                let at = body.index as usize;
                let turns = body.turns_of(bodies[at].get().turn);
                body_rotations[at].turns = turns;
                *angle = body.angle + Angle::from_turns(Fx::from_bits(turns));
            }
            let rotations = Rot::from_angles(&angles);
            for ((body, angle), rotation) in block.iter().zip(angles).zip(rotations) {
                let at = body.index as usize;
                (body_rotations[at].angle, body_rotations[at].rotation) = (angle, rotation);
                quads[at] = Quad([rotation.cos.to_bits(), rotation.sin.to_bits(), 0, 0]);
            }
        }
    }
}
