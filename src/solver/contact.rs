//! Contacts as rows: one along the normal and one along the tangent for each point.
//!
//! Siblings in this folder have the same functions in the same order: `prepare`, `warm_start`, `solve`, `store`.

use alloc::boxed::Box;

use super::body::SolverBody;
use super::limits::{Faults, IMPULSE_MAX};
use super::rolling::Rolling;
use super::row::{Denominator, Lever, MassFractions, Row, impulse_of, lambda_of, separation};
use super::settings::Tuning;
use super::softness::Softness;
use crate::body::{Body, Material};
use crate::collision::{Contact, Manifold, ManifoldPoint, PointImpulse};
use crate::math::{Fx, Grip, Rate, Speed, Step, Unit, fx_mul, mul, narrow, saturate};

/// Whether a pass removes position errors or only velocity errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pass {
    /// Removes position errors by velocity.
    Bias,
    /// Takes the velocity away again that removing position errors has left.
    Relax,
}

/// Which of a contact's two points is solved first. It alternates: the first one turns the body a little, and always
/// the same way it makes a stack of ten boxes sway by 4.7 mm while it settles instead of 0.05 mm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sweep {
    Forward,
    Backward,
}

impl Sweep {
    /// For an iteration of a sub-step: neighbours differ in either direction.
    pub(crate) const fn of(sub_step: u64, iteration: u32) -> Self {
        if sub_step % 2 == iteration as u64 % 2 { Sweep::Forward } else { Sweep::Backward }
    }
}

/// A pair of touching shapes, for one tick.
#[derive(Clone, Debug)]
pub(crate) struct ContactConstraint {
    body_a: u32,
    body_b: u32,
    softness: Softness,
    restitution: Unit,
    /// How fast the surfaces move against each other by themselves, against the tangent.
    surface_speed: Speed,
    /// Few surfaces resist rolling, and the others should not carry a row for it through the caches.
    rolling: Option<Box<Rolling>>,
    count: u8,
    points: [ContactPoint; 2],
}

#[derive(Clone, Debug)]
struct ContactPoint {
    normal: Row,
    tangent: Row,
    /// At the start of the tick.
    separation: Step,
    /// Friction limit for each unit of `normal_lambda`: `mu Dt / Dn`.
    grip: Grip,
    normal_lambda: Speed,
    tangent_lambda: Speed,
    /// Relative normal velocity when the shapes first pushed each other in this tick, for restitution.
    approach: Speed,
    /// Whether the shapes have pushed each other in this tick.
    pushed: bool,
    normal_denominator: Denominator,
    tangent_denominator: Denominator,
    feature: u16,
}

/// Two points that bounce are solved against each other until both leave as they should. After one round the first
/// leaves too fast: a tall box dropped flat gained a third of its energy, and spun. A round takes away at least 3/4
/// of what is wrong for boxes of up to 1 to 3.
const RESTITUTION_ITERATIONS: u32 = 12;

/// Rounds in which the two points of a contact are solved against each other, and the change below which the second
/// leaves the first alone, in m/s. At an impact one round turns the body: ten boxes that fall on each other from 5 or
/// 10 mm then sway by 12 mm, and with up to four rounds by 1 mm. Where piles rest the first round is mostly enough: a
/// pyramid of 5050 boxes costs a tenth more.
const NORMAL_ROUNDS_MAX: u32 = 4;
const SETTLED: Speed = Speed::lit("0.005");

/// The surface that two shapes have in common.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    pub(crate) friction: Fx,
    pub(crate) restitution: Fx,
    /// In metres: the largest torque for each unit of normal force.
    pub(crate) rolling_resistance: Fx,
    /// In m/s.
    pub(crate) surface_speed: Fx,
}

impl Surface {
    /// What two materials have in common, on shapes that are rounded by a radius in metres.
    pub(crate) fn between((a, radius_a): (&Material, Fx), (b, radius_b): (&Material, Fx)) -> Self {
        let resistance = a.rolling_resistance.max(b.rolling_resistance);
        Surface {
            friction: a.mixed_friction(b),
            restitution: a.mixed_restitution(b),
            rolling_resistance: fx_mul(resistance, radius_a.max(radius_b)),
            surface_speed: a.surface_speed.saturating_add(b.surface_speed),
        }
    }
}

/// How the impulses of the last tick were carried over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct WarmStarts {
    /// Points in contact.
    pub(crate) points: u32,
    /// Points that were there in the last tick.
    pub(crate) kept: u32,
    /// Points with an impulse in the last tick that are gone, although the shapes still touch.
    pub(crate) lost: u32,
}

impl ContactConstraint {
    pub(crate) fn prepare(
        manifold: &Manifold,
        memory: &Contact,
        surface: Surface,
        (slot_a, a): (u32, &Body),
        (slot_b, b): (u32, &Body),
        tuning: &Tuning,
        warm: &mut WarmStarts,
    ) -> Self {
        let fractions = MassFractions::of(a, b);
        let to_a = (manifold.origin - a.centre_of_mass()).narrow();
        let to_b = (manifold.origin - b.centre_of_mass()).narrow();
        let mut point = |point: &ManifoldPoint| {
            let lever_a = Lever { arm: point.anchor + to_a, inverse_gyration: a.mass.inverse_gyration };
            let lever_b = Lever { arm: point.anchor + to_b, inverse_gyration: b.mass.inverse_gyration };
            let (normal, normal_denominator) = Row::prepare(manifold.normal, lever_a, lever_b, fractions);
            let (tangent, tangent_denominator) =
                Row::prepare(manifold.normal.perp(), lever_a, lever_b, fractions);
            let carried = memory.impulse_of(point.feature);
            warm.points += 1;
            warm.kept += u32::from(carried.is_some());
            let carried = carried.unwrap_or_default();
            ContactPoint {
                normal,
                tangent,
                separation: point.separation,
                grip: grip(surface.friction, tangent_denominator, normal_denominator),
                normal_lambda: lambda_of(carried.normal, normal_denominator),
                tangent_lambda: lambda_of(carried.tangent, tangent_denominator),
                approach: Speed::ZERO,
                pushed: false,
                normal_denominator,
                tangent_denominator,
                feature: point.feature.0,
            }
        };
        let points = manifold.points();
        let first = point(&points[0]);
        let second = points.get(1).map_or_else(|| first.clone(), point);
        let still_there = |old: &PointImpulse| points.iter().any(|point| point.feature.0 == old.feature);
        let lost = memory.points().iter().filter(|old| old.normal > 0 && !still_there(old)).count();
        warm.lost += u32::try_from(lost).expect("at most 2 points");
        let normals = [first.normal_denominator, second.normal_denominator];
        let rolling = Rolling::prepare(&surface, (a, b), fractions, normals, memory.rolling).map(Box::new);
        let immovable = !(a.is_dynamic() && b.is_dynamic());
        ContactConstraint {
            body_a: slot_a,
            body_b: slot_b,
            softness: if immovable { tuning.contact_immovable } else { tuning.contact },
            restitution: narrow(surface.restitution),
            surface_speed: narrow(surface.surface_speed),
            rolling,
            count: if points.len() == 2 { 2 } else { 1 },
            points: [first, second],
        }
    }

    pub(crate) fn warm_start(&mut self, bodies: &mut [SolverBody], faults: &mut Faults) {
        let (a, b) = SolverBody::pair(bodies, self.body_a, self.body_b);
        for point in &mut self.points[..usize::from(self.count)] {
            point.normal.apply(point.normal_lambda, a, b, faults);
            point.tangent.apply(point.tangent_lambda, a, b, faults);
        }
        if let Some(rolling) = &mut self.rolling {
            rolling.warm_start(a, b, faults);
        }
    }

    /// Remembers how fast shapes that bounce approach, until they push each other: before the solver stops them.
    pub(crate) fn observe_approach(&mut self, bodies: &[SolverBody], faults: &mut Faults) {
        if self.restitution == Unit::ZERO {
            return;
        }
        let (a, b) = (&bodies[self.body_a as usize], &bodies[self.body_b as usize]);
        for point in self.points[..usize::from(self.count)].iter_mut().filter(|point| !point.pushed) {
            point.approach = point.normal.velocity(a, b, faults);
        }
    }

    pub(crate) fn solve(
        &mut self,
        pass: Pass,
        sweep: Sweep,
        tuning: &Tuning,
        bodies: &mut [SolverBody],
        faults: &mut Faults,
    ) {
        let (a, b) = SolverBody::pair(bodies, self.body_a, self.body_b);
        let softness = self.softness;
        let points = &mut self.points[..usize::from(self.count)];
        let mut solve_normal =
            |point: &mut ContactPoint| point.solve_normal(a, b, pass, &softness, tuning, faults);
        match (sweep, &mut *points) {
            (Sweep::Forward, [first, second]) | (Sweep::Backward, [second, first]) => {
                for _ in 0..NORMAL_ROUNDS_MAX {
                    solve_normal(first);
                    if solve_normal(second).abs() < SETTLED {
                        break;
                    }
                }
            }
            (_, points) => points.iter_mut().for_each(|point| {
                solve_normal(point);
            }),
        }
        if let Some(rolling) = &mut self.rolling {
            let second = points.get(1).map_or(Speed::ZERO, |point| point.normal_lambda);
            rolling.solve(a, b, [points[0].normal_lambda, second], faults);
        }
        let surface_speed = self.surface_speed;
        let mut solve_tangent = |point: &mut ContactPoint| point.solve_tangent(a, b, surface_speed, faults);
        match sweep {
            Sweep::Forward => points.iter_mut().for_each(&mut solve_tangent),
            Sweep::Backward => points.iter_mut().rev().for_each(&mut solve_tangent),
        }
    }

    /// Once in a tick, after the sub-steps: what approached faster than the threshold and was pushed, leaves.
    pub(crate) fn apply_restitution(
        &mut self,
        tuning: &Tuning,
        bodies: &mut [SolverBody],
        faults: &mut Faults,
    ) {
        if self.restitution == Unit::ZERO {
            return;
        }
        let (a, b) = SolverBody::pair(bodies, self.body_a, self.body_b);
        let restitution = self.restitution;
        let points = &mut self.points[..usize::from(self.count)];
        for _ in 0..if points.len() == 2 { RESTITUTION_ITERATIONS } else { 1 } {
            for point in points.iter_mut() {
                if point.pushed && point.approach <= -tuning.restitution_threshold {
                    let bounce: Speed = mul(restitution, point.approach);
                    let bounds = (Speed::ZERO, IMPULSE_MAX);
                    let lambda = &mut point.normal_lambda;
                    point.normal.solve(a, b, bounce, &Softness::RIGID, bounds, lambda, faults);
                }
            }
        }
    }

    /// Whether the shapes have pushed each other in this tick.
    pub(crate) fn has_pushed(&self) -> bool {
        self.points[..usize::from(self.count)].iter().any(|point| point.pushed)
    }

    pub(crate) fn store(&self, memory: &mut Contact) {
        memory.clear_points();
        memory.rolling = self.rolling.as_ref().map_or(Speed::ZERO, |rolling| rolling.store());
        for point in &self.points[..usize::from(self.count)] {
            memory.push_point(PointImpulse {
                feature: point.feature,
                normal: impulse_of(point.normal_lambda, point.normal_denominator),
                tangent: impulse_of(point.tangent_lambda, point.tangent_denominator),
            });
        }
    }
}

impl ContactPoint {
    /// The bodies may touch here but not overlap. Returns the change of impulse.
    #[inline]
    fn solve_normal(
        &mut self,
        a: &mut SolverBody,
        b: &mut SolverBody,
        pass: Pass,
        softness: &Softness,
        tuning: &Tuning,
        faults: &mut Faults,
    ) -> Speed {
        let separation = separation(self.separation, self.normal.displacement(a, b));
        // A gap that the bias pass has not closed is left to the next sub-step: to slow an approach down before it
        // arrives, and to bounce there, would make a ball rebound from above the floor.
        if pass == Pass::Relax && separation > 0 && self.normal_lambda == 0 {
            return Speed::ZERO;
        }
        let (bias, softness) = bias_of(separation, pass, softness, tuning);
        let bounds = (Speed::ZERO, IMPULSE_MAX);
        let d = self.normal.solve(a, b, bias, &softness, bounds, &mut self.normal_lambda, faults);
        self.pushed |= self.normal_lambda > 0;
        d
    }

    /// Coulomb: friction stops sliding, as far as it reaches.
    #[inline]
    fn solve_tangent(
        &mut self,
        a: &mut SolverBody,
        b: &mut SolverBody,
        surface_speed: Speed,
        faults: &mut Faults,
    ) {
        let limit: Speed = mul(self.grip, self.normal_lambda);
        let limit = limit.min(IMPULSE_MAX);
        let bounds = (-limit, limit);
        self.tangent.solve(a, b, surface_speed, &Softness::RIGID, bounds, &mut self.tangent_lambda, faults);
    }
}

/// The velocity that a separation asks for, and how softly.
#[inline]
fn bias_of(separation: Step, pass: Pass, softness: &Softness, tuning: &Tuning) -> (Speed, Softness) {
    if separation > 0 {
        // Speculative: the gap may close within this sub-step, but not more. `s / h`, saturated: a gap too wide
        // for the format is too wide to close.
        let per_second = i64::from(separation.to_bits()) * i64::from(tuning.rate);
        return (Speed::from_bits(saturate(crate::math::round_shift(per_second, 6))), Softness::RIGID);
    }
    match pass {
        Pass::Relax => (Speed::ZERO, Softness::RIGID),
        Pass::Bias => {
            let overlap = separation.saturating_add(tuning.slop).min(Step::ZERO);
            let bias =
                mul::<_, _, fixed::types::extra::U21>(overlap, softness.bias_rate).max(-tuning.push_speed);
            (bias, *softness)
        }
    }
}

/// `mu Dt / Dn`, saturated.
pub(super) fn grip(friction: Fx, tangent: Denominator, normal: Denominator) -> Grip {
    // Denominators have at most 45 bits, so 18 more fit.
    let ratio = (tangent << 18) / (normal >> 2).max(1);
    let friction: Grip = narrow(friction);
    Grip::from_bits(saturate((i64::from(saturate(ratio)) * i64::from(friction.to_bits())) >> 20))
}

/// A check of `bias_of`'s formats: 27 + 18 fraction bits are more than a speed's 21.
const _: () = assert!(Step::FRAC_NBITS + Rate::FRAC_NBITS >= Speed::FRAC_NBITS);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fx;
    use crate::math::Vec2;

    #[test]
    fn grip_is_friction_times_the_ratio_of_denominators() {
        let one = 1i64 << 30;
        assert_eq!(grip(fx!(0.5), one, one), Grip::lit("0.5"));
        assert_eq!(grip(fx!(0.5), 4 * one, one), Grip::lit("2"));
        assert_eq!(grip(fx!(0.5), one, 4 * one), Grip::lit("0.125"));
        assert_eq!(grip(fx!(16), 16130 * one, one), Grip::MAX, "saturated, not wrapped");
    }

    #[test]
    fn a_gap_may_close_within_the_sub_step_and_an_overlap_is_pushed_out_slowly() {
        let tuning = Tuning::new(&super::super::SolverSettings::default(), Vec2::ZERO, 60);
        let (bias, _) = bias_of(Step::lit("0.01"), Pass::Bias, &tuning.contact, &tuning);
        assert!((bias - Speed::lit("2.4")).abs() < Speed::lit("0.00001"), "{bias}: 1 cm in 1/240 s");
        let (bias, _) = bias_of(Step::lit("-0.01"), Pass::Bias, &tuning.contact, &tuning);
        assert!((bias + Speed::lit("0.0906873")).abs() < Speed::lit("0.00001"), "{bias}");
        let (bias, _) = bias_of(Step::lit("-5"), Pass::Bias, &tuning.contact, &tuning);
        assert_eq!(bias, -Speed::lit("3"));
        let (bias, _) = bias_of(Step::lit("-5"), Pass::Relax, &tuning.contact, &tuning);
        assert_eq!(bias, Speed::ZERO);
    }
}
