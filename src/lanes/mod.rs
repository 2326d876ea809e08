//! Several rows at a time: the integer operations that the wide kernels are written in.
//!
//! A kernel is one generic function over [`Lanes`]; a backend is one implementation of it. `Scalar<1>` solves a row
//! alone, the others eight rows that have no body in common, in which no lane looks at another: so every backend gives
//! the same bits, and the scalar one is the oracle of the rest. Only 32-bit numbers and their 64-bit products occur,
//! because the widening multiplication 32 x 32 -> 64 is what all processors have (`vpmuldq`, `smull`, `i64x2.extmul`).

// Besides plain integers, the vectors of whichever processor the program is compiled for.
mod body;
mod division;
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
use native::Native;
pub(crate) use prefetch::prefetch;
pub(crate) use scalar::Scalar;
pub(crate) use shared::Shared;

use core::cell::Cell;

/// How many rows a wide kernel solves at a time, on every machine.
pub(crate) const WIDTH: usize = 8;

/// A number for each of `N` rows, aligned for the widest load.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Ints<const N: usize>(pub(crate) [i32; N]);

impl<const N: usize> Ints<N> {
    pub(crate) const ZERO: Self = Ints([0; N]);
}

/// Fraction bits to shift by.
#[expect(clippy::cast_possible_wrap, reason = "at most 64")]
pub(crate) const fn shift(fraction_bits: u32) -> i32 {
    fraction_bits as i32
}

/// Four numbers of a body, loaded at once.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(16))]
pub(crate) struct Quad(pub(crate) [i32; 4]);

/// The three components of a motion: along x, along y, and turning.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion<T> {
    pub(crate) x: T,
    pub(crate) y: T,
    pub(crate) turn: T,
}

/// `N` lanes of 32-bit integers. Sums and differences wrap unless they are named otherwise.
pub(crate) trait Lanes<const N: usize>: Copy {
    type Int: Copy;
    /// Products.
    type Wide: Copy;
    /// A truth value for each lane.
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

    /// `a > b`.
    fn greater(a: Self::Int, b: Self::Int) -> Self::Mask;
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn either(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn any(mask: Self::Mask) -> bool;
    /// A bit for each lane, the first one lowest.
    fn bits(mask: Self::Mask) -> u32;
    /// In how many lanes it is true.
    fn count(mask: Self::Mask) -> u32;
    fn select(mask: Self::Mask, yes: Self::Int, no: Self::Int) -> Self::Int;
    /// -1 where it is true, 0 where it is not.
    fn to_int(mask: Self::Mask) -> Self::Int;
    /// Whether a number is negative.
    fn negative(a: Self::Int) -> Self::Mask;

    /// The exact product.
    fn mul(a: Self::Int, b: Self::Int) -> Self::Wide;
    fn add_wide(a: Self::Wide, b: Self::Wide) -> Self::Wide;
    fn sub_wide(a: Self::Wide, b: Self::Wide) -> Self::Wide;
    fn max_wide(a: Self::Wide, b: Self::Wide) -> Self::Wide;
    fn abs_wide(a: Self::Wide) -> Self::Wide;
    /// `a > b`.
    fn greater_wide(a: Self::Wide, b: Self::Wide) -> Self::Mask;
    /// `a / 2^SHIFT`, rounded to nearest, ties towards +infinity, of a number that then fits 32 bits. `SHIFT` is 1 to
    /// 32.
    fn narrow<const SHIFT: i32>(a: Self::Wide) -> Self::Int;
    /// The same of any number that rounding does not take out of its format, saturated, and where it was. `SHIFT` is 1 to 31.
    fn narrow_saturating<const SHIFT: i32>(a: Self::Wide) -> (Self::Int, Self::Mask);

    /// `a / 2^shift` of each lane, rounded to nearest, ties towards +infinity, saturated. `shift` is 1 to 61 and `a` at
    /// most 2^62 in magnitude.
    fn narrow_by(a: Self::Wide, shift: Self::Int) -> Self::Int;

    /// The lowest 32 bits, as a number between -2^31 and 2^31: what `narrow::<32>` leaves.
    fn low(a: Self::Wide) -> Self::Int;

    /// `a / 2^SHIFT` rounded down, of numbers that are not negative. `SHIFT` is 1 to 63.
    fn shift_down<const SHIFT: i32>(a: Self::Wide) -> Self::Wide;

    /// `1 / d`, both with 30 fraction bits, rounded down: of numbers below 2^46, and of less than 1 as of 1.
    #[inline(always)]
    fn reciprocal(d: Self::Wide) -> Self::Int {
        let mut quotients = Ints::ZERO;
        let d = Self::to_array(d);
        for (quotient, &d) in quotients.0.iter_mut().zip(&d) {
            *quotient = division::reciprocal(d);
        }
        Self::load(&quotients)
    }

    /// The entries `g11, g12, g22` of `G = K^-1` with 30 fraction bits, from those of `K - I` with 46: of what point blocks
    /// have, whose determinants are 1 to 2^27.
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

    /// The numbers of several places: the first of each, the second of each, and so on.
    #[inline(always)]
    fn quads(from: &[Quad], at: &[u32; N]) -> [Self::Int; 4] {
        // `map` would not be inlined into code for other instructions.
        let mut rows = [&from[at[0] as usize]; N];
        for (row, &at) in rows.iter_mut().zip(at) {
            *row = &from[at as usize];
        }
        Self::transposed(rows)
    }
    /// The first number of each row, the second of each, and so on.
    fn transposed(rows: [&Quad; N]) -> [Self::Int; 4];
    /// The velocities of bodies.
    fn velocities(bodies: &[Cell<SolverBody>], at: &[u32; N]) -> Motion<Self::Int>;
    /// How far bodies have come in the tick.
    fn shifts(bodies: &[Cell<SolverBody>], at: &[u32; N]) -> Motion<Self::Int>;
    /// Sets the velocities of bodies, but for those at [`GROUND`].
    fn set_velocities(bodies: &[Cell<SolverBody>], at: &[u32; N], velocities: Motion<Self::Int>);
    /// Sets how far bodies have come, but for those at the ground's place.
    fn set_shifts(bodies: &[Cell<SolverBody>], at: &[u32; N], shifts: Motion<Self::Int>);
}

/// What can be done with any lanes.
pub(crate) trait Kernel<const N: usize> {
    /// Must be `#[inline(always)]`, and so must whatever it calls with lanes: only then is it compiled for the
    /// instructions of its backend.
    fn run<L: Lanes<N>>(self);
}

/// A backend that this machine has: the best one, unless another is asked for.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Machine(Backend);

impl Machine {
    /// `None` if the machine does not have it.
    pub(crate) fn new(backend: Backend) -> Option<Self> {
        Backend::available().find(|&available| available == backend).map(Machine)
    }

    pub(crate) const fn backend(self) -> Backend {
        self.0
    }

    /// Whether eight lanes are faster than one at a time.
    pub(crate) fn has_vectors(self) -> bool {
        self.0 != Backend::Scalar
    }

    /// Runs a kernel.
    #[inline]
    pub(crate) fn run(self, kernel: impl Kernel<WIDTH>) {
        match self.0 {
            Backend::Scalar => kernel.run::<Scalar<WIDTH>>(),
            backend => Native::run(backend, kernel),
        }
    }
}

/// How the solver computes. It changes how fast, never what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Backend {
    /// In plain integers: everywhere.
    Scalar,
    /// In vectors of 256 bits: most x86-64 processors since 2013.
    Avx2,
    /// In vectors of 512 bits: most x86-64 servers since 2017, and desktop processors with AVX-512.
    Avx512,
    /// In vectors of 128 bits: every 64-bit Arm processor.
    Neon,
    /// In vectors of 128 bits: WebAssembly, compiled with `-C target-feature=+simd128`.
    Simd128,
}

impl Backend {
    /// Every backend that this machine can run, the best one last. Without the feature `std` only what the program was
    /// compiled for is known.
    pub fn available() -> impl Iterator<Item = Backend> {
        core::iter::once(Backend::Scalar).chain(Native::backends())
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
