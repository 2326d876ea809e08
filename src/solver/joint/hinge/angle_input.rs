//! Compact copies of the rows on the angle, from which batches are filled.

use alloc::vec::Vec;

use super::super::super::row::{MassFractions, Row};
use super::super::super::softness::Softness;
use super::super::options::{Drive, JointLimit, Spring};
use super::super::parts::{impulse, slot};
use super::super::row::lambda_of;
use super::super::state::{JointImpulses, turns_of};
use super::input::HingeBody;
use crate::math::{Fx, Ratio, Reciprocal, Speed, TAU, Unit, fx_mul, narrow};

/// Largest impulse of a row on the angle. The difference of two such impulses fits the format.
pub(in super::super) const ANGLE_MAX: Speed = Speed::lit("511");

#[derive(Clone, Copy, Debug)]
pub(in super::super) struct AngleParts {
    pub(in super::super) spring: Option<Spring>,
    /// Whether the angle is held rigidly at 0. It is ignored if there is a spring.
    pub(in super::super) held: bool,
    pub(in super::super) drive: Option<Drive>,
    pub(in super::super) limit: Option<JointLimit>,
}

impl AngleParts {
    pub(in super::super) fn is_empty(&self) -> bool {
        let AngleParts { spring, held, drive, limit } = self;
        spring.is_none() && !held && drive.is_none() && limit.is_none()
    }
}

/// Cache of the numbers that depend only on a spring or on the bodies of a hinge, because they take many divisions and
/// many joints are equal. An entry depends only on its key and does not become invalid.
#[derive(Clone, Debug, Default)]
pub(super) struct Memo {
    /// The last spring (hertz, damping ratio, rate) and its softness.
    spring: Option<((Fx, Fx, u32), Softness)>,
    /// Numbers of a row on the angle, at the hash of their key.
    angulars: Vec<Option<Angular>>,
}

impl Memo {
    /// Binary logarithm of the number of cached rows.
    const ANGULARS_BITS: u32 = 6;

    fn softness(&mut self, hertz: Fx, damping_ratio: Fx, rate: u32) -> Softness {
        let wanted = (hertz, damping_ratio, rate);
        match self.spring {
            Some((cached, softness)) if cached == wanted => softness,
            _ => self.spring.insert((wanted, Softness::spring(hertz, damping_ratio, rate))).1,
        }
    }

    fn angular(&mut self, wanted: AngularKey) -> Angular {
        self.angulars.resize(1 << Self::ANGULARS_BITS, None);
        let place = &mut self.angulars[wanted.hash()];
        match *place {
            Some(cached) if cached.key == wanted => cached,
            _ => *place.insert(Angular::new(wanted)),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct AngularKey {
    /// `1 / k` and mass of each body.
    bodies: [(Reciprocal, Fx); 2],
    torque: Fx,
    rate: u32,
}

impl AngularKey {
    fn hash(&self) -> usize {
        let parts = self.bodies.iter().flat_map(|(inverse, mass)| [inverse.parts().0.into(), mass.to_bits()]);
        let hash = parts.fold(0u64, |hash, part| {
            (hash.rotate_left(5) ^ part.cast_unsigned()).wrapping_mul(0x9E37_79B9_7F4A_7C15)
        });
        (hash >> (u64::BITS - Memo::ANGULARS_BITS)) as usize
    }
}

#[derive(Clone, Copy, Debug)]
struct Angular {
    key: AngularKey,
    e: [Ratio; 2],
    f: [Unit; 2],
    s: Fx,
    /// Largest impulse; 0 if impulses turn neither body.
    max: Speed,
    drive_max: Speed,
}

impl Angular {
    fn new(key: AngularKey) -> Self {
        let AngularKey { bodies: [(a, mass_a), (b, mass_b)], torque, rate } = key;
        let (row, denominator, s) = Row::angular(a, b, MassFractions::of_masses(mass_a, mass_b));
        let (e, f) = row.turning_parts();
        let s = Fx::from(s);
        let max = if denominator == 0 { Speed::ZERO } else { ANGLE_MAX };
        let drive_max = lambda_of(impulse(torque, (mass_a, mass_b), rate), denominator, s).min(max);
        Angular { key, e, f, s, max, drive_max }
    }
}

#[derive(Clone, Copy, Debug)]
pub(in super::super) struct AngleInput {
    pub(super) e: [Ratio; 2],
    pub(super) f: [Unit; 2],
    pub(super) spring: Option<SpringInput>,
    pub(super) drive: Option<DriveInput>,
    pub(super) limit: Option<LimitInput>,
}

/// A spring, or a row that holds the angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpringInput {
    pub(super) mass_scale: Unit,
    pub(super) impulse_scale: Unit,
    /// Target angle in units of 2^-32 turn.
    pub(super) target: i64,
    /// Push per turn of distance from the target, as a speed: `massScale biasRate 2 pi s`.
    pub(super) stiffness: Fx,
    /// Largest impulse; 0 if impulses turn neither body.
    pub(super) max: Speed,
    pub(super) held: bool,
    pub(super) lambda: Speed,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct DriveInput {
    /// The negated target speed.
    pub(super) bias: Speed,
    pub(super) max: Speed,
    pub(super) lambda: Speed,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct LimitInput {
    /// Lower limit in units of 2^-32 turn.
    pub(super) lower: i64,
    /// Upper limit in units of 2^-32 turn.
    pub(super) upper: i64,
    /// Push per turn beyond a limit, as a speed: `massScale biasRate 2 pi s`.
    pub(super) closed: Fx,
    /// Speed that reaches a limit within a sub-step, per turn of distance from the limit: `2 pi s / h`.
    pub(super) open: Fx,
    /// Largest impulse; 0 if impulses turn neither body.
    pub(super) max: Speed,
    pub(super) lambda: [Speed; 2],
}

impl AngleInput {
    /// Limits and rows that hold the angle have the softness `rigid`.
    pub(in super::super) fn new(
        parts: &AngleParts,
        ends: [&HingeBody; 2],
        impulses: &JointImpulses,
        memo: &mut Memo,
        rate: u32,
        rigid: &Softness,
    ) -> Self {
        let Angular { key: _, e, f, s, max, drive_max } = memo.angular(AngularKey {
            bodies: ends.map(|end| (end.inverse_gyration, end.mass)),
            torque: parts.drive.map_or(Fx::ZERO, |drive| drive.max),
            rate,
        });
        let lambda = |slot: u8| impulses.0[usize::from(slot)];
        let per_turn = |rate: Fx| fx_mul(fx_mul(TAU, s), rate);
        let stiffness = |soft: &Softness| fx_mul(per_turn(soft.bias_rate.into()), soft.mass_scale.into());
        let spring = |softness: &Softness, target: Fx, held: bool| SpringInput {
            mass_scale: softness.mass_scale,
            impulse_scale: softness.impulse_scale,
            target: turns_of(target),
            stiffness: stiffness(softness),
            max,
            held,
            lambda: lambda(slot::SPRING).clamp(-max, max),
        };
        let from_spring = parts.spring.map(|Spring { hertz, damping_ratio, target }| {
            spring(&memo.softness(hertz, damping_ratio, rate), target, false)
        });
        let drive = parts.drive.map(|Drive { speed, max: _ }| {
            let speed: Speed = narrow(fx_mul(speed, s));
            DriveInput {
                bias: speed.saturating_neg(),
                max: drive_max,
                lambda: lambda(slot::DRIVE).clamp(-drive_max, drive_max),
            }
        });
        let limit = parts.limit.map(|JointLimit { lower, upper }| LimitInput {
            lower: turns_of(lower),
            upper: turns_of(upper),
            closed: stiffness(rigid),
            open: per_turn(Fx::from_num(rate)),
            max,
            lambda: [0, 1].map(|side| lambda(slot::LIMIT + side).clamp(Speed::ZERO, max)),
        });
        let held = parts.held.then(|| spring(rigid, Fx::ZERO, true));
        AngleInput { e, f, spring: from_spring.or(held), drive, limit }
    }
}
