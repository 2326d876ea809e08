//! Rows on the angle of a batch of hinges, with the equations of `joint/row.rs`.
//!
//! ```text
//! vn = eB uB - eA uA,   w = massScale vn + push + impulseScale L,   L' = clamp(L - w, lo, hi),   d = L' - L
//! uA -= fA d,  uB += fB d
//! ```

mod blocked;

use super::super::super::context::Pass;
use super::super::super::limits::Faults;
use super::super::super::pair::{BodyPairW, RATIO, UNIT, clamp};
use super::super::super::softness::Softness;
use super::super::parts::slot;
use super::super::pose::BodyRotation;
use super::super::state::JointImpulses;
use super::angle_input::AngleInput;
use crate::math::{Fx, Speed, Unit, round_shift_wide, saturate, saturate_wide};
use crate::simd::{Ints, Lanes};

/// The rows of a batch. Lanes without a row have gains of 0 or bounds of 0.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(in crate::solver) struct AngleRows<const N: usize> {
    e: [Ints<N>; 2],
    f: [Ints<N>; 2],
    spring: SpringRow<N>,
    drive: DriveRow<N>,
    /// The lower and the upper limit. The row of the upper limit is reversed.
    limits: [LimitRow<N>; 2],
    limit_max: Ints<N>,
    /// Target angles of springs, in units of 2^-32 turn.
    targets: [i64; N],
    stiffness: [Fx; N],
    closed: [Fx; N],
    open: [Fx; N],
    has_spring: bool,
    has_drive: bool,
    has_limit: bool,
    /// Whether a row holds the angle in any lane. If no row does, the relax pass leaves out the spring rows.
    holds: bool,
}

#[derive(Clone, Debug)]
struct SpringRow<const N: usize> {
    lambda: Ints<N>,
    max: Ints<N>,
    mass_scale: Ints<N>,
    impulse_scale: Ints<N>,
    push: Ints<N>,
    /// -1 where the row holds the angle.
    holds: Ints<N>,
}

#[derive(Clone, Debug)]
struct DriveRow<const N: usize> {
    lambda: Ints<N>,
    max: Ints<N>,
    bias: Ints<N>,
}

#[derive(Clone, Debug)]
struct LimitRow<const N: usize> {
    lambda: Ints<N>,
    push: Ints<N>,
    /// -1 where the limit is not reached.
    open: Ints<N>,
    bounds: [i64; N],
}

impl<const N: usize> LimitRow<N> {
    const NONE: Self = LimitRow { lambda: Ints::ZERO, push: Ints::ZERO, open: Ints::ZERO, bounds: [0; N] };
}

impl<const N: usize> AngleRows<N> {
    pub(super) const NONE: Self = AngleRows {
        e: [Ints::ZERO; 2],
        f: [Ints::ZERO; 2],
        has_spring: false,
        has_drive: false,
        has_limit: false,
        holds: false,
        spring: SpringRow {
            lambda: Ints::ZERO,
            max: Ints::ZERO,
            mass_scale: Ints::ZERO,
            impulse_scale: Ints::ZERO,
            push: Ints::ZERO,
            holds: Ints::ZERO,
        },
        drive: DriveRow { lambda: Ints::ZERO, max: Ints::ZERO, bias: Ints::ZERO },
        limits: [LimitRow::NONE, LimitRow::NONE],
        limit_max: Ints::ZERO,
        targets: [0; N],
        stiffness: [Fx::ZERO; N],
        closed: [Fx::ZERO; N],
        open: [Fx::ZERO; N],
    };

    pub(super) fn put(&mut self, lane: usize, input: &AngleInput) {
        for side in 0..2 {
            self.e[side].0[lane] = input.e[side].to_bits();
            self.f[side].0[lane] = input.f[side].to_bits();
        }
        if let Some(spring) = &input.spring {
            self.has_spring = true;
            self.holds |= spring.held;
            self.spring.lambda.0[lane] = spring.lambda.to_bits();
            self.spring.max.0[lane] = spring.max.to_bits();
            self.spring.mass_scale.0[lane] = spring.mass_scale.to_bits();
            self.spring.impulse_scale.0[lane] = spring.impulse_scale.to_bits();
            self.spring.holds.0[lane] = -i32::from(spring.held);
            self.targets[lane] = spring.target;
            self.stiffness[lane] = spring.stiffness;
        }
        if let Some(drive) = &input.drive {
            self.has_drive = true;
            self.drive.lambda.0[lane] = drive.lambda.to_bits();
            self.drive.max.0[lane] = drive.max.to_bits();
            self.drive.bias.0[lane] = drive.bias.to_bits();
        }
        if let Some(limit) = &input.limit {
            self.has_limit = true;
            self.limit_max.0[lane] = limit.max.to_bits();
            self.closed[lane] = limit.closed;
            self.open[lane] = limit.open;
            for (row, (bound, lambda)) in
                self.limits.iter_mut().zip([limit.lower, limit.upper].into_iter().zip(limit.lambda))
            {
                row.bounds[lane] = bound;
                row.lambda.0[lane] = lambda.to_bits();
            }
        }
    }

    /// Loads the impulses of a joint, clamped to the bounds of their rows. The bounds are 0 if there is no row.
    pub(super) fn reload(&mut self, lane: usize, impulses: &JointImpulses) {
        let AngleRows { spring, drive, limits, limit_max, .. } = self;
        let within = |slot: u8, max: i32| impulses.0[usize::from(slot)].to_bits().clamp(-max, max);
        spring.lambda.0[lane] = within(slot::SPRING, spring.max.0[lane]);
        drive.lambda.0[lane] = within(slot::DRIVE, drive.max.0[lane]);
        for (row, side) in limits.iter_mut().zip(0..) {
            row.lambda.0[lane] = within(slot::LIMIT + side, limit_max.0[lane]).max(0);
        }
    }

    /// Impulses of the spring, the motor, the lower limit and the upper limit.
    pub(super) fn impulses(&self, lane: usize) -> [Speed; 4] {
        let [lower, upper] = &self.limits;
        [&self.spring.lambda, &self.drive.lambda, &lower.lambda, &upper.lambda]
            .map(|lambda| Speed::from_bits(lambda.0[lane]))
    }

    /// Computes the pushes of springs and limits at the current pose. `turns` are the joint angles at the start of the
    /// tick, in units of 2^-32 turn.
    pub(super) fn refresh(&mut self, turns: &[i64], [a, b]: &[[u32; N]; 2], body_rotations: &[BodyRotation]) {
        for (lane, turn) in turns.iter().enumerate() {
            let (a, b) = (&body_rotations[a[lane] as usize], &body_rotations[b[lane] as usize]);
            let position = turn.wrapping_add(b.turns).wrapping_sub(a.turns);
            if self.has_spring {
                let stretch = position.saturating_sub(self.targets[lane]);
                self.spring.push.0[lane] = speed_of(stretch, self.stiffness[lane]);
            }
            if self.has_limit {
                let [lower, upper] = &mut self.limits;
                let gaps = [
                    position.saturating_sub(lower.bounds[lane]),
                    upper.bounds[lane].saturating_sub(position),
                ];
                for (row, gap) in [lower, upper].into_iter().zip(gaps) {
                    let open = gap > 0;
                    row.open.0[lane] = -i32::from(open);
                    row.push.0[lane] = speed_of(gap, if open { self.open[lane] } else { self.closed[lane] });
                }
            }
        }
    }

    #[inline(always)]
    pub(super) fn warm_start<L: Lanes<N>>(&self, pair: &mut BodyPairW<L, N>, faults: &mut Faults) {
        if self.has_spring {
            pair.turn(&self.f, L::load(&self.spring.lambda), faults);
        }
        if self.has_drive {
            pair.turn(&self.f, L::load(&self.drive.lambda), faults);
        }
        if self.has_limit {
            let [lower, upper] = &self.limits;
            pair.turn(&self.f, L::load(&lower.lambda), faults);
            pair.turn(&self.f, L::sub(L::splat(0), L::load(&upper.lambda)), faults);
        }
    }

    #[inline(always)]
    pub(super) fn solve<L: Lanes<N>>(
        &mut self,
        pass: Pass,
        softness: &Softness,
        pair: &mut BodyPairW<L, N>,
        faults: &mut Faults,
    ) {
        if self.has_spring && (pass == Pass::Bias || self.holds) {
            self.solve_spring(pass, pair, faults);
        }
        self.solve_drive(pair, faults);
        self.solve_limits(pass, softness, pair, faults);
    }

    #[inline(always)]
    pub(super) fn solve_drive<L: Lanes<N>>(&mut self, pair: &mut BodyPairW<L, N>, faults: &mut Faults) {
        if self.has_drive {
            let target = self.drive_target::<L>();
            let DriveRow { lambda, max, .. } = &mut self.drive;
            let (old, max) = (L::load(lambda), L::load(max));
            let w = L::sub_saturating(velocity::<L, N>(&self.e, max, pair, faults), target);
            let new = clamp::<L, N>(L::sub_saturating(old, w), max);
            L::store(new, lambda);
            pair.turn(&self.f, L::sub(new, old), faults);
        }
    }

    /// Target speed, clamped to the speeds at which the limits may be approached (see `Parts::drive_within`).
    #[inline(always)]
    fn drive_target<L: Lanes<N>>(&self) -> L::Int {
        let zero = L::splat(0);
        let speed = L::sub(zero, L::load(&self.drive.bias));
        if !self.has_limit {
            return speed;
        }
        // A saturated push may be the smallest number, whose negative does not fit.
        let push = |limit: &LimitRow<N>| L::max(L::load(&limit.push), L::splat(-i32::MAX));
        let [behind, ahead] = self.limits.each_ref().map(push);
        let within = L::max(L::min(speed, ahead), L::sub(zero, behind));
        L::select(L::greater(L::load(&self.limit_max), zero), within, speed)
    }

    #[inline(always)]
    fn solve_limits<L: Lanes<N>>(
        &mut self,
        pass: Pass,
        softness: &Softness,
        pair: &mut BodyPairW<L, N>,
        faults: &mut Faults,
    ) {
        if self.has_limit {
            self.solve_limit(0, pass, softness, pair, faults);
            self.solve_limit(1, pass, softness, pair, faults);
        }
    }

    /// Solves springs in the bias pass, and rows that hold the angle in both passes.
    #[inline(always)]
    fn solve_spring<L: Lanes<N>>(&mut self, pass: Pass, pair: &mut BodyPairW<L, N>, faults: &mut Faults) {
        let w = self.wanted_of_spring(pass, pair, faults);
        let SpringRow { lambda, max, .. } = &mut self.spring;
        let (old, max) = (L::load(lambda), L::load(max));
        let new = clamp::<L, N>(L::sub_saturating(old, w), max);
        L::store(new, lambda);
        pair.turn(&self.f, L::sub(new, old), faults);
    }

    #[inline(always)]
    fn wanted_of_spring<L: Lanes<N>>(
        &self,
        pass: Pass,
        pair: &BodyPairW<L, N>,
        faults: &mut Faults,
    ) -> L::Int {
        let SpringRow { lambda, max, mass_scale, impulse_scale, push, holds } = &self.spring;
        let (old, max) = (L::load(lambda), L::load(max));
        let held = L::negative(L::load(holds));
        let solved = if pass == Pass::Bias { max } else { L::select(held, max, L::splat(0)) };
        let vn = velocity::<L, N>(&self.e, solved, pair, faults);
        match pass {
            Pass::Bias => {
                let scales = [L::load(mass_scale), L::load(impulse_scale)];
                L::add_saturating(softened::<L, N>(scales, vn, old), L::load(push))
            }
            Pass::Relax => L::select(held, vn, L::splat(0)),
        }
    }

    /// Solves the lower limits (side 0) or the upper limits (side 1). As with contacts, the relax pass leaves out a
    /// limit that is not reached and has no impulse.
    #[inline(always)]
    fn solve_limit<L: Lanes<N>>(
        &mut self,
        side: usize,
        pass: Pass,
        softness: &Softness,
        pair: &mut BodyPairW<L, N>,
        faults: &mut Faults,
    ) {
        let zero = L::splat(0);
        let LimitRow { lambda, push, open, .. } = &mut self.limits[side];
        let max = L::load(&self.limit_max);
        let vn = velocity::<L, N>(&self.e, max, pair, faults);
        let vn = facing::<L, N>(side, L::max(vn, L::splat(-i32::MAX)));
        let (old, push, open) = (L::load(lambda), L::load(push), L::negative(L::load(open)));
        let w = match pass {
            Pass::Bias => {
                let mass_scale =
                    L::select(open, L::splat(Unit::ONE.to_bits()), L::splat(softness.mass_scale.to_bits()));
                let impulse_scale = L::select(open, zero, L::splat(softness.impulse_scale.to_bits()));
                L::add_saturating(softened::<L, N>([mass_scale, impulse_scale], vn, old), push)
            }
            Pass::Relax => {
                let w = L::add_saturating(vn, L::select(open, push, zero));
                let untouched = L::both(open, L::greater(L::splat(1), old));
                L::select(untouched, zero, w)
            }
        };
        let new = L::min(L::max(L::sub_saturating(old, w), zero), max);
        L::store(new, lambda);
        pair.turn(&self.f, facing::<L, N>(side, L::sub(new, old)), faults);
    }
}

/// `value` for the lower limit (side 0), negated for the upper limit, whose row is reversed.
#[inline(always)]
fn facing<L: Lanes<N>, const N: usize>(side: usize, value: L::Int) -> L::Int {
    if side == 0 { value } else { L::sub(L::splat(0), value) }
}

/// `massScale v + impulseScale L`, where the scales add up to 1.
#[inline(always)]
fn softened<L: Lanes<N>, const N: usize>(
    [mass_scale, impulse_scale]: [L::Int; 2],
    v: L::Int,
    lambda: L::Int,
) -> L::Int {
    L::narrow::<UNIT>(L::add_wide(L::mul(mass_scale, v), L::mul(impulse_scale, lambda)))
}

/// Angular velocity of B relative to A, as a speed. In lanes in which `max` is above 0 (the lanes with a row), a
/// velocity that does not fit counts as a fault.
#[inline(always)]
fn velocity<L: Lanes<N>, const N: usize>(
    e: &[Ints<N>; 2],
    max: L::Int,
    pair: &BodyPairW<L, N>,
    faults: &mut Faults,
) -> L::Int {
    let a = L::mul(L::load(&e[0]), pair.a.turn);
    let b = L::mul(L::load(&e[1]), pair.b.turn);
    let (vn, out) = L::narrow_saturating::<RATIO>(L::sub_wide(b, a));
    if L::any(out) {
        *faults += u64::from(L::count(L::both(out, L::greater(max, L::splat(0)))));
    }
    vn
}

/// Converts units of 2^-32 turn to a speed, saturated.
#[inline]
fn speed_of(turns: i64, per_turn: Fx) -> i32 {
    const EXTRA: u32 = 32 + Fx::FRAC_NBITS - Speed::FRAC_NBITS;
    let wide = i128::from(turns) * i128::from(per_turn.to_bits());
    saturate(saturate_wide(round_shift_wide(wide, EXTRA)))
}
