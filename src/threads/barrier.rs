//! Spin barrier.

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

#[cfg(test)]
mod tests {
    use super::*;

    /// In each round one member stores the number of the round, and all members read it after a barrier.
    #[test]
    fn nobody_leaves_before_the_last_has_arrived() {
        const MEMBERS: usize = 4;
        let (barrier, turn) = (Barrier::new(MEMBERS), AtomicUsize::new(0));
        std::thread::scope(|scope| {
            for member in 0..MEMBERS {
                let (barrier, turn) = (&barrier, &turn);
                scope.spawn(move || {
                    for round in 0..200 {
                        if round % MEMBERS == member {
                            turn.store(round, Ordering::Relaxed);
                        }
                        barrier.wait();
                        assert_eq!(turn.load(Ordering::Relaxed), round);
                        barrier.wait();
                    }
                });
            }
        });
    }

    #[test]
    fn a_member_that_panics_frees_the_others() {
        let barrier = &Barrier::new(2);
        let others = std::thread::scope(|scope| {
            let waits = scope.spawn(|| {
                let _guard = Guard(barrier);
                barrier.wait();
            });
            let panics = scope.spawn(|| {
                let _guard = Guard(barrier);
                panic!("planted");
            });
            [waits.join().is_err(), panics.join().is_err()]
        });
        assert_eq!(others, [true, true]);
    }
}
