//! Batches of hinges: `N` at a time, as a structure of arrays.

use super::super::super::softness::Softness;
use crate::math::Angle;
use crate::simd::Ints;

/// `N` hinges for one tick, no two of which change the same body. Lanes without a hinge have gains of 0, and the ground
/// as both bodies.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(in crate::solver) struct Batch<const N: usize> {
    /// The indices from which bodies are read.
    pub(super) bodies: [[u32; N]; 2],
    /// The indices to which bodies are written: the ground for a body that no impulse changes.
    pub(super) changed: [[u32; N]; 2],
    /// Lever ratios of A and of B.
    pub(super) e: [[Ints<N>; 2]; 2],
    /// `g11, g12, g22` of A and of B.
    pub(super) g: [[Ints<N>; 3]; 2],
    pub(super) f: [[Ints<N>; 2]; 2],
    /// The negated velocity that closes the gap.
    pub(super) bias: [Ints<N>; 2],
    /// The accumulated impulse `L` along the x and y axes of the world.
    pub(super) lambda: [Ints<N>; 2],
    /// Whether the hinges have rows on the angle, in [`super::angle::AngleRows`].
    pub(super) has_angle: bool,
    /// Whether the hinges have a softness of their own. All hinges of a batch then have the same softness, which the
    /// record contains.
    pub(super) is_tuned: bool,
}

/// Constants for the refresh of a batch, and the joints to which the impulses of the batch belong.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(in crate::solver) struct Records<const N: usize> {
    pub(super) shape: Shape<N>,
    /// Number of lanes with a hinge.
    pub(super) len: usize,
    pub(super) slots: [u32; N],
    /// Angles in units of 2^-32 turn: at the start of the tick while the tick is solved, and at its end afterwards.
    pub(super) turns: [i64; N],
    /// Angles of the hinges if all bodies have the angle 0.
    pub(super) rest: [Angle; N],
    /// Softness of a tuned batch, or of a hinge in a block.
    pub(super) softness: Softness,
}

#[derive(Clone, Debug)]
pub(super) struct Shape<const N: usize> {
    /// Vectors from the centres of mass to the anchors, in the frames of A and of B.
    pub(super) arms: [[Ints<N>; 2]; 2],
    /// Lever ratios in the frames of A and of B.
    pub(super) ratios: [[Ints<N>; 2]; 2],
    /// Changes of lever ratios per metre of the gap ([`super::refresh::gap_factors`]).
    pub(super) gap_factors: [Ints<N>; 2],
    pub(super) fractions: [Ints<N>; 2],
    /// Vector from A's centre of mass to B's centre of mass at the start of the tick, with 52 fraction bits.
    pub(super) between: [[i64; N]; 2],
}

impl<const N: usize> Batch<N> {
    pub(super) const NONE: Self = Batch {
        bodies: [[0; N]; 2],
        changed: [[0; N]; 2],
        e: [[Ints::ZERO; 2]; 2],
        g: [[Ints::ZERO; 3]; 2],
        f: [[Ints::ZERO; 2]; 2],
        bias: [Ints::ZERO; 2],
        lambda: [Ints::ZERO; 2],
        has_angle: false,
        is_tuned: false,
    };
}

impl<const N: usize> Records<N> {
    pub(super) const NONE: Self = Records {
        shape: Shape::NONE,
        len: 0,
        slots: [0; N],
        turns: [0; N],
        rest: [Angle::ZERO; N],
        softness: Softness::RIGID,
    };
}

impl<const N: usize> Shape<N> {
    const NONE: Self = Shape {
        arms: [[Ints::ZERO; 2]; 2],
        ratios: [[Ints::ZERO; 2]; 2],
        gap_factors: [Ints::ZERO; 2],
        fractions: [Ints::ZERO; 2],
        between: [[0; N]; 2],
    };
}
