//! No vectors: for processors that no other file here is for.

use super::{Backend, Kernel, Scalar, WIDTH};

pub(super) struct Native;

impl Native {
    pub(super) const fn backend() -> Option<Backend> {
        None
    }

    pub(super) fn run(kernel: impl Kernel<WIDTH>) {
        kernel.run::<Scalar<WIDTH>>();
    }
}
