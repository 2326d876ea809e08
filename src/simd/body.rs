//! Body data that the solver kernels read and write: velocity, and displacement within the tick.

use core::cell::Cell;

use crate::math::{Shift, Speed, Vec2};

/// Index of the ground, which represents all bodies that are not in the body list. Kernels never write to the ground. A
/// constraint has two pairs of indices: bodies to read, and bodies to write. In the second pair, the ground replaces a
/// body that no impulse changes.
pub(crate) const GROUND: u32 = 0;

/// A body in the solver: two halves of 16 bytes, each of which SIMD kernels load as a whole. In every row, a body that
/// no impulse moves has the mass fraction 0.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(32))]
pub(crate) struct SolverBody {
    pub(crate) velocity: Vec2<Speed>,
    /// Angular velocity times the radius of gyration, `u = k w`.
    pub(crate) spin: Speed,
    pub(crate) velocity_padding: i32,
    /// Displacement of the centre of mass since the start of the tick.
    pub(crate) shift: Vec2<Shift>,
    /// Rotation since the start of the tick, times the radius of gyration, `k dtheta`.
    pub(crate) turn: Shift,
    pub(crate) shift_padding: i32,
}

const _: () = assert!(size_of::<SolverBody>() == 32, "a solver body should be two halves of 16 bytes");

impl SolverBody {
    /// Sets the velocity from the bits of three speeds, which the caller has limited to the range of velocities.
    #[inline(always)]
    pub(crate) fn set_motion(&mut self, x: i32, y: i32, spin: i32) {
        self.velocity = Vec2::new(Speed::from_bits(x), Speed::from_bits(y));
        self.spin = Speed::from_bits(spin);
    }

    #[inline(always)]
    pub(crate) fn set_shift(&mut self, x: i32, y: i32, turn: i32) {
        self.shift = Vec2::new(Shift::from_bits(x), Shift::from_bits(y));
        self.turn = Shift::from_bits(turn);
    }

    pub(crate) fn cells(bodies: &mut [Self]) -> &[Cell<Self>] {
        Cell::from_mut(bodies).as_slice_of_cells()
    }

    /// Pointer to velocity, spin and padding: 16 bytes, aligned to 32.
    #[allow(dead_code, reason = "only the vector backends load it as a whole")]
    #[inline(always)]
    pub(crate) fn velocity_bits(body: &Cell<Self>) -> *mut i32 {
        body.as_ptr().cast()
    }

    /// Pointer to displacement, rotation and padding: 16 bytes, aligned to 16.
    #[allow(dead_code, reason = "only the vector backends load it as a whole")]
    #[inline(always)]
    pub(crate) fn shift_bits(body: &Cell<Self>) -> *mut i32 {
        Self::velocity_bits(body).wrapping_add(4)
    }
}
