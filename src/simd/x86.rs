//! Vector backends of x86-64: AVX2 and AVX-512, detected at run time if the feature `std` is enabled.
#![expect(unsafe_code, reason = "vendor intrinsics")]

#[path = "x86/avx2.rs"]
mod avx2;
#[path = "x86/avx512.rs"]
mod avx512;
#[path = "x86/records.rs"]
mod records;

use super::{Backend, Kernel};
use avx2::Avx2;
use avx512::Avx512;

pub(crate) const WIDTH: usize = 8;

#[derive(Clone, Copy, Debug)]
pub(crate) enum Vectors {
    Avx2,
    Avx512,
}

/// Whether the processor has these features: detected at run time with `std`, otherwise by the target features.
macro_rules! has {
    ($($feature:tt),+) => {{
        #[cfg(feature = "std")]
        let has = $(std::arch::is_x86_feature_detected!($feature))&&+;
        #[cfg(not(feature = "std"))]
        let has = $(cfg!(target_feature = $feature))&&+;
        has
    }};
}

impl Vectors {
    /// Whether the scalar backend is compiled in as well.
    pub(super) const ARE_OPTIONAL: bool = true;

    pub(super) fn backends() -> impl Iterator<Item = Backend> {
        let avx2 = has!("avx2").then_some(Backend::Avx2);
        let wide = has!("avx2", "avx512f", "avx512cd", "avx512dq", "bmi2", "popcnt");
        avx2.into_iter().chain(wide.then_some(Backend::Avx512))
    }

    /// The vectors of AVX2 or AVX-512, which the processor must have; `None` for other backends.
    #[inline]
    pub(super) fn of(backend: Backend) -> Option<Self> {
        match backend {
            Backend::Avx2 => Some(Vectors::Avx2),
            Backend::Avx512 => Some(Vectors::Avx512),
            _ => None,
        }
    }

    pub(crate) fn run(self, kernel: impl Kernel<WIDTH>) {
        #[target_feature(enable = "avx2")]
        unsafe fn with_avx2(kernel: impl Kernel<WIDTH>) {
            kernel.run::<Avx2>();
        }
        #[target_feature(enable = "avx2,avx512f,avx512cd,avx512dq,bmi2,popcnt")]
        unsafe fn with_avx512(kernel: impl Kernel<WIDTH>) {
            kernel.run::<Avx512>();
        }
        // SAFETY: a `Machine` is only created for a backend that the processor has.
        unsafe {
            match self {
                Vectors::Avx2 => with_avx2(kernel),
                Vectors::Avx512 => with_avx512(kernel),
            }
        }
    }
}
