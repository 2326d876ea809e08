//! Contact recycling: a contact keeps its manifold while its shapes hardly move relative to each other.

use serde::{Deserialize, Serialize};

use super::manifold::Manifold;
use crate::body::Pose;
use crate::math::{Angle, Fx, Length, Step, TAU, Unit, Vec2, round_shift, saturate};

/// The manifold of a contact, and the poses of the bodies for which it was computed.
///
/// The normal and the lever arms stay constant in world axes while the manifold is kept. If the arms followed every
/// movement, a leaning stack would lean further by itself: columns of more than 40 boxes would fall. With constant
/// arms, columns of 100 boxes stand (`docs/DESIGN.md`). The separations follow from the poses, without the narrow
/// phase.
///
/// Lengths are modulo 1024 m, so that differences are exact even if a fixed body's centre of mass is far away.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct KeptManifold {
    /// Zero if there is no manifold, or if the manifold cannot be kept, for example because it belongs to a time of
    /// impact.
    pub(crate) normal: Vec2<Unit>,
    /// Vector from A's centre of mass to the first point.
    pub(crate) arm_a: Vec2<Length>,
    /// Vector from B's centre of mass to the first point.
    pub(crate) arm_b: Vec2<Length>,
    /// Vector from the first point to the second, or zero.
    pub(crate) to_second: Vec2<Length>,
    /// Vector from A's centre of mass to B's at the poses for which the manifold was computed.
    pub(crate) between: Vec2<Length>,
    pub(crate) angles: [Angle; 2],
    /// Separations of the points. Unused ones are zero.
    pub(crate) separations: [Step; 2],
}

/// Largest rotation for which the movement of a point is computed, in units of 2^-32 turn: 0.1 rad.
const TURN_MAX: i32 = 1 << 26;

#[derive(Clone, Copy, Debug)]
pub(crate) struct KeptSide {
    pub(crate) pose: Pose,
    /// Radius in metres of a circle that contains the shape and is centred at the middle of the shape. 0 for a disc
    /// about the body's centre of mass, because rotation does not move its outline.
    pub(crate) reach: Length,
}

impl KeptManifold {
    pub(crate) const WORDS: usize = 14;

    pub(crate) const NONE: Self = KeptManifold {
        normal: Vec2::ZERO,
        arm_a: Vec2::ZERO,
        arm_b: Vec2::ZERO,
        to_second: Vec2::ZERO,
        between: Vec2::ZERO,
        angles: [Angle::ZERO; 2],
        separations: [Step::ZERO; 2],
    };

    pub(crate) fn new(manifold: &Manifold, poses: [Pose; 2]) -> Self {
        KeptManifold { normal: manifold.normal, ..Self::at_impact(manifold, poses, [Vec2::ZERO; 2]) }
    }

    /// A manifold at a time of impact. Such a manifold cannot be kept. `moved` are the displacements of the bodies up
    /// to the time of impact.
    pub(crate) fn at_impact(manifold: &Manifold, [a, b]: [Pose; 2], moved: [Vec2<Length>; 2]) -> Self {
        let [first, second] = manifold.both_points();
        let arm = |body: Pose, moved: Vec2<Length>| {
            let to_origin = wrapping_sub(wrapped_difference(manifold.origin, body.centre), moved);
            wrapping_add(to_origin, first.anchor)
        };
        let to_second = wrapping_sub(second.anchor, first.anchor);
        KeptManifold {
            normal: Vec2::ZERO,
            arm_a: arm(a, moved[0]),
            arm_b: arm(b, moved[1]),
            to_second: if manifold.count() > 1 { to_second } else { Vec2::ZERO },
            between: wrapped_difference(b.centre, a.centre),
            angles: [a.angle, b.angle],
            separations: [first.separation, second.separation],
        }
    }

    /// Replaces each coordinate of a lever arm by that of an earlier manifold with the same points, if the two differ
    /// by at most the tolerance in metres.
    pub(crate) fn keep_arms_of(&mut self, last: &Self, [tolerance_a, tolerance_b]: [Length; 2]) {
        let keep = |new: &mut Vec2<Length>, old: Vec2<Length>, tolerance: Length| {
            for (new, old) in [(&mut new.x, old.x), (&mut new.y, old.y)] {
                if old.wrapping_sub(*new).unsigned_abs() <= tolerance.unsigned_abs() {
                    *new = old;
                }
            }
        };
        keep(&mut self.arm_a, last.arm_a, tolerance_a);
        keep(&mut self.arm_b, last.arm_b, tolerance_b);
        keep(&mut self.to_second, last.to_second, tolerance_a.min(tolerance_b));
    }

    pub(crate) fn to_words(self) -> [i32; Self::WORDS] {
        let KeptManifold { normal, arm_a, arm_b, to_second, between, angles, separations } = self;
        let [angle_a, angle_b] = angles.map(|angle| angle.to_bits().cast_signed());
        let [s0, s1] = separations.map(Step::to_bits);
        let lengths = [arm_a, arm_b, to_second, between].map(|v| [v.x.to_bits(), v.y.to_bits()]);
        let [[a_x, a_y], [b_x, b_y], [x, y], [between_x, between_y]] = lengths;
        let [n_x, n_y] = [normal.x.to_bits(), normal.y.to_bits()];
        [n_x, n_y, a_x, a_y, b_x, b_y, x, y, between_x, between_y, angle_a, angle_b, s0, s1]
    }

    pub(crate) fn from_words(words: [i32; Self::WORDS]) -> Self {
        let [n_x, n_y, a_x, a_y, b_x, b_y, x, y, between_x, between_y, angle_a, angle_b, s0, s1] = words;
        let vector = |x: i32, y: i32| Vec2::new(Length::from_bits(x), Length::from_bits(y));
        KeptManifold {
            normal: Vec2::new(Unit::from_bits(n_x), Unit::from_bits(n_y)),
            arm_a: vector(a_x, a_y),
            arm_b: vector(b_x, b_y),
            to_second: vector(x, y),
            between: vector(between_x, between_y),
            angles: [angle_a, angle_b].map(|angle| Angle::from_bits(angle.cast_unsigned())),
            separations: [s0, s1].map(Step::from_bits),
        }
    }

    #[inline]
    pub(crate) fn can_be_kept(&self) -> bool {
        self.normal != Vec2::ZERO
    }

    pub(crate) fn end(&mut self) {
        self.normal = Vec2::ZERO;
    }

    /// Whether the normal is zero or a unit vector, and points beyond `count` are zero.
    pub(crate) fn is_valid(&self, count: u8) -> bool {
        /// Largest error of the square of a normal's length, in units of 2^-60.
        const ERROR_MAX: u64 = 1 << 34;
        let square = |unit: Unit| i64::from(unit.to_bits()).unsigned_abs().pow(2);
        let length = square(self.normal.x).saturating_add(square(self.normal.y));
        (!self.can_be_kept() || length.abs_diff(1 << 60) <= ERROR_MAX)
            && (count > 1 || self.to_second == Vec2::ZERO && self.separations[1] == Step::ZERO)
            && (count > 0 || *self == Self::NONE)
    }

    /// Separations of the first `count` points at other poses, to first order. `None` if the shapes have moved relative
    /// to each other by more than `limit` metres or a body has rotated by more than [`TURN_MAX`].
    ///
    /// ```text
    /// d = change of between + thetaB x rB - thetaA x rA,   s' = s + n . d
    /// |d.x| + |d.y| + reachA |thetaA| + reachB |thetaB| <= limit
    /// ```
    ///
    /// `d` is the displacement of B relative to A at the point, `r` a lever arm, `theta` a rotation since the manifold
    /// was computed, and `s` and `s'` are the stored and the new separation.
    #[inline]
    pub(crate) fn separations_at(
        &self,
        [a, b]: [KeptSide; 2],
        count: u8,
        limit: Length,
    ) -> Option<[Step; 2]> {
        let shift = wrapping_sub(wrapped_difference(b.pose.centre, a.pose.centre), self.between);
        let (theta_a, theta_b) = (a.rotation_since(self.angles[0])?, b.rotation_since(self.angles[1])?);
        let (r_a, r_b, to_second) = (self.arm_a, self.arm_b, self.to_second);
        let turned = theta_a.abs() * wide(a.reach) + theta_b.abs() * wide(b.reach);
        let limit = wide(limit) - round_shift(turned, Unit::FRAC_NBITS);
        // `d` has 52 fraction bits. In raw units, coordinates of `shift` and of arms are at most 2^31, and rotations
        // are below 2^27, so the sums are below 2^62.
        let mut d_x = (wide(shift.x) << Unit::FRAC_NBITS) - theta_b * wide(r_b.y) + theta_a * wide(r_a.y);
        let mut d_y = (wide(shift.y) << Unit::FRAC_NBITS) + theta_b * wide(r_b.x) - theta_a * wide(r_a.x);
        let mut separations = [Step::ZERO; 2];
        for (separation, moved) in self.separations.iter().zip(&mut separations).take(usize::from(count)) {
            let (x, y) = (round_shift(d_x, Unit::FRAC_NBITS), round_shift(d_y, Unit::FRAC_NBITS));
            if x.abs() + y.abs() > limit {
                return None;
            }
            let along = i64::from(self.normal.x.to_bits()) * x + i64::from(self.normal.y.to_bits()) * y;
            let change =
                saturate(round_shift(along, Unit::FRAC_NBITS + Length::FRAC_NBITS - Step::FRAC_NBITS));
            *moved = separation.saturating_add(Step::from_bits(change));
            d_x -= (theta_b - theta_a) * wide(to_second.y);
            d_y += (theta_b - theta_a) * wide(to_second.x);
        }
        Some(separations)
    }
}

impl KeptSide {
    /// Rotation since `angle` in radians with 30 fraction bits. `None` if it exceeds [`TURN_MAX`]. 0 for a disc about
    /// the centre of mass.
    #[inline]
    fn rotation_since(&self, angle: Angle) -> Option<i64> {
        if self.reach == Length::ZERO {
            return Some(0);
        }
        let turn = (self.pose.angle - angle).to_bits().cast_signed();
        // `TAU` has 35 bits and the turn at most 27, so that the product fits 64 bits.
        let radians = || round_shift(i64::from(turn) * TAU.to_bits(), 34);
        (-TURN_MAX..=TURN_MAX).contains(&turn).then(radians)
    }
}

#[inline]
fn wide(length: Length) -> i64 {
    length.to_bits().into()
}

/// `to - from`, modulo 1024 m.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "wraps around")]
fn wrapped_difference(to: Vec2<Fx>, from: Vec2<Fx>) -> Vec2<Length> {
    let axis = |to: Fx, from: Fx| {
        Length::from_bits(round_shift(to.wrapping_sub(from).to_bits(), 32 - Length::FRAC_NBITS) as i32)
    };
    Vec2::new(axis(to.x, from.x), axis(to.y, from.y))
}

#[inline]
fn wrapping_add(a: Vec2<Length>, b: Vec2<Length>) -> Vec2<Length> {
    Vec2::new(a.x.wrapping_add(b.x), a.y.wrapping_add(b.y))
}

#[inline]
fn wrapping_sub(a: Vec2<Length>, b: Vec2<Length>) -> Vec2<Length> {
    Vec2::new(a.x.wrapping_sub(b.x), a.y.wrapping_sub(b.y))
}

#[cfg(test)]
mod tests;
