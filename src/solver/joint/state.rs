//! Joints in the state of a world.

use alloc::boxed::Box;

use serde::{Deserialize, Serialize};

use super::super::settings::Tuning;
use super::constraint::JointSet;
use super::def::{JointDef, JointKind};
use crate::body::Body;
use crate::math::{Angle, Fx, Rot, Speed, TAU, Vec2, fx_mul};

/// A joint in the world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// Boxed, so that the parts that every step changes are close together in memory: saving them is memory-bound.
    pub(crate) def: Box<JointDef>,
    pub(crate) impulses: JointImpulses,
    /// The angle of B's frame in A's at the end of the last tick in which the joint was solved, with whole turns, in
    /// units of 2^-32 turn.
    pub(crate) turns: i64,
}

/// The accumulated impulses of the last sub-step, for the warm start of the next: `L` of each row and point, by the
/// slots of [`super::parts::slot`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct JointImpulses(pub(crate) [Speed; 6]);

impl JointImpulses {
    /// The impulse of the point in a slot and the slot after it.
    pub(super) fn point(&self, slot: u8) -> Vec2<Speed> {
        let slot = usize::from(slot);
        Vec2::new(self.0[slot], self.0[slot + 1])
    }

    pub(super) fn set_point(&mut self, slot: u8, lambda: Vec2<Speed>) {
        let slot = usize::from(slot);
        [self.0[slot], self.0[slot + 1]] = [lambda.x, lambda.y];
    }
}

impl Joint {
    pub(crate) fn new(def: JointDef) -> Self {
        Joint { def: Box::new(def), impulses: JointImpulses::default(), turns: 0 }
    }

    /// Changes the definition. Impulses are kept as long as the kind of joint is the same.
    pub(crate) fn redefine(&mut self, def: JointDef) {
        if core::mem::discriminant(&def.kind) != core::mem::discriminant(&self.def.kind) {
            self.impulses = JointImpulses::default();
        }
        *self.def = def;
    }

    /// Whether the solver has a constraint for the joint.
    pub(crate) fn is_solved(&self) -> bool {
        self.def.kind != JointKind::Filter
    }

    /// The definition, with all later changes.
    #[must_use]
    pub const fn def(&self) -> &JointDef {
        &self.def
    }

    /// The angle of B's frame in A's in units of 2^-32 turn, with the number of whole turns that brings it nearest to
    /// the last angle.
    pub(crate) fn turns(&self, a: Angle, b: Angle) -> i64 {
        nearest_turns(self.turns, (b - a) + self.def.rest_angle())
    }

    /// The angle of B's frame in A's in radians, with whole turns.
    pub(crate) fn angle(&self, a: &Body, b: &Body) -> Fx {
        radians(self.turns(a.angle(), b.angle()))
    }

    /// The axes of the joint's frame on A, in the world.
    pub(crate) fn axes(&self, a: &Body) -> Rot {
        Rot::from_angle(a.angle() + self.def.frame_a.angle)
    }

    /// The force in N and the torque in N m about B's anchor that the joint has last exerted on B.
    pub(crate) fn reaction(&self, a: &Body, b: &Body, tuning: &Tuning) -> (Vec2<Fx>, Fx) {
        JointSet::default().reaction(self, (a, b), tuning)
    }
}

/// The angle `now` with the number of whole turns that brings it nearest to `last`. Both are in units of 2^-32 turn.
pub(super) fn nearest_turns(last: i64, now: Angle) -> i64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole turns are dropped")]
    let before = Angle::from_bits(last as u32);
    last.wrapping_add((now - before).to_turns().to_bits())
}

/// Converts units of 2^-32 turn to radians.
pub(super) fn radians(turns: i64) -> Fx {
    fx_mul(Fx::from_bits(turns), TAU)
}

/// Converts radians to units of 2^-32 turn.
pub(super) fn turns_of(radians: Fx) -> i64 {
    /// `1 / (2 pi)` with 63 fraction bits.
    const INVERSE_TAU: i128 = 1_467_945_251_641_000_613;
    crate::math::saturate_wide(crate::math::round_shift_wide(i128::from(radians.to_bits()) * INVERSE_TAU, 63))
}
