//! The response of two pinned bodies to an impulse on their angle.
//!
//! An impulse `L` on the angle alone would move the anchors apart at the velocity `q L`. The impulse `-q L` at the
//! point takes this velocity back. Rows on the angle apply both together, with the lever ratios `e` and gains `f` of
//! the angle, and the lever ratios `E` and gains `G`, `F` of the point (`point_block.rs`):
//!
//! ```text
//! q  = EB fB + EA fA,   n = a G q,   t = f - F.q
//! vA += nA L,  uA -= tA L,  vB -= nB L,  uB += tB L
//! s  = eA tA + eB tB                                          the change of the velocity on the angle by L = 1
//! ```
//!
//! `1 / s` is the inertia of the pinned bodies divided by their inertia without the pin: `(I + m r^2) / I` for a body
//! that is pinned to an immovable body at an arm `r`. This is the effective mass of a Schur complement: the point and a
//! row on the angle are solved exactly, as one system. If each of them were solved alone, the point would give back
//! `1 - s` of the angular velocity that a limit removes.
//!
//! The accumulated impulse of the point does not contain `-q L`. The warm start therefore computes `q` at the current
//! pose, and a large impulse on the angle does not pull the anchors apart when the bodies have turned.

use super::super::super::super::limits::Faults;
use super::super::super::super::pair::{BodyPairW, HALF, RATIO, UNIT, beyond, clamp};
use super::super::batch::Batch;
use crate::simd::{Ints, Lanes, VelocityW};

/// Fraction bits of the components of `q`: one less than those of a lever ratio. `q` may be longer than a ratio.
const SPREAD: i32 = RATIO - 1;

/// Fraction bits of [`Pinned::inertia`].
const INERTIA: i32 = 15;

#[derive(Clone, Debug)]
pub(in super::super) struct Pinned<const N: usize> {
    n: [[Ints<N>; 2]; 2],
    t: [Ints<N>; 2],
    /// `1 / s`, at most 2^15.
    inertia: Ints<N>,
    /// `1 / (impulseScale + massScale s)`, the factor of an implicit spring.
    spring_inertia: Ints<N>,
}

impl<const N: usize> Pinned<N> {
    pub(super) const NONE: Self = Pinned {
        n: [[Ints::ZERO; 2]; 2],
        t: [Ints::ZERO; 2],
        inertia: Ints::ZERO,
        spring_inertia: Ints::ZERO,
    };

    /// `e` and `f` are the lever ratios and gains of the angle, and `scales` the mass scales and impulse scales of the
    /// springs.
    #[inline(always)]
    pub(super) fn update<L: Lanes<N>>(
        &mut self,
        batch: &Batch<N>,
        [e, f]: [&[Ints<N>; 2]; 2],
        [mass_scale, impulse_scale]: [&Ints<N>; 2],
    ) {
        let turning = [L::load(&f[0]), L::load(&f[1])];
        let q = [0, 1].map(|axis: usize| {
            let [a, b] = [L::load(&batch.e[0][axis]), L::load(&batch.e[1][axis])];
            L::narrow::<{ UNIT + RATIO - SPREAD }>(L::add_wide(L::mul(a, turning[0]), L::mul(b, turning[1])))
        });
        let mut t = turning;
        for side in 0..2 {
            let [g11, g12, g22] = &batch.g[side];
            let (x, y) = (dot::<L, N>([g11, g12], q), dot::<L, N>([g12, g22], q));
            L::store(x, &mut self.n[side][0]);
            L::store(y, &mut self.n[side][1]);
            let [f_x, f_y] = &batch.f[side];
            t[side] = L::sub(turning[side], dot::<L, N>([f_x, f_y], q));
            L::store(t[side], &mut self.t[side]);
        }
        // 54 fraction bits. Rounding may leave a number below 0 where the inertia is largest.
        let s = L::add_wide(L::mul(L::load(&e[0]), t[0]), L::mul(L::load(&e[1]), t[1]));
        let s = L::max_wide(s, L::mul(L::splat(0), L::splat(0)));
        L::store(L::reciprocal(L::shift_down::<{ RATIO - INERTIA }>(s)), &mut self.inertia);
        let [mass_scale, impulse_scale] = [L::load(mass_scale), L::load(impulse_scale)];
        let softened = L::add_wide(
            L::mul(mass_scale, L::narrow::<RATIO>(s)),
            L::mul(impulse_scale, L::splat(1 << UNIT)),
        );
        let inverse = L::reciprocal(L::shift_down::<{ UNIT - INERTIA }>(softened));
        L::store(inverse, &mut self.spring_inertia);
    }

    /// `v / s`.
    #[inline(always)]
    pub(super) fn impulse_of<L: Lanes<N>>(&self, v: L::Int) -> L::Int {
        L::narrow_saturating::<INERTIA>(L::mul(v, L::load(&self.inertia))).0
    }

    /// `v / (impulseScale + massScale s)`.
    #[inline(always)]
    pub(super) fn spring_impulse_of<L: Lanes<N>>(&self, v: L::Int) -> L::Int {
        L::narrow_saturating::<INERTIA>(L::mul(v, L::load(&self.spring_inertia))).0
    }
}

#[inline(always)]
fn dot<L: Lanes<N>, const N: usize>([x, y]: [&Ints<N>; 2], q: [L::Int; 2]) -> L::Int {
    L::narrow::<SPREAD>(L::add_wide(L::mul(L::load(x), q[0]), L::mul(L::load(y), q[1])))
}

impl<L: Lanes<N>, const N: usize> BodyPairW<L, N> {
    /// Changes the velocities by impulses `d` on the angle of less than 1024 m/s, and by the reaction of the pin.
    #[inline(always)]
    pub(super) fn turn(&mut self, pinned: &Pinned<N>, d: L::Int, faults: &mut Faults) {
        if L::any(beyond::<L, N>(d, L::splat(HALF - 1))) {
            self.turn_in_steps(pinned, d, faults);
        } else {
            self.turn_step(pinned, d, faults);
        }
    }

    #[inline(always)]
    fn turn_step(&mut self, pinned: &Pinned<N>, d: L::Int, faults: &mut Faults) {
        let times = |gain: &Ints<N>| L::narrow::<UNIT>(L::mul(L::load(gain), d));
        let [[a_x, a_y], [b_x, b_y]] = &pinned.n;
        let [turn_a, turn_b] = &pinned.t;
        let VelocityW { x, y, turn } = self.a;
        self.a = VelocityW {
            x: L::add(x, times(a_x)),
            y: L::add(y, times(a_y)),
            turn: L::sub(turn, times(turn_a)),
        };
        let VelocityW { x, y, turn } = self.b;
        self.b = VelocityW {
            x: L::sub(x, times(b_x)),
            y: L::sub(y, times(b_y)),
            turn: L::add(turn, times(turn_b)),
        };
        self.keep_in_range(faults);
    }

    /// Applies impulses above 512 m/s, as when a motor reverses or a held body is released.
    #[cold]
    fn turn_in_steps(&mut self, pinned: &Pinned<N>, mut d: L::Int, faults: &mut Faults) {
        for _ in 0..3 {
            let step = clamp::<L, N>(d, L::splat(HALF - 1));
            self.turn_step(pinned, step, faults);
            d = L::sub(d, step);
        }
    }
}
