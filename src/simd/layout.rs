//! Data for kernels, laid out for the backend of the machine.

use super::{Machine, Vectors};

/// Data for kernels: for [`WIDTH`](super::WIDTH) lanes if the backend has vectors, and otherwise for one lane. Without
/// vectors, arrays of integers would be slower than single integers, and would compile to several times as much code.
#[derive(Clone, Debug)]
pub(crate) enum Layout<W, S> {
    Wide(W, Vectors),
    Single(S),
}

/// Evaluates an expression for the data of either layout.
macro_rules! with_data {
    ($layout:expr, $data:pat => $value:expr) => {
        match $layout {
            $crate::simd::Layout::Wide($data, _) => $value,
            $crate::simd::Layout::Single($data) => $value,
        }
    };
}
pub(crate) use with_data;

impl<W, S: Default> Default for Layout<W, S> {
    fn default() -> Self {
        Layout::Single(S::default())
    }
}

impl<W: Default, S: Default> Layout<W, S> {
    /// Sets the layout for a machine. If the layout changes, the data is replaced by empty data.
    pub(crate) fn fit(&mut self, machine: Machine) {
        match (machine.vectors(), &mut *self) {
            (Some(new), Layout::Wide(_, vectors)) => *vectors = new,
            (Some(vectors), Layout::Single(_)) => *self = Layout::Wide(W::default(), vectors),
            (None, Layout::Wide(..)) => *self = Layout::default(),
            (None, Layout::Single(_)) => {}
        }
    }
}
