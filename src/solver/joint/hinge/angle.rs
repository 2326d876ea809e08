//! Rows on the angle of a batch of hinges, with the equations of `joint/row.rs`.
//!
//! ```text
//! vn = eB uB - eA uA,   w = massScale vn + push,   L' = clamp(L - w / s - impulseScale L, lo, hi),   d = L' - L
//! spring: L' = clamp(L - (w + impulseScale L) / (impulseScale + massScale s), -max, max)
//! ```
//!
//! `s` takes account of the pin, whose reaction is applied together with `d` (`pinned.rs`). The softness of limits and
//! of rows that hold the angle is relative to the inertia of the pinned bodies. The stiffness of a spring is relative to
//! the inertia of the bodies about their centres of mass, so that it does not depend on the pose.

mod blocked;
mod drive;
mod pinned;

use super::super::super::context::Pass;
use super::super::super::limits::Faults;
use super::super::super::pair::{BodyPairW, RATIO, UNIT, beyond, clamp};
use super::super::super::softness::Softness;
use super::super::parts::slot;
use super::super::pose::BodyRotation;
use super::super::state::JointImpulses;
use super::angle_input::AngleInput;
use super::batch::Batch;
use crate::math::{Fx, Speed, Unit, round_shift_wide, saturate, saturate_wide};
use crate::simd::{Ints, Lanes};
use pinned::Pinned;

/// The rows of a batch. Lanes without a row have gains of 0 or bounds of 0.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(in crate::solver) struct AngleRows<const N: usize> {
    e: [Ints<N>; 2],
    f: [Ints<N>; 2],
    pinned: Pinned<N>,
    /// Whether `pinned` belongs to the current pose. It is computed on demand, because most rows are limits that are
    /// not reached.
    is_pinned: bool,
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
        pinned: Pinned::NONE,
        is_pinned: false,
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
        self.is_pinned = false;
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
    pub(super) fn warm_start<L: Lanes<N>>(
        &mut self,
        batch: &Batch<N>,
        pair: &mut BodyPairW<L, N>,
        faults: &mut Faults,
    ) {
        let [lower, upper] = [0, 1].map(|side: usize| L::load(&self.limits[side].lambda));
        let (spring, drive) = (L::load(&self.spring.lambda), L::load(&self.drive.lambda));
        for impulse in [spring, drive, lower, L::sub(L::splat(0), upper)] {
            self.turn(batch, pair, impulse, faults);
        }
    }

    /// Applies a change of an impulse.
    #[inline(always)]
    fn turn<L: Lanes<N>>(
        &mut self,
        batch: &Batch<N>,
        pair: &mut BodyPairW<L, N>,
        d: L::Int,
        faults: &mut Faults,
    ) {
        if L::any(beyond::<L, N>(d, L::splat(0))) {
            self.pin::<L>(batch);
            pair.turn(&self.pinned, d, faults);
        }
    }

    #[inline(always)]
    fn pin<L: Lanes<N>>(&mut self, batch: &Batch<N>) {
        if !self.is_pinned {
            self.is_pinned = true;
            let scales = [&self.spring.mass_scale, &self.spring.impulse_scale];
            self.pinned.update::<L>(batch, [&self.e, &self.f], scales);
        }
    }

    #[inline(always)]
    pub(super) fn solve<L: Lanes<N>>(
        &mut self,
        pass: Pass,
        softness: &Softness,
        batch: &Batch<N>,
        pair: &mut BodyPairW<L, N>,
        faults: &mut Faults,
    ) {
        if self.has_spring && (pass == Pass::Bias || self.holds) {
            self.solve_spring(pass, batch, pair, faults);
        }
        if self.has_drive {
            self.solve_drive(batch, pair, faults);
        }
        if self.has_limit {
            self.solve_limit(0, pass, softness, batch, pair, faults);
            self.solve_limit(1, pass, softness, batch, pair, faults);
        }
    }

    /// Solves springs in the bias pass, and rows that hold the angle in both passes.
    #[inline(always)]
    fn solve_spring<L: Lanes<N>>(
        &mut self,
        pass: Pass,
        batch: &Batch<N>,
        pair: &mut BodyPairW<L, N>,
        faults: &mut Faults,
    ) {
        self.pin::<L>(batch);
        let [w, give] = self.wanted_of_spring(pass, pair, faults);
        let SpringRow { lambda, max, holds, .. } = &self.spring;
        let (old, max, held) = (L::load(lambda), L::load(max), L::negative(L::load(holds)));
        let rigid = L::add_saturating(self.pinned.impulse_of::<L>(w), give);
        let elastic = self.pinned.spring_impulse_of::<L>(L::add_saturating(w, give));
        let new = clamp::<L, N>(L::sub_saturating(old, L::select(held, rigid, elastic)), max);
        L::store(new, &mut self.spring.lambda);
        self.turn(batch, pair, L::sub(new, old), faults);
    }

    /// `w` and `impulseScale L`.
    #[inline(always)]
    fn wanted_of_spring<L: Lanes<N>>(
        &self,
        pass: Pass,
        pair: &BodyPairW<L, N>,
        faults: &mut Faults,
    ) -> [L::Int; 2] {
        let SpringRow { lambda, max, mass_scale, impulse_scale, push, holds } = &self.spring;
        let (max, zero, held) = (L::load(max), L::splat(0), L::negative(L::load(holds)));
        let solved = if pass == Pass::Bias { max } else { L::select(held, max, zero) };
        let vn = velocity::<L, N>(&self.e, solved, pair, faults);
        match pass {
            Pass::Bias => [
                L::add_saturating(scaled::<L, N>(L::load(mass_scale), vn), L::load(push)),
                scaled::<L, N>(L::load(impulse_scale), L::load(lambda)),
            ],
            Pass::Relax => [L::select(held, vn, zero), zero],
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
        batch: &Batch<N>,
        pair: &mut BodyPairW<L, N>,
        faults: &mut Faults,
    ) {
        let zero = L::splat(0);
        let LimitRow { lambda, push, open, .. } = &self.limits[side];
        let max = L::load(&self.limit_max);
        let vn = velocity::<L, N>(&self.e, max, pair, faults);
        let vn = facing::<L, N>(side, L::max(vn, L::splat(-i32::MAX)));
        let (old, push, open) = (L::load(lambda), L::load(push), L::negative(L::load(open)));
        let [w, give] = match pass {
            Pass::Bias => {
                let mass_scale =
                    L::select(open, L::splat(Unit::ONE.to_bits()), L::splat(softness.mass_scale.to_bits()));
                let give = scaled::<L, N>(L::splat(softness.impulse_scale.to_bits()), old);
                [L::add_saturating(scaled::<L, N>(mass_scale, vn), push), L::select(open, zero, give)]
            }
            Pass::Relax => {
                let untouched = L::both(open, L::greater(L::splat(1), old));
                let w = L::add_saturating(vn, L::select(open, push, zero));
                [L::select(untouched, zero, w), zero]
            }
        };
        // Without an impulse so far, and with `w` of 0 or more, the impulse stays 0.
        let wanted = L::both(L::greater(max, zero), L::greater(zero, w));
        if L::any(L::either(L::greater(old, zero), wanted)) {
            self.pin::<L>(batch);
            let change = L::add_saturating(self.pinned.impulse_of::<L>(w), give);
            let new = L::min(L::max(L::sub_saturating(old, change), zero), max);
            L::store(new, &mut self.limits[side].lambda);
            self.turn(batch, pair, facing::<L, N>(side, L::sub(new, old)), faults);
        }
    }
}

/// `value` for the lower limit (side 0), negated for the upper limit, whose row is reversed.
#[inline(always)]
fn facing<L: Lanes<N>, const N: usize>(side: usize, value: L::Int) -> L::Int {
    if side == 0 { value } else { L::sub(L::splat(0), value) }
}

/// A number times a scale, which is at most 1.
#[inline(always)]
fn scaled<L: Lanes<N>, const N: usize>(scale: L::Int, value: L::Int) -> L::Int {
    L::narrow::<UNIT>(L::mul(scale, value))
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
