//! No vectors: for processors that no other file here is for.

use super::{Backend, Kernel, Scalar, WIDTH};

pub(super) struct Native;

impl Native {
    pub(super) fn backends() -> impl Iterator<Item = Backend> {
        core::iter::empty()
    }

    pub(super) fn run(_: Backend, kernel: impl Kernel<WIDTH>) {
        kernel.run::<Scalar<WIDTH>>();
    }
}
