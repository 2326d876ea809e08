//! Placeholder for target architectures that have no vector backend.

use super::{Backend, Kernel};

pub(crate) const WIDTH: usize = 8;

#[derive(Clone, Copy, Debug)]
pub(crate) enum Vectors {}

impl Vectors {
    pub(super) const ARE_OPTIONAL: bool = true;

    pub(super) fn backends() -> impl Iterator<Item = Backend> {
        core::iter::empty()
    }

    pub(super) fn of(_: Backend) -> Option<Self> {
        None
    }

    pub(crate) fn run(self, _: impl Kernel<WIDTH>) {
        match self {}
    }
}
