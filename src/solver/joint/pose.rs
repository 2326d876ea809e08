//! The anchors of a joint at the current pose, and the rows and positions along its directions.

use core::cell::Cell;

use super::super::body::SolverBody;
use super::super::point_block::PointBlock;
use super::super::row::{Lever, MassFractions, Row};
use super::def::JointDef;
use super::parts::Direction;
use super::row::{Measure, NO_REACH};
use super::state::{Joint, radians};
use crate::body::Body;
use crate::fx;
use crate::math::{Angle, Fx, Length, Reciprocal, Rot, Unit, Vec2, fx_div, round_shift, saturate};

/// The rotation of a body with joints at the last refresh.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BodyRotation {
    pub(super) rotation: Rot,
    pub(super) angle: Angle,
    /// The rotation since the start of the tick, in units of 2^-32 turn.
    pub(super) turns: i64,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Ends {
    body_a: u32,
    body_b: u32,
    /// Vector from the centre of mass of A to the anchor, in the frame of A.
    local_a: Vec2<Length>,
    /// Vector from the centre of mass of B to the anchor, in the frame of B.
    local_b: Vec2<Length>,
    inverse_gyration_a: Reciprocal,
    inverse_gyration_b: Reciprocal,
    fractions: MassFractions,
    /// Vector from A's centre of mass to B's centre of mass at the start of the tick.
    between: Vec2<Fx>,
    /// X axis of the joint's frame on A, in the frame of A.
    axis: Vec2<Unit>,
    /// Angle of the joint at the start of the tick, in units of 2^-32 turn.
    turns: i64,
}

impl Ends {
    pub(super) fn prepare(joint: &Joint, indices: [u32; 2], [a, b]: [&Body; 2]) -> Self {
        let JointDef { frame_a, frame_b, .. } = &*joint.def;
        let axis = Rot::from_angle(frame_a.angle);
        let ((centre_a, arm_a), (centre_b, arm_b)) = (frame_a.centre_and_arm(a), frame_b.centre_and_arm(b));
        Ends {
            body_a: indices[0],
            body_b: indices[1],
            local_a: arm_a.narrow(),
            local_b: arm_b.narrow(),
            inverse_gyration_a: a.mass.inverse_gyration,
            inverse_gyration_b: b.mass.inverse_gyration,
            fractions: MassFractions::of(a, b),
            between: centre_b - centre_a,
            axis: Vec2::new(axis.cos, axis.sin),
            turns: joint.turns(a.angle(), b.angle()),
        }
    }

    pub(super) fn bodies(&self) -> [usize; 2] {
        [self.body_a as usize, self.body_b as usize]
    }

    pub(super) fn fractions(&self) -> MassFractions {
        self.fractions
    }

    /// The angle of the joint in units of 2^-32 turn.
    pub(super) fn turns(&self, body_rotations: &[BodyRotation]) -> i64 {
        let (a, b) = (&body_rotations[self.body_a as usize], &body_rotations[self.body_b as usize]);
        self.turns.wrapping_add(b.turns).wrapping_sub(a.turns)
    }

    #[inline]
    pub(super) fn pose(&self, bodies: &[Cell<SolverBody>], body_rotations: &[BodyRotation]) -> JointPose {
        let (a, b) = (self.body_a as usize, self.body_b as usize);
        let arm_a = WideArm::rotated(body_rotations[a].rotation, self.local_a);
        let arm_b = WideArm::rotated(body_rotations[b].rotation, self.local_b);
        let moved = (bodies[b].get().shift - bodies[a].get().shift).widen();
        // Only the difference of the arms is rounded, from 52 fraction bits to 32.
        let gap = |between: Fx, moved: Fx, arms: i64| {
            between.saturating_add(moved).saturating_add(Fx::from_bits(round_shift(arms, 20)))
        };
        JointPose {
            lever_a: Lever { arm: arm_a.narrow(), inverse_gyration: self.inverse_gyration_a },
            lever_b: Lever { arm: arm_b.narrow(), inverse_gyration: self.inverse_gyration_b },
            fractions: self.fractions,
            gap: Vec2::new(
                gap(self.between.x, moved.x, arm_b.x - arm_a.x),
                gap(self.between.y, moved.y, arm_b.y - arm_a.y),
            ),
        }
    }

    /// The pose at the point where an impulse does not rotate the bodies relative to each other. Rows at this point and
    /// rows on the angle do not disturb each other. With the vector `c` from A's centre to B's, and the share
    /// `sA = iA / (iA + iB)` of the inverse inertias, the point is at `-sA c` from B's centre.
    fn balanced(&self, pose: &JointPose, body_rotations: &[BodyRotation]) -> JointPose {
        let (share_a, _) = self.measure_angle(body_rotations).row.shares();
        let (arm_a, arm_b) = (pose.lever_a.arm.widen(), pose.lever_b.arm.widen());
        let between = arm_a + pose.gap - arm_b;
        let arm = -between.scale(share_a.into());
        // `to_b` leads from B's anchor to the balanced point. `to_a` leads from A's anchor to the point of A that would
        // coincide with it if the joint had no position error.
        let (to_b, apart) = (arm - arm_b, Angle::from_turns(Fx::from_bits(self.turns(body_rotations))));
        let to_a = Rot::from_angle(-apart).apply_wide(to_b);
        let gap = pose.gap + to_b - to_a;
        JointPose {
            lever_a: Lever { arm: (between + arm - gap).narrow(), ..pose.lever_a },
            lever_b: Lever { arm: arm.narrow(), ..pose.lever_b },
            gap,
            ..*pose
        }
    }

    /// The row and the position along a direction. Couplings measure rows themselves, so the result for
    /// [`Direction::Coupled`] is an empty row.
    pub(super) fn measure(
        &self,
        direction: Direction,
        pose: &JointPose,
        body_rotations: &[BodyRotation],
    ) -> Measure {
        match direction {
            Direction::Angle => self.measure_angle(body_rotations),
            Direction::Along => self.measure_axis(self.axis, pose, body_rotations),
            Direction::Across => self.measure_axis(self.axis.perp(), pose, body_rotations),
            Direction::AcrossBalanced => {
                self.measure_axis(self.axis.perp(), &self.balanced(pose, body_rotations), body_rotations)
            }
            Direction::Apart => {
                // If the anchors coincide, any direction is valid.
                let n = pose.gap.normalized().unwrap_or(self.axis);
                let (row, denominator) = Row::prepare(n, pose.lever_a, pose.lever_b, pose.fractions);
                Measure { row, denominator, position: pose.gap.length(), scale: Fx::ONE, reach: NO_REACH }
            }
            Direction::Coupled(_) => Measure {
                row: Row::NONE,
                denominator: 0,
                position: Fx::ZERO,
                scale: Fx::ONE,
                reach: NO_REACH,
            },
        }
    }

    /// The row and the position along an axis that turns with A. Because the axis turns, the arm of A ends at B's
    /// anchor, unless this arm would be too long ([`JointPose::levers_at_one_point`]).
    fn measure_axis(&self, axis: Vec2<Unit>, pose: &JointPose, body_rotations: &[BodyRotation]) -> Measure {
        let n = body_rotations[self.body_a as usize].rotation.apply(axis);
        let [a, b] = pose.levers_at_one_point().unwrap_or([pose.reach_of_a(), pose.lever_b]);
        let (row, denominator) = Row::prepare(n, a, b, pose.fractions);
        let position = pose.gap.dot(n.widen());
        Measure { row, denominator, position, scale: Fx::ONE, reach: [a, b].map(Lever::ratio) }
    }

    fn measure_angle(&self, body_rotations: &[BodyRotation]) -> Measure {
        let (row, denominator, scale) =
            Row::angular(self.inverse_gyration_a, self.inverse_gyration_b, self.fractions);
        Measure {
            row,
            denominator,
            position: radians(self.turns(body_rotations)),
            scale: scale.into(),
            reach: NO_REACH,
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct JointPose {
    pub(super) lever_a: Lever,
    pub(super) lever_b: Lever,
    pub(super) fractions: MassFractions,
    /// Vector from A's anchor to B's.
    pub(super) gap: Vec2<Fx>,
}

impl JointPose {
    pub(super) fn reach_of_a(&self) -> Lever {
        Lever { arm: self.lever_a.arm + self.gap.narrow(), ..self.lever_a }
    }

    /// The block of a pulled or driven point. `mass_scale` is the mass scale of the spring, or 1 for a motor. If there
    /// are no [levers at one point](Self::levers_at_one_point), impulses act only along the line between the centres.
    pub(super) fn block(&self, mass_scale: Unit) -> PointBlock {
        match self.levers_at_one_point() {
            Some([a, b]) => PointBlock::new(a, b, self.fractions, mass_scale),
            None => {
                let between = self.lever_a.arm.widen() + self.gap - self.lever_b.arm.widen();
                PointBlock::along(between.normalized().unwrap_or(Vec2::X), self.fractions)
            }
        }
    }

    /// Levers that end at one common point, so that impulses conserve angular momentum. The point is B's anchor if A's
    /// lever ratio is at most [`REACH_MAX`] on each axis, or if impulses do not move one of the bodies. Otherwise A's
    /// arm is shortened to [`REACH_MAX`], and the point is its end. `None` if B's lever ratio to this point exceeds
    /// [`REACH_MAX`].
    fn levers_at_one_point(&self) -> Option<[Lever; 2]> {
        let a = self.reach_of_a();
        let longest = longest_ratio(a);
        if longest <= REACH_MAX || self.fractions.a == Unit::ZERO || self.fractions.b == Unit::ZERO {
            return Some([a, self.lever_b]);
        }
        let arm = a.arm.widen().scale(fx_div(REACH_MAX, longest)?).narrow();
        let b = Lever { arm: self.lever_b.arm - (a.arm - arm), ..self.lever_b };
        (longest_ratio(b) <= REACH_MAX).then_some([Lever { arm, ..a }, b])
    }
}

/// Largest component of a lever ratio. The length of the lever ratio is then below
/// [`RATIO_MAX`](super::super::row::RATIO_MAX).
const REACH_MAX: Fx = fx!(88);

fn longest_ratio(lever: Lever) -> Fx {
    let ratio = |x: Length| lever.inverse_gyration.times_wide(x.into()).abs();
    ratio(lever.arm.x).max(ratio(lever.arm.y))
}

/// A rotated arm with 52 fraction bits, because the gap is a small difference of long arms.
#[derive(Clone, Copy)]
struct WideArm {
    x: i64,
    y: i64,
}

impl WideArm {
    fn rotated(rotation: Rot, local: Vec2<Length>) -> Self {
        let (c, s) = (i64::from(rotation.cos.to_bits()), i64::from(rotation.sin.to_bits()));
        let (x, y) = (i64::from(local.x.to_bits()), i64::from(local.y.to_bits()));
        WideArm { x: c * x - s * y, y: s * x + c * y }
    }

    fn narrow(self) -> Vec2<Length> {
        let narrow = |wide: i64| Length::from_bits(saturate(round_shift(wide, 30)));
        Vec2::new(narrow(self.x), narrow(self.y))
    }
}
