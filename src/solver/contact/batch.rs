//! Contacts as the kernels read them: `N` at a time, each number in a row of its own.

use crate::lanes::{Ints, Lanes};

/// `N` contacts of which no two change the same body, for one tick. Lanes without a contact have no gains, and stand
/// between the ground and itself.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(in crate::solver) struct Batch<const N: usize> {
    /// Where to read the bodies.
    pub(super) bodies: [[u32; N]; 2],
    /// Where to write them: the ground for those that no impulse changes.
    pub(super) changed: [[u32; N]; 2],
    /// The normal, from A to B, with the fraction bits of a lever ratio. The tangent is its perpendicular.
    pub(super) n_x: Ints<N>,
    pub(super) n_y: Ints<N>,
    /// -1 where one of the bodies does not give way: such contacts are stiffer.
    pub(super) immovable: Ints<N>,
    /// How many of the points have a contact in any lane. What is left of the others has no part in anything.
    pub(super) count: usize,
    /// Whether any surface in it bounces, moves or resists rolling: then it has a [`super::special::Special`] as well.
    pub(super) special: bool,
    /// Whether its rows, and what is special about it, can be those of [`super::care::Calm`] contacts.
    pub(super) calm: bool,
    /// For each point, in which lanes the shapes have pushed each other in this tick: one bit each.
    pub(super) pushed: [u32; 2],
    pub(super) points: [Point<N>; 2],
    /// Friction, half-way between the points: both would have the same row, for they lie on one line along the tangent.
    pub(super) tangent: Row<N>,
    pub(super) tangent_lambda: Ints<N>,
}

/// The same point of `N` contacts.
#[derive(Clone, Debug)]
pub(super) struct Point<const N: usize> {
    pub(super) normal: Row<N>,
    /// At the start of the tick, in the format of a shift.
    pub(super) first_separation: Ints<N>,
    /// Where the bodies are now.
    pub(super) separation: Ints<N>,
    /// Friction limit for each unit of the normal impulse: `mu Dt / Dn`.
    pub(super) grip: Ints<N>,
    pub(super) normal_lambda: Ints<N>,
}

/// `N` rows: lever ratios, and what an impulse of 1 changes. The linear part of a lever ratio is the direction, which
/// the rows of a contact have in common.
#[derive(Clone, Debug)]
pub(super) struct Row<const N: usize> {
    pub(super) e_a: Ints<N>,
    pub(super) e_b: Ints<N>,
    /// `g n` and `f` of each body.
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
        grip: Ints::ZERO,
        normal_lambda: Ints::ZERO,
    };
}

impl<const N: usize> Batch<N> {
    /// No contact in any lane.
    pub(super) const NONE: Self = Batch {
        bodies: [[0; N]; 2],
        changed: [[0; N]; 2],
        n_x: Ints::ZERO,
        n_y: Ints::ZERO,
        immovable: Ints::ZERO,
        count: 0,
        special: false,
        calm: false,
        pushed: [0; 2],
        points: [Point::NONE; 2],
        tangent: Row::NONE,
        tangent_lambda: Ints::ZERO,
    };

    /// Forgets what is not written anew when contacts are put into a batch.
    #[inline(always)]
    pub(super) fn begin(&mut self) {
        self.bodies = Self::NONE.bodies;
        self.changed = Self::NONE.changed;
        (self.count, self.special, self.pushed) = (0, false, [0; 2]);
    }

    /// Sets the normal impulse of a point.
    #[inline(always)]
    pub(super) fn push<L: Lanes<N>>(&mut self, place: usize, lambda: L::Int) {
        L::store(lambda, &mut self.points[place].normal_lambda);
        self.pushed[place] |= L::bits(L::greater(lambda, L::splat(0)));
    }
}
