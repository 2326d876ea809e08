//! Hinges as the kernels read them: `N` at a time, each number in a row of its own.

use crate::lanes::Ints;

/// `N` hinges of which no two change the same body, for one tick. Lanes without a hinge have no gains, and stand between
/// the ground and itself.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Batch<const N: usize> {
    /// Where to read the bodies.
    pub(super) bodies: [[u32; N]; 2],
    /// Where to write them: the ground for those that no impulse changes.
    pub(super) changed: [[u32; N]; 2],
    /// Lever ratios of A and of B.
    pub(super) e: [[Ints<N>; 2]; 2],
    /// `g11, g12, g22` of A and of B.
    pub(super) g: [[Ints<N>; 3]; 2],
    pub(super) f: [[Ints<N>; 2]; 2],
    /// The velocity that closes the gap, reversed.
    pub(super) bias: [Ints<N>; 2],
    /// `L`, in world axes.
    pub(super) lambda: [Ints<N>; 2],
    /// The place of its rows on the angle, if any hinge in it has some.
    pub(super) angle: Option<u32>,
}

/// What their points are made of: what does not change within a tick.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Shape<const N: usize> {
    /// Anchors from the centres of mass, in the frames of A and of B.
    pub(super) arms: [[Ints<N>; 2]; 2],
    /// Lever ratios in the frames of A and of B.
    pub(super) ratios: [[Ints<N>; 2]; 2],
    /// Mass fractions.
    pub(super) fractions: [Ints<N>; 2],
    /// Centre of mass of B from that of A at the start of the tick, with 52 fraction bits.
    pub(super) between: [[i64; N]; 2],
}

impl<const N: usize> Batch<N> {
    /// No hinge in any lane.
    pub(super) const NONE: Self = Batch {
        bodies: [[0; N]; 2],
        changed: [[0; N]; 2],
        e: [[Ints::ZERO; 2]; 2],
        g: [[Ints::ZERO; 3]; 2],
        f: [[Ints::ZERO; 2]; 2],
        bias: [Ints::ZERO; 2],
        lambda: [Ints::ZERO; 2],
        angle: None,
    };
}

impl<const N: usize> Shape<N> {
    pub(super) const NONE: Self = Shape {
        arms: [[Ints::ZERO; 2]; 2],
        ratios: [[Ints::ZERO; 2]; 2],
        fractions: [Ints::ZERO; 2],
        between: [[0; N]; 2],
    };
}
