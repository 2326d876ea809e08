//! Joints in the state of a world.

use alloc::boxed::Box;

use serde::{Deserialize, Serialize};

use super::super::settings::Tuning;
use super::super::softness::Softness;
use super::constraint::JointSet;
use super::def::{JointDef, JointKind};
use super::parts::slot;
use crate::body::Body;
use crate::math::{Angle, Fx, Rot, Speed, TAU, Vec2, fx_mul};

/// A joint in the world.
///
/// ```
/// # use lockstep2d::{body::BodyDef, world::World};
/// use lockstep2d::{fx, solver::{Joint, JointDef, JointKind, Revolute}};
/// # let mut world = World::default();
/// # let a = world.spawn(&BodyDef::fixed(), &[])?;
/// # let b = world.spawn(&BodyDef::dynamic(), &[])?;
/// let hinge = world.add_joint(&JointDef::new(a, b, Revolute::new()))?;
/// // A motor is fitted later: read the definition, change a copy, and set it.
/// let joint: &Joint = world.joint(hinge).expect("just created");
/// let driven = JointDef { kind: Revolute::new().motor(fx!(1), fx!(5)).into(), ..*joint.def() };
/// world.set_joint(hinge, &driven)?;
/// let has_motor = |joint: &Joint| matches!(joint.def().kind, JointKind::Revolute(hinge) if hinge.motor.is_some());
/// assert!(world.joint(hinge).is_some_and(has_motor));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// Boxed, so that the other fields, which every step changes, are close together in memory: the time to save them
    /// is limited by memory bandwidth.
    pub(crate) def: Box<JointDef>,
    pub(crate) impulses: JointImpulses,
    /// Angle of B's frame relative to A's when the joint was last solved, with whole turns, in units of 2^-32 turn.
    pub(crate) turns: i64,
}

/// Accumulated impulses `L` for the warm start, indexed by [`super::parts::slot`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct JointImpulses(pub(crate) [Speed; 6]);

impl JointImpulses {
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

    /// Replaces the definition. If the kind stays the same, the joint keeps its count of whole turns and, if `def` is
    /// enabled, its impulses. Exception: a rack resets its count of turns to 0 if this makes its position error
    /// smaller, as after [`JointDef::fitted`].
    pub(crate) fn redefine(&mut self, def: JointDef, a: &Body, b: &Body) {
        let same_kind = core::mem::discriminant(&def.kind) == core::mem::discriminant(&self.def.kind);
        if !same_kind || !def.enabled {
            self.impulses = JointImpulses::default();
        }
        *self.def = def;
        if !same_kind || Joint::new(def).coupling_error(a, b) < self.coupling_error(a, b) {
            self.turns = 0;
        }
    }

    /// Clears the impulses of a joint between two bodies that are not dynamic.
    pub(crate) fn rest(&mut self) {
        self.impulses = JointImpulses::default();
    }

    pub(crate) fn is_solved(&self) -> bool {
        self.def.enabled && self.def.kind != JointKind::Filter
    }

    /// Softness of the joint's rigid constraints and limits.
    pub(super) fn softness(&self, tuning: &Tuning) -> Softness {
        self.def.softness.map_or(tuning.joint, |soft| tuning.own_softness(soft.hertz, soft.damping_ratio))
    }

    /// The current definition, including all changes since the joint was added.
    #[must_use]
    pub const fn def(&self) -> &JointDef {
        &self.def
    }

    /// The angle of B's frame relative to A's in units of 2^-32 turn, plus the number of whole turns that brings this
    /// angle nearest to the last angle.
    pub(crate) fn turns(&self, a: Angle, b: Angle) -> i64 {
        nearest_turns(self.turns, (b - a) + self.def.rest_angle())
    }

    /// The angle of B's frame relative to A's in radians, with whole turns.
    pub(crate) fn angle(&self, a: &Body, b: &Body) -> Fx {
        radians(self.turns(a.angle(), b.angle()))
    }

    /// Axes of the joint's frame on A, in the world.
    pub(crate) fn axes(&self, a: &Body) -> Rot {
        Rot::from_angle(a.angle() + self.def.frame_a.angle)
    }

    /// The force in N, and the torque in N m about B's anchor, that the joint last exerted on B.
    pub(crate) fn reaction(&self, a: &Body, b: &Body, tuning: &Tuning) -> (Vec2<Fx>, Fx) {
        JointSet::default().reaction(self, (a, b), tuning)
    }

    pub(crate) fn part_reaction(
        &self,
        part: JointPart,
        (a, b): (&Body, &Body),
        tuning: &Tuning,
    ) -> (Vec2<Fx>, Fx) {
        let mut joint = self.clone();
        let slots = part.slots(&self.def.kind);
        for (slot, impulse) in joint.impulses.0.iter_mut().enumerate() {
            if slots >> slot & 1 == 0 {
                *impulse = Speed::ZERO;
            }
        }
        joint.reaction(a, b, tuning)
    }
}

/// A part of a joint, for [`World::joint_part_force`](crate::world::World::joint_part_force).
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, world::World};
/// use lockstep2d::{fx, solver::{JointPart, Revolute}};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # let wall = world.spawn(&BodyDef::fixed(), &[])?;
/// # let weight = world.spawn(&BodyDef::dynamic().position((fx!(2), fx!(0))), &[square])?;
/// // A motor holds a weight of 10 N on an arm of 2 m, and therefore exerts 20 N m.
/// let motor = Revolute::new().motor(fx!(0), fx!(100));
/// let hinge = world.add_joint(&world.joint_at(wall, weight, motor, (fx!(0), fx!(0)))?)?;
/// (0..60).for_each(|_| world.step());
/// let (_, torque) = world.joint_part_force(hinge, JointPart::Motor).expect("still there");
/// assert!((torque - fx!(20)).abs() < fx!(0.1), "{torque}");
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum JointPart {
    /// The motor, or both motors of a motor joint.
    Motor,
    /// The limits, or the rope of a pulley.
    Limit,
    /// The springs, or the soft parts of a weld.
    Spring,
}

impl JointPart {
    fn slots(self, kind: &JointKind) -> u8 {
        let flags = |slots: &[u8]| slots.iter().fold(0, |flags, slot| flags | 1 << slot);
        let point = [slot::HOLD, slot::HOLD + 1];
        let limits = [slot::LIMIT, slot::LIMIT + 1];
        match (self, kind) {
            (JointPart::Spring, JointKind::Weld(weld)) => {
                let angle = if weld.angular.is_some() { flags(&[slot::SPRING]) } else { 0 };
                let anchors = if weld.linear.is_some() { flags(&point) } else { 0 };
                angle | anchors
            }
            // In a motor joint, the linear spring uses the slots of the limits.
            (JointPart::Spring, JointKind::Motor(_)) => flags(&[slot::SPRING]) | flags(&limits),
            (JointPart::Motor, JointKind::Motor(_)) => flags(&[slot::DRIVE]) | flags(&point),
            (_, JointKind::Weld(_)) | (JointPart::Limit, JointKind::Motor(_)) => 0,
            (JointPart::Spring, _) => flags(&[slot::SPRING]),
            (JointPart::Motor, _) => flags(&[slot::DRIVE]),
            (JointPart::Limit, _) => flags(&limits),
        }
    }
}

/// `now` plus the number of whole turns that brings it nearest to `last`, in units of 2^-32 turn.
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
