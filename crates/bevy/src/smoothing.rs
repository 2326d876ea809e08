//! Poses of views: interpolated between two ticks, and offset for a moment after a rollback has moved the body.

use core::f32::consts::TAU;
use core::time::Duration;

use bevy::math::Vec2;
use lockstep2d::math::{Angle, Fx, Vec2 as FixedVec2};

use crate::poses::Pose;

/// Position in metres and rotation in radians, as floats.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct DrawnPose {
    pub(crate) position: Vec2,
    pub(crate) angle: f32,
}

impl DrawnPose {
    pub(crate) fn at(pose: Pose) -> Self {
        DrawnPose { position: metres(pose.position), angle: radians(pose.angle) }
    }

    /// Interpolates two poses, with the rotation along the shorter arc. Fraction 0 is `previous`.
    pub(crate) fn between(previous: Pose, current: Pose, fraction: f32) -> Self {
        let start = Self::at(previous);
        let way = Offset::between(previous, current);
        DrawnPose {
            position: start.position + way.position * fraction,
            angle: start.angle + way.angle * fraction,
        }
    }

    pub(crate) fn shifted(self, offset: Offset) -> Self {
        DrawnPose { position: self.position + offset.position, angle: self.angle + offset.angle }
    }
}

/// Converts fixed point to floats as `draw::to_f32` does, with fewer instructions.
pub(crate) fn metres(vector: FixedVec2<Fx>) -> Vec2 {
    const UNIT: f32 = 1.0 / (1_u64 << Fx::FRAC_NBITS) as f32;
    Vec2::new(vector.x.to_bits() as f32 * UNIT, vector.y.to_bits() as f32 * UNIT)
}

/// A signed angle in radians, -pi to pi.
fn radians(angle: Angle) -> f32 {
    let signed = angle.to_bits().cast_signed();
    signed as f32 * (TAU / 4_294_967_296.0)
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Offset {
    position: Vec2,
    angle: f32,
}

/// Length in metres below which an offset is dropped, if its angle is also below [`ANGLE_MIN`]. It is a tenth of a
/// pixel at the default scale.
const POSITION_MIN: f32 = 1e-3;
/// Angle in radians below which an offset is dropped: see [`POSITION_MIN`].
const ANGLE_MIN: f32 = 1e-3;

impl Offset {
    pub(crate) const ZERO: Self = Offset { position: Vec2::ZERO, angle: 0.0 };

    /// The difference between two poses, with the rotation along the shorter arc. It is computed in fixed point,
    /// because floats are too coarse far from the origin.
    pub(crate) fn between(from: Pose, to: Pose) -> Self {
        Offset { position: metres(to.position - from.position), angle: radians(to.angle - from.angle) }
    }

    /// Adds a displacement. If the sum is longer than `limit` metres, drops it, so that the view jumps.
    pub(crate) fn add(&mut self, other: Self, limit: f32) {
        self.position += other.position;
        self.angle += other.angle;
        if self.position.length() > limit {
            *self = Self::ZERO;
        }
    }

    pub(crate) fn decay(&mut self, time: Duration, half_life: Duration) {
        if *self == Self::ZERO {
            return;
        }
        let half_lives = time.as_secs_f32() / half_life.as_secs_f32();
        // If the half-life is zero, the quotient is infinite or not a number.
        let factor = if half_life.is_zero() { 0.0 } else { (-half_lives).exp2() };
        self.position *= factor;
        self.angle *= factor;
        if self.position.length() < POSITION_MIN && self.angle.abs() < ANGLE_MIN {
            *self = Self::ZERO;
        }
    }
}

#[cfg(test)]
mod tests {
    use lockstep2d::fx;

    use super::*;

    fn pose(x: i32, degrees: i32) -> Pose {
        Pose {
            position: FixedVec2::new(Fx::from_num(x), fx!(0)),
            angle: Angle::from_degrees(Fx::from_num(degrees)),
        }
    }

    #[test]
    fn a_rotation_takes_the_shorter_way() {
        let half = DrawnPose::between(pose(0, 170), pose(2, -170), 0.5);
        assert!((half.angle.abs() - TAU / 2.0).abs() < 1e-5, "{half:?}");
        assert_eq!(half.position, Vec2::new(1.0, 0.0));
        let back = DrawnPose::between(pose(0, -170), pose(0, 170), 0.25);
        assert!((back.angle.to_degrees() + 175.0).abs() < 1e-3, "{back:?}");
    }

    #[test]
    fn an_offset_is_halved_in_a_half_life_and_ends() {
        let mut offset = Offset::between(pose(0, 0), pose(2, 40));
        offset.decay(Duration::from_millis(50), Duration::from_millis(50));
        assert!((offset.position.x - 1.0).abs() < 1e-5 && (offset.angle.to_degrees() - 20.0).abs() < 1e-3);
        offset.decay(Duration::from_secs(1), Duration::from_millis(50));
        assert_eq!(offset, Offset::ZERO);
        let mut none = Offset::between(pose(0, 0), pose(2, 40));
        none.decay(Duration::ZERO, Duration::ZERO);
        assert_eq!(none, Offset::ZERO);
    }

    #[test]
    fn a_long_way_is_a_jump() {
        let mut offset = Offset::ZERO;
        offset.add(Offset::between(pose(0, 0), pose(2, 40)), 3.0);
        assert_ne!(offset, Offset::ZERO);
        offset.add(Offset::between(pose(0, 0), pose(2, 40)), 3.0);
        assert_eq!(offset, Offset::ZERO);
    }
}
