//! Contacts as the kernels read them: `N` at a time, each number in a row of its own.

use super::super::lanes::Ints;

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
    pub(super) bias_rate: Ints<N>,
    pub(super) mass_scale: Ints<N>,
    pub(super) impulse_scale: Ints<N>,
    /// How fast the surfaces move against each other by themselves, against the tangent.
    pub(super) surface_speed: Ints<N>,
    pub(super) restitution: Ints<N>,
    /// How many of the points have a contact in any lane.
    pub(super) count: usize,
    /// Whether anything in it bounces.
    pub(super) bounces: bool,
    /// Whether any surface in it resists rolling: then it has [`super::rolling::RollingRows`] as well.
    pub(super) resists_rolling: bool,
    pub(super) points: [Point<N>; 2],
}

/// The same point of `N` contacts.
#[derive(Clone, Debug)]
pub(super) struct Point<const N: usize> {
    pub(super) normal: Row<N>,
    pub(super) tangent: Row<N>,
    /// At the start of the tick, in the format of a shift.
    pub(super) first_separation: Ints<N>,
    /// Where the bodies are now.
    pub(super) separation: Ints<N>,
    /// Friction limit for each unit of the normal impulse: `mu Dt / Dn`.
    pub(super) grip: Ints<N>,
    /// The largest normal impulse: 0 for a point that is not there.
    pub(super) normal_max: Ints<N>,
    pub(super) normal_lambda: Ints<N>,
    pub(super) tangent_lambda: Ints<N>,
    /// Relative normal velocity when the shapes first pushed each other in this tick, for restitution.
    pub(super) approach: Ints<N>,
    /// -1 where the shapes have pushed each other in this tick.
    pub(super) pushed: Ints<N>,
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
    const NONE: Self = Point {
        normal: Row::NONE,
        tangent: Row::NONE,
        first_separation: Ints::ZERO,
        separation: Ints::ZERO,
        grip: Ints::ZERO,
        normal_max: Ints::ZERO,
        normal_lambda: Ints::ZERO,
        tangent_lambda: Ints::ZERO,
        approach: Ints::ZERO,
        pushed: Ints::ZERO,
    };
}

impl<const N: usize> Batch<N> {
    /// No contact in any lane.
    pub(super) const NONE: Self = Batch {
        bodies: [[0; N]; 2],
        changed: [[0; N]; 2],
        n_x: Ints::ZERO,
        n_y: Ints::ZERO,
        bias_rate: Ints::ZERO,
        mass_scale: Ints::ZERO,
        impulse_scale: Ints::ZERO,
        surface_speed: Ints::ZERO,
        restitution: Ints::ZERO,
        count: 0,
        bounces: false,
        resists_rolling: false,
        points: [Point::NONE; 2],
    };
}
