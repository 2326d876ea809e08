//! SIMD abstraction: the integer operations in which the wide kernels are written.
//!
//! A kernel is a generic function over [`Lanes`], and a backend is an implementation of that trait. `Scalar<1>`
//! processes one row of a constraint at a time. The other backends process [`WIDTH`] rows that share no body, and use
//! `Scalar<1>` for batches with a single row. No lane depends on another, so that every backend gives the same bits.
//! Lanes hold only 32-bit numbers and their 64-bit products, because each vector instruction set has a widening
//! multiplication 32 x 32 -> 64 (`vpmuldq`, `smull`, `i64x2.extmul`).

mod body;
mod division;
mod layout;
#[cfg_attr(target_arch = "x86_64", path = "x86.rs")]
#[cfg_attr(all(target_arch = "aarch64", target_feature = "neon", target_endian = "little"), path = "neon.rs")]
#[cfg_attr(all(target_arch = "wasm32", target_feature = "simd128"), path = "simd128.rs")]
mod native;
mod prefetch;
mod scalar;
mod shared;
#[cfg(test)]
mod tests;

pub(crate) use body::{GROUND, SolverBody};
pub(crate) use layout::{Layout, with_data};
use native::Vectors;
pub(crate) use prefetch::prefetch;
pub(crate) use scalar::Scalar;
pub(crate) use shared::Shared;

use core::cell::Cell;

/// Number of rows that a wide kernel processes at a time: eight, or four if vectors have 128 bits.
pub(crate) use native::WIDTH;

/// One number for each of `N` rows. Batches align these arrays for the widest load. If this type itself had that
/// alignment, a single row would be as large as a vector.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Ints<const N: usize>(pub(crate) [i32; N]);

impl<const N: usize> Ints<N> {
    pub(crate) const ZERO: Self = Ints([0; N]);
}

#[expect(clippy::cast_possible_wrap, reason = "at most 64")]
pub(crate) const fn shift(fraction_bits: u32) -> i32 {
    fraction_bits as i32
}

/// Four numbers that kernels load together.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(16))]
pub(crate) struct Quad(pub(crate) [i32; 4]);

/// Components of a velocity or displacement: along x, along y, and rotation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VelocityW<T> {
    pub(crate) x: T,
    pub(crate) y: T,
    pub(crate) turn: T,
}

/// `N` lanes of 32-bit integers. Sums wrap, except in functions named `saturating`.
pub(crate) trait Lanes<const N: usize>: Copy {
    type Int: Copy;
    /// 64-bit products.
    type Wide: Copy;
    type Mask: Copy;

    fn load(from: &Ints<N>) -> Self::Int;
    fn store(value: Self::Int, to: &mut Ints<N>);
    fn splat(value: i32) -> Self::Int;

    fn add(a: Self::Int, b: Self::Int) -> Self::Int;
    fn sub(a: Self::Int, b: Self::Int) -> Self::Int;
    fn add_saturating(a: Self::Int, b: Self::Int) -> Self::Int;
    fn sub_saturating(a: Self::Int, b: Self::Int) -> Self::Int;
    fn min(a: Self::Int, b: Self::Int) -> Self::Int;
    fn max(a: Self::Int, b: Self::Int) -> Self::Int;
    fn or(a: Self::Int, b: Self::Int) -> Self::Int;

    fn greater(a: Self::Int, b: Self::Int) -> Self::Mask;
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn either(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn any(mask: Self::Mask) -> bool;
    /// Bit mask of the lanes, the first lane in the lowest bit.
    fn bits(mask: Self::Mask) -> u32;
    fn count(mask: Self::Mask) -> u32;
    fn select(mask: Self::Mask, yes: Self::Int, no: Self::Int) -> Self::Int;
    /// -1 in lanes that are true, 0 in the others.
    fn to_int(mask: Self::Mask) -> Self::Int;
    fn negative(a: Self::Int) -> Self::Mask;

    fn mul(a: Self::Int, b: Self::Int) -> Self::Wide;
    fn add_wide(a: Self::Wide, b: Self::Wide) -> Self::Wide;
    fn sub_wide(a: Self::Wide, b: Self::Wide) -> Self::Wide;
    fn max_wide(a: Self::Wide, b: Self::Wide) -> Self::Wide;
    fn abs_wide(a: Self::Wide) -> Self::Wide;
    fn greater_wide(a: Self::Wide, b: Self::Wide) -> Self::Mask;
    /// `a / 2^SHIFT`, rounded to nearest, ties towards +infinity. The result must fit 32 bits. `SHIFT` is 1 to 32.
    fn narrow<const SHIFT: i32>(a: Self::Wide) -> Self::Int;
    /// [`Lanes::narrow`], but saturated, with a mask of the lanes that saturated. Adding the rounding constant must not
    /// overflow 64 bits. `SHIFT` is 1 to 31.
    fn narrow_saturating<const SHIFT: i32>(a: Self::Wide) -> (Self::Int, Self::Mask);

    /// [`Lanes::narrow_saturating`] with its own shift, 1 to 61, for each lane, and without the mask. The magnitude of
    /// `a` is at most 2^62.
    fn narrow_by(a: Self::Wide, shift: Self::Int) -> Self::Int;

    /// The lowest 32 bits, as a signed number.
    fn low(a: Self::Wide) -> Self::Int;

    /// `a / 2^SHIFT` of non-negative numbers, rounded down. `SHIFT` is 1 to 63.
    fn shift_down<const SHIFT: i32>(a: Self::Wide) -> Self::Wide;

    /// `1 / d`, rounded down, where `d` and the result have 30 fraction bits. `d` is below 2^16, and is clamped to at
    /// least 1.
    #[inline(always)]
    fn reciprocal(d: Self::Wide) -> Self::Int {
        let mut quotients = Ints::ZERO;
        let d = Self::to_array(d);
        for (quotient, &d) in quotients.0.iter_mut().zip(&d) {
            *quotient = division::reciprocal(d);
        }
        Self::load(&quotients)
    }

    /// Entries `g11, g12, g22` of `G = K^-1` with 30 fraction bits, from the entries of `K - I` with 46 fraction bits.
    /// `K` is the matrix of a point constraint. Its determinant is 1 to 2^27.
    #[inline(always)]
    fn inverse(entries: [Self::Wide; 3]) -> [Self::Int; 3] {
        let [xx, xy, yy] =
            [Self::to_array(entries[0]), Self::to_array(entries[1]), Self::to_array(entries[2])];
        let mut g = [Ints::ZERO; 3];
        for lane in 0..N {
            [g[0].0[lane], g[1].0[lane], g[2].0[lane]] = division::inverse([xx[lane], xy[lane], yy[lane]]);
        }
        [Self::load(&g[0]), Self::load(&g[1]), Self::load(&g[2])]
    }

    fn to_array(a: Self::Wide) -> [i64; N];
    fn load_wide(from: &[i64; N]) -> Self::Wide;

    /// Loads the quads at the given indices, and transposes them like [`Lanes::transposed`].
    #[inline(always)]
    fn quads(from: &[Quad], at: &[u32; N]) -> [Self::Int; 4] {
        // `map` would not be inlined into functions with other target features.
        let mut rows = [&from[at[0] as usize]; N];
        for (row, &at) in rows.iter_mut().zip(at) {
            *row = &from[at as usize];
        }
        Self::transposed(rows)
    }
    /// Transposes quads: the first number of each row, the second of each row, and so on.
    fn transposed(rows: [&Quad; N]) -> [Self::Int; 4];
    fn velocities(bodies: &[Cell<SolverBody>], at: &[u32; N]) -> VelocityW<Self::Int>;
    fn shifts(bodies: &[Cell<SolverBody>], at: &[u32; N]) -> VelocityW<Self::Int>;
    /// Writes a velocity to the body of each lane, except to [`GROUND`].
    fn set_velocities(bodies: &[Cell<SolverBody>], at: &[u32; N], velocities: VelocityW<Self::Int>);
    fn set_shifts(bodies: &[Cell<SolverBody>], at: &[u32; N], shifts: VelocityW<Self::Int>);
}

/// A computation that is generic over the lanes.
pub(crate) trait Kernel<const N: usize> {
    /// Implementations must be `#[inline(always)]`, so that they are compiled with the target features of the backend.
    fn run<L: Lanes<N>>(self);
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Machine(Backend);

impl Machine {
    pub(crate) fn new(backend: Backend) -> Option<Self> {
        Backend::available().find(|&available| available == backend).map(Machine)
    }

    pub(crate) const fn backend(self) -> Backend {
        self.0
    }

    /// The vectors of the backend. `None` for the scalar backend.
    #[inline]
    pub(crate) fn vectors(self) -> Option<Vectors> {
        Vectors::of(self.0)
    }

    #[inline]
    pub(crate) fn run(self, kernel: impl Kernel<WIDTH> + Kernel<1>) {
        match self.vectors() {
            Some(vectors) => vectors.run(kernel),
            None => Kernel::<1>::run::<Scalar<1>>(kernel),
        }
    }
}

/// SIMD backend of the solver and of the narrow phase for boxes. It changes the speed, never the result.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, fx, world::World};
/// use lockstep2d::world::Backend;
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[square])?;
/// # world.spawn(&BodyDef::dynamic(), &[square])?;
/// let start = world.save();
/// // Every instruction set of this machine gives the same bits.
/// let mut hashes = Backend::available().map(|backend| {
///     world.restore(&start);
///     assert!(world.set_backend(backend));
///     (0..30).for_each(|_| world.step());
///     world.state_hash()
/// });
/// let first = hashes.next().expect("one at least");
/// assert!(hashes.all(|hash| hash == first));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Backend {
    /// Plain integers. Not available in a WebAssembly module with simd128 and the feature `sole_backend`.
    Scalar,
    /// 256-bit vectors, on most x86-64 processors since 2013.
    Avx2,
    /// 512-bit vectors, on most x86-64 servers since 2017 and on desktop processors with AVX-512.
    Avx512,
    /// 128-bit vectors of 64-bit Arm processors.
    Neon,
    /// 128-bit vectors of WebAssembly, if compiled with `-C target-feature=+simd128`.
    Simd128,
}

impl Backend {
    /// The backends that are compiled in and that this machine can run, the best one last. Without the feature `std`,
    /// the list contains only backends whose target features are enabled at compile time.
    pub fn available() -> impl Iterator<Item = Backend> {
        let scalar = Vectors::ARE_OPTIONAL.then_some(Backend::Scalar);
        scalar.into_iter().chain(Vectors::backends())
    }

    /// The best backend of this machine.
    #[must_use]
    pub fn best() -> Self {
        Backend::available().last().unwrap_or(Backend::Scalar)
    }
}

impl Default for Backend {
    fn default() -> Self {
        Backend::best()
    }
}
