//! Thread pool for the work of a tick. The number of threads changes the speed, never the result: work is divided into
//! jobs that do not read each other's results.

/// Threads of a world: only the calling thread, unless the feature `parallel` is enabled and more are requested.
#[derive(Clone, Debug, Default)]
pub(crate) struct Threads {
    #[cfg(feature = "parallel")]
    pool: Option<alloc::sync::Arc<rayon::ThreadPool>>,
}

/// Number of jobs per thread: more than one, because some jobs take longer than others.
const JOBS_PER_THREAD: usize = 4;

impl Threads {
    /// Creates a pool of `count` threads, at least 1. Returns `None` if the threads cannot be started.
    #[cfg(feature = "parallel")]
    pub(crate) fn new(count: usize) -> Option<Self> {
        if count <= 1 {
            return Some(Threads::default());
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().ok()?;
        Some(Threads { pool: Some(alloc::sync::Arc::new(pool)) })
    }

    /// Number of threads.
    #[cfg(feature = "parallel")]
    pub(crate) fn count(&self) -> usize {
        self.pool.as_ref().map_or(1, |pool| pool.current_num_threads())
    }

    /// Number of threads.
    #[cfg(not(feature = "parallel"))]
    #[expect(clippy::unused_self, reason = "same signature as with the feature")]
    pub(crate) const fn count(&self) -> usize {
        1
    }

    /// Number of items, of `count`, that one job should process: all of them for one thread, otherwise at least
    /// `least`.
    pub(crate) fn share(&self, count: usize, least: usize) -> usize {
        match self.count() {
            1 => count.max(1),
            threads => count.div_ceil(threads * JOBS_PER_THREAD).max(least),
        }
    }

    /// Runs `work` on a thread of the pool. Spawning jobs from there costs much less than from outside.
    #[cfg(feature = "parallel")]
    pub(crate) fn install(&self, work: impl FnOnce() + Send) {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }

    /// Runs `work` on the calling thread.
    #[cfg(not(feature = "parallel"))]
    #[expect(clippy::unused_self, reason = "same signature as with the feature")]
    pub(crate) fn install(&self, work: impl FnOnce() + Send) {
        work();
    }

    /// Runs every job, in an unspecified order, and returns the sum of their results.
    #[cfg(feature = "parallel")]
    pub(crate) fn run<J: Send>(
        &self,
        jobs: impl Iterator<Item = J> + Send,
        work: impl Fn(J) -> u64 + Sync,
    ) -> u64 {
        use core::sync::atomic::{AtomicU64, Ordering};

        let Some(pool) = &self.pool else { return jobs.map(work).sum() };
        let mut jobs = jobs;
        let Some(first) = jobs.next() else { return 0 };
        // Small worlds have a single job, which is not worth waking another thread.
        let Some(second) = jobs.next() else { return work(first) };
        let (work, total) = (&work, &AtomicU64::new(0));
        pool.scope(|scope| {
            for job in [first, second].into_iter().chain(jobs) {
                scope.spawn(move |_| {
                    total.fetch_add(work(job), Ordering::Relaxed);
                });
            }
        });
        total.load(Ordering::Relaxed)
    }

    /// Runs every job, in an unspecified order, and returns the sum of their results.
    #[cfg(not(feature = "parallel"))]
    #[expect(clippy::unused_self, reason = "same signature as with the feature")]
    pub(crate) fn run<J: Send>(
        &self,
        jobs: impl Iterator<Item = J> + Send,
        work: impl Fn(J) -> u64 + Sync,
    ) -> u64 {
        jobs.map(work).sum()
    }
}
