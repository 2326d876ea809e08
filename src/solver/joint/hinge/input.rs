//! Compact copies of hinges in the order of the state, from which batches are filled.

use super::super::super::body_list::GROUND;
use super::super::super::colour::{Node, Size};
use super::super::super::row::{MassFractions, turning};
use super::super::super::settings::Tuning;
use super::super::super::softness::Softness;
use super::super::def::JointFrame;
use super::super::parts::slot;
use super::super::state::Joint;
use super::refresh::gap_factors;
use crate::body::{Body, Pose};
use crate::math::{
    Angle, Fx, Length, Ratio, Reciprocal, Shift, Speed, Unit, Vec2, round_shift, round_shift_wide, saturate,
    saturate_wide,
};

#[derive(Clone, Copy, Debug)]
pub(in super::super) struct HingeBody {
    pub(in super::super) turning: Turning,
    pub(in super::super) inverse_gyration: Reciprocal,
    /// Mass in kg; 0 if no impulse moves the body.
    pub(in super::super) mass: Fx,
    pub(in super::super) joints: u32,
    centre: Vec2<Fx>,
    local_centre: Vec2<Fx>,
}

#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Turning {
    pub(in super::super) index: u32,
    /// Angle at the start of the tick.
    pub(in super::super) angle: Angle,
    /// Factor from `SolverBody::turn` (rotation in radians times radius of gyration, in units of 2^-26 m) to units of
    /// 2^-32 turn.
    turns: Fx,
    /// Rotation in radians in a sub-step per m/s of the spin, times 2^9, the ratio of the formats.
    ahead: Fx,
}

impl HingeBody {
    pub(in super::super) fn new(index: u32, body: &Body, rate: u32) -> Self {
        /// `2^32 / 2^26 / (2 pi)`.
        const TURNS: Fx = crate::fx!(10.18591635788);
        let inverse = body.mass.inverse_gyration;
        HingeBody {
            turning: Turning {
                index,
                angle: body.angle(),
                turns: inverse.times_wide(TURNS),
                ahead: inverse.times_wide(Fx::from_bits((512 << 32) / i64::from(rate))),
            },
            inverse_gyration: inverse,
            mass: if body.is_dynamic() { body.mass() } else { Fx::ZERO },
            joints: 0,
            centre: body.centre_of_mass(),
            local_centre: body.local_centre_of_mass(),
        }
    }

    /// A fixed body with its far anchor as the centre.
    pub(in super::super) fn far_anchor(index: u32, pose: Pose, frame: &JointFrame) -> Self {
        HingeBody {
            turning: Turning { index, angle: pose.angle, turns: Fx::ZERO, ahead: Fx::ZERO },
            inverse_gyration: Reciprocal::ZERO,
            mass: Fx::ZERO,
            joints: 0,
            centre: pose.centre,
            local_centre: frame.anchor,
        }
    }

    /// The index of the body, or the ground if no impulse changes it.
    pub(in super::super) fn changed(&self) -> u32 {
        if self.mass > 0 { self.turning.index } else { GROUND }
    }
}

/// The shares of two bodies in the mobility at the anchor of a hinge. The mobility of a body is `a (2 + e^2)`, with the
/// mass fraction `a` and the lever ratio `e`.
pub(in super::super) fn shares(joint: &Joint, [a, b]: [&HingeBody; 2]) -> [Unit; 2] {
    let fractions = MassFractions::of_masses(a.mass, b.mass);
    let mobility = |frame: &JointFrame, body: &HingeBody, fraction: Unit| {
        let e = ratios(arm(frame.anchor - body.local_centre), body.inverse_gyration);
        2 * i64::from(fraction.to_bits()) + turning(fraction, e.x, e.x) + turning(fraction, e.y, e.y)
    };
    let a = mobility(&joint.def.frame_a, a, fractions.a);
    let b = mobility(&joint.def.frame_b, b, fractions.b);
    // A mobility is below 2^46.
    let share = |own: i64| Unit::from_bits(saturate((own << 15) / ((a + b) >> 15).max(1)));
    [share(a), share(b)]
}

impl Turning {
    /// The rotation since the start of the tick, in units of 2^-32 turn.
    #[inline]
    pub(in super::super) fn turns_of(&self, turn: Shift) -> i64 {
        product(turn.to_bits(), self.turns)
    }

    #[inline]
    pub(in super::super) fn ahead_of(&self, spin: Speed) -> Unit {
        Unit::from_bits(saturate(product(spin.to_bits(), self.ahead)))
    }

    /// The rotation in a sub-step in radians, with 30 fraction bits, for a spin with 32 fraction bits.
    pub(in super::super) fn ahead_of_wide(&self, spin: i64) -> i64 {
        // 32 bits are the fraction of `ahead`, 9 bits are its additional scale, and 2 bits convert 32 to 30 fraction
        // bits.
        let wide = i128::from(spin) * i128::from(self.ahead.to_bits());
        saturate_wide(round_shift_wide(wide, 32 + 9 + 2))
    }
}

/// The product of a number and a factor, computed in two parts, each of which fits 64 bits.
fn product(number: i32, factor: Fx) -> i64 {
    let (number, high, low) = (i64::from(number), factor.to_bits() >> 32, factor.to_bits() & 0xFFFF_FFFF);
    number * high + round_shift(number * low, 32)
}

pub(in super::super) fn node(key: u32, a: &HingeBody, b: &HingeBody) -> Node {
    Node::new(key.into(), [a.changed(), b.changed()], Size::Large)
}

#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Input {
    pub(super) slot: u32,
    pub(super) bodies: [u32; 2],
    pub(super) changed: [u32; 2],
    /// Index of the hinge's rows on the angle.
    pub(super) angle: Option<u32>,
    /// Vectors from the centres of mass to the anchors, in the frames of the bodies.
    pub(super) arms: [Vec2<Length>; 2],
    pub(super) ratios: [Vec2<Ratio>; 2],
    /// Changes of lever ratios per metre of the gap.
    pub(super) gap_factors: [i32; 2],
    pub(super) fractions: MassFractions,
    pub(super) between: Vec2<Fx>,
    /// Angle of the joint in units of 2^-32 turn.
    pub(super) turns: i64,
    /// Angle of the joint if both bodies have the angle 0.
    pub(super) rest: Angle,
    pub(super) lambda: [i32; 2],
    pub(super) softness: Softness,
    /// Whether the softness is the joint's own.
    pub(super) is_tuned: bool,
}

impl Input {
    pub(in super::super) fn new(
        slot: u32,
        joint: &Joint,
        [a, b]: [&HingeBody; 2],
        angle: Option<u32>,
        tuning: &Tuning,
    ) -> Self {
        let arms = [(&joint.def.frame_a, a), (&joint.def.frame_b, b)]
            .map(|(frame, end)| arm(frame.anchor - end.local_centre));
        let lambda = joint.impulses.point(slot::HOLD);
        let fractions = MassFractions::of_masses(a.mass, b.mass);
        Input {
            slot,
            bodies: [a.turning.index, b.turning.index],
            changed: [a.changed(), b.changed()],
            angle,
            arms,
            ratios: [ratios(arms[0], a.inverse_gyration), ratios(arms[1], b.inverse_gyration)],
            gap_factors: gap_factors([a.inverse_gyration, b.inverse_gyration], fractions),
            fractions,
            between: b.centre - a.centre,
            turns: joint.turns(a.turning.angle, b.turning.angle),
            rest: joint.def.rest_angle(),
            lambda: [lambda.x.to_bits(), lambda.y.to_bits()],
            softness: joint.softness(tuning),
            is_tuned: joint.def.softness.is_some(),
        }
    }

    /// The body that the hinge holds, if no impulse moves the other body and the joint has no softness of its own.
    pub(super) fn anchored_body(&self) -> Option<u32> {
        match self.changed {
            _ if self.is_tuned => None,
            [GROUND, body] | [body, GROUND] if body != GROUND => Some(body),
            _ => None,
        }
    }
}

/// Clamped vector from the centre of mass to an anchor. Both points are within 128 m of the body's origin on each axis,
/// so the clamp never acts. It guarantees the range on which the sums that compute the gap rely.
fn arm(arm: Vec2<Fx>) -> Vec2<Length> {
    const ARM_MAX: Fx = crate::fx!(300);
    Vec2::new(arm.x.clamp(-ARM_MAX, ARM_MAX), arm.y.clamp(-ARM_MAX, ARM_MAX)).narrow()
}

/// Largest length of a lever ratio. The average of a ratio over the predicted rotation (`Stretch` in `share.rs`) may be
/// about 1 % longer than the ratio. With this limit, the average still fits a [`Ratio`] (±128).
pub(super) const LENGTH_MAX: Ratio = Ratio::lit("124");

/// `(-r_y, r_x) / k`, no longer than [`LENGTH_MAX`].
pub(super) fn ratios(arm: Vec2<Length>, inverse_gyration: Reciprocal) -> Vec2<Ratio> {
    let perp = arm.perp();
    let e: Vec2<Ratio> = Vec2::new(inverse_gyration.times(perp.x), inverse_gyration.times(perp.y));
    let square = |part: Ratio| u64::from(part.unsigned_abs().to_bits()).pow(2);
    if square(e.x) + square(e.y) <= square(LENGTH_MAX) {
        return e;
    }
    perp.normalized().map_or(e, |direction| direction.scale(LENGTH_MAX))
}
