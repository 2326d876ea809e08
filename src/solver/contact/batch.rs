//! Batches of contacts, as a structure of arrays.

use super::super::pair::shift;
use crate::math::{Shift, Step};
use crate::simd::{Ints, Lanes};

/// `N` contacts, no two of which change the same body. Lanes without a contact have gains of 0, and the ground as both
/// bodies.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(in crate::solver) struct Batch<const N: usize> {
    pub(super) bodies: [[u32; N]; 2],
    /// The indices to which the bodies are written: the ground for a body that no impulse changes.
    pub(super) changed: [[u32; N]; 2],
    /// The normal, from A to B, with the fraction bits of a lever ratio.
    pub(super) n_x: Ints<N>,
    pub(super) n_y: Ints<N>,
    /// -1 in lanes in which impulses do not move one of the bodies: such contacts are stiffer. -2 if in addition the
    /// other body has an impact ([`super::ActiveContact::is_impact`]) in any of its contacts: overlaps that approach
    /// faster than `IMPACT_SPEED` (`solve.rs`) are then rigid. 0 in other lanes.
    pub(super) immovable: Ints<N>,
    /// -1 in lanes with two points. If a batch has contacts with two points, each contact with one point gets a copy of
    /// this point, without an impulse, as its second point.
    pub(super) both: Ints<N>,
    pub(super) points: [Point<N>; 2],
    /// The friction row, half-way between the points. One row is enough, because both points lie on one line along the
    /// tangent.
    pub(super) tangent: Row<N>,
    pub(super) tangent_lambda: Ints<N>,
    /// Largest number of points of a contact in the batch. Points beyond this number are stale.
    pub(super) count: usize,
    /// Whether the batch has a [`super::extras::ContactExtras`].
    pub(super) extras: bool,
    /// Whether the warm start first runs without overflow checks ([`super::overflow_policy::Unchecked`]). Iterations do
    /// so as well, if [`super::Constants::unchecked`] holds.
    pub(super) unchecked: bool,
    /// For each point, the lanes in which its normal impulse has been positive in this tick, as a bit mask.
    pub(super) pushed: [u32; 2],
}

#[derive(Clone, Debug)]
pub(super) struct Point<const N: usize> {
    pub(super) normal: Row<N>,
    /// Separation at the start of the tick, in the format of a shift.
    pub(super) first_separation: Ints<N>,
    /// Separation at the current positions.
    pub(super) separation: Ints<N>,
    /// Friction limit per unit of the normal impulse: `mu Dt / Dn`, with the denominators `D` of the tangential and the
    /// normal row.
    pub(super) friction_ratio: Ints<N>,
    pub(super) normal_lambda: Ints<N>,
}

/// `N` rows. The linear part of the Jacobian is the normal or the tangent of the batch.
#[derive(Clone, Debug)]
pub(super) struct Row<const N: usize> {
    pub(super) e_a: Ints<N>,
    pub(super) e_b: Ints<N>,
    /// Velocity changes of each body by an impulse of 1: `g n_x`, `g n_y` and `f`.
    pub(super) a: [Ints<N>; 3],
    pub(super) b: [Ints<N>; 3],
}

impl<const N: usize> Row<N> {
    pub(super) const NONE: Self =
        Row { e_a: Ints::ZERO, e_b: Ints::ZERO, a: [Ints::ZERO; 3], b: [Ints::ZERO; 3] };
}

impl<const N: usize> Point<N> {
    pub(super) const NONE: Self = Point {
        normal: Row::NONE,
        first_separation: Ints::ZERO,
        separation: Ints::ZERO,
        friction_ratio: Ints::ZERO,
        normal_lambda: Ints::ZERO,
    };
}

impl<const N: usize> Batch<N> {
    pub(super) const NONE: Self = Batch {
        bodies: [[0; N]; 2],
        changed: [[0; N]; 2],
        n_x: Ints::ZERO,
        n_y: Ints::ZERO,
        immovable: Ints::ZERO,
        both: Ints::ZERO,
        points: [Point::NONE; 2],
        tangent: Row::NONE,
        tangent_lambda: Ints::ZERO,
        count: 0,
        extras: false,
        unchecked: false,
        pushed: [0; 2],
    };

    /// Resets the fields that are set lane by lane.
    #[inline(always)]
    pub(super) fn begin(&mut self) {
        self.bodies = Self::NONE.bodies;
        self.changed = Self::NONE.changed;
        (self.count, self.extras, self.pushed) = (0, false, [0; 2]);
    }

    #[inline(always)]
    pub(super) fn directions<L: Lanes<N>>(&self) -> ([L::Int; 2], [L::Int; 2]) {
        let (x, y) = (L::load(&self.n_x), L::load(&self.n_y));
        ([x, y], [L::sub(L::splat(0), y), x])
    }

    /// Sets the separations at the start of the tick, given in the format of a step.
    #[inline(always)]
    pub(super) fn separate<L: Lanes<N>>(&mut self, [first, second]: [L::Int; 2]) {
        const STEP_TO_SHIFT: i32 = shift(Step::FRAC_NBITS - Shift::FRAC_NBITS);
        let second = L::select(L::negative(L::load(&self.both)), second, first);
        for (point, separation) in self.points[..self.count].iter_mut().zip([first, second]) {
            let separation = L::narrow::<STEP_TO_SHIFT>(L::mul(separation, L::splat(1)));
            L::store(separation, &mut point.first_separation);
            L::store(separation, &mut point.separation);
        }
    }

    /// Sets the normal impulse of a point, and records the lanes in which it is positive.
    #[inline(always)]
    pub(super) fn push<L: Lanes<N>>(&mut self, place: usize, lambda: L::Int) {
        L::store(lambda, &mut self.points[place].normal_lambda);
        self.pushed[place] |= L::bits(L::greater(lambda, L::splat(0)));
    }
}
