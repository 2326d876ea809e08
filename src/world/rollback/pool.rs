//! Bodies that are packed in the step, for snapshots that share them with the world.
//!
//! Who saves or hashes one tick does so with the next. Then the step packs the bodies while it has them at hand, and a
//! save has nothing to copy of them.

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::sync::atomic::{AtomicBool, Ordering};

use super::bodies::PackedBodies;

/// How many are kept to be used again: a ring of snapshots gives back what it has had for so many ticks.
const USED_MAX: usize = 16;

/// The packed bodies of a world, a cache.
#[derive(Debug, Default)]
pub(in crate::world) struct Pool {
    /// As the state has them.
    current: Option<Arc<PackedBodies>>,
    /// As it had them, oldest first. Those that no snapshot has any more may be written over.
    used: Vec<Arc<PackedBodies>>,
    /// Whether the state has been saved or hashed since the last step.
    is_wanted: AtomicBool,
}

impl Clone for Pool {
    fn clone(&self) -> Self {
        let is_wanted = AtomicBool::new(self.is_wanted.load(Ordering::Relaxed));
        Pool { current: self.current.clone(), used: Vec::new(), is_wanted }
    }
}

impl Pool {
    /// Those of the state as it is, if they are there.
    pub(in crate::world) fn current(&self) -> Option<&Arc<PackedBodies>> {
        self.current.as_ref()
    }

    /// Says that the state is saved or hashed.
    pub(in crate::world) fn want(&self) {
        self.is_wanted.store(true, Ordering::Relaxed);
    }

    /// Says that the state changes.
    pub(in crate::world) fn forget(&mut self) {
        if let Some(packed) = self.current.take() {
            if self.used.len() == USED_MAX {
                self.used.remove(0);
            }
            self.used.push(packed);
        }
    }

    /// Room for those of the end of a step, if they will be wanted.
    pub(in crate::world) fn room(&mut self) -> Option<Arc<PackedBodies>> {
        self.forget();
        core::mem::take(self.is_wanted.get_mut()).then(|| {
            let unused = self.used.iter_mut().position(|packed| Arc::get_mut(packed).is_some());
            unused.map_or_else(Arc::default, |place| self.used.remove(place))
        })
    }

    /// Takes those of the state, which has not changed since.
    pub(in crate::world) fn keep(&mut self, packed: Option<Arc<PackedBodies>>) {
        self.current = packed;
    }
}
