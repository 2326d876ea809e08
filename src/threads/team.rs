//! A team: the calling thread and the threads of a pool.

use core::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use alloc::vec::Vec;
use std::sync::{Mutex, PoisonError, TryLockError};

use super::barrier::{Barrier, Guard};
use super::pace::{Mode, Pace};
use super::{Member, Sharing};

/// Number of polls after which a thread without work yields.
const LOOKS: u32 = 1000;

/// Number of spins of the calling thread at the end of [`Team::run`], while the other threads return from the last
/// barrier. Without these spins, the calling thread would go to sleep, and waking it would take 50 microseconds.
const RETURN_SPINS: u32 = 100;

#[derive(Debug)]
pub(super) struct Team {
    /// All threads but the calling one.
    pool: rayon::ThreadPool,
    /// Held during a tick, because worlds that are clones of each other share a team. If two worlds used the team at
    /// once, each could wait for a thread that waits at the barrier of the other world. The mutex contains `None` for
    /// [`Sharing::Always`].
    turn: Mutex<Option<Pace>>,
}

/// Tells the other threads that the tick is over, even if the calling thread panics.
struct TickEnd<'a>(&'a AtomicBool);

impl Drop for TickEnd<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}

/// Runs tasks of the pool until the tick is over.
fn run_stages(is_over: &AtomicBool) {
    let mut looks = 0;
    while !is_over.load(Ordering::Acquire) {
        if rayon::yield_now() == Some(rayon::Yield::Executed) {
            looks = 0;
        } else if looks < LOOKS {
            looks += 1;
            core::hint::spin_loop();
        } else {
            std::thread::yield_now();
        }
    }
}

impl Team {
    pub(super) fn new(count: usize, sharing: Sharing) -> Option<Self> {
        let name = |number: usize| alloc::format!("lockstep2d {}", number + 1);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count - 1).thread_name(name).build().ok()?;
        let pace = (sharing == Sharing::Adaptive).then(Pace::new);
        Some(Team { pool, turn: Mutex::new(pace) })
    }

    pub(super) fn count(&self) -> usize {
        self.pool.current_num_threads() + 1
    }

    /// Runs a tick of a world with `bodies` active bodies. All threads share it, unless [`Pace`] chooses the calling
    /// thread or another tick uses the team.
    pub(super) fn run_tick<R>(&self, bodies: usize, tick: impl FnOnce(usize) -> R) -> R {
        let mut turn = match self.turn.try_lock() {
            Ok(turn) => turn,
            Err(TryLockError::Poisoned(turn)) => turn.into_inner(),
            Err(TryLockError::WouldBlock) => return tick(1),
        };
        let Some(pace) = &mut *turn else { return self.share_tick(tick) };
        let mode = pace.mode();
        #[expect(clippy::disallowed_types, reason = "chooses threads; no result depends on their number")]
        let start = std::time::Instant::now();
        let result = match mode {
            Mode::Alone => tick(1),
            Mode::Team => self.share_tick(tick),
        };
        pace.record(mode, start.elapsed(), bodies);
        result
    }

    /// Runs a tick with all threads. The threads stay awake between the stages, because waking a thread takes 50
    /// microseconds.
    fn share_tick<R>(&self, tick: impl FnOnce(usize) -> R) -> R {
        let is_over = &AtomicBool::new(false);
        self.pool.in_place_scope(|scope| {
            scope.spawn_broadcast(|_, _| run_stages(is_over));
            let _end = TickEnd(is_over);
            tick(self.count())
        })
    }

    /// Runs `work` on the first part in the calling thread, and on each of the others in a thread of its own. Returns
    /// the sum of the results. Must be called in a tick.
    pub(super) fn run<P: Send>(
        &self,
        first: P,
        others: impl Iterator<Item = P>,
        work: impl Fn(P, Member<'_>) -> u64 + Sync,
    ) -> u64 {
        let others: Vec<_> = others.map(|part| Mutex::new(Some(part))).collect();
        let (barrier, total) = (&Barrier::new(others.len() + 1), &AtomicU64::new(0));
        let run = |part: P| {
            let guard = Guard(barrier);
            total.fetch_add(work(part, Member { barrier: Some(barrier) }), Ordering::Relaxed);
            barrier.wait();
            core::mem::forget(guard);
        };
        self.pool.in_place_scope(|scope| {
            scope.spawn_broadcast(|_, context| {
                let part = others.get(context.index()).map(Mutex::lock);
                let part = part.and_then(|part| part.unwrap_or_else(PoisonError::into_inner).take());
                part.into_iter().for_each(&run);
            });
            run(first);
            (0..RETURN_SPINS).for_each(|_| core::hint::spin_loop());
        });
        total.load(Ordering::Relaxed)
    }
}
