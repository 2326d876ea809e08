//! Fallback without vectors, for target architectures that have no backend.

use super::{Backend, Kernel, Scalar, WIDTH};

pub(super) struct Native;

impl Native {
    pub(super) const IS_SOLE: bool = true;
    pub(super) const HAS_VECTORS: bool = false;

    pub(super) fn backends() -> impl Iterator<Item = Backend> {
        core::iter::empty()
    }

    pub(super) fn run(_: Backend, kernel: impl Kernel<WIDTH>) {
        kernel.run::<Scalar<WIDTH>>();
    }
}
