//! Spin barrier.

#[cfg(test)]
mod tests;

use core::hint;
use core::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Number of spins after which a waiting member yields. They take some microseconds. The member yields because another
/// member, for which it waits, may need the processor.
const SPINS: u32 = 100;

/// Lets `count` members wait for each other, any number of times.
#[derive(Debug)]
pub(super) struct Barrier {
    count: usize,
    /// Number of members that have arrived at the current wait.
    arrived: AtomicUsize,
    generation: AtomicUsize,
    /// Whether a member has panicked, so that it will not arrive.
    is_broken: AtomicBool,
}

impl Barrier {
    pub(super) fn new(count: usize) -> Self {
        Barrier {
            count,
            arrived: AtomicUsize::new(0),
            generation: AtomicUsize::new(0),
            is_broken: AtomicBool::new(false),
        }
    }

    /// Waits until all members have arrived. Earlier writes of a member are then visible to all members.
    ///
    /// # Panics
    ///
    /// If a member has panicked.
    pub(super) fn wait(&self) {
        let generation = self.generation.load(Ordering::Acquire);
        if self.arrived.fetch_add(1, Ordering::AcqRel) + 1 == self.count {
            self.arrived.store(0, Ordering::Relaxed);
            self.generation.store(generation.wrapping_add(1), Ordering::Release);
            return;
        }
        let mut spins = 0;
        while self.generation.load(Ordering::Acquire) == generation {
            assert!(!self.is_broken.load(Ordering::Relaxed), "another thread of the tick has panicked");
            if spins < SPINS {
                spins += 1;
                hint::spin_loop();
            } else {
                std::thread::yield_now();
            }
        }
    }
}

/// Breaks the barrier when it is dropped, as by a panic. A member that finishes its work passes its guard to
/// `mem::forget`, so that the barrier stays intact.
pub(super) struct Guard<'a>(pub(super) &'a Barrier);

impl Drop for Guard<'_> {
    fn drop(&mut self) {
        self.0.is_broken.store(true, Ordering::Relaxed);
    }
}
